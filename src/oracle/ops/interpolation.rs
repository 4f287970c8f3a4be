//! The paper's rule between and beyond the poses of a table.

use super::super::{Answer, Arguments, Code, Refusal};
use crate::force_map::{ForceTable, InvalidForceMap, Matrix};

/// The force at a pose.
pub fn interpolate(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let depths = arguments.numbers("depths_m")?;
    let laterals = arguments.numbers("laterals_m")?;
    let rows = arguments.rows("table_n")?;
    let depth = arguments.number("depth_m")?;
    let lateral = arguments.number("lateral_m")?;
    let forces = matrix("table_n", &rows, depths.len(), laterals.len())?;
    let table = ForceTable::new(depths, laterals, forces.clone(), forces).map_err(refusal)?;
    let force = table.force(depth, lateral).map_err(refusal)?;
    Ok(Answer::default().with("force_n", force.normal))
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

fn refusal(error: InvalidForceMap) -> Refusal {
    let code = match error {
        InvalidForceMap::EmptyAxis { .. } | InvalidForceMap::SinglePosition { .. } => {
            Code::BadArgument
        }
        InvalidForceMap::ForceTooLarge { .. } => Code::Overflow,
        _ => Code::OutOfRange,
    };
    Refusal::new(code, error.to_string())
}
