//! `palpate detect`, end to end: two solved maps, a simulated sweep, the program, and its answer
//! against the library's and against plain sums.
#![cfg(feature = "cli")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use palpate::detect::assessment::assess;
use palpate::detect::{Decision, theta_of_record};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable};
use palpate::stats::random::Generator;
use serde_json::Value;

/// Standard deviation of the noise in the sweeps, N.
const NOISE: Force<f64> = Force::new(0.05, 0.12);
/// Where the moved inclusion lies, in samples of half a millimetre: 1.5 mm.
const MOVED: usize = 3;

fn palpate(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.args(arguments).output().unwrap()
}

/// The folder with maps and traces, made once.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("detect_command");
        fs::create_dir_all(&folder).unwrap();
        for (phantom, file) in [("none", "none.json"), ("2.6", "inclusion.json")] {
            let solved = palpate(&[
                "solve",
                "--phantom",
                phantom,
                "--depths-mm",
                "2,3",
                "--laterals-mm=-8:8:0.5",
                "--mesh-mm",
                "2",
                "--format",
                "json",
            ]);
            assert!(solved.status.success(), "{solved:?}");
            fs::write(folder.join(file), solved.stdout).unwrap();
        }
        let [none, inclusion] = maps(&folder);
        write_trace(&folder.join("with.csv"), &sweep(inclusion.table()), 1);
        write_trace(&folder.join("without.csv"), &sweep(none.table()), 2);
        write_trace(&folder.join("moved.csv"), &moved(&none, &inclusion), 3);
        folder
    })
}

fn maps(folder: &Path) -> [ForceMap; 2] {
    ["none.json", "inclusion.json"].map(|file| ForceMap::read(&folder.join(file)).unwrap())
}

/// The forces at 3 mm depth: position in mm, lateral, normal.
fn sweep(map: &ForceTable) -> Vec<[f64; 3]> {
    let row = map.row(0.003).unwrap();
    (0..row.lateral.len())
        .map(|i| {
            let position = i as f64 * 0.5 - 8.0;
            [position, row.lateral[i], row.normal[i]]
        })
        .collect()
}

/// The sweep over an inclusion that lies `MOVED` samples further to the right.
fn moved(none: &ForceMap, inclusion: &ForceMap) -> Vec<[f64; 3]> {
    let (without, with) = (sweep(none.table()), sweep(inclusion.table()));
    let force = |i: usize, channel: usize| {
        let signal = i.checked_sub(MOVED);
        without[i][channel] + signal.map_or(0.0, |j| with[j][channel] - without[j][channel])
    };
    (0..without.len())
        .map(|i| [without[i][0], force(i, 1), force(i, 2)])
        .collect()
}

/// Writes a trace with noise of `NOISE`, from a fixed seed.
fn write_trace(path: &Path, forces: &[[f64; 3]], stream: u64) {
    let generator = Generator::new(20_261_121, stream);
    let mut text = String::from("# simulated\nposition_mm,normal_force_mn,lateral_force_n\n");
    for (i, [position, lateral, normal]) in (0..).zip(forces) {
        let lateral = lateral + NOISE.lateral * generator.normal(0, i);
        let normal = normal + NOISE.normal * generator.normal(1, i);
        text += &format!("{position},{:e},{lateral:e}\n", normal * 1e3);
    }
    fs::write(path, text).unwrap();
}

/// The observed forces in a file that `write_trace` wrote.
fn observed(path: &Path) -> Force<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().skip(2).map(|row| row.split(',').collect());
    let rows: Vec<Vec<&str>> = rows.collect();
    let column = |at: usize| rows.iter().map(move |row| row[at].parse::<f64>().unwrap());
    Force::new(
        column(2).collect(),
        column(1).map(|millinewton| millinewton / 1e3).collect(),
    )
}

fn detect(trace: &str, more: &[&str]) -> Output {
    let path = |file: &str| folder().join(file).display().to_string();
    let (trace, none, inclusion) = (path(trace), path("none.json"), path("inclusion.json"));
    let mut arguments = vec!["detect", &trace, "--reference", &none];
    arguments.extend(["--inclusion", &inclusion]);
    arguments.extend(more);
    palpate(&arguments)
}

