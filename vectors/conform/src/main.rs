//! `palpate-conform`: another program against the vectors (`spec/oracle.md`). It shares no code with the implementation in this
//! repository, whose oracle it asks as it asks others.
//!
//! Implements: ORA-070.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

use palpate_conform::{
    Choice, ConformError, Expected, Form, Measure, Profile, Require, Settings, Suite, Verdict,
    judge_files, junit, page, questions, read_accepted, run, table,
};

/// Asks another program the questions of the vectors, and says what it gets wrong.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true
)]
struct Arguments {
    #[command(subcommand)]
    work: Option<Work>,
    #[command(flatten)]
    chosen: Chosen,
    #[command(flatten)]
    judged: Judged,
    /// Prints the cases of --case, and what is expected, instead of asking them
    #[arg(long, requires = "case")]
    show: bool,
    /// How long the program may take for one answer, in seconds
    #[arg(long, value_name = "T", value_parser = seconds, default_value = "10")]
    timeout_s: Duration,
    /// The program that answers lines of JSON on its standard output, with its arguments
    #[arg(last = true, required_unless_present = "show", value_name = "CMD ARGS")]
    command: Vec<OsString>,
}

#[derive(Debug, Subcommand)]
enum Work {
    /// Writes the questions to a file, for a program that cannot serve a pipe
    Questions {
        #[command(flatten)]
        chosen: Chosen,
        /// The file, or else standard output
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
        /// How they are written
        #[arg(long, value_enum, default_value_t = Form::Jsonl)]
        form: Form,
    },
    /// Judges a file of answers to a file of questions
    Judge {
        #[command(flatten)]
        chosen: Chosen,
        #[command(flatten)]
        judged: Judged,
        /// What `questions` wrote
        questions: PathBuf,
        /// The answers, in the same form
        answers: PathBuf,
    },
}

/// Which cases are asked.
#[derive(Debug, Args)]
struct Chosen {
    /// A folder of vectors instead of those in this program
    #[arg(long, value_name = "DIR")]
    vectors: Option<PathBuf>,
    #[command(flatten)]
    choice: Choice,
}

/// How a program is judged, and how that is printed.
#[derive(Debug, Args)]
struct Judged {
    /// The working precision: exact, f64, f32, or a file of JSON
    #[arg(long, value_name = "NAME", default_value = "exact")]
    profile: String,
    /// Counts the cases where the precision ends too
    #[arg(long)]
    extreme: bool,
    /// What must be so for exit code 0
    #[arg(long, value_enum, default_value_t = Require::Right)]
    require: Require,
    /// A list of known mistakes: a case and its reason a line
    #[arg(long, value_name = "FILE")]
    accept: Option<PathBuf>,
    /// Passes over lines that are no answer, such as a banner, and tells them
    #[arg(long)]
    lenient: bool,
    /// How the verdict is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Table,
    /// For programs
    Json,
    /// For CI: JUnit's XML
    Junit,
    /// A page to be signed
    Html,
}

fn seconds(text: &str) -> Result<Duration, String> {
    text.parse()
        .ok()
        .filter(|seconds| (0.01..=86_400.0).contains(seconds))
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("{text:?}: expected seconds from 0.01 to 86400, such as 10"))
}

/// Why the exit code is not 0.
enum Failure {
    /// The program is not as required: 1.
    Check(String),
    /// There is no verdict, since something of the command line or a file is wrong: 2.
    Usage(String),
}

fn usage(error: impl std::fmt::Display) -> Failure {
    Failure::Usage(error.to_string())
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Clap's own text is several lines for a mistake; the usage is left out.
            let text = error.to_string();
            let is_asked_for = !error.use_stderr();
            let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
            let lines = lines.take_while(|line| !line.starts_with("Usage:"));
            let line: Vec<&str> = lines.collect();
            return match is_asked_for {
                true => exit(print(&text)),
                false => exit(Err(usage(line.join(" ").trim_start_matches("error: ")))),
            };
        }
    };
    exit(work(arguments))
}

fn exit(result: Result<(), Failure>) -> ExitCode {
    let (code, message) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Check(message)) => (1, message),
        Err(Failure::Usage(message)) => (2, message),
    };
    eprintln!("palpate-conform: {message}");
    ExitCode::from(code)
}

