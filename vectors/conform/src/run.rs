//! All cases asked through a pipe, despite crashes and silence.

use std::ffi::OsString;
use std::time::{Duration, Instant};

use super::answers::{Answers, CAPABILITIES, Capabilities};
use super::measure::Measure;
use super::partner::{Event, Partner};
use super::program::Program;
use super::suite::Suite;
use super::text::cut;
use super::verdict::Verdict;

/// How many requests may be open at a time.
const WINDOW: usize = 64;
/// How often the program is started, at most: one that dies of every bad request needs many starts.
const MOST_STARTS: usize = 200;
/// How often it may be silent until the timeout.
const MOST_SILENCES: usize = 6;
/// How long a program may take to end once its input has ended.
const PATIENCE: Duration = Duration::from_secs(2);

/// What is run, and how.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The program and its arguments.
    pub command: Vec<OsString>,
    /// Groups and cases that are not asked.
    pub skip: Vec<String>,
    /// Whether a line that is no answer is ignored.
    pub lenient: bool,
    /// How long the program may take for one answer.
    pub timeout: Duration,
}

/// Why there is no verdict.
#[derive(Debug, thiserror::Error)]
pub enum ConformError {
    /// The program cannot be started.
    #[error("cannot start {program}: {error}")]
    Start {
        /// The program.
        program: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// The program does not speak the protocol.
    #[error(
        "{found}; it must answer {CAPABILITIES} at once with a line such as {{\"id\":\"capabilities\",\"ok\":{{\"version\":\"1.0\",\"ops\":[\"normal_cdf\"]}}}}"
    )]
    Capabilities {
        /// What came instead.
        found: String,
    },
}

/// Asks a program all cases; `progress` is called with the number of cases judged so far.
///
/// # Errors
/// [`ConformError`]; a program that answers wrongly, or ends, has a verdict.
///
/// Implements: ORA-042, ORA-043, ORA-044, ORA-045, ORA-069, ORA-079.
pub fn run(
    suite: &Suite,
    settings: &Settings,
    measure: &Measure,
    progress: impl FnMut(usize),
) -> Result<Verdict, ConformError> {
    let (partner, claims) = start_and_ask(settings)?;
    let (skip, profile) = (&settings.skip, &measure.profile);
    let mut answers = Answers::new(suite, skip, profile, settings.lenient);
    answers.claim(&claims.ops);
    let mut run = Run {
        settings,
        answers,
        alone: 0,
        starts: 1,
        silences: 0,
        stops: Vec::new(),
        progress,
    };
    run.ask_all(partner)?;
    let never = "not asked: the program had ended or was silent too often";
    let stops = run.stops.iter().map(|(_, times)| times).sum();
    let told = run.stops.iter().map(|(why, times)| {
        format!("stops before the end of the input: {times}, each time the program {why}")
    });
    run.answers.notes.extend(told);
    let (outcomes, notes) = run.answers.outcomes(never);
    let program = Program::of_command(&settings.command, claims.version());
    Ok(Verdict::new(
        suite, measure, program, outcomes, notes, stops,
    ))
}

/// Starts the program and asks what it can do.
///
/// Implements: ORA-042.
fn start_and_ask(settings: &Settings) -> Result<(Partner, Capabilities), ConformError> {
    let partner = Partner::start(&settings.command).map_err(|error| {
        let program = settings.command.first().cloned().unwrap_or_default();
        let program = program.to_string_lossy().into_owned();
        ConformError::Start { program, error }
    })?;
    partner.ask(format!("{CAPABILITIES}\n"));
    let deadline = Instant::now() + settings.timeout;
    let found = loop {
        match partner.next(deadline) {
            Event::Line(line) => match Capabilities::read(&line) {
                Some(capabilities) => return Ok((partner, capabilities)),
                None if settings.lenient && Instant::now() < deadline => {}
                // Lines that answer nothing are no answer, however many there are.
                None if settings.lenient => {
                    let told = farewell(partner, &Event::Silence, settings.timeout);
                    break format!("the program {told}");
                }
                None => {
                    let text = cut(&String::from_utf8_lossy(&line));
                    break format!("the program answered {text:?}");
                }
            },
            end => break format!("the program {}", farewell(partner, &end, settings.timeout)),
        }
    };
    Err(ConformError::Capabilities { found })
}

