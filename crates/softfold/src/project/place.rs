//! Points of the sheet as a project names them: by (u, v), by a crease or by the outline.

use serde::Deserialize;

/// A point of the sheet.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    untagged,
    expecting = "give [u, v], or { crease = \"NAME\", at_mm = LENGTH }, or { outline_mm = LENGTH }; share = 0 to 1 in place of lengths"
)]
pub enum Place {
    /// (u, v), mm.
    Uv([f64; 2]),
    /// On a crease as it is drawn.
    Crease(OnCrease),
    /// On the outline.
    Outline(OnOutline),
}

/// `{ crease = "NAME", at_mm = LENGTH }`, or with `share` of its length.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct OnCrease {
    /// Name of the crease.
    pub crease: String,
    /// Arc length from its start, mm.
    pub at_mm: Option<f64>,
    /// The same as share of its length.
    pub share: Option<f64>,
}

/// `{ outline_mm = LENGTH }` or `{ outline_share = SHARE }`.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct OnOutline {
    /// Arc length from its start, counter-clockwise, mm.
    pub outline_mm: Option<f64>,
    /// The same as share of its length.
    pub outline_share: Option<f64>,
}

/// A point of the sheet, or all vertices in a region.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    untagged,
    expecting = "give [u, v], or { crease = \"NAME\", at_mm = LENGTH }, or { outline_mm = LENGTH }, or { region = [[u, v], ...] }"
)]
pub enum Spot {
    /// One point.
    Place(Place),
    /// The vertices of the mesh in a polygon.
    Region(Region),
}

/// `{ region = [[u, v], ...] }`
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Corners of the polygon, mm.
    pub region: Vec<[f64; 2]>,
}

/// What a place must be.
pub(super) const MEND: &str = "places must be finite numbers: [u, v], { crease = \"NAME\", at_mm or share = NUMBER }, or \
                               { outline_mm or outline_share = NUMBER }, with one of the two keys and shares from 0 to 1";

impl Place {
    /// Whether it says one place.
    pub(super) fn is_fine(&self) -> bool {
        match self {
            Place::Uv(uv) => super::number::finite(uv),
            Place::Crease(c) => one_of(c.at_mm, c.share),
            Place::Outline(o) => one_of(o.outline_mm, o.outline_share),
        }
    }
}

impl Spot {
    pub(super) fn is_fine(&self) -> bool {
        match self {
            Spot::Place(place) => place.is_fine(),
            Spot::Region(r) => r.region.len() > 2 && r.region.iter().all(|p| super::number::finite(p)),
        }
    }
}

fn one_of(length_mm: Option<f64>, share: Option<f64>) -> bool {
    match (length_mm, share) {
        (Some(s), None) => s >= 0.0 && s.is_finite(),
        (None, Some(share)) => (0.0..=1.0).contains(&share),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct Holder {
        at: Vec<Spot>,
    }

    fn parse(at: &str) -> Result<Vec<Spot>, String> {
        toml::from_str::<Holder>(&format!("at = [{at}]")).map(|h| h.at).map_err(|e| e.message().to_owned())
    }

    #[test]
    fn every_way_to_name_a_place_is_read() {
        let said = "[1, 2], { crease = \"a\", share = 0.5 }, { outline_mm = 30 }, { region = [[0, 0], [1, 0], [0, 1]] }";
        let spots = parse(said).unwrap();
        assert!(spots.iter().all(Spot::is_fine));
        assert_eq!(spots[0], Spot::Place(Place::Uv([1.0, 2.0])));
        let crease = OnCrease { crease: "a".into(), at_mm: None, share: Some(0.5) };
        assert_eq!(spots[1], Spot::Place(Place::Crease(crease)));
        assert!(matches!((&spots[2], &spots[3]), (Spot::Place(Place::Outline(_)), Spot::Region(_))));
    }

    #[test]
    fn what_is_no_place_is_refused_with_the_mend() {
        assert!(parse("\"there\"").unwrap_err().contains("crease ="));
        assert!(parse("{ crease = \"a\", at = 3 }").unwrap_err().contains("at_mm"));
        for bad in [
            "{ crease = \"a\" }",
            "{ crease = \"a\", share = 1.5 }",
            "{ outline_mm = 3, outline_share = 0.1 }",
        ] {
            assert!(!parse(bad).unwrap()[0].is_fine(), "{bad}");
        }
        assert!(!parse("{ region = [[0, 0], [1, 0]] }").unwrap()[0].is_fine());
    }
}
