//! A page of the documentation: its blocks of commands and files, and what its text names.

use std::fs;
use std::path::Path;

use palpate_asserts::line_matches;

/// A command with the output that the page shows, or a file.
pub struct Step {
    /// The line of the page, from 1.
    pub line: usize,
    /// The command, or what is in the file.
    pub text: String,
    /// The output of a command, with wildcards; every line with its end.
    pub output: String,
    /// The name of a file.
    pub file: Option<String>,
}

/// A page, read.
pub struct Page {
    /// Its path from the root of the package.
    pub name: String,
    /// All of it.
    pub text: String,
    /// What a reader does, in order.
    pub steps: Vec<Step>,
    /// Commands that are not run, with the reason that the page gives.
    pub not_run: Vec<(String, String)>,
}

impl Page {
    /// Reads the page; a block of commands in another language than `console` must say why it is not run.
    pub fn read(path: &Path) -> Page {
        let text = fs::read_to_string(path).unwrap();
        let name = path.strip_prefix(crate::ROOT).unwrap();
        let mut page = Page {
            name: name.display().to_string(),
            text: text.clone(),
            steps: Vec::new(),
            not_run: Vec::new(),
        };
        let lines: Vec<&str> = text.lines().collect();
        let (mut number, mut paragraph) = (0, String::new());
        while number < lines.len() {
            let Some(language) = lines[number].strip_prefix("```") else {
                if lines[number].is_empty()
                    && lines
                        .get(number + 1)
                        .is_some_and(|next| !next.starts_with("```"))
                {
                    paragraph.clear();
                }
                paragraph = paragraph + lines[number] + " ";
                number += 1;
                continue;
            };
            let end = number
                + 1
                + lines[number + 1..]
                    .iter()
                    .position(|line| *line == "```")
                    .unwrap();
            page.block(language, number + 2, &lines[number + 1..end], &paragraph);
            (number, paragraph) = (end + 1, String::new());
        }
        page
    }

    /// Takes up a block whose first line has the number `first`, under `paragraph`.
    fn block(&mut self, language: &str, first: usize, lines: &[&str], paragraph: &str) {
        let reason = paragraph.split("Not run by the tests:").nth(1);
        match (language.split_once("file="), reason) {
            (Some((_, file)), _) => {
                assert!(
                    paragraph.contains(file),
                    "{}:{first}: the text does not name {file}",
                    self.name
                );
                let text = lines.iter().map(|line| format!("{line}\n")).collect();
                self.steps.push(Step {
                    line: first,
                    text,
                    output: String::new(),
                    file: Some(file.into()),
                });
            }
            (None, None) if language == "console" => self.steps.extend(commands(first, lines)),
            (None, Some(reason)) => {
                let commands = commands(first, lines).into_iter().map(|step| step.text);
                self.not_run
                    .extend(commands.map(|command| (command, reason.trim().to_string())));
            }
            // README.md has commands in blocks of its own, which have a test of their own.
            (None, None) => assert!(
                self.name == "README.md"
                    || !lines.iter().any(|line| line.starts_with("$ ")) && language != "sh",
                "{}:{first}: commands are neither run nor said not to be",
                self.name
            ),
        }
    }

