//! When a loop keeps its budget: by a percentile of its times, with bounds that hold whatever their distribution is.

use std::time::Duration;

use hdrhistogram::Histogram;

use crate::refusal::Refusal;
use crate::stats::NumericError;
use crate::stats::binomial::{at_least, at_most, first};

/// What a loop may take, and how sure the verdict must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    pub(super) cycle: Duration,
    percentile: f64,
    confidence_percent: f64,
    /// The most cycles of a measurement that may take longer; any number if `None`.
    pub allowed_misses: Option<u64>,
    /// The most of them in a row; any number if `None`.
    pub allowed_run: Option<u64>,
}

/// What a measurement says of a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BudgetOutcome {
    /// The loop keeps it.
    Kept,
    /// It does not.
    Broken,
    /// There are too few cycles to tell.
    Undecided,
}

impl Budget {
    /// A cycle may take `cycle` at this percentile of the times, which the verdict is sure of by `confidence_percent`.
    ///
    /// # Errors
    /// A percentile that is not strictly between 0 and 100; a confidence below 50 %, with which the lower bound would be above the upper
    /// one, or not below 100 %.
    pub fn new(
        cycle: Duration,
        percentile: f64,
        confidence_percent: f64,
    ) -> Result<Budget, Refusal> {
        let is_right = percentile > 0.0 && percentile < 100.0;
        Refusal::value("percentile", percentile, "above 0 and below 100").when(!is_right)?;
        let is_right = (50.0..100.0).contains(&confidence_percent);
        let must = "at least 50 and below 100";
        Refusal::value("confidence-percent", confidence_percent, must).when(!is_right)?;
        Ok(Budget {
            percentile,
            confidence_percent,
            ..Budget::of(cycle)
        })
    }

    /// 999 of 1000 cycles may take at most this long, with 95 % confidence.
    pub const fn of(cycle: Duration) -> Budget {
        Budget {
            cycle,
            percentile: 99.9,
            confidence_percent: 95.0,
            allowed_misses: None,
            allowed_run: None,
        }
    }

    /// The fewest cycles that can show that a budget is kept.
    ///
    /// Implements: HID-064.
    pub fn least_cycles(&self) -> u64 {
        // Fewer than this many are all below the percentile with a probability of more than 1 − confidence.
        let unsure = libm::log(1.0 - self.confidence_percent / 100.0);
        libm::ceil(unsure / libm::log(self.percentile / 100.0)) as u64
    }

    /// Which of `cycles` times in ascending order, from 1, are at most (0 for none) and at least the percentile (`None` for none),
    /// each with the stated confidence.
    fn ranks(&self, cycles: u64) -> Result<(u64, Option<u64>), NumericError> {
        let (share, confidence) = (self.percentile / 100.0, self.confidence_percent / 100.0);
        // So many times lie below the percentile as a binomial law says, whatever the law of the times.
        let lower = first(1, cycles, |rank| {
            Ok(at_least(rank, cycles, share)? < confidence)
        })?;
        let upper = first(1, cycles, |rank| {
            Ok(at_most(rank - 1, cycles, share)? >= confidence)
        })?;
        Ok((lower - 1, Some(upper).filter(|&rank| rank <= cycles)))
    }
}

/// The times of a loop against its budget.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Judged {
    /// Cycles measured.
    pub cycles: u64,
    /// What a cycle may take, µs.
    pub budget_us: f64,
    /// The percentile of the times that must be within the budget.
    pub percentile: f64,
    /// How sure the bounds are, each of them.
    pub confidence_percent: f64,
    /// The percentile is at least this, µs; `None` if there are too few cycles for a bound.
    pub at_least_us: Option<f64>,
    /// The percentile is at most this, µs; `None` if there are too few cycles for a bound.
    pub at_most_us: Option<f64>,
    /// Cycles that took longer than the budget.
    pub misses: u64,
    /// The most of them in a row.
    pub longest_run: u64,
    /// What that says.
    pub outcome: BudgetOutcome,
    /// The budget is kept.
    pub passed: bool,
    /// How long the cycles took, µs. In a loop that is measured here: the input's age when it is answered, from the report at hand to
    /// the force written, and if the cycles were paced, from the time at which the report was due.
    pub response_us: Distribution,
    /// How far the time from the begin of one cycle to that of the next is from the loop's period, µs; `None` if it has none.
    pub jitter_us: Option<Distribution>,
}