const USUAL: [&str; 6] = [
    "--depth-mm",
    "3",
    "--noise-sd-lateral-n",
    "0.05",
    "--noise-sd-normal-n",
    "0.12",
];

fn answer(trace: &str, more: &[&str]) -> Value {
    let arguments = [&USUAL[..], &["--format", "json"], more].concat();
    let output = detect(trace, &arguments);
    // These maps end where the signal is not yet gone, of which a scan warns.
    let warnings = String::from_utf8_lossy(&output.stderr);
    let only_of_the_ends = warnings
        .lines()
        .all(|line| line.contains("at an end of the maps"));
    assert!(output.status.success() && only_of_the_ends, "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(answer: &Value, key: &str) -> f64 {
    answer[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} in {answer}"))
}

/// Σ (rΔ − Δ²/2)/s² and ΣΔ²/s² over both channels, Δ shifted by `shift` samples, in plain
/// arithmetic from the rows of the maps.
fn plain(trace: &str, shift: isize) -> (f64, f64) {
    let [none, inclusion] = maps(folder());
    let (without, with) = (sweep(none.table()), sweep(inclusion.table()));
    let observed = observed(&folder().join(trace));
    let (mut theta, mut energy) = (0.0, 0.0);
    for (channel, observed, sd) in [
        (1, &observed.lateral, NOISE.lateral),
        (2, &observed.normal, NOISE.normal),
    ] {
        for (i, observed) in observed.iter().enumerate() {
            let Some(j) = i.checked_add_signed(-shift).filter(|j| *j < with.len()) else {
                continue;
            };
            let signal = with[j][channel] - without[j][channel];
            let residual = observed - without[i][channel];
            theta += (residual * signal - 0.5 * signal * signal) / (sd * sd);
            energy += signal * signal / (sd * sd);
        }
    }
    (theta, energy)
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(error < 1e-11, "found {found}, expected {expected}");
}

// Verifies: CLI-040, CLI-041, CLI-043, CLI-045, CLI-046, TRC-021.
#[test]
fn theta_is_that_of_the_library_and_of_a_plain_sum() {
    let [none, inclusion] = maps(folder());
    for (trace, decision) in [
        ("with.csv", Decision::Inclusion),
        ("without.csv", Decision::NoInclusion),
    ] {
        let found = answer(trace, &["--prior-h1", "0.2"]);
        let (theta, energy) = plain(trace, 0);
        assert_near(number(&found, "theta"), theta);
        assert_near(number(&found, "gamma"), energy.sqrt());
        assert_near(number(&found, "eta"), 4.0_f64.ln());
        assert_near(
            number(&found, "posterior_h1"),
            1.0 / (1.0 + 4.0 * (-theta).exp()),
        );
        let observed = observed(&folder().join(trace));
        let [f0, f1] = [&none, &inclusion].map(|map| map.row(0.003).unwrap());
        let observed = observed.as_deref();
        let statistic = theta_of_record(observed, f0, f1, NOISE).unwrap();
        let library = assess(statistic, 0.2, 4.0_f64.ln()).unwrap();
        assert_near(number(&found, "theta"), library.statistic.theta);
        assert_near(number(&found, "false_alarm"), library.rates.false_alarm);
        assert_near(number(&found, "miss"), library.rates.miss);
        assert_near(number(&found, "y_lateral_n"), library.statistic.y.lateral);
        assert_near(number(&found, "y_normal_n"), library.statistic.y.normal);
        let name = match decision {
            Decision::Inclusion => "inclusion",
            Decision::NoInclusion => "no_inclusion",
        };
        assert_eq!(
            (library.decision, &found["decision"]),
            (decision, &name.into())
        );
        assert_eq!(number(&found, "depth_m"), 0.003);
        assert_eq!(number(&found, "noise_sd_normal_n"), NOISE.normal);
    }
}

// Verifies: CLI-042, CLI-043.
#[test]
fn criteria_set_the_threshold_and_keep_their_rate() {
    let criterion = ["--criterion", "neyman-pearson-miss", "--max-miss", "0.01"];
    let found = answer("with.csv", &criterion);
    assert!((number(&found, "miss") / 0.01 - 1.0).abs() < 1e-9);
    let name = "neyman-pearson-false-alarm";
    let found = answer(
        "with.csv",
        &["--criterion", name, "--max-false-alarm", "0.02"],
    );
    assert!((number(&found, "false_alarm") / 0.02 - 1.0).abs() < 1e-9);
    assert_eq!(number(&found, "max_false_alarm"), 0.02);
    assert!(found.get("max_miss").is_none());
}

// Verifies: CLI-055, TRC-050, TRC-051.
#[test]
fn a_record_that_fits_neither_map_is_reported() {
    let [none, inclusion] = maps(folder());
    for (trace, map) in [("with.csv", &inclusion), ("without.csv", &none)] {
        let found = answer(trace, &[]);
        let observed = observed(&folder().join(trace));
        let chi_square: f64 = sweep(map.table())
            .iter()
            .enumerate()
            .map(|(i, [_, lateral, normal])| {
                ((observed.lateral[i] - lateral) / NOISE.lateral).powi(2)
                    + ((observed.normal[i] - normal) / NOISE.normal).powi(2)
            })
            .sum();
        assert_near(number(&found, "chi_square"), chi_square);
        // n = 66 and t = 13.8155: 66 + 2·30.1964 + 27.6310.
        assert!((number(&found, "chi_square_limit") - 154.024).abs() < 1e-3);
    }
    // The sweep was at 3 mm.
    for scan in [&[][..], &["--scan"]] {
        let elsewhere = ["--depth-mm", "2", "--noise-sd-n", "0.1"];
        let output = detect("with.csv", &[&elsewhere[..], scan].concat());
        let warning = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0));
        let of_the_fit = warning
            .lines()
            .filter(|line| line.contains("fits neither map"));
        assert_eq!(of_the_fit.count(), 1, "{warning}");
        // The maps end at ±8 mm, where the signal is not yet gone: only a scan minds.
        let of_the_ends = warning
            .lines()
            .filter(|line| line.contains("at an end of the maps"));
        assert_eq!(of_the_ends.count(), scan.len(), "{warning}");
    }
}