    /// The command lines of the program in blocks of a page without `$ `; `cargo run --release --` is the program.
    pub fn plain_commands(&self) -> Vec<String> {
        let text = self
            .text
            .replace("\\\n", "")
            .replace("cargo run --release --", "palpate");
        let lines = text.lines().filter(|line| line.starts_with("palpate "));
        let commands = lines.map(|line| line.split(" #").next().unwrap_or(line));
        commands
            .map(|command| command.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect()
    }

    /// Every command line of the program that the page names, in blocks and in spans of code.
    pub fn mentions(&self) -> Vec<String> {
        let prose = self.text.split("```").step_by(2);
        let spans = prose.flat_map(|prose| prose.split('`').skip(1).step_by(2));
        let steps = self.steps.iter().filter(|step| step.file.is_none());
        let steps = steps.map(|step| step.text.as_str());
        let all = steps
            .chain(self.not_run.iter().map(|(command, _)| command.as_str()))
            .chain(spans);
        let parts = all.flat_map(|command| command.split("| ").flat_map(|part| part.split(" -- ")));
        let found = parts
            .map(str::trim)
            .filter(|part| part.starts_with("palpate "));
        // Elsewhere such a line is an output that begins with the program's name.
        let plain = (self.name == "README.md").then(|| self.plain_commands());
        let found = found.map(String::from);
        found.chain(plain.unwrap_or_default()).collect()
    }

    /// Relative links: the file, from the page's folder, and the heading in it, empty if there is none.
    pub fn links(&self) -> Vec<(String, String)> {
        let targets = self
            .text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next());
        let relative = targets.filter(|target| !target.contains("://"));
        let parts = relative.map(|target| target.split_once('#').unwrap_or((target, "")));
        parts
            .map(|(file, heading)| (file.to_string(), heading.to_string()))
            .collect()
    }
}

/// The names under which a page's headings are linked to: small letters, no signs, hyphens for spaces.
pub fn headings(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let titles = headings.map(|line| line.trim_start_matches('#').trim().to_lowercase());
    let kept = |c: &char| c.is_alphanumeric() || [' ', '-', '_'].contains(c);
    titles
        .map(|title| {
            title
                .chars()
                .filter(kept)
                .collect::<String>()
                .replace(' ', "-")
        })
        .collect()
}

/// The commands of a block with their outputs.
fn commands(first: usize, lines: &[&str]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    for (offset, line) in lines.iter().enumerate() {
        match (
            line.strip_prefix("$ "),
            line.strip_prefix("> "),
            steps.last_mut(),
        ) {
            (Some(command), ..) => {
                steps.push(Step {
                    line: first + offset,
                    text: command.into(),
                    output: String::new(),
                    file: None,
                });
            }
            (None, Some(more), Some(step)) if step.output.is_empty() => {
                step.text = format!("{}\n{more}", step.text)
            }
            (_, _, Some(step)) => step.output = format!("{}{line}\n", step.output),
            (_, _, None) => panic!(
                "line {}: a block begins with no command: {line}",
                first + offset
            ),
        }
    }
    steps
}

/// Whether the output is that of the page: `...` stands for any lines, `[..]` for any text in a line.
pub fn matches(expected: &str, output: &str) -> bool {
    fn lines_match(expected: &[&str], output: &[&str]) -> bool {
        match (expected.split_first(), output.split_first()) {
            (Some((&"...", rest)), _) => {
                (0..=output.len()).any(|skipped| lines_match(rest, &output[skipped..]))
            }
            (Some((wanted, rest)), Some((found, others))) => {
                line_matches(wanted, found) && lines_match(rest, others)
            }
            (None, None) => true,
            _ => false,
        }
    }
    lines_match(
        &expected.lines().collect::<Vec<_>>(),
        &output.lines().collect::<Vec<_>>(),
    )
}

/// The options in a command line.
pub fn options(command: &str) -> Vec<&str> {
    let words = command
        .split_whitespace()
        .filter(|word| word.starts_with("--"));
    words
        .map(|word| word.split('=').next().unwrap_or(word))
        .collect()
}

/// The ids of requirements in a text, such as `DET-015`.
pub fn requirements(text: &str) -> Vec<&str> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    let is_id = |word: &&str| {
        word.is_ascii()
            && word.len() == 7
            && word[..3].bytes().all(|b| b.is_ascii_uppercase())
            && &word[3..4] == "-"
            && word[4..].bytes().all(|b| b.is_ascii_digit())
    };
    // A hash function has a name of the same form.
    words
        .filter(is_id)
        .filter(|word| *word != "SHA-256")
        .collect()
}
