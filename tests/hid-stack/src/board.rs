//! The device's part: a board that reports a thousand times a second, plays forces, checks every byte it is
//! sent (the system checks none), and has a watchdog of its own.

use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use palpate::hid::{Capabilities, Control, ForceReport, PositionReport, button, simulated, status};

use crate::link::{self, Answer, Completion, Kind, Link};
use crate::schedule::{self, Fifo};

/// What the board says that it is.
pub const CAPABILITIES: Capabilities = simulated::PAPER;

/// Between two reports.
pub const PERIOD: Duration = Duration::from_millis(1);

/// The hand holds the deadman from this tick on, counted like those of a script.
const HELD_FROM: u32 = 50;

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
    /// From now on takes no force report, but goes on reporting: the bus says NAK.
    Refuse,
}

/// How the board answers the question for its capabilities.
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

/// Which board.
#[derive(Debug, Clone, Copy)]
pub struct Make {
    /// Its cable.
    pub kind: Kind,
    /// What it does.
    pub script: Script,
    /// What it says of itself.
    pub answers: Answers,
    /// When a force report is taken.
    pub takes: Completion,
}

/// What happens, tick by tick since the board was first enabled; until then it reports.
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
    /// How long after the last force report the control `stop` came.
    pub stopped_after: Option<Duration>,
    /// When the cable was pulled.
    pub unplugged: Option<Instant>,
    /// From each position report to the force report that followed it.
    pub round_trips: Vec<Duration>,
}

struct State {
    make: Make,
    record: Record,
    /// Tick of the script.
    tick: Option<u32>,
    enabled: bool,
    dropped: bool,
    force: [i16; 2],
    written: Instant,
    sent: Instant,
    answered: bool,
    refuses: bool,
    sequence: u16,
}

/// What the system talks to.
struct Shared(Mutex<State>);

/// A board that is plugged in.
///
/// Implements: HID-089.
pub struct Board {
    link: Arc<dyn Link>,
    shared: Arc<Shared>,
    clock: Option<JoinHandle<io::Result<()>>>,
    server: Option<JoinHandle<io::Result<()>>>,
}

impl Board {
    /// Plugs a board in.
    pub fn plug(serial: &str, make: Make) -> io::Result<Board> {
        let link = link::plug(make.kind, serial)?;
        let shared = Arc::new(Shared(Mutex::new(State::new(make))));
        let (cable, board) = (link.clone(), shared.clone());
        let server = thread::spawn(move || {
            schedule::fifo(Fifo::Board)?;
            cable.serve(&*board)
        });
        let (cable, board) = (link.clone(), shared.clone());
        let clock = thread::spawn(move || tick(&*cable, &board));
        Ok(Board {
            link,
            shared,
            clock: Some(clock),
            server: Some(server),
        })
    }

    /// What it saw so far.
    pub fn record(&self) -> Record {
        self.shared.lock().record.clone()
    }

    /// Pulls the cable, if the script has not done so, and returns what the board saw.
    pub fn unplug(mut self) -> io::Result<Record> {
        self.shared.pull(&*self.link)?;
        for thread in [self.clock.take(), self.server.take()] {
            let ended = thread.map_or(Ok(Ok(())), JoinHandle::join);
            ended.map_err(|_| io::Error::other("a thread of the board panicked"))??;
        }
        Ok(self.record())
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Pulls the cable, once.
    fn pull(&self, link: &dyn Link) -> io::Result<()> {
        let before = {
            let unplugged = &mut self.lock().record.unplugged;
            let before = *unplugged;
            *unplugged = before.or(Some(Instant::now()));
            before
        };
        before.map_or_else(|| link.unplug(), |_| Ok(()))
    }
}

/// The board's clock: a frame of the bus and a report each period, until it is unplugged.
fn tick(link: &dyn Link, shared: &Shared) -> io::Result<()> {
    schedule::fifo(Fifo::BoardClock)?;
    let began = Instant::now();
    for tick in 0.. {
        thread::sleep((PERIOD * tick).saturating_sub(began.elapsed()));
        let mut state = shared.lock();
        if state.record.unplugged.is_some() {
            break;
        }
        let act = state.tick.map_or(Act::Report, state.make.script);
        let report = state.advance(act);
        drop(state);
        if let Act::Unplug = act {
            return shared.pull(link);
        }
        let sent = link
            .frame()
            .and_then(|()| report.map_or(Ok(()), |report| link.input(&report)));
        // The cable may have been pulled in between.
        if sent.is_err() && shared.lock().record.unplugged.is_none() {
            return sent;
        }
    }
    Ok(())
}

impl link::Board for Shared {
    fn output(&self, report: &[u8]) -> Completion {
        self.lock().output(report)
    }

    fn get(&self, number: u8) -> Answer {
        let mut state = self.lock();
        if number != Capabilities::NUMBER {
            return Answer::Error;
        }
        state.record.questions += 1;
        let report = CAPABILITIES.encode();
        match state.make.answers {
            Answers::Good => Answer::Report(report.to_vec()),
            Answers::Short => Answer::Report(report[..9].to_vec()),
            Answers::Error => Answer::Error,
            Answers::None => Answer::Nothing,
        }
    }

    fn set(&self, report: &[u8]) -> bool {
        self.lock().control(report)
    }
}

impl State {
    fn new(make: Make) -> State {
        let now = Instant::now();
        State {
            make,
            record: Record {
                round_trips: Vec::with_capacity(10_000),
                ..Record::default()
            },
            tick: None,
            enabled: false,
            dropped: false,
            force: [0, 0],
            written: now,
            sent: now,
            answered: true,
            refuses: false,
            sequence: 0,
        }
    }

    /// One period: the watchdog, and the bytes to send.
    fn advance(&mut self, act: Act) -> Option<Vec<u8>> {
        self.record.ticks += 1;
        self.tick = self.tick.map(|tick| tick + 1);
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
            Act::Report | Act::Repeat | Act::Refuse => {
                self.refuses |= matches!(act, Act::Refuse);
                self.answered = self.record.forces == 0;
                Some(self.report().encode().to_vec())
            }
        }
    }

    fn held(&self) -> bool {
        self.tick.is_some_and(|tick| tick > HELD_FROM)
    }

    /// A hand that presses 2 mm into the gel, going to and fro over 8 mm.
    fn report(&self) -> PositionReport {
        let held = self.held();
        let phase = (self.record.ticks % 1600) as i16;
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

    fn output(&mut self, bytes: &[u8]) -> Completion {
        if self.refuses {
            return Completion::Never;
        }
        let Ok(report) = ForceReport::decode(bytes) else {
            self.record.invalid += 1;
            return Completion::Now;
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
        let early = !self.held() && self.force != [0, 0];
        self.record.too_early += u32::from(early);
        self.move_motors();
        self.make.takes
    }

    fn control(&mut self, bytes: &[u8]) -> bool {
        let Ok(control) = Control::decode(bytes) else {
            self.record.invalid += 1;
            return false;
        };
        match control {
            Control::Stop => {
                self.enabled = false;
                self.record.stopped_after = Some(self.written.elapsed());
            }
            Control::Enable => {
                self.enabled = true;
                self.tick = self.tick.or(Some(0));
            }
            Control::ClearFault => {
                // The hand lets go.
                self.tick = self.tick.filter(|_| !self.dropped);
                self.dropped = false;
            }
        }
        self.written = Instant::now();
        self.record.controls.push(control);
        self.move_motors();
        true
    }
}
