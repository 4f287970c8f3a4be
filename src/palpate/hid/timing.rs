//! How long the cycles of the loop take on this machine, against a budget.

mod budget;
mod log;
pub mod paper;

use std::cell::Cell;
use std::time::{Duration, Instant};

use super::{
    Capabilities, Control, Cycle, DeviceError, ForceReport, HapticDevice, Received, Session,
};
use crate::refusal::Refusal;
use crate::servo::{Limits, Table};
pub use budget::{Budget, BudgetOutcome, Distribution, Judged};
use budget::{Recorded, Responses};
pub use log::judge_log;

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
    /// Sleeps until the next cycle is due; when it was due, if cycles have a pace.
    fn wait(&mut self) -> Option<Duration> {
        let period = self.period?;
        self.due += period;
        let due = self.due;
        let now = self.began.elapsed();
        if let Some(left) = self.due.checked_sub(now) {
            std::thread::sleep(left);
        }
        let now = self.began.elapsed();
        // A cycle that was lost is not made up for.
        while self.due + period <= now {
            self.due += period;
        }
        Some(due)
    }
}

impl<D: HapticDevice> HapticDevice for HostClock<'_, D> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.device.capabilities()
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        if timeout.is_zero() {
            return self.device.read(timeout);
        }
        let due = self.wait();
        let received = self.device.read(timeout)?;
        if let Some(due) = due {
            self.late.set(self.began.elapsed().saturating_sub(due));
        }
        Ok(received)
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

/// What was measured.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Timing {
    /// The responses against the budget.
    #[serde(flatten)]
    pub judged: Judged,
    /// The servo kernel's share of the response: from the drained queue to the force computed, µs.
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
}

/// Times by quantity, recorded without allocation.
pub(super) struct Times {
    responses: Responses,
    /// Of the kernel, the write, the round trip.
    others: [Recorded; 3],
    /// When the last force reports were written, by their number.
    sent: [Option<(u16, Duration)>; SENT],
    /// In the response, and in the kernel.
    total: [Duration; 2],
    /// The time between two cycles, if they have one, and when the last one began.
    period: Option<Duration>,
    woke: Option<Duration>,
}

/// Force reports whose round trip may be under way at a time: more is no playback.
const SENT: usize = 64;

impl Times {
    /// No times yet, of cycles that come every `period` if they are paced.
    pub(super) fn new(budget: Budget, period: Option<Duration>) -> Times {
        Times {
            responses: Responses::new(budget),
            others: std::array::from_fn(|_| Recorded::new()),
            sent: [None; SENT],
            total: [Duration::ZERO; 2],
            period,
            woke: None,
        }
    }

    pub(super) fn record(&mut self, cycle: &Cycle, late: Duration) {
        let response = late + cycle.written.saturating_sub(cycle.woke);
        let compute = cycle.computed.saturating_sub(cycle.received);
        let write = cycle.written.saturating_sub(cycle.computed);
        let interval = self.woke.map(|woke| cycle.woke.abs_diff(woke));
        let jitter = self.period.zip(interval);
        let jitter = jitter.map(|(period, interval)| interval.abs_diff(period));
        self.woke = Some(cycle.woke);
        self.responses.record(response, jitter);
        // Each report that was sent is answered once.
        let answered = cycle.position.and_then(|position| {
            let number = position.force_sequence;
            self.slot(number).take_if(|(sent, _)| *sent == number)
        });
        let round_trip = answered.map(|(_, written)| cycle.woke.saturating_sub(written));
        let times = [Some(compute), Some(write), round_trip];
        for (other, time) in self.others.iter_mut().zip(times) {
            time.into_iter().for_each(|time| other.record(time));
        }
        let sequence = cycle.force.sequence;
        *self.slot(sequence) = Some((sequence, cycle.written));
        self.total[0] += response;
        self.total[1] += compute;
    }

    /// Where the force report of this number is kept, or another one.
    fn slot(&mut self, sequence: u16) -> &mut Option<(u16, Duration)> {
        &mut self.sent[usize::from(sequence) % SENT]
    }

    /// The figures of the cycles so far; `None` without one.
    pub(super) fn timing(&self) -> Option<Timing> {
        let [response, compute] = self.total.map(|total| total.as_secs_f64());
        let [compute_us, write_us, round_trip_us] = self.others.each_ref().map(Distribution::of);
        Some(Timing {
            judged: self.responses.judged()?,
            compute_us: compute_us?,
            write_us: write_us?,
            round_trip_us,
            compute_share: compute / response.max(f64::MIN_POSITIVE),
            paced: self.period.is_some(),
        })
    }
}

/// Measures `cycles` cycles of the shipped loop on `device`, against `budget`; at the pace of `period`
/// or as fast as they go.
///
/// # Errors
/// Why the session did not begin, or ended before the cycles were through; fewer cycles than the budget needs.
///
/// Implements: HID-060, HID-064, HID-083.
pub fn measure<D: HapticDevice>(
    device: D,
    table: Table,
    limits: Limits,
    cycles: u64,
    budget: Budget,
    period: Option<Duration>,
) -> Result<Timing, Refusal> {
    let least = budget.least_cycles();
    let remedy = format!("measure at least {least} for this percentile and confidence");
    Refusal::state(format_args!("{cycles} cycles are too few"), remedy).when(cycles < least)?;
    let mut times = Times::new(budget, period);
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
        times.responses.cycles() < cycles
    });
    let timing = times.timing();
    timing
        .filter(|timing| timing.judged.cycles == cycles)
        .ok_or_else(|| {
            let measured = times.responses.cycles();
            Refusal::state(format_args!("after {measured} cycles: {end}"), "")
        })
}

#[cfg(test)]
mod tests;
