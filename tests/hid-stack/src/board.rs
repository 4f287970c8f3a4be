//! The device's part: a board that reports a thousand times a second, plays forces, checks every byte it is
//! sent (the system checks none), and has a watchdog of its own.

use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use palpate::hid::{
    Capabilities, Control, DESCRIPTOR, ForceReport, PositionReport, button, simulated, status,
};

use crate::schedule::{self, Fifo};
use crate::uhid::{Event, Uhid};

/// Vendor and product, of the numbers that pid.codes keeps for tests.
pub const NUMBERS: [u16; 2] = [0x1209, 0x0001];

/// What the board calls itself.
pub const NAME: &str = "palpate test display";

/// What the board says that it is.
pub const CAPABILITIES: Capabilities = simulated::PAPER;

/// Between two reports.
pub const PERIOD: Duration = Duration::from_millis(1);

/// The hand holds the deadman from this tick on.
pub const HELD_FROM: u32 = 50;

/// What the board does in a tick instead of a report with the next sequence number.
#[derive(Debug, Clone, Copy)]
pub enum Act {
    /// Nothing else.
    Report,
    /// Sends these bytes.
    Bytes(&'static [u8]),
    /// Sends the last sequence number again.
    Repeat,
    /// Sends nothing.
    Silence,
    /// The cable is pulled.
    Unplug,
}

/// How the board answers questions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answers {
    /// As the profile says.
    Good,
    /// With a report that is cut off.
    Short,
    /// With an error.
    Error,
    /// Not.
    None,
}

/// What happens, tick by tick.
pub type Script = fn(tick: u32) -> Act;

/// What the board saw and did.
#[derive(Debug, Clone, Default)]
pub struct Record {
    /// Ticks so far.
    pub ticks: u32,
    /// Force reports.
    pub forces: u32,
    /// Output and feature reports that are none of the profile.
    pub invalid: u32,
    /// Force reports whose sequence number is not one above the last.
    pub out_of_order: u32,
    /// Ticks, between the first force report and the last control `stop`, to which none was the answer.
    pub unanswered: u32,
    /// Questions for report 3.
    pub questions: u32,
    /// Controls in the order in which they came.
    pub controls: Vec<Control>,
    /// Largest force that the motors made, counts.
    pub largest_force: u16,
    /// Ticks at which the motors made a force.
    pub ticks_with_force: u32,
    /// Force reports other than zero before the deadman was held.
    pub too_early: u32,
    /// The last force report.
    pub last: Option<ForceReport>,
    /// The force that the motors make now, counts.
    pub motors: [i16; 2],
    /// How long after the last force report the board's own watchdog dropped the force.
    pub dropped_after: Option<Duration>,
    /// When the cable was pulled.
    pub unplugged: Option<Instant>,
    /// From each position report to the force report that followed it.
    pub round_trips: Vec<Duration>,
}

struct State {
    record: Record,
    enabled: bool,
    dropped: bool,
    force: [i16; 2],
    written: Instant,
    sent: Instant,
    answered: bool,
    sequence: u16,
}

