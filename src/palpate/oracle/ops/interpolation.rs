//! The paper's rule between and beyond the poses of a table.

use std::collections::BTreeMap;

use super::{Code, List, Refused, Rows, arguments, named};
use crate::force_map::{self, Matrix};

arguments! {
    TableAndPose {
        depths_m: List<f64>,
        laterals_m: List<f64>,
        table_n: Rows,
        depth_m: f64,
        lateral_m: f64,
    }
}

/// The force at a pose.
pub fn interpolate(arguments: TableAndPose) -> Result<BTreeMap<&'static str, f64>, Refused> {
    let TableAndPose {
        depths_m: List(depths),
        laterals_m: List(laterals),
        ..
    } = &arguments;
    check_axis("depths_m", depths)?;
    check_axis("laterals_m", laterals)?;
    let (rows, columns) = (depths.len(), laterals.len());
    let forces = arguments.table_n.concat("table_n", rows, columns)?;
    let forces = Matrix::from_fn(rows, columns, |row, column| forces[row * columns + column]);
    let TableAndPose {
        depth_m, lateral_m, ..
    } = arguments;
    match force_map::interpolate(depths, laterals, &forces, depth_m, lateral_m) {
        Some(force) => Ok(named("force_n", force)),
        None => {
            let wrong = "force_n would be beyond the largest f64";
            Err(Refused::new(Code::Overflow, wrong))
        }
    }
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
