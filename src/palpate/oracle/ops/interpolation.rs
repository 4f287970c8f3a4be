//! The paper's rule between and beyond the poses of a table.

use serde::Serialize;

use super::{Code, Refused, Rows, answer};
use crate::force_map::{self, Matrix};

/// The force at a pose.
pub fn interpolate(
    depths: &[f64],
    laterals: &[f64],
    table: &Rows,
    depth: f64,
    lateral: f64,
) -> Result<impl Serialize, Refused> {
    check_axis("depths_m", depths)?;
    check_axis("laterals_m", laterals)?;
    let (rows, columns) = (depths.len(), laterals.len());
    let forces = table.concat("table_n", rows, columns)?;
    let forces = Matrix::from_fn(rows, columns, |row, column| forces[row * columns + column]);
    let force = force_map::interpolate(depths, laterals, &forces, depth, lateral);
    let overflow = "force_n would be beyond the largest f64";
    let force_n = force.ok_or_else(|| Refused::new(Code::Overflow, overflow))?;
    Ok(answer! { force_n })
}

/// Whether an axis has a cell and increases; how closely, does not matter to the rule.
fn check_axis(name: &str, axis: &[f64]) -> Result<(), Refused> {
    if axis.len() < 2 {
        let wrong = format_args!("{name} has {} entries, but needs at least 2", axis.len());
        return Err(Refused::argument(wrong));
    }
    match axis.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(index) => Err(Refused::range(format_args!(
            "{name}[{}] is {}, but must be above the entry before it, {}",
            index + 1,
            axis[index + 1],
            axis[index]
        ))),
        None => Ok(()),
    }
}
