//! Help where people look for it, and what a terminal and a spreadsheet are given: `spec/command-line.md`.

use std::ffi::OsString;
use std::fs;

use palpate_program::arguments::{CommandLine, read};
use serde_json::Value;

use crate::program::{Place, text};
use palpate_asserts::assert_has;

/// The commands, and the actions of those that have some.
fn commands(here: &Place) -> Vec<String> {
    let listed = |help: String| -> Vec<String> {
        let list = help.split("Commands:\n").nth(1).unwrap_or_default();
        let lines = list.lines().take_while(|line| !line.is_empty());
        let names = lines.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
        let names = names.filter(|name| !name.is_empty() && *name != "help");
        names.map(String::from).collect()
    };
    let mut all = Vec::new();
    for name in listed(here.succeed("--help")) {
        let actions = listed(here.succeed(&format!("{name} --help")));
        all.extend(actions.iter().map(|action| format!("{name} {action}")));
        all.push(name);
    }
    assert!(all.len() > 18, "{all:?}");
    all
}

// Verifies: CLI-220.
#[test]
fn help_of_a_command_is_its_help() {
    let here = Place::new("help-of");
    assert_eq!(here.succeed("help"), here.succeed("--help"));
    for name in commands(&here) {
        let asked = here.succeed(&format!("help {name}"));
        assert_eq!(asked, here.succeed(&format!("{name} --help")));
    }
}

/// The words of a line as a shell makes them, up to where its input or output is redirected.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (at, part) in line.split('\'').enumerate() {
        if at % 2 == 1 {
            words.push(part.to_string());
        } else {
            words.extend(part.split_whitespace().map(String::from));
        }
    }
    let ends = |word: &String| ["|", "<", ">"].contains(&&**word);
    let end = words.iter().position(ends).unwrap_or(words.len());
    words.truncate(end);
    words
}

// Verifies: CLI-221.
#[test]
fn help_ends_with_examples_that_are_accepted() {
    let here = Place::new("examples");
    for name in commands(&here) {
        // An action has its examples above it.
        let of = name.split(' ').next().unwrap();
        let help = here.succeed(&format!("help {of}"));
        let (_, examples) = help.split_once("Example").expect(&name);
        let mut found = 0;
        for line in examples.lines().filter(|line| line.contains("palpate ")) {
            let line = line
                .rsplit_once("| palpate")
                .map_or(line.trim().into(), |(_, rest)| format!("palpate{rest}"));
            let words = words(&line);
            found += usize::from(line.starts_with(&format!("palpate {name}")));
            let arguments = words.iter().map(OsString::from);
            let accepted = read::<CommandLine>(arguments);
            assert!(matches!(accepted, Ok(Ok(_))), "{line}: {accepted:?}");
        }
        let is_above = help.contains("\nCommands:\n") && !name.contains(' ');
        assert!(found > 0 || is_above, "{name} has no example: {examples}");
    }
}

// Verifies: CLI-223.
#[test]
fn each_command_has_a_completion_and_a_page() {
    let here = Place::new("manual");
    let names = commands(&here);
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let text = here.succeed(&format!("completions {shell}"));
        for name in names.iter().flat_map(|name| name.split(' ')) {
            assert!(text.contains(name), "{shell}: {name}");
        }
        assert_has(&text, "depth-mm");
    }
    let printed = here.succeed("man pages/of");
    for name in &names {
        let file = format!("palpate-{}.1", name.replace(' ', "-"));
        let page = here.read(&format!("pages/of/{file}"));
        assert_has(&page, ".SH SYNOPSIS");
        assert!(printed.contains(&file), "{printed}");
    }
    assert_eq!(here.succeed("man"), here.read("pages/of/palpate.1"));
}

// Verifies: CLI-222.
#[test]
fn a_slip_is_told_what_was_meant() {
    let here = Place::new("slips");
    for (line, meant) in [
        ("detct", "similar subcommand exists: 'detect'"),
        (
            "solve --depth-mm 4",
            "similar argument exists: '--depths-mm'",
        ),
    ] {
        let said = here.refused(line);
        assert!(said.contains(meant), "{line}: {said}");
    }
    here.write("run.toml", "refrence = \"none\"\n");
    let said = here.refused("run --config run.toml");
    let meant = "run.toml:1: refrence is unknown (did you mean reference?); give one of";
    assert!(said.starts_with(meant), "{said}");
    here.write("ask", "{\"id\":1,\"op\":\"thet\"}\n");
    let mut oracle = here.palpate("oracle");
    let asked = fs::File::open(here.at("ask")).unwrap();
    let answered = oracle.stdin(asked).output().unwrap();
    let meant = "unknown op \\\"thet\\\" (did you mean theta?); the ops are";
    assert_has(text(&answered.stdout), meant);
    here.write("run.toml", "qqqq = \"none\"\n");
    let said = here.refused("run --config run.toml");
    assert!(
        said.starts_with("run.toml:1: qqqq is unknown; give one of"),
        "{said}"
    );
}

// Verifies: CLI-224.
#[test]
fn quiet_leaves_out_notes_and_keeps_warnings() {
    let here = Place::new("quiet");
    let header = "depth_mm,lateral_mm,normal_force_n,by\n";
    here.write(
        "gel.csv",
        format!("{header}1,0,0.2,me\n1,1,0.2,me\n2,0,0.5,me\n2,1,0.5,me\n"),
    );
    let told = |line: &str| text(&here.run(line).stderr).to_string();
    assert_has(
        &told("import-map gel.csv --out a.json"),
        "note: gel.csv: column",
    );
    for line in [
        "-q import-map gel.csv --out a.json",
        "import-map gel.csv --quiet --out a.json",
    ] {
        assert_eq!(told(line), "");
    }
    let deep = "solve --phantom 2.6 --laterals-mm 0 --mesh-mm 2 --depths-mm 4.25";
    assert_eq!(told(&format!("{deep} -q")), told(deep));
    assert_has(&told(deep), "palpate: warning: phantom 2.6");
}

