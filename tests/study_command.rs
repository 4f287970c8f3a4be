//! `palpate study`, end to end: shards that are killed and go on give the bytes of an undisturbed run; every refusal.

use std::fs;
use std::process::Stdio;
use std::sync::OnceLock;
use std::time::Duration;

use crate::program::{Place, text};
use palpate_asserts::{assert_cases, assert_has, changed};
use palpate_paper::study::StudyResults;

const STUDY: &str = include_str!("study_command/study.toml");
const SAMPLES: usize = 39;

/// A folder with the study.
fn place(name: &str) -> Place {
    let place = Place::new(&format!("study-{name}"));
    place.write("study.toml", STUDY);
    place.write("depths.csv", "value\n0.1\n-0.2\n0.2\n");
    place
}

/// The samples and the results of a run that nothing disturbs, on one thread.
fn expected() -> &'static [String; 2] {
    static EXPECTED: OnceLock<[String; 2]> = OnceLock::new();
    EXPECTED.get_or_init(|| {
        let place = place("expected");
        let run = place
            .palpate("study run study.toml --out out")
            .env("RAYON_NUM_THREADS", "1")
            .output();
        let run = run.unwrap();
        let said = text(&run.stdout);
        let holds = said.starts_with("39 samples in out/samples-1-of-1.jsonl, of which ");
        assert!(holds, "{said}");
        place.succeed("study merge out --out study.json");
        [
            place.read("out/samples-1-of-1.jsonl"),
            place.read("study.json"),
        ]
    })
}

/// A place with the samples of [`expected`].
fn finished(name: &str) -> Place {
    let place = place(name);
    fs::create_dir(place.at("out")).unwrap();
    place.write("out/samples-1-of-1.jsonl", &expected()[0]);
    place
}

// Verifies: STU-001, STU-010, STU-032, STU-050, STU-051.
#[test]
fn a_study_tells_bands_indices_and_failures() {
    let place = finished("results");
    let results: StudyResults = serde_json::from_str(&expected()[1]).unwrap();
    assert_eq!(
        (results.schema.as_str(), results.samples),
        ("palpate-study", SAMPLES)
    );
    // Beyond 0.4995, at 1.19 standard deviations, lie 12 % of the draws.
    assert!((1..=12).contains(&results.failed), "{}", results.failed);
    assert_eq!(results.failures.len(), results.failed);
    let reason = &results.failures[0].reason;
    let holds = reason.contains("layer[1].poisson_ratio = 0.") && reason.contains("but must be");
    assert!(holds, "{reason}");
    assert_eq!(results.groups, [["Poisson's ratio"], ["depth"]]);
    // The depths of the file, in order.
    let plan = serde_json::to_value(&results.plan).unwrap();
    assert_eq!(
        plan["inputs"][1]["distribution"]["empirical"]["values"],
        serde_json::json!([-0.2, 0.1, 0.2])
    );
    let said = place.succeed("study merge out --out study.json");
    let words = "39 samples, |6.6: γ |detectable depth, m|6.6: γ ≥ 3.290: in |p of the convention";
    assert_has(&said, words);
    let json = place.succeed("study merge out --out study.json --format json");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let same: serde_json::Value = serde_json::from_str(&expected()[1]).unwrap();
    assert_eq!(json, same);
    // A run that it does not fit is refused before anything is solved.
    let refused = place.refused("run --study study.json --out run");
    assert_has(&refused, "study.json: the study of the inputs has another");
    assert!(!place.at("run").exists());
}

// Verifies: STU-021, STU-024, STU-026.
#[test]
fn killed_shards_go_on_and_give_the_same_bytes() {
    let place = place("shards");
    for shards in [3, 17] {
        let mut folders = Vec::new();
        for shard in (1..=shards).rev() {
            // Two folders, as on two machines.
            let folder = format!("of-{shards}-{}", shard % 2);
            let line = format!("study run study.toml --out {folder} --shard {shard}/{shards}");
            for wait in [150, 300] {
                let mut child = place.palpate(&line).stdout(Stdio::null()).spawn().unwrap();
                std::thread::sleep(Duration::from_millis(wait));
                child.kill().unwrap();
                child.wait().unwrap();
            }
            let file = format!("{folder}/samples-{shard}-of-{shards}.jsonl");
            let before = place.read(&file);
            let whole = &before[..before.rfind('\n').map_or(0, |end| end + 1)];
            // What a kill in the middle of a write leaves.
            place.write(&file, format!("{whole}{{\"sample\":"));
            place.succeed(&line);
            let holds = place.read(&file).starts_with(whole);
            assert!(holds, "nothing is computed again");
            folders.push(folder);
        }
        // Each folder is named several times.
        folders.reverse();
        place.succeed(&format!(
            "study merge {} --out study.json",
            folders.join(" ")
        ));
        assert_eq!(place.read("study.json"), expected()[1], "{shards} shards");
    }
}

