//! One number for all results of the core over a fixed sweep of inputs, so that processors can be compared.

pub mod draw;
mod kernel;
mod records;
#[cfg(test)]
mod tests;

use core::fmt::{self, Write};

use palpate_core::detect::{self, Costs};
use palpate_core::hid::{Capabilities, Control, ForceReport, PositionReport};
use palpate_core::servo::{approach, limit};
use palpate_core::stats::{binomial, noncentral, normal};

use crate::hash::Digest;
use crate::scenario;
use draw::Draw;

/// What a function of the core is asked: how often, and a question and the text of its answer.
struct Sweep {
    name: &'static str,
    questions: u32,
    ask: fn(&mut Draw, &mut dyn Write) -> fmt::Result,
}

/// Rows `NAME, QUESTIONS: |draw| ANSWER;`.
macro_rules! sweeps {
    ($($name:literal, $questions:literal: |$draw:ident| $answer:expr;)+) => {
        &[$(Sweep {
            name: $name,
            questions: $questions,
            ask: |$draw, text| write!(text, "{:?};", $answer),
        }),+]
    };
}

const SWEEPS: &[Sweep] = sweeps! {
    "cell of an axis", 4096: |d| kernel::located(d);
    "force of a table", 4096: |d| kernel::force(d);
    "stiffness of a table", 256: |d| kernel::stiffest(d);
    "limit", 4096: |d| limit(d.single(-9.0, 9.0), d.between(0.0, 5.0) as f32);
    "approach", 4096: |d| {
        let [last, target, rise, fall] = [-4.0, -4.0, 0.0, 0.0].map(|low| d.between(low, 4.0) as f32);
        approach(last, target, rise, fall)
    };
    "step", 4096: |d| kernel::stepped(d);
    "10,000 cycles", 1: |_d| scenario::outcome();
    "position report", 2048: |d| {
        PositionReport::decode(d.report(1, PositionReport::LENGTH)).map(|found| (found, found.encode()))
    };
    "force report", 2048: |d| {
        ForceReport::decode(d.report(2, ForceReport::LENGTH)).map(|found| (found, found.encode()))
    };
    "capabilities", 2048: |d| {
        Capabilities::decode(d.report(3, Capabilities::LENGTH)).map(|found| (found, found.encode()))
    };
    "control", 2048: |d| Control::decode(d.report(4, Control::LENGTH)).map(|found| (found, found.encode()));
    "units", 2048: |d| kernel::converted(d);
    "Φ", 2048: |d| (normal::cdf(d.number(-40.0, 40.0)), normal::upper_tail(d.number(-40.0, 40.0)));
    "Φ⁻¹", 2048: |d| normal::quantile(d.rate());
    "chi-square", 256: |d| noncentral::chi_square(d.number(0.0, 90.0), d.number(0.1, 60.0), d.between(0.0, 60.0));
    "F", 256: |d| {
        noncentral::f_ratio(d.number(0.0, 9.0), d.number(0.1, 60.0), d.number(0.1, 60.0), d.between(0.0, 60.0))
    };
    "Student's t", 256: |d| noncentral::student(d.number(-9.0, 9.0), d.number(0.1, 60.0), d.between(-8.0, 8.0));
    "Wilson", 1024: |d| binomial::wilson(d.word() % 50, d.word() % 100, d.rate());
    "Clopper and Pearson", 16: |d| binomial::clopper_pearson(d.word() % 50, 50, d.rate());
    "decision", 1024: |d| detect::decide(d.number(-1.0, 1.0), d.number(-1.0, 1.0));
    "posterior", 1024: |d| detect::posterior(d.number(-50.0, 50.0), d.rate());
    "threshold map", 1024: |d| detect::map_threshold(d.rate());
    "threshold bayes", 1024: |d| {
        let [c00, c01, c10, c11] = [0.0, 1.0, 1.0, 0.0].map(|low| d.number(low, low + 1.0));
        detect::bayes_threshold(d.rate(), Costs { c00, c01, c10, c11 })
    };
    "threshold miss", 1024: |d| detect::neyman_pearson_miss_threshold(d.number(0.0, 9.0), d.rate());
    "threshold false alarm", 1024: |d| detect::neyman_pearson_false_alarm_threshold(d.number(0.0, 9.0), d.rate());
    "error rates", 1024: |d| detect::error_rates(d.number(0.0, 9.0), d.number(-50.0, 50.0));
    "ROC", 1024: |d| detect::roc_miss(d.number(0.0, 9.0), d.rate());
    "required gamma", 1024: |d| detect::required_gamma(d.rate(), d.rate());
    "two-alternative forced choice", 1024: |d| detect::two_afc(d.number(0.0, 9.0));
    "gamma of a forced choice", 1024: |d| detect::gamma_from_two_afc(d.rate());
    "noise budget", 1024: |d| {
        let [alpha, beta, source] = [(); 3].map(|()| d.number(1e-4, 0.4));
        detect::noise_budget::noise_budget(d.number(0.1, 9.0), alpha, beta, &[source])
    };
    "matched filter", 512: |d| records::filtered(d);
    "theta", 512: |d| records::theta(d);
    "theta at every shift", 256: |d| records::scanned(d);
    "theta beside nuisances", 256: |d| records::beside_nuisances(d);
    "theta in coloured noise", 256: |d| records::in_coloured_noise(d);
    "theta row by row", 512: |d| records::row_by_row(d);
};

/// Prints the digest of each function and of all; the one of all.
///
/// Implements: FIR-001.
pub fn print(text: &mut impl Write) -> u64 {
    let mut all = Digest::default();
    for (stream, sweep) in (0..).zip(SWEEPS) {
        let (mut draw, mut digest) = (Draw::new(stream), Digest::default());
        let Sweep {
            name,
            questions,
            ask,
        } = sweep;
        for _ in 0..*questions {
            let _ = ask(&mut draw, &mut digest); // a digest takes every text
        }
        // Text that is lost changes no verdict.
        let _ = writeln!(text, "{name}: {questions} questions, {:016x}", digest.0);
        let _ = write!(all, "{:016x}", digest.0);
    }
    let _ = writeln!(text, "digest: {:016x}", all.0);
    all.0
}
