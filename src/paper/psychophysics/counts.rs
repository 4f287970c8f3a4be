//! Right answers of subjects to inclusions, and the names in a file of them.

use palpate::decimal::parse_scaled;
use palpate::force_map::ForceMap;
use palpate::refusal::{Refusal, shortened};

/// The names of inclusions that are right, for a person.
const EXPECTED_INCLUSION: &str =
    "the name of an inclusion that ends in its depth in mm, such as 6.6 or soft 6.6";
/// Most trials of a row, as many as an experiment may have; it keeps the work of an analysis small.
pub const MOST_TRIALS: u32 = 1_000;

/// An inclusion: a column of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// As in the header: untrusted text.
    pub name: String,
    /// The depth of its top, m.
    pub depth: f64,
}

/// The answers of one subject in one condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subject {
    /// Who answered: untrusted text.
    pub name: String,
    /// Pairs judged for each inclusion.
    pub trials: u32,
    /// Right answers to each inclusion.
    pub correct: Vec<u32>,
}

impl Subject {
    /// The share of right answers to each inclusion.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> {
        let share = |&correct| f64::from(correct) / f64::from(self.trials);
        self.correct.iter().map(share)
    }
}

/// One of the experiments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    /// What was felt: untrusted text.
    pub name: String,
    /// Who felt it, at least one, each once.
    pub subjects: Vec<Subject>,
}

impl Condition {
    /// Right answers and pairs of each subject at the inclusion in `column`.
    pub fn counts(&self, column: usize) -> Vec<(u32, u32)> {
        let count = |subject: &Subject| (subject.correct[column], subject.trials);
        self.subjects.iter().map(count).collect()
    }

    /// Right answers and pairs of all subjects together.
    pub fn pooled(&self, column: usize) -> (u64, u64) {
        let add =
            |(correct, trials), (k, n): (u32, u32)| (correct + u64::from(k), trials + u64::from(n));
        self.counts(column).into_iter().fold((0, 0), add)
    }
}

/// The inclusion of a name, which stands at a `place`.
pub(super) fn column(place: &str, name: &str) -> Result<Column, Refusal> {
    let last = name.split_whitespace().next_back();
    let depth = last
        .and_then(|word| parse_scaled(word, -3))
        .filter(|&depth| depth > 0.0 && is_plain(name))
        .ok_or_else(|| refused(place, name, EXPECTED_INCLUSION))?;
    let name = name.to_string();
    Ok(Column { name, depth })
}

/// The depth (m) of the only inclusion of a map's phantom, where it is more than 0.1 mm from that in its name.
///
/// Implements: CLI-240.
pub fn depth_unlike_name(name: &str, map: &ForceMap) -> Option<f64> {
    let [inclusion] = map.phantom()?.inclusions() else {
        return None;
    };
    let named = column("", name).ok()?.depth;
    ((inclusion.depth - named).abs() > 0.1e-3).then_some(inclusion.depth)
}

/// The inclusions of these names, each of which stands at a place.
pub(super) fn columns<'a>(
    names: impl IntoIterator<Item = (String, &'a str)>,
) -> Result<Vec<Column>, Refusal> {
    let mut columns: Vec<Column> = Vec::new();
    for (place, name) in names {
        let column = column(&place, name)?;
        if columns.iter().any(|other| other.name == name) {
            return Err(refused(&place, name, "each inclusion once"));
        }
        columns.push(column);
    }
    Ok(columns)
}

/// A name in a column, which can be printed.
pub(super) fn plain(column: &str, name: &str) -> Result<String, Refusal> {
    if name.is_empty() || !is_plain(name) {
        return Err(refused(column, name, "a name of printable characters"));
    }
    Ok(name.into())
}

pub(super) fn refused(column: &str, found: &str, expected: &str) -> Refusal {
    Refusal::value(column, format!("{:?}", shortened(found)), expected)
}

/// Whether a name can be printed as it is.
fn is_plain(name: &str) -> bool {
    !name.chars().any(char::is_control)
}
