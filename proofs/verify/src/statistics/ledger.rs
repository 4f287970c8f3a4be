//! The ledger of the battery's errors: α and power of every check.

use std::sync::LazyLock;

use super::{Outcome, SHOWN_POWER};

/// One row of `ledger.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The check.
    pub name: &'static str,
    /// The largest probability that it fails for a detector without defect.
    pub alpha: f64,
    /// Its number of trials.
    pub trials: usize,
    /// The probability that it fails for each defect it is meant for.
    pub powers: Vec<(&'static str, f64)>,
}

impl Row {
    /// The defects that its negative controls plant: those of which it is all but sure to tell.
    pub fn shown_defects(&self) -> impl Iterator<Item = &'static str> {
        let shown = self
            .powers
            .iter()
            .filter(|(_, power)| *power >= SHOWN_POWER);
        shown.map(|&(defect, _)| defect)
    }

    fn parse(line: &'static str) -> Outcome<Row> {
        let fields: Vec<&str> = line.split(',').collect();
        let [name, alpha, trials, powers] = fields[..] else {
            return Err(format!("ledger: {line:?} must have four fields").into());
        };
        let power = |text: &'static str| -> Outcome<_> {
            let (defect, power) = text
                .split_once('=')
                .ok_or_else(|| format!("ledger: {text:?} must be defect=power"))?;
            Ok((defect, power.parse()?))
        };
        Ok(Row {
            name,
            alpha: alpha.parse()?,
            trials: trials.parse()?,
            powers: powers.split(';').map(power).collect::<Outcome<_>>()?,
        })
    }
}

/// All rows. The file is part of this program, and a test reads it.
pub(super) static ROWS: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let lines = include_str!("ledger.csv").lines().skip(1);
    let rows: Outcome<_> = lines.map(Row::parse).collect();
    rows.unwrap_or_else(|error| panic!("{error}"))
});
