//! Refusal of a key, and overriding of coefficients in a table.

use crate::coefficients::Row;
use std::collections::BTreeMap;

/// A key, its value and the limit it broke.
pub(super) type Refusal = (String, String, String);

/// Replaces coefficients of a row by those of the same name in a table.
pub(super) fn override_by_name(
    row: &mut Row,
    table: &BTreeMap<String, toml::Value>,
    columns: &[String],
    has: &str,
) -> Result<(), Refusal> {
    for (key, value) in table {
        if !columns.contains(key) {
            let limit = format!("unknown key; {has} the coefficients {}", columns.join(", "));
            return Err((key.clone(), value.to_string(), limit));
        }
        let number = match value {
            toml::Value::Float(number) => *number,
            toml::Value::Integer(number) => *number as f64,
            _ => return Err((key.clone(), value.to_string(), "must be a number".to_owned())),
        };
        if !number.is_finite() {
            return Err((key.clone(), value.to_string(), "must be finite".to_owned()));
        }
        row.insert(key.clone(), number);
    }
    Ok(())
}
