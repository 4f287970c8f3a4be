//! The paper's rule between and beyond the poses of a table.

use super::{Answer, Arguments, Code, Refused, check_rows};
use crate::force_map::{self, Matrix};

/// The force at a pose.
pub fn interpolate(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let depths = arguments.numbers("depths_m")?;
    let laterals = arguments.numbers("laterals_m")?;
    let rows = arguments.rows("table_n")?;
    let [depth, lateral] = arguments.each(["depth_m", "lateral_m"])?;
    check_axis("depths_m", &depths)?;
    check_axis("laterals_m", &laterals)?;
    let size = [depths.len(), laterals.len()];
    let words = [
        format!("one for each of {} depths", size[0]),
        format!("one for each of {} lateral positions", size[1]),
    ];
    check_rows("table_n", &rows, size, words)?;
    let forces = Matrix::from_fn(size[0], size[1], |row, column| rows[row][column]);
    let force = force_map::interpolate(&depths, &laterals, &forces, depth, lateral);
    let overflow = "force_n would be beyond the largest number";
    let force = force.ok_or_else(|| Refused::new(Code::Overflow, overflow))?;
    Ok(Answer::of([("force_n", force)]))
}

/// Whether an axis has a cell and increases; how closely, does not matter to the rule.
fn check_axis(name: &str, axis: &[f64]) -> Result<(), Refused> {
    if axis.len() < 2 {
        let wrong = format_args!("{name} has {} entries, expected at least 2", axis.len());
        return Err(Refused::argument(wrong));
    }
    match axis.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(index) => Err(Refused::range(format_args!(
            "{name}[{}] is {}, expected more than the entry before it, {}",
            index + 1,
            axis[index + 1],
            axis[index]
        ))),
        None => Ok(()),
    }
}
