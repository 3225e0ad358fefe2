//! Roles from stroke colours and from FOLD's letters.

use softfold_geometry::Role;

/// Origami Simulator's colours; CSS `green` is #008000, drawing programs write #00ff00.
const PALETTE: [([u8; 3], Role); 7] = [
    ([0, 0, 0], Role::Boundary),
    ([255, 0, 0], Role::Mountain),
    ([0, 0, 255], Role::Valley),
    ([255, 255, 0], Role::Flat),
    ([0, 255, 0], Role::Cut),
    ([0, 128, 0], Role::Cut),
    ([255, 0, 255], Role::Unassigned),
];
/// Farthest a colour may be from its palette colour, as a distance in RGB of 0..=255. Royal blue
/// (65, 105, 225), which pattern editors write for valleys, is 127 from blue; mid grey is 221 from black.
pub(crate) const REACH: f64 = 130.0;

/// The role whose colour is nearest; none if all are farther than [`REACH`].
#[allow(dead_code)] // for formats whose colours need no remark
pub(crate) fn role_of(rgb: [u8; 3]) -> Option<Role> {
    nearest(rgb).map(|(role, _)| role)
}

/// The role whose colour is nearest and the distance to it; none if all are farther than [`REACH`].
pub(crate) fn nearest(rgb: [u8; 3]) -> Option<(Role, f64)> {
    let (d, role) = PALETTE
        .iter()
        .map(|&(p, role)| (distance(rgb, p), role))
        .fold((f64::INFINITY, Role::Boundary), |best, next| if next.0 < best.0 { next } else { best });
    (d <= REACH).then_some((role, d))
}

/// The user's role for a colour, if one of the user's colours is nearest; none if a usual one is, or if all are
/// farther than [`REACH`].
pub(crate) fn nearest_of(own: &[([u8; 3], Option<Role>)], rgb: [u8; 3]) -> Option<Option<Role>> {
    let usual = PALETTE.iter().map(|&(p, _)| distance(rgb, p)).fold(REACH, f64::min);
    own.iter()
        .map(|&(p, role)| (distance(rgb, p), role))
        .filter(|(d, _)| *d <= usual)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, role)| role)
}

/// The colour in which a role is written.
pub(crate) fn colour_of(role: Role) -> &'static str {
    match role {
        Role::Boundary => "#000000",
        Role::Mountain => "#ff0000",
        Role::Valley => "#0000ff",
        Role::Flat => "#ffff00",
        Role::Cut => "#00ff00",
        Role::Unassigned => "#ff00ff",
    }
}

/// The role of one of FOLD's letters.
pub(crate) fn role_of_letter(letter: &str) -> Option<Role> {
    match letter.trim() {
        "B" | "b" => Some(Role::Boundary),
        "M" | "m" => Some(Role::Mountain),
        "V" | "v" => Some(Role::Valley),
        "F" | "f" => Some(Role::Flat),
        "U" | "u" => Some(Role::Unassigned),
        "C" | "c" => Some(Role::Cut),
        _ => None,
    }
}

fn distance(a: [u8; 3], b: [u8; 3]) -> f64 {
    let square = |i: usize| (f64::from(a[i]) - f64::from(b[i])).powi(2);
    (square(0) + square(1) + square(2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_colours_of_pattern_editors_have_their_roles() {
        for (rgb, role) in [
            ([220, 20, 60], Some(Role::Mountain)), // crimson
            ([65, 105, 225], Some(Role::Valley)),  // royalblue
            ([0, 128, 0], Some(Role::Cut)),        // green
            ([255, 215, 0], Some(Role::Flat)),     // gold
            ([35, 31, 32], Some(Role::Boundary)),  // a printer's black
            ([237, 28, 36], Some(Role::Mountain)), // a printer's red
            ([128, 128, 128], None),               // grey
            ([255, 255, 255], None),               // white
        ] {
            assert_eq!(role_of(rgb), role, "{rgb:?}");
        }
    }

    #[test]
    fn colours_and_letters_round_trip() {
        for role in [Role::Boundary, Role::Mountain, Role::Valley, Role::Flat, Role::Cut, Role::Unassigned] {
            let hex = u32::from_str_radix(&colour_of(role)[1..], 16).unwrap().to_be_bytes();
            assert_eq!(role_of([hex[1], hex[2], hex[3]]), Some(role));
            assert_eq!(role_of_letter(&role.letter().to_string()), Some(role));
        }
        assert_eq!(role_of_letter("J"), None);
    }
}