// Verifies: CLI-044, TRC-032, TRC-034.
#[test]
fn the_scan_finds_an_inclusion_that_was_moved() {
    let criterion = [
        "--criterion",
        "neyman-pearson-false-alarm",
        "--max-false-alarm",
        "0.001",
    ];
    let found = answer("moved.csv", &[&["--scan"], &criterion[..]].concat());
    let best = (-16..=16).map(|shift| plain("moved.csv", shift).0);
    assert_near(number(&found, "theta_max"), best.fold(f64::MIN, f64::max));
    assert_eq!(found["decision"], "inclusion");
    let (position, bound) = (
        number(&found, "position_m"),
        number(&found, "position_sd_bound_m"),
    );
    let moved = MOVED as f64 * 0.0005;
    assert!((position - moved).abs() < 4.0 * bound, "{found}");
    assert!(bound > 1e-5 && bound < 5e-4, "{found}");
    assert!(number(&found, "false_alarm_bound") <= 0.001);
    assert_eq!(number(&found, "candidates"), 33.0);
    let nothing = answer("without.csv", &[&["--scan"], &criterion[..]].concat());
    assert_eq!(nothing["decision"], "no_inclusion");
}

// Verifies: CLI-044.
#[test]
fn a_scan_with_an_inclusion_off_the_axis_says_what_its_position_means() {
    let mut map: Value =
        serde_json::from_str(&fs::read_to_string(folder().join("inclusion.json")).unwrap())
            .unwrap();
    map["phantom"]["inclusion"][0]["centre_x_m"] = 3e-3.into();
    fs::write(folder().join("off.json"), map.to_string()).unwrap();
    let path = |file: &str| folder().join(file).display().to_string();
    let (trace, none, off) = (path("with.csv"), path("none.json"), path("off.json"));
    let files = [
        "detect",
        &trace,
        "--reference",
        &none,
        "--inclusion",
        &off,
        "--scan",
    ];
    let output = palpate(&[&files[..], &USUAL].concat());
    let warnings = String::from_utf8(output.stderr).unwrap();
    assert!(
        warnings.contains("off.json: the position is where x = 0 of this map lies")
            && warnings.contains("x = 3 mm"),
        "{warnings}"
    );
}