/// A board that is plugged in.
pub struct Board {
    uhid: Arc<Uhid>,
    state: Arc<Mutex<State>>,
    ticker: Option<JoinHandle<io::Result<()>>>,
    answerer: Option<JoinHandle<io::Result<()>>>,
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Board {
    /// Plugs in a board that follows `script`.
    pub fn plug(serial: &str, script: Script, answers: Answers) -> io::Result<Board> {
        let uhid = Arc::new(Uhid::create(NAME, serial, NUMBERS, &DESCRIPTOR)?);
        let now = Instant::now();
        let state = Arc::new(Mutex::new(State {
            record: Record {
                round_trips: Vec::with_capacity(10_000),
                ..Record::default()
            },
            enabled: false,
            dropped: false,
            force: [0, 0],
            written: now,
            sent: now,
            answered: true,
            sequence: 0,
        }));
        let (device, shared) = (uhid.clone(), state.clone());
        let answerer = thread::spawn(move || answer(&device, &shared, answers));
        let (device, shared) = (uhid.clone(), state.clone());
        let ticker = thread::spawn(move || tick(&device, &shared, script));
        Ok(Board {
            uhid,
            state,
            ticker: Some(ticker),
            answerer: Some(answerer),
        })
    }

    /// What it saw so far.
    pub fn record(&self) -> Record {
        lock(&self.state).record.clone()
    }

    /// Pulls the cable, if the script has not done so, and returns what the board saw.
    pub fn unplug(mut self) -> io::Result<Record> {
        pull(&self.uhid, &self.state)?;
        for thread in [self.ticker.take(), self.answerer.take()] {
            let ended = thread.map_or(Ok(Ok(())), JoinHandle::join);
            ended.map_err(|_| io::Error::other("a thread of the board panicked"))??;
        }
        Ok(self.record())
    }
}

fn pull(uhid: &Uhid, state: &Mutex<State>) -> io::Result<()> {
    {
        let unplugged = &mut lock(state).record.unplugged;
        if unplugged.is_some() {
            return Ok(());
        }
        *unplugged = Some(Instant::now());
    }
    uhid.destroy()
}

/// The board's clock: a report each period, until it is unplugged.
fn tick(uhid: &Uhid, shared: &Mutex<State>, script: Script) -> io::Result<()> {
    schedule::fifo(Fifo::BoardClock)?;
    let began = Instant::now();
    for tick in 0.. {
        let due = PERIOD * tick;
        thread::sleep(due.saturating_sub(began.elapsed()));
        if lock(shared).record.unplugged.is_some() {
            break;
        }
        match script(tick) {
            Act::Unplug => {
                pull(uhid, shared)?;
                break;
            }
            act => {
                if let Some(bytes) = lock(shared).tick(tick, act) {
                    uhid.input(&bytes)?;
                }
            }
        }
    }
    Ok(())
}

/// Answers what the system asks, until the driver is gone.
fn answer(uhid: &Uhid, shared: &Mutex<State>, answers: Answers) -> io::Result<()> {
    schedule::fifo(Fifo::Board)?;
    loop {
        match uhid.event()? {
            Event::Stop => return Ok(()),
            Event::Start | Event::Open | Event::Close => {}
            Event::Output(report) => lock(shared).output(&report),
            Event::GetReport { id, number } => {
                let known = number == Capabilities::NUMBER;
                lock(shared).record.questions += u32::from(known);
                let report = CAPABILITIES.encode();
                match answers {
                    Answers::Good if known => uhid.answer_get(id, Some(&report))?,
                    Answers::Short => uhid.answer_get(id, Some(&report[..9]))?,
                    Answers::Good | Answers::Error => uhid.answer_get(id, None)?,
                    Answers::None => {}
                }
            }
            Event::SetReport { id, report } => {
                let done = lock(shared).control(&report);
                uhid.answer_set(id, done)?;
            }
        }
    }
}

impl State {
    /// One period: the watchdog, and the bytes to send.
    fn tick(&mut self, tick: u32, act: Act) -> Option<Vec<u8>> {
        self.record.ticks += 1;
        self.record.unanswered += u32::from(self.enabled && !self.answered);
        let silent = self.written.elapsed();
        let watchdog = Duration::from_millis(u64::from(CAPABILITIES.watchdog_ms));
        if self.enabled && !self.dropped && silent > watchdog {
            self.dropped = true;
            self.record.dropped_after = Some(silent);
        }
        self.move_motors();
        self.record.ticks_with_force += u32::from(self.record.motors != [0, 0]);
        self.sequence = match act {
            Act::Repeat => self.sequence,
            _ => self.sequence.wrapping_add(1),
        };
        self.sent = Instant::now();
        match act {
            Act::Silence | Act::Unplug => None,
            Act::Bytes(bytes) => Some(bytes.to_vec()),
            Act::Report | Act::Repeat => {
                self.answered = self.record.forces == 0;
                Some(self.report(tick).encode().to_vec())
            }
        }
    }

    /// A hand that presses 2 mm into the gel, going to and fro over 8 mm.
    fn report(&self, tick: u32) -> PositionReport {
        let held = tick >= HELD_FROM;
        let phase = (tick % 1600) as i16;
        let last = self.record.last;
        PositionReport {
            lateral: 10 * (400 - (phase - 800).abs()),
            normal: if held { -2000 } else { 1000 },
            buttons: if held { button::DEADMAN } else { 0 },
            status: if self.dropped { status::WATCHDOG } else { 0 },
            sequence: self.sequence,
            force_sequence: last.map_or(0, |last| last.sequence),
        }
    }

    /// Sets what the motors make, and keeps the largest.
    fn move_motors(&mut self) {
        let on = self.enabled && !self.dropped;
        self.record.motors = if on { self.force } else { [0, 0] };
        for count in self.record.motors {
            let force = count.unsigned_abs();
            self.record.largest_force = self.record.largest_force.max(force);
        }
    }

    fn output(&mut self, bytes: &[u8]) {
        let Ok(report) = ForceReport::decode(bytes) else {
            self.record.invalid += 1;
            return;
        };
        if !self.answered {
            self.record.round_trips.push(self.sent.elapsed());
        }
        self.answered = true;
        self.written = Instant::now();
        self.record.forces += 1;
        let last = self.record.last.replace(report);
        let next = last.map(|last| last.sequence.wrapping_add(1));
        self.record.out_of_order += u32::from(next.is_some_and(|next| next != report.sequence));
        let play = report.flags & ForceReport::PLAY != 0;
        self.force = if play {
            [report.lateral, report.normal]
        } else {
            [0, 0]
        };
        let early = self.record.ticks <= HELD_FROM && self.force != [0, 0];
        self.record.too_early += u32::from(early);
        self.move_motors();
    }

    fn control(&mut self, bytes: &[u8]) -> bool {
        let Ok(control) = Control::decode(bytes) else {
            self.record.invalid += 1;
            return false;
        };
        match control {
            Control::Stop => self.enabled = false,
            Control::Enable => self.enabled = true,
            Control::ClearFault => self.dropped = false,
        }
        self.written = Instant::now();
        self.record.controls.push(control);
        self.move_motors();
        true
    }
}
