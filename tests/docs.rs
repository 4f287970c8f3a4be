//! The documentation's commands, run as a reader would run them (`spec/verification-plan.md`).
//!
//! A runner of our own, since trycmd splits a command into words and starts it without a shell, so that it has no pipe,
//! no redirection and no `$?`, which the pages need; it would also bring twelve crates.

mod page;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use page::{Page, matches};

/// The root of the package, from which pages are named.
use crate::ROOT;
use crate::program::PROGRAM;

/// How many commands of `docs/` the test does not run, each with its reason on the page.
const NOT_RUN: usize = 38;

/// Parts of the commands in `README.md` that are not run, and why.
const README_NOT_RUN: [(&str, &str); 5] = [
    (
        "vectors/conform/tests/toys/right.py",
        "needs Python: vectors/conform/tests/conform_command/diagnosis.rs runs it",
    ),
    (
        "palpate run ",
        "docs/tutorial.md and docs/how-to/demo.md run it",
    ),
    (
        "palpate study ",
        "takes ten minutes; docs/how-to/study.md runs a smaller one",
    ),
    (
        "palpate-verify",
        "takes minutes without optimisation; proofs/verify/tests/verify_command.rs and proofs/verify/tests/statistics.rs run the battery",
    ),
    (
        "--device hid",
        "needs a device; tests/hid-stack/run has one",
    ),
];

/// All Markdown files of `docs/`, by name.
fn pages() -> Vec<Page> {
    let folders = ["docs", "docs/how-to"].into_iter().map(at);
    let entries = folders.flat_map(|folder| fs::read_dir(folder).unwrap());
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths
        .filter(|path| path.extension() == Some("md".as_ref()))
        .collect();
    paths.sort();
    paths.iter().map(|path| Page::read(path)).collect()
}

/// Those, and `README.md`.
fn pages_and_readme() -> Vec<Page> {
    [pages(), vec![Page::read(&at("README.md"))]]
        .into_iter()
        .flatten()
        .collect()
}

/// A file or folder of the checkout.
fn at(name: &str) -> PathBuf {
    Path::new(ROOT).join(name)
}

fn text(name: &str) -> String {
    fs::read_to_string(at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// An empty folder for a page's commands.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("docs")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A folder with the program under test as `palpate`.
fn bin() -> &'static Path {
    static BIN: OnceLock<PathBuf> = OnceLock::new();
    BIN.get_or_init(|| {
        let bin = Path::new(env!("CARGO_TARGET_TMPDIR")).join("docs-bin");
        fs::create_dir_all(&bin).unwrap();
        // Each test has a process of its own, and another may have made it; it is never removed.
        let _ = symlink(PROGRAM, bin.join("palpate"));
        assert_eq!(
            fs::read_link(bin.join("palpate")).unwrap(),
            Path::new(PROGRAM)
        );
        bin
    })
}

/// Output, both streams as they come, and exit code of a command after one that left the code `before`; the program
/// under test comes first on the path, then its companions.
fn shell(folder: &Path, command: &str, before: i32) -> (String, i32) {
    let companions = Path::new(PROGRAM).parent().unwrap();
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{}:{path}", bin().display(), companions.display());
    let script = format!("exec 2>&1\n(exit {before})\n{command}");
    let mut sh = Command::new("sh");
    sh.args(["-c", &script])
        .env("PATH", path)
        .current_dir(folder);
    let output = sh.output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    (said, output.status.code().unwrap_or(-1))
}

fn palpate(arguments: &str) -> String {
    let (help, code) = shell(Path::new(ROOT), &format!("palpate {arguments}"), 0);
    assert_eq!(code, 0, "palpate {arguments}: {help}");
    help
}

/// Runs a page; what differs from it, one text each.
fn differences(page: &Page) -> Vec<String> {
    let folder = folder(&page.name.replace('/', "-"));
    let (mut differences, mut code) = (Vec::new(), 0);
    for (index, step) in page.steps.iter().enumerate() {
        if let Some(file) = &step.file {
            let path = folder.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, &step.text).unwrap();
            continue;
        }
        let (output, found) = shell(&folder, &step.text, code);
        code = found;
        let next = page.steps.get(index + 1);
        let asked = next.is_some_and(|next| next.text == "echo $?");
        if !matches(&step.output, &output) || (code != 0 && !asked) {
            differences.push(format!(
                "{}:{}: $ {}\n--- the page\n{}--- the program, exit code {code}\n{output}",
                page.name, step.line, step.text, step.output
            ));
        }
    }
    differences
}