/// What a terminal is given by a command line, and the environment's variable.
#[cfg(target_os = "linux")]
fn on_a_terminal(here: &Place, line: &str, variable: [&str; 2]) -> String {
    let line = format!("{} {line}", crate::program::PROGRAM);
    let mut script = std::process::Command::new("script");
    let output = script
        .args(["-qec", &line, "/dev/null"])
        .current_dir(here.at(""))
        .env_remove("NO_COLOR")
        .env("TERM", "xterm")
        .env(variable[0], variable[1])
        .output();
    text(&output.expect("script of Debian's bsdutils").stdout).into()
}

// Verifies: CLI-006, CLI-224, CLI-225.
#[cfg(target_os = "linux")]
#[test]
fn a_terminal_is_given_colour_and_progress_unless_they_are_not_wanted() {
    let here = Place::new("terminal");
    let map = "--laterals-mm=-8:8:1 --mesh-mm 3 --depths-mm 1,4.25 --format json";
    for name in ["none", "2.6"] {
        let line = format!("solve --phantom {name} {map}");
        here.write(&format!("{name}.json"), here.succeed(&line));
    }
    let sweep = "position_mm,lateral_force_n,normal_force_n\n";
    let map: Value = serde_json::from_str(&here.read("2.6.json")).unwrap();
    let force = |key: &str, at: usize| map[key][1][at].as_f64().unwrap();
    let row = |at: usize| {
        let [lateral, normal] = ["lateral_force_n", "normal_force_n"].map(|key| force(key, at));
        // Some noise, for no record is without.
        let noise = 0.01 * (at * at % 7) as f64;
        format!(
            "{},{},{}\n",
            at as f64 - 8.0,
            lateral - noise,
            normal + noise
        )
    };
    here.write(
        "sweep.csv",
        sweep.to_string() + &(0..17).map(row).collect::<String>(),
    );
    let detect = "detect --model exact sweep.csv --reference none.json --inclusion 2.6.json --depth-mm 4.25 --noise-sd-n 0.05";
    let solve = "solve --phantom 2.6 --laterals-mm 0 --mesh-mm 3 --depths-mm 3,4.25";
    let shown = |line: &str, variable| on_a_terminal(&here, line, variable);
    let any = ["LC_ALL", "C.UTF-8"];
    let found = shown(detect, any);
    assert!(
        found.starts_with("\x1b[1m\x1b[31mInclusion detected\x1b[0m, and"),
        "{found:?}"
    );
    let found = shown(solve, any);
    assert_has(
        &found,
        "palpate: \x1b[1m\x1b[33mwarning\x1b[0m: phantom 2.6",
    );
    // The bar clears its line.
    assert!(found.contains("\x1b[2K"), "{found:?}");
    assert!(!shown(&format!("{solve} -q"), any).contains("\x1b[2K"));
    for line in [detect, solve] {
        let plain = shown(&format!("-q {line}"), ["NO_COLOR", "1"]);
        assert!(!plain.contains('\x1b'), "{plain:?}");
        // A pipe is given the same.
        let piped = here.run(&format!("-q {line}"));
        let both = text(&piped.stdout).to_string() + text(&piped.stderr);
        assert_eq!(sorted(&plain), sorted(&both));
    }
    let mut forced = here.palpate(detect);
    let forced = forced.env("CLICOLOR_FORCE", "1").output().unwrap();
    assert_has(text(&forced.stdout), "\x1b[31mInclusion detected\x1b[0m");
    assert!(here.succeed(detect).starts_with("Inclusion detected, and"));
}

/// The lines of a text, without their ends.
#[cfg(target_os = "linux")]
fn sorted(text: &str) -> Vec<&str> {
    let mut lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    lines.sort();
    lines
}

/// How many values an answer holds.
fn values(answer: &Value) -> usize {
    match answer {
        Value::Object(parts) => parts.values().map(values).sum(),
        Value::Array(parts) => parts.iter().map(values).sum(),
        _ => 1,
    }
}

// Verifies: CLI-226.
#[test]
fn a_table_in_csv_has_each_value_of_the_answer() {
    let here = Place::new("csv");
    here.write("times.csv", format!("duration_us\n{}", "7\n".repeat(3000)));
    let solve =
        "solve --phantom none --depths-mm 0:4:1 --laterals-mm=-9:9:1 --mesh-mm 3 --format json";
    here.write("map.json", here.succeed(solve));
    for line in [
        "psychophysics",
        "timing --from times.csv",
        "play --map map.json",
    ] {
        let json: Value =
            serde_json::from_str(&here.succeed(&format!("{line} --format json"))).unwrap();
        let csv = here.succeed(&format!("{line} --format csv"));
        let mut lines = csv.lines();
        assert_eq!(lines.next(), Some("key,value"));
        let mut seen = 0;
        for field in lines {
            let (key, value) = field.split_once(',').unwrap();
            let pointer = key.replace(['.', '['], "/").replace(']', "");
            let expected = json.pointer(&format!("/{pointer}")).expect(field);
            let expected = match expected {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            // In quotes where a spreadsheet would take it for more than one field.
            let bare = value
                .strip_prefix('"')
                .and_then(|rest| rest.strip_suffix('"'));
            assert!(bare.is_some() || !value.contains([',', '"']), "{field}");
            let value = bare.unwrap_or(value).replace("\"\"", "\"");
            assert_eq!(value, expected, "{field}");
            seen += 1;
        }
        assert_eq!(seen, values(&json), "{line}");
        assert!(seen > 5, "{csv}");
    }
}
