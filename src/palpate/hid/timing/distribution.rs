//! Distributions of times.

use std::time::Duration;

use hdrhistogram::Histogram;

/// Distribution of a time, µs.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Distribution {
    /// Half of all cycles are no longer.
    pub p50: f64,
    /// 99 % of all.
    pub p99: f64,
    /// 99.9 % of all.
    pub p99_9: f64,
    /// All.
    pub max: f64,
}

impl Distribution {
    /// `None` of no time.
    pub(super) fn of(times: &Histogram<u64>) -> Option<Distribution> {
        let quantile = |share| times.value_at_quantile(share) as f64 / 1e3;
        (!times.is_empty()).then(|| Distribution {
            p50: quantile(0.5),
            p99: quantile(0.99),
            p99_9: quantile(0.999),
            max: times.max() as f64 / 1e3,
        })
    }
}

/// From 1 ns to 100 s within 0.1 %: everything that a cycle can take.
pub(super) fn histogram() -> Option<Histogram<u64>> {
    Histogram::new_with_bounds(1, 100_000_000_000, 3).ok()
}

pub(super) fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
