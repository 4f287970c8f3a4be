//! One cycle of the loop between a device and the servo kernel: read, drain, step, write.

use core::time::Duration;

use super::{DeviceError, ForceReport, HapticDevice, PositionReport, Received, Units};
use crate::force::Force;
use crate::servo::{self, Input, Limits, Mode, Request, State, Table, step};

/// Reports that one cycle takes from the queue at most: what the kernel of the system keeps.
pub const QUEUE: usize = 64;

/// What is played, and how far it got.
#[derive(Debug, Clone, Copy)]
pub struct Playback<'a> {
    table: Table<'a>,
    limits: Limits,
    units: Units,
    timeout: Duration,
    state: State,
    sequence: u16,
    counters: Counters,
}

/// What happened in all cycles so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Cycles.
    pub cycles: u64,
    /// Cycles in which the force followed the table.
    pub played: u64,
    /// Cycles without a fresh sample.
    pub missed: u64,
    /// Reports that never came, by the gaps between sequence numbers.
    pub skipped: u64,
    /// Reports that had come with a newer one, and were passed over.
    pub drained: u64,
    /// Reports that did not decode.
    pub garbage: u64,
    /// Stops, and reports of zero that go with them, that the device refused.
    pub refused: u64,
}

/// What one cycle did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// The report that it used.
    pub position: Option<PositionReport>,
    /// The report that it sent.
    pub force: ForceReport,
    /// The force follows the table.
    pub playing: bool,
    /// When the wait for a report ended, on the device's clock.
    pub woke: Duration,
    /// When the queue was drained.
    pub received: Duration,
    /// When the force was computed.
    pub computed: Duration,
    /// When it was written.
    pub written: Duration,
}

impl<'a> Playback<'a> {
    /// Playback of `table` within `limits` on a device with these units, which sends a report every
    /// `period`: a cycle waits twice as long for one.
    pub fn new(table: Table<'a>, limits: Limits, units: Units, period: Duration) -> Playback<'a> {
        Playback {
            table,
            limits,
            units,
            timeout: period * 2,
            state: State::default(),
            sequence: 0,
            counters: Counters::default(),
        }
    }

    /// The kernel's state after the last cycle.
    pub fn state(&self) -> State {
        self.state
    }

    /// What happened so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// One cycle: waits for a report, takes the newest of the queue, steps the kernel with the
    /// `request` and writes the force.
    ///
    /// # Errors
    /// [`DeviceError`]; the device must be stopped and opened again.
    ///
    /// Implements: HID-013, HID-014, HID-015.
    pub fn cycle<D: HapticDevice>(
        &mut self,
        device: &mut D,
        request: Request,
    ) -> Result<Cycle, DeviceError> {
        let (position, woke, passed_over) = self.newest(device)?;
        let received = device.now();
        self.count(position, passed_over);
        let input = Input {
            sample: position.map(|report| self.units.sample(&report)),
            request,
        };
        let (state, command) = step(&self.table, &self.limits, self.state, input);
        self.state = state;
        self.sequence = self.sequence.wrapping_add(1);
        let force = self.units.report(&command, self.sequence);
        self.counters.missed += u64::from(state.missed > 0);
        self.counters.played += u64::from(command.playing);
        let computed = device.now();
        device.write(&force)?;
        Ok(Cycle {
            position,
            force,
            playing: command.playing,
            woke,
            received,
            computed,
            written: device.now(),
        })
    }

    /// Waits for a report and takes what the queue holds besides: the newest, the time when the wait
    /// was over, and how many older ones it passed over. Garbage ends the wait, since a cycle must not
    /// last.
    fn newest<D: HapticDevice>(
        &mut self,
        device: &mut D,
    ) -> Result<(Option<PositionReport>, Duration, u64), DeviceError> {
        let mut newest = None;
        let mut passed_over = 0;
        let mut received = device.read(self.timeout)?;
        let woke = device.now();
        for _ in 0..QUEUE {
            match received {
                Received::Report(report) => {
                    passed_over += u64::from(newest.is_some());
                    newest = Some(report);
                }
                Received::Garbage(_) => self.counters.garbage += 1,
                Received::Nothing => break,
            }
            received = device.read(Duration::ZERO)?;
        }
        Ok((newest, woke, passed_over))
    }

    /// Counts a cycle, the reports that it passed over, and those missing before `position`.
    fn count(&mut self, position: Option<PositionReport>, passed_over: u64) {
        self.counters.cycles += 1;
        self.counters.drained += passed_over;
        let (Some(position), Some(last)) = (position, self.state.sequence) else {
            return;
        };
        let ahead = position.sequence.wrapping_sub(last);
        if (1..=servo::MOST_AHEAD).contains(&ahead) {
            self.counters.skipped += u64::from(ahead - 1).saturating_sub(passed_over);
        }
    }

    /// Ends the playback: tells the device to stop, and disarms. Tries everything even if the device
    /// fails, and returns the first failure.
    ///
    /// # Errors
    /// [`DeviceError`].
    ///
    /// Implements: HID-016, HID-025, HID-029.
    pub fn stop<D: HapticDevice>(&mut self, device: &mut D) -> Result<(), DeviceError> {
        self.state.mode = Mode::Disarmed;
        self.state.force = Force::ZERO;
        self.sequence = self.sequence.wrapping_add(1);
        let zero = ForceReport {
            lateral: 0,
            normal: 0,
            sequence: self.sequence,
            flags: 0,
        };
        // First what a device takes that no longer takes forces: a blocked write would hold it up.
        let stopped = self.tried(STOP_TRIES, || device.control(super::Control::Stop));
        // Once the device is stopped, a force report is a courtesy.
        let tries = if stopped.is_ok() { 1 } else { STOP_TRIES };
        let written = self.tried(tries, || device.write(&zero));
        stopped.and(written)
    }

    /// Sends until the device takes it, is gone or takes nothing in time, or was asked so many times; the last answer. Counts
    /// what was refused.
    fn tried(
        &mut self,
        tries: usize,
        mut send: impl FnMut() -> Result<(), DeviceError>,
    ) -> Result<(), DeviceError> {
        let mut last = Ok(());
        for _ in 0..tries {
            last = send();
            let Err(error) = &last else { break };
            self.counters.refused += 1;
            if error.is_gone() || error.is_stalled() {
                break;
            }
        }
        last
    }
}

/// How often a stop is sent to a device that does not take it.
const STOP_TRIES: usize = 5;
