//! The device's part: a board that reports a thousand times a second, plays forces, checks every byte it is
//! sent (the system checks none), and has a watchdog of its own.

use std::io;
use std::sync::{Arc, Mutex};
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

/// Which board.
#[derive(Debug, Clone)]
pub struct Make {
    /// Its cable.
    pub kind: Kind,
    /// What it does.
    pub script: Script,
    /// The answer to the question for its capabilities.
    pub answer: Answer,
    /// When a force report is taken.
    pub takes: Completion,
}

impl Make {
    /// A good board.
    pub fn new(kind: Kind, script: Script) -> Make {
        Make {
            kind,
            script,
            answer: Answer::Report(CAPABILITIES.encode().to_vec()),
            takes: Completion::Now,
        }
    }
}

/// What happens from which tick on, counted since the board was first enabled; before that it reports.
pub type Script = &'static [(u32, Act)];

/// Nothing but reports.
pub const REPORTS: Script = &[];

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

/// A board that is plugged in.
///
/// Implements: HID-089.
pub struct Board {
    link: Arc<dyn Link>,
    shared: Arc<Mutex<State>>,
    threads: [JoinHandle<()>; 2],
}

impl Board {
    /// Plugs a good board in.
    pub fn good(kind: Kind, serial: &str, script: Script) -> Board {
        Board::plug(serial, Make::new(kind, script))
    }

    /// Plugs a board in.
    pub fn plug(serial: &str, make: Make) -> Board {
        let link = link::plug(make.kind, serial).expect("a cable");
        let shared = Arc::new(Mutex::new(State::new(make)));
        let (cable, board) = (link.clone(), shared.clone());
        let server = thread::spawn(move || {
            schedule::fifo(Fifo::Board);
            cable.serve(&*board).expect("the board answers");
        });
        let (cable, board) = (link.clone(), shared.clone());
        let clock = thread::spawn(move || tick(&*cable, &board).expect("the board reports"));
        Board {
            link,
            shared,
            threads: [server, clock],
        }
    }

    /// What it saw so far.
    pub fn record(&self) -> Record {
        self.shared.lock().unwrap().record.clone()
    }

    /// Waits until the board made a force for 100 ticks.
    pub fn wait_for_force(&self) {
        while self.record().ticks_with_force < 100 {
            thread::sleep(PERIOD);
            assert!(self.record().ticks < 10_000, "no force for 10 s");
        }
    }

    /// Pulls the cable, if the script has not done so, and returns what the board saw.
    pub fn unplug(self) -> Record {
        pull(&self.shared, &*self.link).expect("the cable is pulled");
        for thread in self.threads {
            thread.join().expect("a thread of the board");
        }
        self.shared.lock().unwrap().record.clone()
    }
}

/// Pulls the cable, once.
fn pull(shared: &Mutex<State>, link: &dyn Link) -> io::Result<()> {
    let mut state = shared.lock().unwrap();
    if state.record.unplugged.is_some() {
        return Ok(());
    }
    state.record.unplugged = Some(Instant::now());
    drop(state);
    link.unplug()
}

/// The board's clock: a frame of the bus and a report each period, until it is unplugged.
fn tick(link: &dyn Link, shared: &Mutex<State>) -> io::Result<()> {
    schedule::fifo(Fifo::BoardClock);
    let began = Instant::now();
    for tick in 0.. {
        thread::sleep((PERIOD * tick).saturating_sub(began.elapsed()));
        let mut state = shared.lock().unwrap();
        if state.record.unplugged.is_some() {
            break;
        }
        let begun = |(from, _): &&(u32, Act)| state.tick.is_some_and(|tick| tick >= *from);
        let act = state.make.script.iter().rfind(begun);
        let act = act.map_or(Act::Report, |&(_, act)| act);
        let report = state.advance(act);
        drop(state);
        if let Act::Unplug = act {
            return pull(shared, link);
        }
        let sent = link
            .frame()
            .and_then(|()| report.map_or(Ok(()), |report| link.input(&report)));
        // The cable may have been pulled in between.
        if sent.is_err() && shared.lock().unwrap().record.unplugged.is_none() {
            return sent;
        }
    }
    Ok(())
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
        if self.enabled && !self.dropped && silent > CAPABILITIES.watchdog() {
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
}

impl link::Board for Mutex<State> {
    fn get(&self, number: u8) -> Answer {
        let mut state = self.lock().unwrap();
        if number != Capabilities::NUMBER {
            return Answer::Error;
        }
        state.record.questions += 1;
        state.make.answer.clone()
    }

    fn output(&self, bytes: &[u8]) -> Completion {
        let mut state = self.lock().unwrap();
        if state.refuses {
            return Completion::Never;
        }
        let Ok(report) = ForceReport::decode(bytes) else {
            state.record.invalid += 1;
            return Completion::Now;
        };
        let round_trip = state.sent.elapsed();
        if !state.answered {
            state.record.round_trips.push(round_trip);
        }
        state.answered = true;
        state.written = Instant::now();
        state.record.forces += 1;
        let last = state.record.last.replace(report);
        let next = last.map(|last| last.sequence.wrapping_add(1));
        state.record.out_of_order += u32::from(next.is_some_and(|next| next != report.sequence));
        let play = i16::from(report.flags & ForceReport::PLAY != 0);
        state.force = [report.lateral, report.normal].map(|force| force * play);
        let early = !state.held() && state.force != [0, 0];
        state.record.too_early += u32::from(early);
        state.move_motors();
        state.make.takes
    }

    fn set(&self, bytes: &[u8]) -> bool {
        let mut state = self.lock().unwrap();
        let Ok(control) = Control::decode(bytes) else {
            state.record.invalid += 1;
            return false;
        };
        match control {
            Control::Stop => {
                state.enabled = false;
                state.record.stopped_after = Some(state.written.elapsed());
            }
            Control::Enable => {
                state.enabled = true;
                state.tick = state.tick.or(Some(0));
            }
            Control::ClearFault => {
                // The hand lets go.
                state.tick = state.tick.filter(|_| !state.dropped);
                state.dropped = false;
            }
        }
        state.written = Instant::now();
        state.record.controls.push(control);
        state.move_motors();
        true
    }
}
