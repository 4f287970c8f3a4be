//! The paper's rule between and beyond the poses of a table.

use super::super::{Answer, Arguments, Code, Refusal};
use crate::force_map::{self, Matrix};

/// The force at a pose.
pub fn interpolate(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let depths = arguments.numbers("depths_m")?;
    let laterals = arguments.numbers("laterals_m")?;
    let rows = arguments.rows("table_n")?;
    let depth = arguments.number("depth_m")?;
    let lateral = arguments.number("lateral_m")?;
    check_axis("depths_m", &depths)?;
    check_axis("laterals_m", &laterals)?;
    let forces = matrix("table_n", &rows, depths.len(), laterals.len())?;
    let force = force_map::interpolate(&depths, &laterals, &forces, depth, lateral);
    match force {
        Some(force) => Ok(Answer::default().with("force_n", force)),
        None => Err(Refusal::new(
            Code::Overflow,
            "force_n would be beyond the largest number",
        )),
    }
}

/// Whether an axis has a cell and increases; how closely, does not matter to the rule.
fn check_axis(name: &str, axis: &[f64]) -> Result<(), Refusal> {
    if axis.len() < 2 {
        return Err(Refusal::argument(
            name,
            format_args!("has {} entries, expected at least 2", axis.len()),
        ));
    }
    match axis.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(index) => Err(Refusal::new(
            Code::OutOfRange,
            format!(
                "{name}[{}] is {}, expected more than the entry before it, {}",
                index + 1,
                axis[index + 1],
                axis[index]
            ),
        )),
        None => Ok(()),
    }
}

fn matrix(
    name: &str,
    rows: &[Vec<f64>],
    depths: usize,
    laterals: usize,
) -> Result<Matrix, Refusal> {
    if rows.len() != depths {
        return Err(Refusal::argument(
            name,
            format_args!(
                "has {} rows, expected one for each of {depths} depths",
                rows.len()
            ),
        ));
    }
    for (index, row) in rows.iter().enumerate() {
        if row.len() != laterals {
            return Err(Refusal::new(
                Code::BadArgument,
                format!(
                    "{name}[{index}] has {} entries, expected one for each of {laterals} lateral positions",
                    row.len()
                ),
            ));
        }
    }
    Ok(Matrix::from_fn(depths, laterals, |row, column| {
        rows[row][column]
    }))
}
