//! The servo kernel, to the bit.

use std::fmt::Debug;

use serde::Serialize;

use super::{Bits, List, Refused, answer};
use crate::force::Force;
use crate::servo::{Axis, Knots, Table};

/// Numbers as the kernel stores its knots.
///
/// Implements: ORA-009.
fn knots(List(knots): &List<f64>) -> Knots {
    Knots::new(knots.iter().map(|&knot| knot as f32).collect())
}

fn axis_of<'a>(name: &str, knots: &'a Knots) -> Result<Axis<'a>, Refused> {
    let right = "2 to 1024 knots within 1 m, each at least 1e-6 m above the one before";
    knots.axis().map_err(|error| refused(name, error, right))
}

fn refused(name: &str, error: impl Debug, right: &str) -> Refused {
    let wrong = format_args!("the servo kernel refuses {name}, {error:?}; it takes {right}");
    Refused::range(wrong)
}

fn bits(value: f32) -> String {
    format!("{:#010x}", value.to_bits())
}

/// Cell and fraction of a coordinate.
pub fn axis(list: &List<f64>, Bits(coordinate): Bits) -> Result<impl Serialize + use<>, Refused> {
    let cell = axis_of("knots", &knots(list))?.locate(coordinate);
    Ok(answer! { cell: cell.index, fraction_bits: bits(cell.fraction) })
}

/// The force of a table at a pose.
pub fn interpolate(
    depth_knots: &List<f64>,
    lateral_knots: &List<f64>,
    entries: &List<List<Bits>>,
    Bits(depth): Bits,
    Bits(lateral): Bits,
) -> Result<impl Serialize + use<>, Refused> {
    let [depth_knots, lateral_knots] = [depth_knots, lateral_knots].map(knots);
    let depths = axis_of("depth_knots", &depth_knots)?;
    let laterals = axis_of("lateral_knots", &lateral_knots)?;
    let (rows, columns) = (depths.knots().len(), laterals.knots().len());
    let entries = entries.concat("table_bits", rows, columns)?;
    // Both components alike.
    let both = |Bits(force)| Force::new(force, force);
    let forces: Vec<_> = entries.into_iter().map(both).collect();
    let table = Table::new(depths, laterals, &forces)
        .map_err(|error| refused("table_bits", error, "numbers within 100 N"))?;
    let force = table.force(depth, lateral);
    Ok(answer! { force_bits: bits(force.normal) })
}
