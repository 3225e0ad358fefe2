//! Boards placed on stock sheets.

use crate::error::{MoldError, Setting};
use glam::{DVec2, Vec2Swizzles as _};

/// The sheets that boards are cut from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockOptions {
    /// Length and width, mm.
    pub size_mm: [f64; 2],
    /// Kept free along the border, mm.
    pub margin_mm: f64,
    /// Kept free between boards, mm.
    pub spacing_mm: f64,
}

impl Default for StockOptions {
    /// A full plywood sheet; room for a 6 mm cutter on both sides of a cut.
    fn default() -> Self {
        Self { size_mm: [2440.0, 1220.0], margin_mm: 10.0, spacing_mm: 12.0 }
    }
}

impl StockOptions {
    pub(crate) fn check(&self) -> Result<(), MoldError> {
        let size = Setting::of("waffle", "stock_mm", "side of the stock sheet (mm)");
        self.size_mm.iter().try_for_each(|&side| size.positive(side))?;
        Setting::inner("margin of the stock sheet (mm)").not_negative(self.margin_mm)?;
        Setting::inner("spacing between boards (mm)").not_negative(self.spacing_mm)?;
        let least = self.size_mm[0].min(self.size_mm[1]);
        size.require(least > 2.0 * self.margin_mm, least, "it must be more than the margins on both sides")
    }
}

/// One board on a stock sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its number in the list that was nested.
    pub board: usize,
    /// Where the lower left corner of its box lies on the sheet, mm.
    pub position_mm: DVec2,
    /// Whether it was turned a quarter counter-clockwise.
    pub rotated: bool,
}

/// One stock sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// What is cut from it.
    pub placed: Vec<Placed>,
}

/// All stock sheets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nest {
    /// The sheets in order.
    pub sheets: Vec<Sheet>,
    /// The boxes' share of the area of the sheets.
    pub use_fraction: f64,
}

/// A row of boxes along the sheet's length.
struct Shelf {
    sheet: usize,
    y: f64,
    height: f64,
    x: f64,
}

/// Places boxes (mm) on as few sheets as shelves allow: the highest first, each on the first shelf with room, turned so
/// that its long side lies along the sheet. This is first-fit decreasing height (Coffman, Garey, Johnson and Tarjan,
/// 1980): at most 1.7 times the least height, and not a nest of true shapes: concave boards are not interlocked.
///
/// # Errors
/// A box larger than a sheet without its margin; options that make no sense.
pub fn nest(sizes: &[(String, DVec2)], stock: &StockOptions) -> Result<Nest, MoldError> {
    stock.check()?;
    let room = DVec2::from(stock.size_mm) - 2.0 * stock.margin_mm;
    let laid =
        sizes.iter().map(|(name, size)| lay(name, *size, room, stock)).collect::<Result<Vec<_>, _>>()?;
    let mut order: Vec<usize> = (0..laid.len()).collect();
    order.sort_by(|&a, &b| {
        let key = |i: usize| (laid[i].0.y, laid[i].0.x);
        key(b).0.total_cmp(&key(a).0).then(key(b).1.total_cmp(&key(a).1)).then(a.cmp(&b))
    });
    let (mut nest, mut shelves) = (Nest::default(), Vec::new());
    for board in order {
        let (size, rotated) = laid[board];
        let (sheet, corner) = put(&mut shelves, size, room, stock.spacing_mm);
        nest.sheets.resize_with(nest.sheets.len().max(sheet + 1), Sheet::default);
        let position_mm = corner + stock.margin_mm;
        nest.sheets[sheet].placed.push(Placed { board, position_mm, rotated });
    }
    let used: f64 = sizes.iter().map(|(_, s)| s.element_product()).sum();
    let whole = stock.size_mm[0] * stock.size_mm[1] * nest.sheets.len() as f64;
    nest.use_fraction = if whole > 0.0 { used / whole } else { 0.0 };
    Ok(nest)
}

