//! `palpate-conform`: judges another program against the vectors (`spec/oracle.md`). It shares no code with the implementation in
//! this repository, whose oracle it asks like any other.
//!
//! Implements: ORA-070.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

use palpate_conform::{
    Choice, ConformError, Expected, Form, Measure, Settings, Suite, Verdict, judge_files, junit,
    page, questions, read_accepted, run, table,
};

/// The command line.
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
    /// Prints the cases of --case and the expected answers instead of asking them
    #[arg(long, requires = "case")]
    show: bool,
    /// Longest time for one answer, in seconds
    #[arg(long, value_name = "T", value_parser = seconds, default_value = "10")]
    timeout_s: Duration,
    /// Program that answers lines of JSON on its standard output, with its arguments
    #[arg(last = true, required_unless_present = "show", value_name = "CMD ARGS")]
    command: Vec<OsString>,
}

#[derive(Debug, Subcommand)]
enum Work {
    /// Writes the questions to a file, for a program that cannot serve a pipe
    Questions {
        #[command(flatten)]
        chosen: Chosen,
        /// File to write; standard output by default
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
        /// Form of the questions
        #[arg(long, value_enum, default_value_t = Form::Jsonl)]
        form: Form,
    },
    /// Judges a file of answers to a file of questions
    Judge {
        #[command(flatten)]
        chosen: Chosen,
        #[command(flatten)]
        judged: Judged,
        /// File that `questions` wrote
        questions: PathBuf,
        /// File of answers, in the same form
        answers: PathBuf,
    },
}

/// Which cases are asked.
#[derive(Debug, Args)]
struct Chosen {
    /// Folder of vectors to use instead of those built into this program
    #[arg(long, value_name = "DIR")]
    vectors: Option<PathBuf>,
    #[command(flatten)]
    choice: Choice,
}

/// How a program is judged, and how the verdict is printed.
#[derive(Debug, Args)]
struct Judged {
    #[command(flatten)]
    measure: Measure,
    /// List of known mistakes: a case and its reason per line
    #[arg(long, value_name = "FILE")]
    accept: Option<PathBuf>,
    /// Ignores lines that are not answers, such as a banner, and reports them
    #[arg(long)]
    lenient: bool,
    /// Form of the verdict
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
        .ok_or_else(|| "give seconds from 0.01 to 86400, such as 10".into())
}

/// The exit code, if it is not 0, and why.
struct Failure(u8, String);

/// There is no verdict, because the command line or a file is wrong.
fn usage(error: impl Display) -> Failure {
    Failure(2, error.to_string())
}

/// The program is not as required.
fn unmet(error: impl Display) -> Failure {
    Failure(1, error.to_string())
}

fn main() -> ExitCode {
    let done = read_arguments().and_then(|arguments| arguments.map_or(Ok(()), work));
    done.map_or_else(
        |Failure(code, message)| {
            eprintln!("palpate-conform: {message}");
            code.into()
        },
        |()| ExitCode::SUCCESS,
    )
}

/// The arguments, or none if --help or --version has been printed.
fn read_arguments() -> Result<Option<Arguments>, Failure> {
    let error = match Arguments::try_parse() {
        Ok(arguments) => return Ok(Some(arguments)),
        Err(error) => error,
    };
    let text = error.to_string();
    if !error.use_stderr() {
        return print(&text).map(|()| None);
    }
    // Clap's own text has several lines for a mistake; the usage and the hint at --help are left out.
    let lines = text.lines().map(str::trim);
    let is_mistake = |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more");
    let line: Vec<&str> = lines
        .take_while(is_mistake)
        .filter(|line| !line.is_empty())
        .collect();
    Err(usage(line.join(" ").trim_start_matches("error: ")))
}

/// Prints text; a reader who has gone away (`| head`) is no error.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(unmet(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Implements: ORA-040, ORA-049, ORA-050, ORA-057.
fn work(arguments: Arguments) -> Result<(), Failure> {
    match arguments.work {
        None => conform(arguments),
        Some(Work::Questions { chosen, out, form }) => {
            let text = questions(&chosen.part(chosen.suite()?)?, form);
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
            let (suite, measure) = judged.prepare(&chosen)?;
            let skip = &chosen.choice.skip;
            let verdict = judge_files(suite, skip, &questions, &answers, &measure, judged.lenient);
            let (verdict, suite) = verdict.map_err(usage)?;
            judged.report(&verdict, &suite)
        }
    }
}

/// Asks, and prints the verdict.
fn conform(arguments: Arguments) -> Result<(), Failure> {
    let Arguments { chosen, judged, .. } = arguments;
    let (suite, measure) = judged.prepare(&chosen)?;
    if arguments.show {
        return print(&shown(&suite));
    }
    let settings = Settings {
        command: arguments.command,
        skip: chosen.choice.skip,
        lenient: judged.lenient,
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
        ConformError::Capabilities { .. } => unmet(error),
        ConformError::Start { .. } => usage(error),
    })?;
    judged.report(&verdict, &suite)
}

/// The requests of the cases, and the expected answers.
fn shown(suite: &Suite) -> String {
    let mut text = String::new();
    for (case, request) in suite.requests() {
        text += &format!("{}: {}\n{request}", case.id, case.comment);
        if matches!(case.expected, Expected::Refusal { .. }) {
            text += "must be refused\n";
        }
        for wanted in case.expected.values() {
            let (key, value, tolerance) = (&wanted.key, &wanted.value, wanted.tolerance);
            text += &format!("{key} = {value} within {tolerance}\n");
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
    fn part(&self, suite: Suite) -> Result<Suite, Failure> {
        suite.select(&self.choice).map_err(usage)
    }
}

impl Judged {
    /// The cases that are asked, and the measure with the list of known mistakes.
    fn prepare(&self, chosen: &Chosen) -> Result<(Suite, Measure), Failure> {
        let (suite, mut measure) = (chosen.suite()?, self.measure.clone());
        measure.named = !chosen.choice.only.is_empty() || !chosen.choice.case.is_empty();
        if let Some(file) = &self.accept {
            measure.accepted = read_accepted(file, &suite).map_err(usage)?;
        }
        Ok((chosen.part(suite)?, measure))
    }

    /// Prints the verdict.
    fn report(&self, verdict: &Verdict, suite: &Suite) -> Result<(), Failure> {
        print(&match self.format {
            Format::Table => table(verdict),
            // A verdict holds nothing that JSON cannot express.
            Format::Json => serde_json::to_string_pretty(verdict).unwrap_or_default() + "\n",
            Format::Junit => junit(verdict, suite),
            Format::Html => page(verdict),
        })?;
        verdict
            .failure
            .as_ref()
            .map_or(Ok(()), |why| Err(unmet(why)))
    }
}