#[test]
fn commands_do_what_the_pages_show() {
    let pages = pages();
    let found: Vec<_> = std::thread::scope(|scope| {
        let running = pages.iter().map(|page| scope.spawn(|| differences(page)));
        let running: Vec<_> = running.collect();
        let threads = running.into_iter();
        threads.flat_map(|thread| thread.join().unwrap()).collect()
    });
    assert!(found.is_empty(), "{}", found.join("\n"));
    let commands = pages.iter().flat_map(|page| &page.steps);
    let commands = commands.filter(|step| step.file.is_none()).count();
    println!("{commands} commands of {} pages run", pages.len());
    let mut not_run = 0;
    for page in &pages {
        for (command, reason) in &page.not_run {
            println!("not run: {}: {command}: {reason}", page.name);
            not_run += 1;
        }
    }
    assert_eq!(not_run, NOT_RUN, "commands that are not run");
}

#[test]
fn files_on_the_pages_are_those_of_the_sources() {
    let mut same = 0;
    for page in pages() {
        let files = page
            .steps
            .iter()
            .filter_map(|step| Some((step, step.file.as_ref()?)));
        let is_ours = |file: &str| file.starts_with("docs/") || file.starts_with(".github/");
        for (step, file) in files.filter(|(_, file)| is_ours(file)) {
            assert_eq!(step.text, text(file), "{}: {file}", page.name);
            same += 1;
        }
    }
    assert!(same >= 4, "{same} files: are the pages read?");
}

#[test]
fn the_site_has_every_page_of_docs_and_spec() {
    let summary = Page::read(&at("docs/site/SUMMARY.md"));
    let listed: Vec<String> = summary.links().into_iter().map(|(file, _)| file).collect();
    let unique: BTreeSet<&String> = listed.iter().collect();
    assert_eq!(listed.len(), unique.len(), "a page is listed twice");
    for file in &listed {
        assert!(at(file).is_file(), "no {file}");
    }
    for folder in ["docs", "docs/how-to", "spec"] {
        for entry in fs::read_dir(at(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let page = format!("{folder}/{name}");
            let is_missing = name.ends_with(".md") && !listed.contains(&page);
            assert!(!is_missing, "docs/site/SUMMARY.md does not list {page}");
        }
    }
}

#[test]
fn commands_and_options_exist() {
    let help = palpate("--help");
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let list = list.lines().take_while(|line| !line.is_empty());
    let names: BTreeSet<&str> = list
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(names.len() >= 10, "{help}");
    let index = text("docs/README.md");
    for name in &names {
        let page = format!("how-to/{name}.md");
        assert!(at(&format!("docs/{page}")).exists(), "no {page}");
        assert!(
            index.contains(&format!("({page})")),
            "docs/README.md does not link to {name}"
        );
    }
    let (mut seen, mut helps) = (0, BTreeMap::new());
    let mut help_of = |name: &str| -> String {
        let help = || palpate(&format!("{name} --help"));
        helps.entry(name.to_owned()).or_insert_with(help).clone()
    };
    for page in pages_and_readme() {
        for command in page.mentions() {
            let name = command.split_whitespace().nth(1).unwrap_or_default();
            if name.starts_with('-') || name == "help" {
                continue;
            }
            assert!(names.contains(name), "{}: {command}", page.name);
            let mut help = help_of(name);
            // Of several actions each has its own options.
            if help.contains("\nCommands:\n") {
                let action = command.split_whitespace().nth(2).unwrap_or_default();
                help = help_of(&format!("{name} {action}"));
            }
            let words = help.split(|c: char| !(c.is_alphanumeric() || c == '-'));
            for option in page::options(&command) {
                seen += 1;
                let is_known = words.clone().any(|word| word == option);
                assert!(is_known, "{}: palpate {name} has no {option}", page.name);
            }
        }
    }
    assert!(seen > 100, "{seen} options seen: are the pages read?");
}

#[test]
fn links_and_requirements_lead_somewhere() {
    let spec = fs::read_dir(at("spec")).unwrap();
    let spec: String = spec
        .map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap())
        .collect();
    let (mut links, mut ids) = (0, 0);
    for page in pages_and_readme() {
        let folder = at(&page.name);
        for (file, heading) in page.links() {
            links += 1;
            let target = match file.as_str() {
                "" => folder.clone(),
                file => folder.parent().unwrap().join(file),
            };
            assert!(target.exists(), "{}: no {file}", page.name);
            let found = heading.is_empty()
                || page::headings(&fs::read_to_string(&target).unwrap()).contains(&heading);
            assert!(found, "{}: no heading {heading} in {file}", page.name);
        }
        for id in page::requirements(&page.text) {
            ids += 1;
            let is_defined = spec.contains(&format!("**{id}**"));
            assert!(is_defined, "{}: no {id} in spec/", page.name);
        }
    }
    let is_read = links > 20 && ids > 50;
    assert!(
        is_read,
        "{links} links, {ids} requirements: are the pages read?"
    );
    let theory = text("docs/theory.md");
    let sections = theory.split("\n## ").skip(1);
    for section in sections.filter(|section| section.contains("$$")) {
        let title = section.lines().next().unwrap_or_default();
        let names_one = !page::requirements(section).is_empty();
        assert!(names_one, "docs/theory.md, {title}: which requirement?");
    }
}