// Verifies: TRC-010, TRC-012.
#[test]
fn a_trace_over_time_is_the_same_trace() {
    let text = fs::read_to_string(folder().join("with.csv")).unwrap();
    let back_in_time = text.lines().skip(2).collect::<Vec<_>>().into_iter().rev();
    let rows = back_in_time.map(|row| {
        let (position, forces) = row.split_once(',').unwrap();
        // 4 mm/s towards −x, from 8 mm at time 0.
        format!(
            "{},{forces}\n",
            (8.0 - position.parse::<f64>().unwrap()) / 4.0
        )
    });
    let head = "time_s,normal_force_mn,lateral_force_n\n".to_string();
    fs::write(folder().join("time.csv"), head + &rows.collect::<String>()).unwrap();
    let found = answer("time.csv", &["--velocity-mm-s", "-4", "--start-mm", "8"]);
    let expected = answer("with.csv", &[]);
    assert_near(number(&found, "theta"), number(&expected, "theta"));
}

// Verifies: CLI-046.
#[test]
fn people_get_a_table_and_no_decision_is_a_failure() {
    let output = detect("with.csv", &[&USUAL[..], &["--scan"]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with("decision  ") && text.contains("position, mm"),
        "{text}"
    );
    let output = detect("without.csv", &USUAL);
    assert_eq!(output.status.code(), Some(0));
}

// Verifies: CLI-041, CLI-042, CLI-046, CLI-048.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    let noise = ["--depth-mm", "3", "--noise-sd-n", "0.1"];
    let with = |more: &[&'static str]| [&noise[..], more].concat();
    for (arguments, expected) in [
        (vec!["--noise-sd-n", "0.1"], "--depth-mm"),
        (vec!["--depth-mm", "3"], "--noise-sd-n"),
        (
            vec!["--depth-mm", "3", "--noise-sd-lateral-n", "1"],
            "--noise-sd-normal-n",
        ),
        (
            with(&["--noise-sd-lateral-n", "1", "--noise-sd-normal-n", "1"]),
            "cannot be used with",
        ),
        (
            vec!["--depth-mm", "3", "--noise-sd-n", "0"],
            "expected N above 0",
        ),
        (
            vec!["--depth-mm", "3", "--noise-sd-n", "-1"],
            "expected N above 0",
        ),
        (
            vec!["--depth-mm", "3", "--noise-sd-n", "nan"],
            "expected N above 0",
        ),
        (
            vec!["--depth-mm", "inf", "--noise-sd-n", "1"],
            "expected a finite number",
        ),
        (
            vec!["--depth-mm", "-1", "--noise-sd-n", "1"],
            "depth -0.001 m is outside the map",
        ),
        (
            vec!["--depth-mm", "3.5", "--noise-sd-n", "1"],
            "expected 0.002 to 0.003 m",
        ),
        (with(&["--prior-h1", "1"]), "strictly between 0 and 1"),
        (
            with(&["--max-miss", "0.1"]),
            "--criterion map: expected no --max-miss and no --max-false-alarm",
        ),
        (
            with(&["--criterion", "neyman-pearson-miss"]),
            "expected a --max-miss and no --max-false-alarm",
        ),
        (
            with(&["--criterion", "neyman-pearson"]),
            "neyman-pearson-miss",
        ),
        (with(&["--velocity-mm-s", "1"]), "--start-mm"),
        (
            with(&["--velocity-mm-s", "1", "--start-mm", "0"]),
            "expected neither velocity nor start",
        ),
        (with(&["--sacn"]), "--scan"),
    ] {
        let output = detect("with.csv", &arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
        assert_eq!(error.lines().count(), 1, "{arguments:?}: {error}");
        assert!(output.stdout.is_empty());
    }
}

// Verifies: TRC-004, TRC-006, TRC-008, TRC-024, CLI-047.
#[test]
fn bad_files_are_refused_with_file_and_line() {
    let head = "position_mm,lateral_force_n,normal_force_n\n";
    for (name, rows, expected) in [
        (
            "word.csv",
            "0,0,1\n1,zero,1\n",
            "word.csv:3: lateral_force_n = \"zero\"",
        ),
        (
            "nan.csv",
            "0,0,NaN\n",
            "nan.csv:2: normal_force_n = \"NaN\"",
        ),
        (
            "unsorted.csv",
            "1,0,1\n0,0,1\n",
            "unsorted.csv:3: position 0.0 mm after 1.0 mm",
        ),
        (
            "far.csv",
            "0,0,1\n9,0,1\n",
            "far.csv:3: position 9.0 mm is outside the maps",
        ),
        ("empty.csv", "", "empty.csv:1: no samples"),
    ] {
        fs::write(folder().join(name), format!("{head}{rows}")).unwrap();
        let output = detect(name, &USUAL);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(
            error.contains(expected) && error.lines().count() == 1,
            "{error}"
        );
    }
    fs::write(folder().join("latin1.csv"), b"position_mm\xff").unwrap();
    let path = |file: &str| folder().join(file).display().to_string();
    let [trace, none, inclusion] = ["with.csv", "none.json", "inclusion.json"].map(path);
    let mut other: Value = serde_json::from_str(&fs::read_to_string(&none).unwrap()).unwrap();
    let mesh_size = other["certificate"]["mesh_size_m"].clone();
    other["certificate"]["mesh_size_m"] = 0.003.into();
    fs::write(path("coarse.json"), other.to_string()).unwrap();
    other["certificate"]["mesh_size_m"] = mesh_size;
    other["phantom"]["layer"][0]["material"]["youngs_modulus_pa"] = 7.5e4.into();
    fs::write(path("other-gel.json"), other.to_string()).unwrap();
    for (trace, reference, inclusion, expected) in [
        (
            path("latin1.csv"),
            &none,
            &inclusion,
            "latin1.csv: cannot be read",
        ),
        (
            path("missing.csv"),
            &none,
            &inclusion,
            "missing.csv: cannot be read",
        ),
        (
            trace.clone(),
            &path("missing.json"),
            &inclusion,
            "palpate solve",
        ),
        (trace.clone(), &inclusion, &none, "the other way round"),
        (
            trace.clone(),
            &none,
            &none,
            "none.json: number of inclusions is 0, and 0",
        ),
        (
            trace.clone(),
            &inclusion,
            &inclusion,
            "number of inclusions is 1, and 1",
        ),
        (
            trace.clone(),
            &path("other-gel.json"),
            &inclusion,
            "phantom.layer[0].material.youngs_modulus_pa is",
        ),
        (
            trace.clone(),
            &path("coarse.json"),
            &inclusion,
            "mesh_size_m is",
        ),
        (trace.clone(), &trace, &inclusion, "with.csv:2: header"),
    ] {
        let files = [
            "detect",
            &trace,
            "--reference",
            reference,
            "--inclusion",
            inclusion,
        ];
        let output = palpate(&[&files[..], &USUAL].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(
            error.contains(expected) && error.lines().count() == 1,
            "{error}"
        );
    }
}

// Verifies: CLI-047.
#[test]
fn maps_that_do_not_belong_together_are_taken_where_they_are_meant_and_told() {
    let path = |file: &str| folder().join(file).display().to_string();
    let [trace, inclusion] = ["with.csv", "inclusion.json"].map(path);
    let maps = [
        "--reference",
        &inclusion,
        "--inclusion",
        &inclusion,
        "--any-maps",
    ];
    let output = palpate(&[&["detect", &trace], &maps[..], &USUAL].concat());
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("warning") && told.contains("number of inclusions is 1"),
        "{told}"
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(told.contains("the maps do not differ"), "{told}");
}
