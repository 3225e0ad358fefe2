//! AutoCAD's colour numbers.

/// The first ten: black or white by the ground (0, 7), the pure colours, greys.
const FIRST: [[u8; 3]; 10] = [
    [0, 0, 0],
    [255, 0, 0],
    [255, 255, 0],
    [0, 255, 0],
    [0, 255, 255],
    [0, 0, 255],
    [255, 0, 255],
    [0, 0, 0],
    [128, 128, 128],
    [192, 192, 192],
];
/// The last six: from black to white.
const GREYS: [[u8; 3]; 6] =
    [[0, 0, 0], [101, 101, 101], [102, 102, 102], [153, 153, 153], [204, 204, 204], [255, 255, 255]];
/// Brightness of the five pairs of shades of a hue.
const SHADES: [f64; 5] = [255.0, 165.0, 127.0, 76.0, 38.0];
/// White, which is ink on a dark screen: black on paper.
const WHITE: [u8; 3] = [255, 255, 255];

/// The colour of a number, as on paper: 10 to 249 are 24 hues, each in five shades, full (even) and pale (odd).
/// None beyond 0 to 255.
pub(super) fn rgb(number: i64) -> Option<[u8; 3]> {
    let number = usize::try_from(number).ok().filter(|n| *n <= 255)?;
    Some(match number {
        0..=9 => FIRST[number],
        250.. => on_paper(GREYS[number - 250]),
        _ => {
            let hue_deg = 15.0 * (number / 10 - 1) as f64;
            let bright = SHADES[number % 10 / 2];
            let least = if number % 2 == 0 { 0.0 } else { 0.5 * bright };
            // Red, green and blue have their peaks at 0°, 120° and 240°.
            [0.0, 240.0, 120.0].map(|shift| {
                let share = (((hue_deg + shift) % 360.0 / 60.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
                (least + (bright - least) * share) as u8
            })
        }
    })
}

/// A true colour, `0xRRGGBB`, as on paper.
pub(super) fn rgb_of_true_colour(value: i64) -> [u8; 3] {
    on_paper([16, 8, 0].map(|shift| (value >> shift & 0xff) as u8))
}

fn on_paper(rgb: [u8; 3]) -> [u8; 3] {
    if rgb == WHITE { [0, 0, 0] } else { rgb }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::role_of;
    use softfold_geometry::Role;

    #[test]
    fn shades_are_those_of_the_palette() {
        // AutoCAD's palette as listed by other programs.
        for (number, hex) in [
            (10, 0xff_0000),
            (11, 0xff_7f7f),
            (13, 0xa5_5252),
            (19, 0x26_1313),
            (21, 0xff_9f7f),
            (30, 0xff_7f00),
            (94, 0x00_7f00),
            (130, 0x00_ffff),
            (170, 0x00_00ff),
        ] {
            assert_eq!(rgb(number), Some(rgb_of_true_colour(hex)), "{number}");
        }
        assert_eq!((rgb(-1), rgb(256)), (None, None));
    }

    #[test]
    fn usual_numbers_have_their_roles() {
        for (number, role) in [
            (1, Some(Role::Mountain)),
            (2, Some(Role::Flat)),
            (3, Some(Role::Cut)),
            (5, Some(Role::Valley)),
            (6, Some(Role::Unassigned)),
            (0, Some(Role::Boundary)),
            (7, Some(Role::Boundary)),
            (250, Some(Role::Boundary)),
            (255, Some(Role::Boundary)),
            (8, None),
            (4, None),
        ] {
            assert_eq!(role_of(rgb(number).unwrap()), role, "{number}");
        }
        assert_eq!(role_of(rgb_of_true_colour(0xff_ffff)), Some(Role::Boundary), "white is ink");
    }
}
