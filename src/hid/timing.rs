//! How long the cycles of the loop take on this machine, against a budget.

pub mod paper;

use std::cell::Cell;
use std::time::{Duration, Instant};

use hdrhistogram::Histogram;

use super::{
    Capabilities, Control, Cycle, DeviceError, ForceReport, HapticDevice, Received, Session,
};
use crate::refusal::Refusal;
use crate::servo::{Limits, Table};

/// A device on the clock of the host instead of its own, and at the host's pace if it is asked to.
struct HostClock<'a, D> {
    device: D,
    began: Instant,
    /// Time between two cycles; `None` goes on as fast as it can.
    period: Option<Duration>,
    due: Duration,
    /// How much too late the last wait for a cycle ended.
    late: &'a Cell<Duration>,
}

impl<D> HostClock<'_, D> {
    /// Sleeps until the next cycle is due.
    fn wait(&mut self) {
        let Some(period) = self.period else { return };
        self.due += period;
        let now = self.began.elapsed();
        if let Some(left) = self.due.checked_sub(now) {
            std::thread::sleep(left);
        }
        let now = self.began.elapsed();
        self.late.set(now.saturating_sub(self.due));
        // A cycle that was lost is not made up for.
        while self.due + period <= now {
            self.due += period;
        }
    }
}

impl<D: HapticDevice> HapticDevice for HostClock<'_, D> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.device.capabilities()
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        if !timeout.is_zero() {
            self.wait();
        }
        self.device.read(timeout)
    }

    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        self.device.write(report)
    }

    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.device.control(control)
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }
}

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
    fn of(times: &Histogram<u64>) -> Option<Distribution> {
        let quantile = |share| times.value_at_quantile(share) as f64 / 1e3;
        (!times.is_empty()).then(|| Distribution {
            p50: quantile(0.5),
            p99: quantile(0.99),
            p99_9: quantile(0.999),
            max: times.max() as f64 / 1e3,
        })
    }
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Timing {
    /// Cycles measured.
    pub cycles: u64,
    /// The budget of a cycle, µs.
    pub budget_us: f64,
    /// Cycles that took longer than the budget.
    pub misses: u64,
    /// The input's age when it is answered: from the report at hand to the force written, and if the cycles were paced, from the time at
    /// which the report was due, µs.
    pub response_us: Distribution,
    /// The servo kernel's share of it: from the drained queue to the force computed, µs.
    pub compute_us: Distribution,
    /// A force report's write: from the force computed to the write done, µs.
    pub write_us: Distribution,
    /// From a force written to the report at hand that says the device has played it, µs; `None` if
    /// none did.
    pub round_trip_us: Option<Distribution>,
    /// Time in the kernel over time in the response, all cycles together.
    pub compute_share: f64,
    /// The cycles came at the pace of the device, not as fast as they went.
    pub paced: bool,
    /// At least 99.9 % of the cycles kept the budget.
    pub passed: bool,
}

/// Times by quantity, recorded without allocation.
pub(super) struct Times {
    budget: Duration,
    /// Of the response, the kernel, the write, the round trip.
    histograms: [Histogram<u64>; 4],
    /// When the last force reports were written, by their number.
    sent: [Option<(u16, Duration)>; SENT],
    total: [Duration; 2],
    misses: u64,
}

/// Force reports whose round trip may be under way at a time: more is no playback.
const SENT: usize = 64;

impl Times {
    /// No times yet, of cycles that may each take as long as `budget`.
    pub(super) fn new(budget: Duration) -> Option<Times> {
        // 1 ns to 100 s within 0.1 %: everything that a cycle can take.
        let histogram = Histogram::new_with_bounds(1, 100_000_000_000, 3).ok()?;
        Some(Times {
            budget,
            histograms: std::array::from_fn(|_| histogram.clone()),
            sent: [None; SENT],
            total: [Duration::ZERO; 2],
            misses: 0,
        })
    }

    /// The cycles so far.
    fn cycles(&self) -> u64 {
        self.histograms[0].len()
    }

    pub(super) fn record(&mut self, cycle: &Cycle, late: Duration) {
        let response = late + cycle.written.saturating_sub(cycle.woke);
        let compute = cycle.computed.saturating_sub(cycle.received);
        let write = cycle.written.saturating_sub(cycle.computed);
        // Each report that was sent is answered once.
        let answered = cycle.position.and_then(|position| {
            let number = position.force_sequence;
            self.slot(number).take_if(|(sent, _)| *sent == number)
        });
        let round_trip = answered.map(|(_, written)| cycle.woke.saturating_sub(written));
        let times = [Some(response), Some(compute), Some(write), round_trip];
        for (histogram, time) in self.histograms.iter_mut().zip(times) {
            if let Some(time) = time {
                let time = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
                histogram.saturating_record(time);
            }
        }
        let sequence = cycle.force.sequence;
        *self.slot(sequence) = Some((sequence, cycle.written));
        self.total[0] += response;
        self.total[1] += compute;
        self.misses += u64::from(response > self.budget);
    }

    /// Where the force report of this number is kept, or another one.
    fn slot(&mut self, sequence: u16) -> &mut Option<(u16, Duration)> {
        &mut self.sent[usize::from(sequence) % SENT]
    }

    /// The figures of the cycles so far; `None` without one.
    pub(super) fn timing(&self, paced: bool) -> Option<Timing> {
        let [response, compute] = self.total.map(|total| total.as_secs_f64());
        let cycles = self.cycles();
        let [response_us, compute_us, write_us, round_trip_us] =
            self.histograms.each_ref().map(Distribution::of);
        Some(Timing {
            cycles,
            budget_us: self.budget.as_secs_f64() * 1e6,
            misses: self.misses,
            response_us: response_us?,
            compute_us: compute_us?,
            write_us: write_us?,
            round_trip_us,
            compute_share: compute / response.max(f64::MIN_POSITIVE),
            paced,
            passed: self.misses <= cycles / 1000,
        })
    }
}

/// Measures `cycles` cycles of the shipped loop on `device`, against `budget`; at the pace of `period`
/// or as fast as they go.
///
/// # Errors
/// Why the session did not begin, or ended before the cycles were through; fewer cycles than a p99.9 needs.
///
/// Implements: HID-060, HID-061, HID-062, HID-063, HID-084.
pub fn measure<D: HapticDevice>(
    device: D,
    table: Table,
    limits: Limits,
    cycles: u64,
    budget: Duration,
    period: Option<Duration>,
) -> Result<Timing, Refusal> {
    let too_few = || Refusal::state(format_args!("{cycles} cycles"), "at least 1000 for a p99.9");
    let times = Times::new(budget).filter(|_| cycles >= 1000);
    let mut times = times.ok_or_else(too_few)?;
    let late = Cell::new(Duration::ZERO);
    let clock = HostClock {
        device,
        began: Instant::now(),
        period,
        due: Duration::ZERO,
        late: &late,
    };
    let end = Session::begin(clock, table, limits)?.run(|cycle, _| {
        times.record(cycle, late.get());
        times.cycles() < cycles
    });
    let timing = times.timing(period.is_some());
    timing
        .filter(|timing| timing.cycles == cycles)
        .ok_or_else(|| {
            let measured = times.cycles();
            Refusal::state(format_args!("after {measured} cycles: {end}"), "")
        })
}

#[cfg(test)]
mod tests;
