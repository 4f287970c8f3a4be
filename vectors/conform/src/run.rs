//! All cases asked, in a pipeline, through crashes and silence.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::time::{Duration, Instant};

use super::answers::Answers;
use super::partner::{Event, Partner};
use super::plan::{CAPABILITIES, Capabilities, Plan};
use super::suite::Suite;
use super::text::cut;
use super::verdict::{Measure, Program, Verdict};

/// How many requests may be without an answer at a time.
const WINDOW: usize = 64;
/// How often the program is started, at most: one that dies of every bad request needs many.
const MOST_STARTS: usize = 200;
/// How often it may be silent until the timeout.
const MOST_SILENCES: usize = 6;
/// How long a program may take to end, once its input has.
const PATIENCE: Duration = Duration::from_secs(2);

/// What is run, and how.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The program and its arguments.
    pub command: Vec<OsString>,
    /// Groups and cases that are not asked.
    pub skip: Vec<String>,
    /// Whether a line that is no answer is passed over.
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
        /// What the system says.
        error: std::io::Error,
    },
    /// The program does not speak the protocol.
    #[error(
        "{found}; expected a line like {{\"id\":\"capabilities\",\"ok\":{{\"version\":\"1.0\",\"ops\":[\"normal_cdf\"]}}}} as the answer to {{\"args\":{{}},\"id\":\"capabilities\",\"op\":\"capabilities\"}}, written out at once"
    )]
    Capabilities {
        /// What came instead.
        found: String,
    },
}

/// Runs the vectors against a program; `progress` is called for each case that is done.
///
/// # Errors
/// [`ConformError`]; a program that answers wrongly, or ends, has a verdict.
///
/// Implements: ORA-042, ORA-043, ORA-044, ORA-045, ORA-069.
pub fn run(
    suite: &Suite,
    settings: &Settings,
    measure: &Measure,
    progress: impl FnMut(usize),
) -> Result<Verdict, ConformError> {
    let (partner, capabilities) = start_and_ask(settings)?;
    let plan = Plan::new(suite, &settings.skip, |op| {
        capabilities.ops.iter().any(|known| known == op)
    });
    let answers = Answers::new(plan.cases(suite), &measure.profile, settings.lenient);
    let lines = plan.asked.iter().map(|&(group, case)| {
        let group = &suite.groups[group];
        group.cases[case].line(&group.op).into_bytes()
    });
    let mut run = Run::new(settings, answers, lines.collect(), progress);
    run.ask_all(partner)?;
    let never = "not asked: the program had ended or was silent too often";
    let answers = run.answers;
    let outcomes = plan.outcomes(answers.outcomes, never);
    let program = Program::of_command(&settings.command, capabilities.version);
    Ok(Verdict::new(
        suite,
        measure,
        program,
        outcomes,
        answers.notes,
    ))
}

fn start(settings: &Settings) -> Result<Partner, ConformError> {
    Partner::start(&settings.command).map_err(|error| ConformError::Start {
        program: settings
            .command
            .first()
            .map_or_else(String::new, |p| p.to_string_lossy().into_owned()),
        error,
    })
}

/// Implements: ORA-042.
fn start_and_ask(settings: &Settings) -> Result<(Partner, Capabilities), ConformError> {
    let partner = start(settings)?;
    partner.ask(format!("{CAPABILITIES}\n").into_bytes());
    let deadline = Instant::now() + settings.timeout;
    let found = loop {
        match partner.next(deadline) {
            Event::Line(line) => match Capabilities::read(&line) {
                Some(capabilities) => return Ok((partner, capabilities)),
                None if settings.lenient => {}
                None => {
                    break format!(
                        "the program answered {:?}",
                        cut(&String::from_utf8_lossy(&line))
                    );
                }
            },
            Event::Silence => {
                let seconds = settings.timeout.as_secs_f64();
                let end = partner.end(Duration::ZERO);
                break format!("the program gave no answer within {seconds} s ({end})");
            }
            Event::End => {
                let end = partner.end(PATIENCE);
                break format!("the program ended without an answer ({end})");
            }
        }
    };
    Err(ConformError::Capabilities { found })
}

