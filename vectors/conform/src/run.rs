//! All cases asked, in a pipeline, through crashes and silence.

use std::collections::{HashSet, VecDeque};
use std::ffi::OsString;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::case::{Case, Question};
use super::judge::judge;
use super::partner::{Event, Partner};
use super::suite::Suite;
use super::tolerance::{cut, shortened};
use super::verdict::{Outcome, Verdict};

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
    /// The groups that are asked, or all if there are none.
    pub only: Vec<String>,
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
    /// A group that does not exist.
    #[error("no group {name:?} in these vectors, expected one of {known}")]
    Group {
        /// Its name.
        name: String,
        /// The groups that exist.
        known: String,
    },
    /// The program does not speak the protocol.
    #[error(
        "{found}; expected a line like {{\"id\":\"capabilities\",\"ok\":{{\"version\":\"1.0\",\"ops\":[\"normal_cdf\"]}}}} as the answer to {{\"id\":\"capabilities\",\"op\":\"capabilities\",\"args\":{{}}}}, written out at once"
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
/// Implements: ORA-042, ORA-043, ORA-044, ORA-045.
pub fn run(
    suite: &Suite,
    settings: &Settings,
    progress: impl FnMut(),
) -> Result<Verdict, ConformError> {
    check_groups(suite, &settings.only)?;
    let suite = &suite.only(&settings.only);
    let (partner, capabilities) = start_and_ask(settings)?;
    let claimed = |op: &str| op.is_empty() || capabilities.ops.iter().any(|known| known == op);
    let mut asked: Vec<(usize, usize)> = Vec::new();
    let mut outcomes: Vec<Vec<Outcome>> = Vec::new();
    for (index, group) in suite.groups.iter().enumerate() {
        outcomes.push(vec![Outcome::Skipped; group.cases.len()]);
        if claimed(&group.op) {
            asked.extend((0..group.cases.len()).map(|case| (index, case)));
        }
    }
    let cases = asked
        .iter()
        .map(|&(group, case)| {
            (
                &suite.groups[group].cases[case],
                &suite.groups[group].op[..],
            )
        })
        .collect();
    let mut run = Run::new(settings, cases, progress);
    run.ask_all(partner)?;
    for (&(group, case), outcome) in asked.iter().zip(run.outcomes) {
        outcomes[group][case] = outcome.unwrap_or_else(|| {
            Outcome::failed("not asked: the program had ended or was silent too often")
        });
    }
    let command = settings
        .command
        .iter()
        .map(|part| part.to_string_lossy().into_owned());
    Ok(Verdict::new(
        suite,
        command.collect(),
        capabilities.version,
        outcomes,
        run.notes,
    ))
}

fn check_groups(suite: &Suite, only: &[String]) -> Result<(), ConformError> {
    let known: Vec<&str> = suite.groups.iter().map(|group| &group.name[..]).collect();
    match only.iter().find(|name| !known.contains(&&name[..])) {
        Some(name) => Err(ConformError::Group {
            name: name.clone(),
            known: known.join(", "),
        }),
        None => Ok(()),
    }
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

/// What a program says that it can do.
struct Capabilities {
    version: String,
    ops: Vec<String>,
}

/// Implements: ORA-042.
fn start_and_ask(settings: &Settings) -> Result<(Partner, Capabilities), ConformError> {
    let partner = start(settings)?;
    partner.ask(b"{\"id\":\"capabilities\",\"op\":\"capabilities\",\"args\":{}}\n".to_vec());
    let found = match partner.next(Instant::now() + settings.timeout) {
        Event::Line(line) => match capabilities(&line) {
            Some(capabilities) => return Ok((partner, capabilities)),
            None => format!(
                "the program answered {:?}",
                cut(&String::from_utf8_lossy(&line))
            ),
        },
        Event::Silence => {
            let seconds = settings.timeout.as_secs_f64();
            format!(
                "the program gave no answer within {seconds} s ({})",
                partner.end(Duration::ZERO)
            )
        }
        Event::End => format!(
            "the program ended without an answer ({})",
            partner.end(PATIENCE)
        ),
    };
    Err(ConformError::Capabilities { found })
}

fn capabilities(line: &[u8]) -> Option<Capabilities> {
    let answer: Value = serde_json::from_slice(line).ok()?;
    let ok = answer.get("ok")?;
    let ops = ok
        .get("ops")?
        .as_array()?
        .iter()
        .map(|op| op.as_str().map(str::to_string));
    let version = match ok.get("version")? {
        Value::String(version) => version.clone(),
        version => version.to_string(),
    };
    (answer.get("id")? == "capabilities").then_some(())?;
    Some(Capabilities {
        version,
        ops: ops.collect::<Option<_>>()?,
    })
}

/// The cases that are asked and what became of them.
struct Run<'a, P> {
    settings: &'a Settings,
    cases: Vec<(&'a Case, &'a str)>,
    outcomes: Vec<Option<Outcome>>,
    /// Cases to be asked, by their index, the next one first.
    queue: VecDeque<usize>,
    /// Cases that were asked and have no answer yet, the oldest first.
    waiting: VecDeque<usize>,
    /// So many more cases are asked one at a time: among them is one that the program died of.
    alone: usize,
    /// The ids of cases that are judged.
    judged: HashSet<&'a str>,
    starts: usize,
    silences: usize,
    notes: Vec<String>,
    progress: P,
}

