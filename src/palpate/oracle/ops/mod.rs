//! The ops by name.

mod counts;
mod decision;
mod element;
mod filter;
mod interpolation;
mod nuisance;
mod probe;
mod proportion;
mod report;
mod servo;

use std::collections::BTreeMap;

use serde::Serialize;

use super::answer::{Code, Refused, json};
use super::arguments::{Bits, List, Rows, Whole, arguments, arguments_of};
use crate::detect;
use crate::stats::{noncentral, normal};
pub use probe::Models;

/// An op.
#[derive(Debug, Clone, Copy)]
pub struct Op {
    /// Its name in a request.
    pub name: &'static str,
    /// The JSON text of its answer, from that of its arguments.
    pub function: fn(&str, &mut Models) -> Result<Vec<u8>, Refused>,
}

/// An op: its name, and a function from its arguments, and from the models if it needs them, to its answer.
macro_rules! op {
    ($name:literal, $function:expr) => {
        Op {
            name: $name,
            function: |text, _| json(($function)(arguments_of(text)?)?),
        }
    };
    ($name:literal, $function:expr, models) => {
        Op {
            name: $name,
            function: |text, models| json(($function)(arguments_of(text)?, models)?),
        }
    };
}

arguments! { Nothing {} }
arguments! { Point { x: f64 } }
arguments! { Probability { p: f64 } }
arguments! { Gamma { gamma: f64 } }
arguments! { Correct { p_correct: f64 } }
arguments! { Law { x: f64, degrees: f64, noncentrality: f64 } }
arguments! { LawOfRatio { x: f64, numerator: f64, denominator: f64, noncentrality: f64 } }

/// All ops.
///
/// Implements: ORA-020.
pub const OPS: &[Op] = &[
    op!("capabilities", capabilities),
    op!("normal_cdf", |a: Point| normal::cdf(a.x)
        .map(|p| named("p", p))),
    op!("normal_quantile", |a: Probability| normal::quantile(a.p)
        .map(|x| named("x", x))),
    op!("matched_filter", filter::matched_filter),
    op!("theta", filter::theta),
    op!("theta_colored", filter::theta_colored),
    op!("theta_nuisances", nuisance::theta),
    op!("bank_posterior", nuisance::bank_posterior),
    op!("threshold", decision::threshold),
    op!("error_rates", decision::error_rates),
    op!("roc", decision::roc),
    op!("required_gamma", decision::required_gamma),
    op!("two_afc", |a: Gamma| detect::two_afc(a.gamma)
        .map(|p| named("p_correct", p))),
    op!("gamma_from_two_afc", |a: Correct| {
        detect::gamma_from_two_afc(a.p_correct).map(|gamma| named("gamma", gamma))
    }),
    op!("proportion_interval", proportion::interval),
    op!("chi_square_tail", |a: Law| noncentral::chi_square(
        a.x,
        a.degrees,
        a.noncentrality
    )),
    op!("f_tail", |a: LawOfRatio| {
        noncentral::f_ratio(a.x, a.numerator, a.denominator, a.noncentrality)
    }),
    op!("student_tail", |a: Law| noncentral::student(
        a.x,
        a.degrees,
        a.noncentrality
    )),
    op!("noise_budget", decision::noise_budget),
    op!("interpolate", interpolation::interpolate),
    op!("scan", filter::scan),
    op!("element_stiffness", element::stiffness),
    op!("servo_axis", servo::axis),
    op!("servo_interpolate", servo::interpolate),
    op!("report_decode", report::decode),
    op!("report_encode", report::encode),
    op!("count_analysis", counts::analysis),
    op!("probe_force", probe::force, models),
];

/// The op of that name.
///
/// # Errors
/// [`Code::UnknownOp`].
pub fn find(name: &str) -> Result<&'static Op, Refused> {
    OPS.iter().find(|op| op.name == name).ok_or_else(|| {
        let names = names().join(", ");
        let unknown = format_args!("unknown op {name:?}; the ops are {names}");
        Refused::new(Code::UnknownOp, unknown)
    })
}

fn names() -> Vec<&'static str> {
    OPS.iter().map(|op| op.name).collect()
}

/// An answer of one value.
fn named<T>(name: &'static str, value: T) -> BTreeMap<&'static str, T> {
    BTreeMap::from([(name, value)])
}

/// The version of the program, and what it can do.
#[derive(Debug, Serialize)]
struct Capabilities {
    version: &'static str,
    ops: Vec<&'static str>,
}

/// Implements: ORA-020.
fn capabilities(_: Nothing) -> Result<Capabilities, Refused> {
    let version = env!("CARGO_PKG_VERSION");
    Ok(Capabilities {
        version,
        ops: names(),
    })
}