// Verifies: STU-024, STU-026, STU-027.
#[test]
fn a_finished_study_computes_nothing_and_takes_each_sample_once() {
    let place = finished("finished");
    let output = place.run("study run study.toml --out out");
    let holds = text(&output.stderr).contains("39 of 39 samples already computed");
    assert!(holds, "{output:?}");
    assert_eq!(place.read("out/samples-1-of-1.jsonl"), expected()[0]);
    // What failed before counts as if it had failed now.
    let failed = expected()[0].matches("\"failed\":").count();
    let told = format!("39 samples in out/samples-1-of-1.jsonl, of which {failed} failed\n");
    assert_eq!((text(&output.stdout), failed > 0), (&*told, true));
    assert_takes_its_own_samples_once(&place);
    assert_merges_in_any_order(&place);
}

/// Asserts that a run goes on with samples of its own shard alone, each of them once.
fn assert_takes_its_own_samples_once(place: &Place) {
    let file = "out/samples-1-of-1.jsonl";
    let all = &expected()[0];
    let lines: Vec<&str> = all.lines().collect();
    let number = |line: &str| {
        line.split([':', ','])
            .nth(1)
            .unwrap()
            .parse::<usize>()
            .unwrap()
    };
    let refused = |file: &str, text: String, line: &str, number: usize| {
        place.write(file, &text);
        let error = place.refused(line);
        let at = text.lines().count();
        assert_eq!(
            error,
            format!("{file}:{at}: sample {number} appears twice or belongs to another shard")
        );
        assert_eq!(place.read(file), text);
    };
    // The first sample again, with another one left to compute.
    let cut: String = lines[..SAMPLES]
        .iter()
        .map(|line| format!("{line}\n"))
        .collect();
    let twice = format!("{cut}{}\n", lines[1]);
    refused(
        file,
        twice,
        "study run study.toml --out out",
        number(lines[1]),
    );
    // A shard of 39 has one sample; that of the next one is not its own.
    let run = "study run study.toml --out out --shard 3/39";
    let file = "out/samples-3-of-39.jsonl";
    place.succeed(run);
    let own = place.read(file);
    assert_eq!(own.lines().skip(1).map(number).collect::<Vec<_>>(), [2]);
    let of_another = lines[1..].iter().find(|line| number(line) == 3).unwrap();
    refused(file, format!("{own}{of_another}\n"), run, 3);
}

/// Asserts that the order of samples and folders changes nothing.
fn assert_merges_in_any_order(place: &Place) {
    let [all, results] = expected();
    assert_merges_alike(place, all, results);
    // With two more that failed, in shards of their own, which are told in the order of the samples.
    let failing = all.lines().map(|line| match line {
        line if line.starts_with("{\"sample\":37,") => "{\"sample\":37,\"failed\":\"a\"}\n".into(),
        line if line.starts_with("{\"sample\":38,") => "{\"sample\":38,\"failed\":\"b\"}\n".into(),
        line => format!("{line}\n"),
    });
    let failing: String = failing.collect();
    assert_ne!(failing, *all);
    let _ = fs::create_dir(place.at("whole"));
    place.write("whole/samples-1-of-1.jsonl", &failing);
    place.succeed("study merge whole --out whole.json");
    let results = place.read("whole.json");
    assert_has(&results, "\"sample\":37|\"sample\":38");
    assert_merges_alike(place, &failing, &results);
}

/// Asserts that these samples have these results in whatever order and folders they come.
fn assert_merges_alike(place: &Place, all: &str, results: &str) {
    let (header, samples) = all.split_once('\n').unwrap();
    let shard = |number: usize| {
        let header = header.replace(
            "{\"number\":1,\"of\":1}",
            &format!("{{\"number\":{number},\"of\":3}}"),
        );
        assert_ne!(header, all.split_once('\n').unwrap().0);
        let mut lines: Vec<&str> = samples.lines().collect();
        lines.retain(|line| {
            line.split([':', ','])
                .nth(1)
                .unwrap()
                .parse::<usize>()
                .unwrap()
                % 3
                == number - 1
        });
        (header, lines)
    };
    for (folders, is_reversed) in [("c b a", true), ("a c b", false)] {
        for (number, folder) in (1..=3).zip(["a", "b", "c"]) {
            let (header, mut lines) = shard(number);
            lines.sort();
            if is_reversed {
                lines.reverse();
            }
            let _ = fs::create_dir(place.at(folder));
            let text = format!("{header}\n{}\n", lines.join("\n"));
            place.write(&format!("{folder}/samples-{number}-of-3.jsonl"), text);
        }
        place.succeed(&format!("study merge {folders} --out study.json"));
        assert_eq!(place.read("study.json"), results, "{folders}");
    }
}