/// Prints text; a reader who has gone away (`| head`) is no error.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Check(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Implements: ORA-040, ORA-049, ORA-050, ORA-057.
fn work(arguments: Arguments) -> Result<(), Failure> {
    match arguments.work {
        None => conform(&arguments),
        Some(Work::Questions { chosen, out, form }) => {
            let text = questions(&chosen.part(&chosen.suite()?)?, form);
            match out {
                None => print(&text),
                Some(file) => std::fs::write(&file, text)
                    .map_err(|error| usage(format!("{}: {error}", file.display()))),
            }
        }
        Some(Work::Judge {
            chosen,
            judged,
            questions,
            answers,
        }) => {
            let suite = chosen.suite()?;
            let measure = judged.measure(&suite)?;
            let suite = chosen.part(&suite)?;
            let verdict = judge_files(
                &suite,
                &chosen.choice.skip,
                &questions,
                &answers,
                &measure,
                judged.lenient,
            );
            let (verdict, suite) = verdict.map_err(usage)?;
            judged.tell(&verdict, &suite)
        }
    }
}

/// Asks, and prints the verdict.
fn conform(arguments: &Arguments) -> Result<(), Failure> {
    let suite = arguments.chosen.suite()?;
    let measure = arguments.judged.measure(&suite)?;
    let suite = arguments.chosen.part(&suite)?;
    if arguments.show {
        return print(&shown(&suite));
    }
    let settings = Settings {
        command: arguments.command.clone(),
        skip: arguments.chosen.choice.skip.clone(),
        lenient: arguments.judged.lenient,
        timeout: arguments.timeout_s,
    };
    let is_watched = std::io::stderr().is_terminal();
    let verdict = run(&suite, &settings, &measure, |done| {
        if is_watched && done % 16 == 0 {
            eprint!("\r{done} of {} cases ", suite.cases());
        }
    });
    if is_watched {
        eprint!("\r\x1b[K");
    }
    let verdict = verdict.map_err(|error| match error {
        ConformError::Capabilities { .. } => Failure::Check(error.to_string()),
        ConformError::Start { .. } => usage(error),
    })?;
    arguments.judged.tell(&verdict, &suite)
}

/// The requests of the cases, and what is expected.
fn shown(suite: &Suite) -> String {
    let mut text = String::new();
    for group in &suite.groups {
        for case in &group.cases {
            let _ = write!(
                text,
                "{}: {}\n{}",
                case.id,
                case.comment,
                case.line(&group.op)
            );
            match &case.expected {
                Expected::Refusal { .. } => text.push_str("must be refused\n"),
                Expected::Values(values) => {
                    for wanted in values {
                        let _ = writeln!(
                            text,
                            "{} = {} within {}",
                            wanted.key, wanted.value, wanted.tolerance
                        );
                    }
                }
            }
        }
    }
    text
}

impl Chosen {
    fn suite(&self) -> Result<Suite, Failure> {
        let suite = match &self.vectors {
            Some(folder) => Suite::read(folder),
            None => Suite::embedded(),
        };
        suite.map_err(usage)
    }

    /// The part that is chosen.
    fn part(&self, suite: &Suite) -> Result<Suite, Failure> {
        suite.select(&self.choice).map_err(usage)
    }
}

impl Judged {
    fn measure(&self, suite: &Suite) -> Result<Measure, Failure> {
        let accepted = self
            .accept
            .as_deref()
            .map(|file| read_accepted(file, suite));
        Ok(Measure {
            profile: Profile::named(&self.profile).map_err(usage)?,
            extreme: self.extreme,
            require: self.require,
            accepted: accepted.transpose().map_err(usage)?.unwrap_or_default(),
        })
    }

    fn tell(&self, verdict: &Verdict, suite: &Suite) -> Result<(), Failure> {
        print(&match self.format {
            Format::Table => table(verdict),
            // A verdict holds nothing that JSON has not.
            Format::Json => serde_json::to_string_pretty(verdict).unwrap_or_default() + "\n",
            Format::Junit => junit(verdict, suite),
            Format::Html => page(verdict),
        })?;
        verdict
            .failure()
            .map_or(Ok(()), |failure| Err(Failure::Check(failure)))
    }
}
