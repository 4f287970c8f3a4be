//! Counts of right answers of several subjects under several conditions, as in Table 1.

use super::proportion::MOST_TRIALS;
use super::{Answer, Arguments, Refused, check_rows};
use crate::detect::gamma_from_two_afc;
use crate::stats::dispersion::dispersion;

/// The pooled rates of right answers, γ from them, and how far the subjects differ from one
/// binomial.
///
/// Implements: ORA-020.
pub fn analysis(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let counts = arguments.rows("correct")?;
    let trials = arguments.whole("trials", 1, MOST_TRIALS)? as f64;
    check(&counts, trials)?;
    let subjects = counts.len() as f64;
    let (mut pooled, mut rates) = (Vec::new(), Vec::new());
    let (mut gammas, mut chi2s) = (Vec::new(), Vec::new());
    for condition in 0..counts[0].len() {
        // Whole numbers, at most 10⁹ each: exact in either type.
        let of_subject = |row: &Vec<f64>| (row[condition] as u32, trials as u32);
        let column: Vec<(u32, u32)> = counts.iter().map(of_subject).collect();
        let right: u64 = column.iter().map(|&(right, _)| u64::from(right)).sum();
        let rate = right as f64 / (subjects * trials);
        pooled.push(right);
        rates.push(rate);
        gammas.push(gamma_from_two_afc(rate)?);
        // A single subject has the pooled rate.
        let dispersion = dispersion(&column)?;
        chi2s.push(dispersion.map_or(0.0, |found| found.chi_square));
    }
    Ok(Answer::of([("pooled", pooled)])
        .with("rate", rates)
        .with("gamma", gammas)
        .with("chi2", chi2s)
        .with("df", counts.len() - 1))
}

fn check(counts: &[Vec<f64>], trials: f64) -> Result<(), Refused> {
    let conditions = counts.first().map_or(0, Vec::len);
    if conditions == 0 {
        let wrong = "correct is empty, expected a row for each subject";
        return Err(Refused::argument(wrong));
    }
    let words = [String::new(), conditions.to_string()];
    check_rows("correct", counts, [counts.len(), conditions], words)?;
    for (subject, row) in counts.iter().enumerate() {
        for (condition, &count) in row.iter().enumerate() {
            if count.trunc() != count || !(0.0..=trials).contains(&count) {
                return Err(Refused::range(format_args!(
                    "correct[{subject}][{condition}] is {count}, expected a whole number from 0 to {trials}"
                )));
            }
        }
    }
    Ok(())
}