/// Ends a program that is silent or gone, and says so.
fn farewell(partner: Partner, event: &Event, timeout: Duration) -> String {
    match event {
        Event::Silence => {
            let end = partner.end(Duration::ZERO);
            format!("gave no answer within {} s ({end})", timeout.as_secs_f64())
        }
        _ => format!("ended without an answer ({})", partner.end(PATIENCE)),
    }
}

/// The cases that are asked, and their outcomes.
struct Run<'a, P> {
    settings: &'a Settings,
    answers: Answers<'a>,
    /// How many more cases are asked one at a time, because the program died of one of them.
    alone: usize,
    starts: usize,
    silences: usize,
    /// How it ended or was silent before its input ended, and how often so.
    stops: Vec<(String, usize)>,
    progress: P,
}

impl<P: FnMut(usize)> Run<'_, P> {
    /// Asks until every case is judged or the program has ended too often.
    fn ask_all(&mut self, mut partner: Partner) -> Result<(), ConformError> {
        while let Some(event) = self.converse(&partner) {
            self.bury(partner, &event);
            if self.answers.queued() == 0 {
                return Ok(());
            }
            if self.starts == MOST_STARTS || self.silences == MOST_SILENCES {
                self.answers.notes.push(format!(
                    "{} cases were not asked: the program was started {} times and silent {} times",
                    self.answers.queued(),
                    self.starts,
                    self.silences
                ));
                return Ok(());
            }
            self.starts += 1;
            // Its capabilities are asked again, so that its start does not take the time of the next case.
            partner = match start_and_ask(self.settings) {
                Ok((partner, _)) => partner,
                Err(error @ ConformError::Capabilities { .. }) => {
                    self.answers.notes.push(format!("started again, {error}"));
                    return Ok(());
                }
                Err(error) => return Err(error),
            };
        }
        let end = partner.end(PATIENCE);
        if !end.starts_with("exit status: 0") {
            let note = format!("at the end of its input: {end}");
            self.answers.notes.push(note);
        }
        Ok(())
    }

    /// Asks and listens until nothing is left, or the program is gone or silent.
    fn converse(&mut self, partner: &Partner) -> Option<Event> {
        let mut deadline = Instant::now() + self.settings.timeout;
        loop {
            let window = if self.alone > 0 { 1 } else { WINDOW };
            if self.answers.open() == 0 {
                deadline = Instant::now() + self.settings.timeout;
            }
            while self.answers.open() < window
                && let Some(line) = self.answers.ask()
            {
                partner.ask(line);
            }
            if self.answers.open() == 0 {
                return None;
            }
            match partner.next(deadline) {
                Event::Line(line) => {
                    let before = self.answers.settled();
                    if self.answers.take(&line) {
                        let settled = self.answers.settled();
                        self.alone = self.alone.saturating_sub(settled - before);
                        (self.progress)(settled);
                        // The time for the next case starts with the answer to the one before.
                        deadline = Instant::now() + self.settings.timeout;
                    } else if Instant::now() >= deadline {
                        // Lines that answer nothing are no answer, however many there are.
                        return Some(Event::Silence);
                    }
                }
                end => return Some(end),
            }
        }
    }

    /// The program is gone or silent. If one case was open, that is to blame; of several, each is asked again alone.
    ///
    /// Implements: ORA-044, ORA-045, ORA-079.
    fn bury(&mut self, partner: Partner, event: &Event) {
        self.silences += usize::from(matches!(event, Event::Silence));
        let why = farewell(partner, event, self.settings.timeout);
        match self.stops.iter_mut().find(|(known, _)| *known == why) {
            Some((_, times)) => *times += 1,
            None => self.stops.push((why.clone(), 1)),
        }
        if self.answers.open() == 1 {
            self.answers.fail(why);
            self.alone = self.alone.saturating_sub(1);
            (self.progress)(self.answers.settled());
        } else {
            self.alone = self.answers.open();
            self.answers.take_back();
        }
    }
}
