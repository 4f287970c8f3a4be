//! The servo kernel, to the bit.

use std::fmt::Debug;

use super::{Answer, Arguments, Bits, Refused};
use crate::force::Force;
use crate::servo::{Axis, Table};

/// Knots as the kernel stores them, with the reciprocals of the widths.
///
/// Implements: ORA-009.
fn knots(arguments: &mut Arguments, name: &'static str) -> Result<(Vec<f32>, Vec<f32>), Refused> {
    let knots = arguments.numbers(name)?;
    let knots: Vec<f32> = knots.into_iter().map(|knot| knot as f32).collect();
    let width = |pair: &[f32]| Axis::reciprocal_width(pair[0], pair[1]);
    let reciprocals = knots.windows(2).map(width).collect();
    Ok((knots, reciprocals))
}

fn axis_of<'a>(
    name: &str,
    (knots, reciprocals): &'a (Vec<f32>, Vec<f32>),
) -> Result<Axis<'a>, Refused> {
    Axis::new(knots, reciprocals).map_err(|error| {
        refused(
            name,
            error,
            "2 to 1024 knots within 1 m, each at least 1e-6 m above the one before",
        )
    })
}

fn refused(name: &str, error: impl Debug, right: &str) -> Refused {
    Refused::range(format_args!(
        "{name} is refused by the kernel, {error:?}: expected {right}"
    ))
}

fn bits(value: f32) -> String {
    format!("{:#010x}", value.to_bits())
}

/// Cell and fraction of a coordinate.
pub fn axis(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let knots = knots(arguments, "knots")?;
    let coordinate = arguments.bits("coordinate_bits")?;
    let cell = axis_of("knots", &knots)?.locate(coordinate);
    Ok(Answer::of([("cell", cell.index)]).with("fraction_bits", bits(cell.fraction)))
}

/// The force of a table at a pose.
pub fn interpolate(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let depth_knots = knots(arguments, "depth_knots")?;
    let lateral_knots = knots(arguments, "lateral_knots")?;
    let rows = arguments.list("table_bits", "a list of lists of texts")?;
    let depth = arguments.bits("depth_bits")?;
    let lateral = arguments.bits("lateral_bits")?;
    let depths = axis_of("depth_knots", &depth_knots)?;
    let laterals = axis_of("lateral_knots", &lateral_knots)?;
    let forces = forces(&rows, depths.knots().len(), laterals.knots().len())?;
    let table = Table::new(depths, laterals, &forces)
        .map_err(|error| refused("table_bits", error, "numbers within 100 N"))?;
    let force = table.force(depth, lateral).normal;
    Ok(Answer::of([("force_bits", bits(force))]))
}

/// The entries of a table, both components alike.
fn forces(rows: &[Vec<Bits>], depths: usize, laterals: usize) -> Result<Vec<Force<f32>>, Refused> {
    if rows.len() != depths || rows.iter().any(|row| row.len() != laterals) {
        return Err(Refused::argument(format_args!(
            "table_bits is expected to have {depths} rows of {laterals} entries"
        )));
    }
    let both = |&Bits(force)| Force::new(force, force);
    Ok(rows.iter().flatten().map(both).collect())
}