/// Distribution of a time, µs, within 0.1 % but for the longest.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Distribution {
    /// Half of all cycles are no longer.
    pub p50: f64,
    /// 99 % of all.
    pub p99: f64,
    /// 99.9 % of all.
    pub p99_9: f64,
    /// The longest.
    pub max: f64,
}

impl Distribution {
    /// `None` of no time.
    pub(super) fn of(of: &Recorded) -> Option<Distribution> {
        let quantile = |share| of.times.value_at_quantile(share).min(of.longest) as f64 / 1e3;
        (!of.times.is_empty()).then(|| Distribution {
            p50: quantile(0.5),
            p99: quantile(0.99),
            p99_9: quantile(0.999),
            max: quantile(1.0),
        })
    }
}

/// Times, recorded without allocation: from 1 ns to centuries within 0.1 %, everything that a cycle can take, and the longest.
pub(super) struct Recorded {
    pub times: Histogram<u64>,
    longest: u64,
}

impl Recorded {
    pub fn new() -> Recorded {
        let times = Histogram::new_with_bounds(1, u64::MAX, 3);
        Recorded {
            times: times.expect("these bounds and digits are right"),
            longest: 0,
        }
    }

    pub fn record(&mut self, time: Duration) {
        let nanoseconds = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.times.saturating_record(nanoseconds);
        self.longest = self.longest.max(nanoseconds);
    }
}

/// Times of cycles, recorded without allocation.
pub(in crate::hid) struct Responses {
    budget: Budget,
    responses: Recorded,
    jitter: Recorded,
    misses: u64,
    /// Misses in a row up to now.
    run: u64,
    longest_run: u64,
}

impl Responses {
    /// No times yet.
    pub fn new(budget: Budget) -> Responses {
        Responses {
            budget,
            responses: Recorded::new(),
            jitter: Recorded::new(),
            misses: 0,
            run: 0,
            longest_run: 0,
        }
    }

    /// How many there are.
    pub fn cycles(&self) -> u64 {
        self.responses.times.len()
    }

    /// The next cycle, and how far its begin was from the right time, if that is known.
    pub fn record(&mut self, response: Duration, jitter: Option<Duration>) {
        self.responses.record(response);
        if let Some(jitter) = jitter {
            self.jitter.record(jitter);
        }
        let missed = response > self.budget.cycle;
        self.run = if missed { self.run + 1 } else { 0 };
        self.misses += u64::from(missed);
        self.longest_run = self.longest_run.max(self.run);
    }

    /// What the cycles so far say; `None` without one.
    ///
    /// Implements: HID-062, HID-064, HID-060.
    pub fn judged(&self) -> Option<Judged> {
        let (budget, cycles) = (&self.budget, self.cycles());
        let (times, response_us) = (&self.responses.times, Distribution::of(&self.responses)?);
        let (lower, upper) = budget.ranks(cycles).ok()?;
        let budget_us = budget.cycle.as_nanos() as f64 / 1e3;
        let within = cycles - self.misses;
        // The longest of the times that the histogram does not tell from that of a rank.
        let longest = |rank: u64| {
            let share = (rank as f64 - 0.5) / cycles as f64;
            times.value_at_quantile(share)
        };
        // On which side of the budget a time lies is known exactly.
        let at_least = |rank: u64| {
            let time = times.lowest_equivalent(longest(rank)) as f64 / 1e3;
            time.max(if within < rank { budget_us } else { 0.0 })
        };
        let at_most = |rank: u64| {
            let time = longest(rank) as f64 / 1e3;
            time.min(if within < rank { time } else { budget_us })
        };
        let exceeds = |found, allowed: Option<u64>| allowed.is_some_and(|allowed| found > allowed);
        let outcome = if exceeds(self.misses, budget.allowed_misses)
            || exceeds(self.longest_run, budget.allowed_run)
            || within < lower
        {
            BudgetOutcome::Broken
        } else if upper.is_some_and(|upper| within >= upper) {
            BudgetOutcome::Kept
        } else {
            BudgetOutcome::Undecided
        };
        Some(Judged {
            cycles,
            budget_us,
            percentile: budget.percentile,
            confidence_percent: budget.confidence_percent,
            at_least_us: (lower > 0).then(|| at_least(lower)),
            at_most_us: upper.map(at_most),
            misses: self.misses,
            longest_run: self.longest_run,
            outcome,
            passed: outcome == BudgetOutcome::Kept,
            response_us,
            jitter_us: Distribution::of(&self.jitter),
        })
    }
}

#[cfg(test)]
mod tests;