// Verifies: STU-026, STU-027, STU-050.
#[test]
fn samples_that_are_missing_twice_there_or_foreign_are_named() {
    let place = finished("wrong");
    let all = &expected()[0];
    let lines: Vec<&str> = all.lines().collect();
    let number = |line: &str| line.split([':', ',']).nth(1).unwrap().to_string();
    let [first, last] = [lines[1], lines[SAMPLES]].map(number);
    let refused = |text: &str, expected: &str| {
        place.write("out/samples-1-of-1.jsonl", text);
        let error = place.refused("study merge out --out study.json");
        assert!(error.contains(expected), "{error}");
    };
    let without = |line: usize| {
        let kept = lines.iter().enumerate().filter(|(at, _)| *at != line);
        kept.map(|(_, line)| format!("{line}\n"))
            .collect::<String>()
    };
    let missing = "1 of 39 samples are missing, the first is";
    refused(&without(1), &format!("{missing} {first}; run"));
    // The last line was cut off.
    refused(all.trim_end(), &format!("{missing} {last}"));
    let huge = all.replace("\"rows\":8", "\"rows\":1048576");
    refused(
        &huge,
        "4194272 of 4194311 samples are missing, the first is",
    );
    let file = "out/samples-1-of-1.jsonl";
    let twice = format!("{file}:41: sample {first} is also in {file}; delete one of them");
    refused(&format!("{all}{}\n", lines[1]), &twice);
    refused(&format!("{all}{{}}\n"), &format!("{file}:41: "));
    for foreign in ["39,\"failed\":\"x\"", "1,\"values\":[1.0]"] {
        let text = format!("{all}{{\"sample\":{foreign}}}\n");
        refused(&text, "this line is not a sample of this study");
    }
    refused(
        "nonsense\n",
        &format!("{file}: the first line is not that of a file of study samples"),
    );
    place.write("out/samples-1-of-1.jsonl", all);
    let other = all.replace("\"rows\":8", "\"rows\":9");
    place.write("out/samples-2-of-2.jsonl", &other);
    place.refuses("study merge", str::to_string);
    fs::remove_file(place.at("out/samples-2-of-2.jsonl")).unwrap();
    assert_samples_of_another_program_are_refused(&place);
    // Samples of another study are not gone on with.
    place.write("out/samples-1-of-1.jsonl", &other);
    let error = place.refused("study run study.toml --out out");
    assert_has(&error, "belongs to a different request or version");
}

/// Asserts that samples of another program are refused though all their files agree, and those of another arithmetic keep it.
fn assert_samples_of_another_program_are_refused(place: &Place) {
    let file = "out/samples-1-of-1.jsonl";
    let [all, results] = expected();
    let version = env!("CARGO_PKG_VERSION");
    for (key, own, foreign) in [
        ("schema_version", "1", "2"),
        ("program_version", &*format!("\"{version}\""), "\"0.0.1\""),
    ] {
        let keyed = |value: &str| format!("\"{key}\":{value},");
        place.write(file, all.replacen(&keyed(own), &keyed(foreign), 1));
        let error = place.refused("study merge out --out foreign.json");
        let right = format!("{own}, which is what this program merges");
        let expected = format!("{file}:1: {key} = {foreign}, but must be {right}");
        assert_eq!(error, expected);
    }
    let header: serde_json::Value = serde_json::from_str(all.lines().next().unwrap()).unwrap();
    let own = format!("\"arithmetic\":{}", header["arithmetic"]);
    let foreign = "\"arithmetic\":\"that of another machine\"";
    place.write(file, all.replacen(&own, foreign, 1));
    place.succeed("study merge out --out foreign.json");
    assert_eq!(
        place.read("foreign.json"),
        results.replacen(&own, foreign, 1)
    );
    assert_ne!(place.read("foreign.json"), *results);
    // Samples without one.
    place.write(file, all.replacen(&format!("{own},"), "", 1));
    let error = place.refused("study merge out --out foreign.json");
    assert_has(&error, "the first line names no arithmetic; compute");
}

// Verifies: STU-001, STU-011, STU-010, STU-024.
#[test]
fn a_file_that_is_no_study_is_refused_with_line_and_key() {
    let place = place("refused");
    place.write("empty.csv", "value\n1\n");
    assert_cases("refused/study.txt", "changes", |change| {
        place.write("other.toml", changed(STUDY, change));
        place.refused("study run other.toml --out out")
    });
    for shard in ["0/3", "4/3", "1", "a/b"] {
        let error = place.refused(&format!("study run study.toml --out out --shard {shard}"));
        assert!(error.contains("must be k/n with 1 ≤ k ≤ n"), "{error}");
    }
    assert!(!place.at("out").exists());
}
