//! Numbers of a phantom file, changed by their key.

use toml::{Table, Value};

use super::Input;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;

/// A phantom as the table of its file.
///
/// # Errors
/// As [`Phantom::to_toml`].
pub fn table(phantom: &Phantom) -> Result<Table, Refusal> {
    let text = phantom.to_toml()?;
    text.parse().map_err(|error| Refusal::state(error, ""))
}

/// The number at a key such as `layer[1].thickness_mm`.
pub fn number<'a>(table: &'a mut Table, key: &str) -> Option<&'a mut f64> {
    let mut keys = key.split('.');
    let mut value = entry(table, keys.next()?)?;
    for key in keys {
        value = entry(value.as_table_mut()?, key)?;
    }
    match value {
        Value::Float(number) => Some(number),
        _ => None,
    }
}

/// The value of one key of a table, or of one entry of its list.
fn entry<'a>(table: &'a mut Table, key: &str) -> Option<&'a mut Value> {
    let Some((key, index)) = key.split_once('[') else {
        return table.get_mut(key);
    };
    let index: usize = index.strip_suffix(']')?.parse().ok()?;
    table.get_mut(key)?.as_array_mut()?.get_mut(index)
}

/// The phantom of a table, with the values of those inputs whose keys it has.
///
/// # Errors
/// A phantom that [`Phantom::validate`] refuses.
///
/// Implements: STU-001.
pub fn phantom(table: &Table, inputs: &[Input], values: &[f64]) -> Result<Phantom, Refusal> {
    let mut table = table.clone();
    for (input, &value) in inputs.iter().zip(values) {
        if let Some(number) = number(&mut table, &input.key) {
            *number = input.change.of(*number, value);
        }
    }
    // Tables of texts and numbers are TOML.
    let text = toml::to_string(&table).unwrap_or_default();
    // No line: nobody has the file.
    Phantom::from_toml(&text, "").map_err(|refusal| Refusal {
        line: None,
        ..refusal
    })
}
