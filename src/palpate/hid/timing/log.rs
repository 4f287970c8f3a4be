//! The cycles of another loop, as it logged them.

use std::time::Duration;

use super::budget::{Budget, Judged, Responses};
use crate::csv::{Column, Rows};
use crate::decimal::parse_scaled;
use crate::file::Members;
use crate::refusal::{Refusal, shortened};

/// The names of durations and then of time stamps, with the power of ten from their unit to seconds.
const COLUMN: Column = &[
    &[
        ("duration_ns", -9),
        ("duration_us", -6),
        ("duration_ms", -3),
        ("duration_s", 0),
    ],
    &[
        ("time_ns", -9),
        ("time_us", -6),
        ("time_ms", -3),
        ("time_s", 0),
    ],
];
const EXPECTED: &str = "one of duration_ns, _us, _ms, _s (how long each cycle took) or time_ns, _us, _ms, _s (when each began)";

/// The cycles in `text`: CSV with a header, or lines of JSON objects. Each has a column or key `duration_…` or `time_…`; of time stamps the
/// intervals count. Against `budget`.
///
/// # Errors
/// Text of neither form; numbers that are not finite, a duration below 0, a time stamp that is not above the one before, or whose
/// resolution decides; no cycle; with the line.
///
/// Implements: CLI-173.
pub fn judge_log(text: &str, budget: Budget) -> Result<Judged, Refusal> {
    let (name, numbers) = match text.trim_start().starts_with(['{', '[']) {
        true => of_json_lines(text)?,
        false => {
            let rows = Rows::<1>::parse(text, [COLUMN], EXPECTED)?;
            let [name] = rows.names;
            let numbers = rows.rows.into_iter().map(|(line, [number])| (line, number));
            (name, numbers.collect())
        }
    };
    let no_cycle = || Refusal::state("no cycle", "give a row for each");
    let mut responses = Responses::new(budget);
    if name.starts_with("duration") {
        for (line, seconds) in numbers {
            responses.record(duration(name, line, seconds)?, None);
        }
    } else {
        let mut intervals = Vec::new();
        for pair in numbers.windows(2) {
            let [(_, begin), (line, end)] = [pair[0], pair[1]];
            if end <= begin {
                let late = "a time above the one before";
                return Err(Refusal::value(name, format!("{end} s"), late).at(line));
            }
            check_resolved(name, begin, end, &budget).map_err(|refusal| refusal.at(line))?;
            intervals.push(duration(name, line, end - begin)?);
        }
        let period = median(&intervals).ok_or_else(no_cycle)?;
        for interval in intervals {
            responses.record(interval, Some(interval.abs_diff(period)));
        }
    }
    responses.judged().ok_or_else(no_cycle)
}

/// Refuses an interval (s) that is so near the budget that the last place of its time stamps decides: an interval is kept to the
/// nanosecond, but a Unix time has an `f64` only each 0.24 µs, one of two months each nanosecond.
fn check_resolved(name: &str, begin: f64, end: f64, budget: &Budget) -> Result<(), Refusal> {
    let largest = begin.abs().max(end.abs());
    let spacing = largest.next_up() - largest;
    let from_budget = (end - begin - budget.cycle.as_secs_f64()).abs();
    let resolution = spacing * 1e6;
    let expected = format!(
        "resolved better than to {resolution:.2} µs, which decides whether the budget is kept: subtract the first time from all"
    );
    Refusal::value(name, format!("{end} s"), expected)
        .when(spacing > 0.5e-9 && from_budget <= spacing)
}

fn duration(name: &str, line: usize, seconds: f64) -> Result<Duration, Refusal> {
    let expected = "at least 0 and less than a century";
    let right = (0.0..3.2e9).contains(&seconds);
    let wrong = || Refusal::value(name, format!("{seconds} s"), expected).at(line);
    right
        .then(|| Duration::from_secs_f64(seconds))
        .ok_or_else(wrong)
}

/// What loops without a stated period run at: the middle of the intervals.
fn median(intervals: &[Duration]) -> Option<Duration> {
    let mut sorted = intervals.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).copied()
}

/// Numbers with the lines that they stand in, s.
type Numbers = Vec<(usize, f64)>;

/// The name, and the number in each line.
fn of_json_lines(text: &str) -> Result<(&'static str, Numbers), Refusal> {
    let give = || format!("give {EXPECTED}");
    let mut found: Option<(&'static str, i32)> = None;
    let mut numbers = Vec::new();
    let lines = text.lines().enumerate();
    for (line, text) in lines.filter(|(_, text)| !text.trim().is_empty()) {
        let line = line + 1;
        let Members(object) = serde_json::from_str(text)
            .map_err(|error| Refusal::state(format!("no JSON object: {error}"), give()).at(line))?;
        for names in COLUMN {
            let mut there = names.iter().filter(|(name, _)| object.contains_key(*name));
            if let (Some((a, _)), Some((b, _))) = (there.next(), there.next()) {
                return Err(Refusal::state(format!("{a} and {b}"), "give one of them").at(line));
            }
        }
        let mut names = COLUMN.iter().copied().flatten();
        let named = found.or_else(|| names.find(|(name, _)| object.contains_key(*name)).copied());
        let (name, power) =
            named.ok_or_else(|| Refusal::state(shortened(text), give()).at(line))?;
        found = named;
        let missing = || Refusal::state(format!("no {name}"), "give it in each line");
        let value = object.get(name).ok_or_else(|| missing().at(line))?;
        let wrong = || Refusal::value(name, value, "a finite number").at(line);
        let number = value.as_number().ok_or_else(wrong)?;
        let seconds = parse_scaled(&number.to_string(), power).ok_or_else(wrong)?;
        numbers.push((line, seconds));
    }
    let (name, _) = found.ok_or_else(|| Refusal::state("no line", give()))?;
    Ok((name, numbers))
}

#[cfg(test)]
mod tests;