#[test]
fn the_commands_of_the_readme_succeed() {
    let folder = folder("README");
    fs::create_dir(folder.join("docs")).unwrap();
    let phantom = "docs/phantom.toml";
    fs::copy(at(phantom), folder.join(phantom)).unwrap();
    // Coarse maps where 'palpate run' leaves fine ones.
    let coarse = "laterals_mm = \"-10:10:1\"\n[mesh]\nsize_mm = 1.5\n";
    fs::write(folder.join("coarse.toml"), coarse).unwrap();
    let (output, code) = shell(&folder, "palpate run --config coarse.toml", 0);
    assert_eq!(code, 0, "{output}");
    let commands = Page::read(&at("README.md")).plain_commands();
    let mut run = 0;
    for command in &commands {
        let whole = format!("{command} ");
        match README_NOT_RUN.iter().find(|(part, _)| whole.contains(part)) {
            Some((_, reason)) => println!("not run: {command}: {reason}"),
            None => {
                let (output, code) = shell(&folder, command, 0);
                assert_eq!(code, 0, "{command}: {output}");
                run += 1;
            }
        }
    }
    assert!(run >= 8, "{run} commands run: is README.md read?");
}

/// The lines of a folder's Rust that are neither blank nor comment, without tests.
fn lines_of_code(folder: &Path) -> usize {
    let paths = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let code = paths.filter(|path| path.file_stem().is_none_or(|name| name != "tests"));
    let lines = code.map(|path| match path.extension() {
        _ if path.is_dir() => lines_of_code(&path),
        Some(extension) if extension == "rs" => {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.split("\nmod tests {").next().unwrap_or_default();
            let lines = code.lines().map(str::trim);
            lines
                .filter(|line| !line.is_empty() && !line.starts_with("//"))
                .count()
        }
        _ => 0,
    });
    lines.sum()
}

#[test]
fn the_page_of_each_crate_states_its_length() {
    for name in ["core", "palpate", "paper", "program"] {
        let page = text(&format!("src/{name}/lib.rs"));
        let (before, _) = page.split_once(" lines of code").expect(name);
        let stated = before.rsplit(' ').next().unwrap().replace(',', "");
        let stated: f64 = stated.parse().expect(name);
        let counted = lines_of_code(&at(&format!("src/{name}"))) as f64;
        let is_true = (stated / counted - 1.0).abs() < 0.03;
        assert!(
            is_true,
            "src/{name}: {stated} lines stated, {counted} counted"
        );
    }
}