impl<'a, P: FnMut()> Run<'a, P> {
    fn new(settings: &'a Settings, cases: Vec<(&'a Case, &'a str)>, progress: P) -> Self {
        Run {
            settings,
            outcomes: vec![None; cases.len()],
            queue: (0..cases.len()).collect(),
            waiting: VecDeque::new(),
            alone: 0,
            judged: HashSet::new(),
            starts: 1,
            silences: 0,
            notes: Vec::new(),
            cases,
            progress,
        }
    }

    /// Asks until every case is judged or the program has ended too often.
    fn ask_all(&mut self, partner: Partner) -> Result<(), ConformError> {
        let mut running = Some(partner);
        while !self.queue.is_empty() || !self.waiting.is_empty() {
            let partner = match running.take() {
                Some(partner) => partner,
                None if self.starts == MOST_STARTS || self.silences == MOST_SILENCES => {
                    self.notes.push(format!(
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
                            self.notes.push(format!("started again, {error}"));
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
                self.notes.push(format!("at the end of its input: {end}"));
            }
        }
        Ok(())
    }

    /// Asks and listens until there is nothing left or the program is gone or silent.
    fn converse(&mut self, partner: &Partner) -> Option<Event> {
        let mut deadline = Instant::now() + self.settings.timeout;
        loop {
            let window = if self.alone > 0 { 1 } else { WINDOW };
            if self.waiting.is_empty() {
                deadline = Instant::now() + self.settings.timeout;
            }
            while self.waiting.len() < window
                && let Some(next) = self.queue.pop_front()
            {
                let (case, op) = self.cases[next];
                partner.ask(case.line(op));
                self.waiting.push_back(next);
            }
            if self.waiting.is_empty() {
                return None;
            }
            match partner.next(deadline) {
                Event::Line(line) => {
                    if self.take(&line) {
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
        if self.waiting.len() == 1 {
            self.settle(Outcome::failed(format!("{what} ({end})")));
            return;
        }
        self.alone = self.waiting.len();
        while let Some(last) = self.waiting.pop_back() {
            self.queue.push_front(last);
        }
    }

    /// Finds out which case a line answers, and judges it. False for a line that answers nothing
    /// that is still open.
    ///
    /// Implements: ORA-043.
    fn take(&mut self, line: &[u8]) -> bool {
        let Ok(answer) = serde_json::from_slice::<Value>(line) else {
            let text = cut(&String::from_utf8_lossy(line));
            self.settle(Outcome::failed(format!("answered with no JSON: {text}")));
            return true;
        };
        let id = answer.get("id").unwrap_or(&Value::Null);
        let name = id.as_str().unwrap_or_default();
        if let Some(place) = self
            .waiting
            .iter()
            .position(|&index| self.cases[index].0.id == name)
        {
            for _ in 0..place {
                self.settle(Outcome::failed(format!(
                    "no answer: the next one was for {name}"
                )));
            }
            let index = self.waiting[0];
            self.settle(judge(self.cases[index].0, &answer));
            return true;
        }
        if self.judged.contains(name) {
            return false; // a late answer, whose case has failed already
        }
        let case = self.cases[self.waiting[0]].0;
        let id_may_be_lost = id.is_null() && matches!(case.question, Question::Line(_));
        self.settle(if id_may_be_lost {
            judge(case, &answer)
        } else {
            let (found, wanted) = (shortened(id), Value::from(&case.id[..]));
            Outcome::failed(format!(
                "answered with the id {found}, expected {wanted}: {}",
                shortened(&answer)
            ))
        });
        true
    }

    /// The oldest open case has this outcome.
    fn settle(&mut self, outcome: Outcome) {
        if let Some(index) = self.waiting.pop_front() {
            self.judged.insert(&self.cases[index].0.id);
            self.outcomes[index] = Some(outcome);
            self.alone = self.alone.saturating_sub(1);
            (self.progress)();
        }
    }
}
