//! Which line is what: by the user's map, by layer, by colour.

use crate::colour;
use softfold_geometry::Role;
use std::collections::BTreeMap;

/// The user's own word on roles; it wins over everything that a file says. `None` leaves lines out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoleMap {
    /// By stroke colour; the nearest of these and of the usual colours decides.
    pub colours: Vec<([u8; 3], Option<Role>)>,
    /// By layer name (SVG: label or id of a group around the line), without regard to case.
    pub layers: BTreeMap<String, Option<Role>>,
    /// By element id.
    pub elements: BTreeMap<String, Option<Role>>,
}

/// Layer names of tools and workshops, whole or as a word of the name, and what they mean. Where a name has
/// words of several rows, the first row decides.
const LAYERS: [(&[&str], Role); 6] = [
    (&["mountain", "mountainline", "fold_mountain", "iv_bend_down", "bend_down"], Role::Mountain),
    (&["valley", "valleyline", "fold_valley", "iv_bend", "bend", "bend_up"], Role::Valley),
    (
        &[
            "outline",
            "boundary",
            "border",
            "contour",
            "profile",
            "cutline",
            "cut",
            "iv_outer_profile",
            "iv_interior_profiles",
            "openings",
            "outer",
            "edge",
        ],
        Role::Boundary,
    ),
    (&["slit", "slits", "halfcut"], Role::Cut),
    (&["flat", "auxiliary", "auxiliaryline", "facet", "ruling", "rulings"], Role::Flat),
    (&["crease", "score", "fold", "unassigned", "perforation"], Role::Unassigned),
];

/// What a layer's name says; none if nothing.
pub(crate) fn role_of_layer(name: &str) -> Option<Role> {
    let lower = name.to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).collect();
    let says = |names: &[&str]| names.iter().any(|n| lower == *n || words.contains(n));
    LAYERS.iter().find(|(names, _)| says(names)).map(|(_, role)| *role)
}

impl RoleMap {
    /// The user's word on an element with these ids, layers (innermost first) and colour: `Some(None)` leaves it
    /// out, `None` says nothing.
    pub(crate) fn of(&self, id: Option<&str>, layers: &[&str], rgb: Option<[u8; 3]>) -> Option<Option<Role>> {
        let by_id = id.and_then(|id| self.elements.get(id).copied());
        let layer = |name: &&str| {
            let same = |(l, _): &(&String, _)| l.to_lowercase() == name.to_lowercase();
            self.layers.iter().find(same).map(|(_, role)| *role)
        };
        let by_colour = || colour::nearest_of(&self.colours, rgb?);
        by_id.or_else(|| layers.iter().find_map(layer)).or_else(by_colour)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_of_the_field_have_their_roles() {
        for (name, role) in [
            ("MountainLine", Some(Role::Mountain)),
            ("ORIGAMI_VALLEY", Some(Role::Valley)),
            ("IV_BEND_DOWN", Some(Role::Mountain)),
            ("IV_BEND", Some(Role::Valley)),
            ("CutLine", Some(Role::Boundary)),
            ("PROFILE_THROUGH", Some(Role::Boundary)),
            ("AuxiliaryLine", Some(Role::Flat)),
            ("SCORE", Some(Role::Unassigned)),
            ("FOLD_MOUNTAIN", Some(Role::Mountain)),
            ("0", None),
            ("NOTES_IGNORE", None),
        ] {
            assert_eq!(role_of_layer(name), role, "{name}");
        }
    }

    #[test]
    fn an_element_wins_over_its_layer_and_a_layer_over_its_colour() {
        let map = RoleMap {
            colours: vec![([255, 128, 0], Some(Role::Valley))],
            layers: [("Notes".to_owned(), None)].into(),
            elements: [("a".to_owned(), Some(Role::Cut))].into(),
        };
        assert_eq!(map.of(Some("a"), &["notes"], None), Some(Some(Role::Cut)));
        assert_eq!(map.of(Some("b"), &["notes"], Some([255, 128, 0])), Some(None));
        assert_eq!(map.of(None, &["other"], Some([255, 120, 10])), Some(Some(Role::Valley)));
        assert_eq!(map.of(None, &[], Some([255, 0, 0])), None, "the usual red is nearer");
        assert_eq!(RoleMap::default().of(None, &[], Some([1, 2, 3])), None);
    }
}