/// The cases that are asked and what became of them.
struct Run<'a, P> {
    settings: &'a Settings,
    answers: Answers<'a>,
    /// The request of each case.
    lines: Vec<Vec<u8>>,
    /// Cases to be asked, by their index, the next one first.
    queue: VecDeque<usize>,
    /// So many more cases are asked one at a time: among them is one that the program died of.
    alone: usize,
    starts: usize,
    silences: usize,
    progress: P,
}

impl<'a, P: FnMut(usize)> Run<'a, P> {
    fn new(settings: &'a Settings, answers: Answers<'a>, lines: Vec<Vec<u8>>, progress: P) -> Self {
        Run {
            settings,
            queue: (0..lines.len()).collect(),
            answers,
            lines,
            alone: 0,
            starts: 1,
            silences: 0,
            progress,
        }
    }

    /// Asks until every case is judged or the program has ended too often.
    fn ask_all(&mut self, partner: Partner) -> Result<(), ConformError> {
        let mut running = Some(partner);
        while !self.queue.is_empty() || !self.answers.waiting.is_empty() {
            let partner = match running.take() {
                Some(partner) => partner,
                None if self.starts == MOST_STARTS || self.silences == MOST_SILENCES => {
                    self.answers.notes.push(format!(
                        "{} cases were not asked: the program was started {} times and silent {} times",
                        self.queue.len(),
                        self.starts,
                        self.silences
                    ));
                    return Ok(());
                }
                None => {
                    self.starts += 1;
                    // Asked again, so that the time it takes to start is not the next case's.
                    match start_and_ask(self.settings) {
                        Ok((partner, _)) => partner,
                        Err(error @ ConformError::Capabilities { .. }) => {
                            self.answers.notes.push(format!("started again, {error}"));
                            return Ok(());
                        }
                        Err(error) => return Err(error),
                    }
                }
            };
            match self.converse(&partner) {
                None => running = Some(partner),
                Some(end) => self.bury(partner, end),
            }
        }
        if let Some(partner) = running {
            let end = partner.end(PATIENCE);
            if !end.starts_with("exit status: 0") {
                self.answers
                    .notes
                    .push(format!("at the end of its input: {end}"));
            }
        }
        Ok(())
    }

    /// Asks and listens until there is nothing left or the program is gone or silent.
    fn converse(&mut self, partner: &Partner) -> Option<Event> {
        let mut deadline = Instant::now() + self.settings.timeout;
        loop {
            let window = if self.alone > 0 { 1 } else { WINDOW };
            if self.answers.waiting.is_empty() {
                deadline = Instant::now() + self.settings.timeout;
            }
            while self.answers.waiting.len() < window
                && let Some(next) = self.queue.pop_front()
            {
                partner.ask(self.lines[next].clone());
                self.answers.waiting.push_back(next);
            }
            if self.answers.waiting.is_empty() {
                return None;
            }
            match partner.next(deadline) {
                Event::Line(line) => {
                    let before = self.answers.settled();
                    if self.answers.take(&line) {
                        let settled = self.answers.settled();
                        self.alone = self.alone.saturating_sub(settled - before);
                        (self.progress)(settled);
                        // The clock of the next one starts with the answer of the one before.
                        deadline = Instant::now() + self.settings.timeout;
                    }
                }
                end => return Some(end),
            }
        }
    }

    /// The program is gone or silent. If it was asked one thing, that was it; of several, each is
    /// asked again alone.
    ///
    /// Implements: ORA-044, ORA-045.
    fn bury(&mut self, partner: Partner, event: Event) {
        let (what, patience) = match event {
            Event::Silence => {
                self.silences += 1;
                let seconds = self.settings.timeout.as_secs_f64();
                (format!("no answer within {seconds} s"), Duration::ZERO)
            }
            _ => ("the program ended without an answer".into(), PATIENCE),
        };
        let end = partner.end(patience);
        if self.answers.waiting.len() == 1 {
            self.answers.fail(format!("{what} ({end})"));
            self.alone = self.alone.saturating_sub(1);
            (self.progress)(self.answers.settled());
            return;
        }
        self.alone = self.answers.waiting.len();
        while let Some(last) = self.answers.waiting.pop_back() {
            self.queue.push_front(last);
        }
    }
}
