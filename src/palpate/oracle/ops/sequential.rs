//! Evidence row by row, and where Wald's test ends.

use serde::Serialize;

use super::nuisance::{limited, signals};
use super::{Refused, Rows, answer};
use crate::detect::Decision;
use crate::detect::sequential::{Evidence, Sequential, Wald, memory};
use crate::stats::error::{check_samples, representable};

/// Most templates and nuisances.
const MOST_TEMPLATES: usize = 1_000;

/// θ and γ of each template after the last row, and the row at which Wald's test of it ends.
///
/// Implements: ORA-011, ORA-020.
pub fn sequential(
    residual: &[f64],
    templates: &Rows,
    nuisances: &Rows,
    [max_false_alarm, max_miss]: [f64; 2],
) -> Result<impl Serialize + use<>, Refused> {
    let (samples, hypotheses) = (residual.len(), templates.0.len());
    check_samples("residual", residual, samples)?;
    let templates = limited("templates", templates, samples, MOST_TEMPLATES)?;
    let test = Wald::new(max_false_alarm, max_miss)?;
    let signals = signals(nuisances, samples)?;
    let count = nuisances.0.len();
    let memory = vec![0.0; memory(hypotheses, count)];
    let mut found = Sequential::new(memory, hypotheses, count)?;
    let (mut inclusion_at, mut no_inclusion_at) = (vec![0; hypotheses], vec![0; hypotheses]);
    let at = |lists: &[f64], row: usize| lists.iter().skip(row).step_by(samples).copied().collect();
    for row in 0..samples {
        let (nuisances, templates): (Vec<f64>, Vec<f64>) = (at(&signals, row), at(&templates, row));
        found.push(residual[row], &nuisances, &templates)?;
        for (hypothesis, evidence) in found.evidence().enumerate() {
            let decision = test.decide(representable("theta", evidence.theta())?)?;
            if inclusion_at[hypothesis] + no_inclusion_at[hypothesis] > 0 {
                continue;
            }
            match decision {
                Some(Decision::Inclusion) => inclusion_at[hypothesis] = row + 1,
                Some(Decision::NoInclusion) => no_inclusion_at[hypothesis] = row + 1,
                None => {}
            }
        }
    }
    let each = |value: fn(Evidence) -> f64| found.evidence().map(value).collect::<Vec<f64>>();
    Ok(answer! {
        theta: each(Evidence::theta),
        gamma: each(|of| libm::sqrt(of.gamma_squared)),
        residual: found.residual(),
        rank: found.rank(),
        inclusion_at: inclusion_at,
        no_inclusion_at: no_inclusion_at,
    })
}
