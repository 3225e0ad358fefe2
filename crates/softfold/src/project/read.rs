//! `[read]` and `[roles]`: how the pattern's file is understood.

use super::ProjectFault;
use super::number::{Number, Range, line_of};
use serde::Deserialize;
use softfold_geometry::Role;
use softfold_pattern::{ReadOptions, RoleMap};
use std::collections::BTreeMap;

/// `read.outline`
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Outline {
    /// The lines that are drawn as boundary.
    #[default]
    Drawn,
    /// The outermost lines, whatever their role.
    Lines,
    /// The convex hull of all lines.
    Hull,
}

/// `[read]`
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Read {
    /// Millimetres per unit of a pattern without a physical size.
    pub unit_mm: Option<f64>,
    /// What is the outline.
    pub outline: Outline,
    /// Which of several sheets, from 1 by falling area.
    pub sheet: Option<usize>,
    /// Which frame of a FOLD file, from 0.
    pub frame: Option<usize>,
    /// Dense polylines are refitted by smooth curves within this, mm; 0: never.
    pub refit_mm: Option<f64>,
    /// Ends closer than this are joined, mm.
    pub join_mm: Option<f64>,
    /// Gaps wider than this are refused, mm.
    pub refuse_mm: Option<f64>,
}

/// `[roles.colours]`, `[roles.layers]`, `[roles.elements]`: a letter of FOLD's, or `ignore`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Roles {
    /// By stroke colour, `#rrggbb`.
    pub colours: BTreeMap<String, String>,
    /// By layer.
    pub layers: BTreeMap<String, String>,
    /// By element id.
    pub elements: BTreeMap<String, String>,
}

impl Read {
    /// The options that a reader takes.
    pub fn options(&self, roles: RoleMap) -> ReadOptions {
        ReadOptions {
            unit_mm: self.unit_mm,
            roles,
            outline: match self.outline {
                Outline::Drawn => softfold_pattern::Outline::Drawn,
                Outline::Lines => softfold_pattern::Outline::Lines,
                Outline::Hull => softfold_pattern::Outline::Hull,
            },
            sheet: self.sheet,
            frame: self.frame,
            refit_mm: self.refit_mm,
            join_mm: self.join_mm,
            refuse_mm: self.refuse_mm,
        }
    }

    pub(super) fn numbers(&self) -> Vec<Number> {
        let wanted = [
            ("unit_mm", self.unit_mm, Range::Positive),
            ("sheet", self.sheet.map(|n| n as f64), Range::AtLeastOne),
            ("refit_mm", self.refit_mm, Range::NotNegative),
            ("join_mm", self.join_mm, Range::Positive),
            ("refuse_mm", self.refuse_mm, Range::Positive),
        ];
        wanted.into_iter().filter_map(|(k, v, range)| Some(Number::new("read", k, v?, range))).collect()
    }
}

impl Roles {
    /// The map that a reader takes.
    ///
    /// # Errors
    /// What is no colour or no role, with its table and key.
    pub fn map(&self) -> Result<RoleMap, (&'static str, String, String)> {
        let mut map = RoleMap::default();
        for (key, role) in &self.colours {
            let rgb = colour(key).ok_or_else(|| {
                ("roles.colours", key.clone(), format!("\"{key}\" is no colour; write #rrggbb"))
            })?;
            map.colours.push((rgb, role_of(role).ok_or_else(|| no_role("roles.colours", key, role))?));
        }
        for (key, role) in &self.layers {
            map.layers.insert(key.clone(), role_of(role).ok_or_else(|| no_role("roles.layers", key, role))?);
        }
        for (key, role) in &self.elements {
            map.elements
                .insert(key.clone(), role_of(role).ok_or_else(|| no_role("roles.elements", key, role))?);
        }
        Ok(map)
    }

    pub(super) fn check(&self, text: &str) -> Result<(), ProjectFault> {
        self.map().map(|_| ()).map_err(|(table, key, message)| {
            let line = line_of(text, table, &key).or_else(|| line_of(text, table, &format!("\"{key}\"")));
            ProjectFault { line, message: format!("[{table}]: {message}") }
        })
    }

    /// Takes a `KEY=ROLE` of the command line: `#rrggbb=V`, `layer:NAME=M`, `id:NAME=ignore`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn add(&mut self, word: &str) -> Result<(), String> {
        let form = "write #rrggbb=V, layer:NAME=M or id:NAME=ignore; roles are B, M, V, F, U, C and ignore";
        let (key, role) = word.rsplit_once('=').ok_or_else(|| format!("--role {word}: {form}"))?;
        let (table, name) = match key.split_once(':') {
            Some(("layer", name)) => (&mut self.layers, name),
            Some(("id", name)) => (&mut self.elements, name),
            _ => (&mut self.colours, key),
        };
        table.insert(name.to_owned(), role.to_owned());
        self.map().map(|_| ()).map_err(|(_, _, message)| format!("--role {word}: {message}; {form}"))
    }
}

fn no_role(table: &'static str, key: &str, role: &str) -> (&'static str, String, String) {
    let message = format!("\"{role}\" is no role; give B, M, V, F, U, C or ignore");
    (table, key.to_owned(), message)
}

/// A role by FOLD's letter; `Some(None)` for `ignore`.
fn role_of(word: &str) -> Option<Option<Role>> {
    let all = [Role::Boundary, Role::Mountain, Role::Valley, Role::Flat, Role::Unassigned, Role::Cut];
    if word.eq_ignore_ascii_case("ignore") {
        return Some(None);
    }
    all.into_iter().find(|r| word.eq_ignore_ascii_case(&r.letter().to_string())).map(Some)
}

fn colour(text: &str) -> Option<[u8; 3]> {
    let hex = text.strip_prefix('#').filter(|h| h.len() == 6 && h.is_ascii())?;
    let [_, r, g, b] = u32::from_str_radix(hex, 16).ok()?.to_be_bytes();
    Some([r, g, b])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_of_the_command_line_reach_their_tables() {
        let mut roles = Roles::default();
        for word in ["#FF8000=v", "layer:Notes=ignore", "id:a=b=U"] {
            roles.add(word).unwrap();
        }
        let map = roles.map().unwrap();
        assert_eq!(map.colours, [([255, 128, 0], Some(Role::Valley))]);
        assert_eq!(map.layers["Notes"], None);
        assert_eq!(map.elements["a=b"], Some(Role::Unassigned));
    }

    #[test]
    fn what_is_no_colour_or_role_is_named() {
        assert!(Roles::default().add("red=V").unwrap_err().contains("\"red\" is no colour"));
        assert!(Roles::default().add("layer:x=Q").unwrap_err().contains("\"Q\" is no role"));
        assert!(Roles::default().add("V").unwrap_err().contains("write #rrggbb=V"));
    }
}