/// The box as it lies on the sheet, and whether it was turned.
fn lay(name: &str, size: DVec2, room: DVec2, stock: &StockOptions) -> Result<(DVec2, bool), MoldError> {
    let fits = |s: DVec2| s.cmple(room).all();
    let long_first = size.x >= size.y;
    let ways = [(size, false), (size.yx(), true)];
    let [first, second] = if long_first == (room.x >= room.y) { ways } else { [ways[1], ways[0]] };
    [first, second].into_iter().find(|w| fits(w.0)).ok_or_else(|| MoldError::BoardTooLarge {
        name: name.into(),
        size_mm: size,
        stock_mm: stock.size_mm,
    })
}

/// The sheet and the corner for a box that fits an empty sheet.
fn put(shelves: &mut Vec<Shelf>, size: DVec2, room: DVec2, spacing_mm: f64) -> (usize, DVec2) {
    let with_room = |s: &&mut Shelf| size.y <= s.height && s.x + size.x <= room.x;
    if let Some(shelf) = shelves.iter_mut().find(with_room) {
        let corner = DVec2::new(shelf.x, shelf.y);
        shelf.x += size.x + spacing_mm;
        return (shelf.sheet, corner);
    }
    let sheets = shelves.last().map_or(0, |s| s.sheet + 1);
    let top = |sheet: usize| {
        let own = shelves.iter().filter(|s| s.sheet == sheet);
        own.map(|s| s.y + s.height + spacing_mm).fold(0.0, f64::max)
    };
    let sheet = (0..sheets).find(|&s| top(s) + size.y <= room.y).unwrap_or(sheets);
    let y = top(sheet);
    shelves.push(Shelf { sheet, y, height: size.y, x: size.x + spacing_mm });
    shelves.sort_by(|a, b| a.sheet.cmp(&b.sheet).then(a.y.total_cmp(&b.y)));
    (sheet, DVec2::new(0.0, y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes() -> Vec<(String, DVec2)> {
        let size = |k: usize| DVec2::new(300.0 + ((k * 271) % 800) as f64, 80.0 + ((k * 137) % 200) as f64);
        (0..30).map(|k| (format!("W{k}"), if k % 3 == 0 { size(k).yx() } else { size(k) })).collect()
    }

    #[test]
    fn nothing_overlaps_and_nothing_leaves_its_sheet() {
        let (boxes, stock) = (boxes(), StockOptions::default());
        let nest = nest(&boxes, &stock).unwrap();
        let corners = |p: &Placed| {
            let size = if p.rotated { boxes[p.board].1.yx() } else { boxes[p.board].1 };
            (p.position_mm, p.position_mm + size)
        };
        let placed: usize = nest.sheets.iter().map(|s| s.placed.len()).sum();
        assert_eq!(placed, 30);
        for sheet in &nest.sheets {
            for (i, a) in sheet.placed.iter().enumerate() {
                let (lower, upper) = corners(a);
                assert!(lower.min_element() >= 10.0 && upper.x <= 2430.0 && upper.y <= 1210.0);
                for b in &sheet.placed[..i] {
                    let (l, u) = corners(b);
                    let apart = (l - upper).max(lower - u).max_element();
                    assert!(apart >= 12.0 - 1e-9, "{a:?} {b:?}");
                }
            }
        }
        assert!(nest.use_fraction > 0.55, "{}", nest.use_fraction);
    }

    #[test]
    fn a_board_longer_than_the_sheet_is_refused_by_name() {
        let found = nest(&[("W7".into(), DVec2::new(2500.0, 90.0))], &StockOptions::default());
        assert!(found.unwrap_err().to_string().starts_with("waffle board W7 measures 2500 x 90 mm"));
    }

    #[test]
    fn no_boards_need_no_sheet() {
        assert_eq!(nest(&[], &StockOptions::default()).unwrap(), Nest::default());
    }
}
