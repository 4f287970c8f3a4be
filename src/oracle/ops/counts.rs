//! Counts of right answers of several subjects under several conditions, as in Table 1.

use super::super::{Answer, Arguments, Code, Refusal};
use super::proportion::MOST_TRIALS;
use crate::detect::gamma_from_two_afc;

/// The pooled rates of right answers, γ from them, and how far the subjects differ from one
/// binomial.
///
/// Implements: ORA-026.
pub fn analysis(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let counts = arguments.rows("correct")?;
    let trials = arguments.whole("trials", 1, MOST_TRIALS)? as f64;
    let confidence = arguments.number("confidence")?;
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(Refusal::range(
            "confidence",
            format_args!("is {confidence}, expected strictly between 0 and 1"),
        ));
    }
    check(&counts, trials)?;
    let subjects = counts.len() as f64;
    let (mut pooled, mut rates) = (Vec::new(), Vec::new());
    let (mut gammas, mut chi2s) = (Vec::new(), Vec::new());
    for condition in 0..counts[0].len() {
        let column = || counts.iter().map(|row| row[condition]);
        let right: f64 = column().sum(); // whole numbers, at most 10¹⁵: exact
        let rate = right / (subjects * trials);
        // Σ(k − T p)² = Σ(n k − Σk)²/n², in which whole numbers do not round.
        let squares: f64 = column().map(|k| subjects * k - right).map(|d| d * d).sum();
        let wrong = subjects * trials - right;
        pooled.push(right as u64); // whole, at most 10¹⁵
        rates.push(rate);
        gammas.push(gamma_from_two_afc(rate)?);
        chi2s.push(squares * trials / (right * wrong));
    }
    Ok(Answer::default()
        .with("pooled", pooled)
        .with("rate", rates)
        .with("gamma", gammas)
        .with("chi2", chi2s)
        .with("df", counts.len() - 1))
}

fn check(counts: &[Vec<f64>], trials: f64) -> Result<(), Refusal> {
    let conditions = counts.first().map_or(0, Vec::len);
    if conditions == 0 {
        return Err(Refusal::argument(
            "correct",
            "is empty, expected a row for each subject",
        ));
    }
    for (subject, row) in counts.iter().enumerate() {
        if row.len() != conditions {
            return Err(Refusal::new(
                Code::BadArgument,
                format!(
                    "correct[{subject}] has {} entries, expected {conditions}",
                    row.len()
                ),
            ));
        }
        for (condition, &count) in row.iter().enumerate() {
            if count.trunc() != count || !(0.0..=trials).contains(&count) {
                return Err(Refusal::new(
                    Code::OutOfRange,
                    format!(
                        "correct[{subject}][{condition}] is {count}, expected a whole number from 0 to {trials}"
                    ),
                ));
            }
        }
    }
    Ok(())
}
