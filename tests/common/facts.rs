//! What outside readers say, taken apart.

#![allow(dead_code, reason = "each test binary uses its part")]

use serde_json::Value;

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

pub(crate) fn assert_near(what: &str, value: f64, wanted: f64, relative: f64) {
    let error = (value - wanted).abs() / wanted.abs();
    assert!(
        error <= relative,
        "{what}: {value} instead of {wanted}: off by {error:.2e}, allowed {relative:.0e}"
    );
}

/// The one product of a STEP file, by its name, in millimetres.
pub(crate) fn product(facts: &Value, name: &str) -> Value {
    let units: Vec<String> =
        facts["units"].as_array().unwrap().iter().map(|u| u.to_string().to_lowercase()).collect();
    assert_eq!(units, ["\"millimetre\""], "{name}");
    let products = facts["products"].as_array().unwrap();
    assert_eq!(products.len(), 1, "{name}: products");
    assert_eq!(products[0]["name"], name);
    assert_eq!(products[0]["valid"], true, "{name}");
    products[0].clone()
}

/// The volume of the one valid closed solid that a STEP file holds.
pub(crate) fn solid_volume(facts: &Value, name: &str) -> f64 {
    let product = product(facts, name);
    let solids = product["solids"].as_array().unwrap();
    assert_eq!(solids.len(), 1, "{name}: solids");
    assert!(solids[0]["valid"] == true && solids[0]["closed"] == true, "{name}: {}", solids[0]);
    number(&solids[0]["volume_mm3"])
}
