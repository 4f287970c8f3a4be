//! `palpate detect`, end to end: two solved maps, a simulated sweep, the program, and its answer
//! against the library's and against plain sums.
#![cfg(feature = "cli")]

mod program;

use std::process::Output;
use std::sync::OnceLock;

use palpate::detect::assessment::assess;
use palpate::detect::{Decision, theta_of_record};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable};
use palpate::stats::random::Generator;
use program::{Place, text};
use serde_json::Value;

/// Standard deviation of the noise in the sweeps, N.
const NOISE: Force<f64> = Force::new(0.05, 0.12);
/// Where the moved inclusion lies, in samples of half a millimetre: 1.5 mm.
const MOVED: usize = 3;

/// The folder with maps and traces, made once.
fn place() -> &'static Place {
    static PLACE: OnceLock<Place> = OnceLock::new();
    PLACE.get_or_init(|| {
        let place = Place::new("detect_command");
        for (phantom, file) in [("none", "none.json"), ("2.6", "inclusion.json")] {
            let poses = "--depths-mm 2,3 --laterals-mm=-8:8:0.5 --mesh-mm 2 --format json";
            place.write(
                file,
                place.succeed(&format!("solve --phantom {phantom} {poses}")),
            );
        }
        let [none, inclusion] = maps(&place);
        write_trace(&place, "with.csv", &sweep(inclusion.table()), 1);
        write_trace(&place, "without.csv", &sweep(none.table()), 2);
        write_trace(&place, "moved.csv", &moved(&none, &inclusion), 3);
        place
    })
}

fn maps(place: &Place) -> [ForceMap; 2] {
    ["none.json", "inclusion.json"].map(|file| ForceMap::read(&place.at(file)).unwrap())
}

/// The forces at 3 mm depth: position in mm, lateral, normal.
fn sweep(map: &ForceTable) -> Vec<[f64; 3]> {
    let row = map.row(0.003).unwrap();
    let sample = |i| [i as f64 * 0.5 - 8.0, row.lateral[i], row.normal[i]];
    (0..row.lateral.len()).map(sample).collect()
}

/// The sweep over an inclusion that lies `MOVED` samples further to the right.
fn moved(none: &ForceMap, inclusion: &ForceMap) -> Vec<[f64; 3]> {
    let (without, with) = (sweep(none.table()), sweep(inclusion.table()));
    let force = |i: usize, channel: usize| {
        let signal = i.checked_sub(MOVED);
        without[i][channel] + signal.map_or(0.0, |j| with[j][channel] - without[j][channel])
    };
    let sample = |i: usize| [without[i][0], force(i, 1), force(i, 2)];
    (0..without.len()).map(sample).collect()
}

/// Writes a trace with noise of `NOISE`, from a fixed seed.
fn write_trace(place: &Place, name: &str, forces: &[[f64; 3]], stream: u64) {
    let generator = Generator::new(20_261_121, stream);
    let mut text = String::from("# simulated\nposition_mm,normal_force_mn,lateral_force_n\n");
    for (i, [position, lateral, normal]) in (0..).zip(forces) {
        let lateral = lateral + NOISE.lateral * generator.normal(0, i);
        let normal = normal + NOISE.normal * generator.normal(1, i);
        text += &format!("{position},{:e},{lateral:e}\n", normal * 1e3);
    }
    place.write(name, text);
}

/// The observed forces in a file that `write_trace` wrote.
fn observed(name: &str) -> Force<Vec<f64>> {
    let text = place().read(name);
    let rows = text.lines().skip(2).map(|row| row.split(',').collect());
    let rows: Vec<Vec<&str>> = rows.collect();
    let column = |at: usize| rows.iter().map(move |row| row[at].parse::<f64>().unwrap());
    Force::new(
        column(2).collect(),
        column(1).map(|millinewton| millinewton / 1e3).collect(),
    )
}

/// The usual noise and depth.
const USUAL: &str = "--depth-mm 3 --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12";
/// The two maps.
const MAPS: &str = "--reference none.json --inclusion inclusion.json";

fn detect(trace: &str, more: &str) -> Output {
    place().run(&format!("detect {trace} {MAPS} {more}"))
}

fn answer(trace: &str, more: &str) -> Value {
    let output = detect(trace, &format!("{USUAL} --format json {more}"));
    // These maps end where the signal is not yet gone, of which a scan warns.
    let mut warnings = text(&output.stderr).lines();
    let only_of_the_ends = warnings.all(|line| line.contains("at an end of the maps"));
    assert!(output.status.success() && only_of_the_ends, "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(answer: &Value, key: &str) -> f64 {
    let number = answer[key].as_f64();
    number.unwrap_or_else(|| panic!("{key} in {answer}"))
}

/// Σ (rΔ − Δ²/2)/s² and ΣΔ²/s² over both channels, Δ shifted by `shift` samples, in plain
/// arithmetic from the rows of the maps.
fn plain(trace: &str, shift: isize) -> (f64, f64) {
    let [none, inclusion] = maps(place());
    let (without, with) = (sweep(none.table()), sweep(inclusion.table()));
    let observed = observed(trace);
    let (mut theta, mut energy) = (0.0, 0.0);
    let channels = observed.zip(NOISE).into_array();
    for (channel, (observed, sd)) in (1..).zip(channels) {
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
    let [none, inclusion] = maps(place());
    for (trace, decision, name) in [
        ("with.csv", Decision::Inclusion, "inclusion"),
        ("without.csv", Decision::NoInclusion, "no_inclusion"),
    ] {
        let found = answer(trace, "--prior-h1 0.2");
        let (theta, energy) = plain(trace, 0);
        let observed = observed(trace);
        let [f0, f1] = [&none, &inclusion].map(|map| map.row(0.003).unwrap());
        let statistic = theta_of_record(observed.as_deref(), f0, f1, NOISE).unwrap();
        let library = assess(statistic, 0.2, 4.0_f64.ln()).unwrap();
        for (key, expected) in [
            ("theta", theta),
            ("gamma", energy.sqrt()),
            ("eta", 4.0_f64.ln()),
            ("posterior_h1", 1.0 / (1.0 + 4.0 * (-theta).exp())),
            ("theta", library.statistic.theta),
            ("false_alarm", library.rates.false_alarm),
            ("miss", library.rates.miss),
            ("y_lateral_n", library.statistic.y.lateral),
            ("y_normal_n", library.statistic.y.normal),
        ] {
            assert_near(number(&found, key), expected);
        }
        assert_eq!(library.decision, decision);
        assert_eq!(found["decision"], name);
        assert_eq!(number(&found, "depth_m"), 0.003);
        assert_eq!(number(&found, "noise_sd_normal_n"), NOISE.normal);
    }
}

// Verifies: CLI-042, CLI-043.
#[test]
fn criteria_set_the_threshold_and_keep_their_rate() {
    let found = answer(
        "with.csv",
        "--criterion neyman-pearson-miss --max-miss 0.01",
    );
    assert!((number(&found, "miss") / 0.01 - 1.0).abs() < 1e-9);
    let criterion = "--criterion neyman-pearson-false-alarm --max-false-alarm 0.02";
    let found = answer("with.csv", criterion);
    assert!((number(&found, "false_alarm") / 0.02 - 1.0).abs() < 1e-9);
    assert_eq!(number(&found, "max_false_alarm"), 0.02);
    assert!(found.get("max_miss").is_none());
}

// Verifies: CLI-055, TRC-050, TRC-051.
#[test]
fn a_record_that_fits_neither_map_is_reported() {
    let [none, inclusion] = maps(place());
    for (trace, map) in [("with.csv", &inclusion), ("without.csv", &none)] {
        let found = answer(trace, "");
        let observed = observed(trace);
        let squares = (0..)
            .zip(sweep(map.table()))
            .map(|(i, [_, lateral, normal]): (usize, _)| {
                ((observed.lateral[i] - lateral) / NOISE.lateral).powi(2)
                    + ((observed.normal[i] - normal) / NOISE.normal).powi(2)
            });
        assert_near(number(&found, "chi_square"), squares.sum());
        // n = 66 and t = 13.8155: 66 + 2·30.1964 + 27.6310.
        assert!((number(&found, "chi_square_limit") - 154.024).abs() < 1e-3);
    }
    // The sweep was at 3 mm.
    for (scan, ends) in [("", 0), ("--scan", 1)] {
        let output = detect("with.csv", &format!("--depth-mm 2 --noise-sd-n 0.1 {scan}"));
        let warning = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0));
        let lines = |words: &str| warning.lines().filter(|line| line.contains(words)).count();
        assert_eq!(lines("fits neither map"), 1, "{warning}");
        // The maps end at ±8 mm, where the signal is not yet gone: only a scan minds.
        assert_eq!(lines("at an end of the maps"), ends, "{warning}");
    }
}

// Verifies: CLI-044, TRC-032, TRC-034.
#[test]
fn the_scan_finds_an_inclusion_that_was_moved() {
    let scan = "--scan --criterion neyman-pearson-false-alarm --max-false-alarm 0.001";
    let found = answer("moved.csv", scan);
    let best = (-16..=16).map(|shift| plain("moved.csv", shift).0);
    assert_near(number(&found, "theta_max"), best.fold(f64::MIN, f64::max));
    assert_eq!(found["decision"], "inclusion");
    let [position, bound] = ["position_m", "position_sd_bound_m"].map(|key| number(&found, key));
    let moved = MOVED as f64 * 0.0005;
    assert!((position - moved).abs() < 4.0 * bound, "{found}");
    assert!(bound > 1e-5 && bound < 5e-4, "{found}");
    assert!(number(&found, "false_alarm_bound") <= 0.001);
    assert_eq!(number(&found, "candidates"), 33.0);
    let nothing = answer("without.csv", scan);
    assert_eq!(nothing["decision"], "no_inclusion");
}

// Verifies: CLI-044.
#[test]
fn a_scan_with_an_inclusion_off_the_axis_says_what_its_position_means() {
    let mut map: Value = serde_json::from_str(&place().read("inclusion.json")).unwrap();
    map["phantom"]["inclusion"][0]["centre_x_m"] = 3e-3.into();
    place().write("off.json", map.to_string());
    let maps = "--reference none.json --inclusion off.json";
    let output = place().run(&format!("detect with.csv {maps} --scan {USUAL}"));
    let warnings = text(&output.stderr);
    let words = "off.json: the position is where x = 0 of this map lies";
    assert!(warnings.contains(words), "{warnings}");
    assert!(warnings.contains("x = 3 mm"), "{warnings}");
}

// Verifies: TRC-010, TRC-012.
#[test]
fn a_trace_over_time_is_the_same_trace() {
    let text = place().read("with.csv");
    let back_in_time = text.lines().skip(2).collect::<Vec<_>>().into_iter().rev();
    let rows = back_in_time.map(|row| {
        let (position, forces) = row.split_once(',').unwrap();
        // 4 mm/s towards −x, from 8 mm at time 0.
        let time = (8.0 - position.parse::<f64>().unwrap()) / 4.0;
        format!("{time},{forces}\n")
    });
    let head = "time_s,normal_force_mn,lateral_force_n\n".to_string();
    place().write("time.csv", head + &rows.collect::<String>());
    let found = answer("time.csv", "--velocity-mm-s -4 --start-mm 8");
    let expected = answer("with.csv", "");
    assert_near(number(&found, "theta"), number(&expected, "theta"));
}

// Verifies: CLI-046.
#[test]
fn people_get_a_table_and_no_decision_is_a_failure() {
    let table = place().succeed(&format!("detect with.csv {MAPS} {USUAL} --scan"));
    assert!(table.starts_with("decision  "), "{table}");
    assert!(table.contains("position, mm"), "{table}");
    assert_eq!(detect("without.csv", USUAL).status.code(), Some(0));
}

/// Arguments, and words of the refusal.
const REFUSED: &str = "
--noise-sd-n 0.1 => --depth-mm
--depth-mm 3 => --noise-sd-n
--depth-mm 3 --noise-sd-lateral-n 1 => --noise-sd-normal-n
--depth-mm 3 --noise-sd-n 0.1 --noise-sd-lateral-n 1 --noise-sd-normal-n 1 => cannot be used with
--depth-mm 3 --noise-sd-n 0 => expected N above 0
--depth-mm 3 --noise-sd-n -1 => expected N above 0
--depth-mm 3 --noise-sd-n nan => expected N above 0
--depth-mm inf --noise-sd-n 1 => expected a finite number
--depth-mm -1 --noise-sd-n 1 => depth -0.001 m is outside the map
--depth-mm 3.5 --noise-sd-n 1 => expected 0.002 to 0.003 m
--depth-mm 3 --noise-sd-n 0.1 --prior-h1 1 => strictly between 0 and 1
--depth-mm 3 --noise-sd-n 0.1 --max-miss 0.1 => --criterion map: expected no --max-miss and no --max-false-alarm
--depth-mm 3 --noise-sd-n 0.1 --criterion neyman-pearson-miss => expected a --max-miss and no --max-false-alarm
--depth-mm 3 --noise-sd-n 0.1 --criterion neyman-pearson => neyman-pearson-miss
--depth-mm 3 --noise-sd-n 0.1 --velocity-mm-s 1 => --start-mm
--depth-mm 3 --noise-sd-n 0.1 --velocity-mm-s 1 --start-mm 0 => expected neither velocity nor start
--depth-mm 3 --noise-sd-n 0.1 --sacn => --scan
";

// Verifies: CLI-041, CLI-042, CLI-046, CLI-048.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    for case in REFUSED.trim().lines() {
        let (arguments, expected) = case.split_once(" => ").unwrap();
        let error = place().refused(&format!("detect with.csv {MAPS} {arguments}"));
        assert!(error.contains(expected), "{arguments}: {error}");
    }
}

/// Files and other arguments, and words of the refusal.
const REFUSED_FILES: &str = "
word.csv --reference none.json --inclusion inclusion.json => word.csv:3: lateral_force_n = \"zero\"
nan.csv --reference none.json --inclusion inclusion.json => nan.csv:2: normal_force_n = \"NaN\"
unsorted.csv --reference none.json --inclusion inclusion.json => unsorted.csv:3: position 0.0 mm after 1.0 mm
far.csv --reference none.json --inclusion inclusion.json => far.csv:3: position 9.0 mm is outside the maps
empty.csv --reference none.json --inclusion inclusion.json => empty.csv:1: no samples
latin1.csv --reference none.json --inclusion inclusion.json => latin1.csv: cannot be read
missing.csv --reference none.json --inclusion inclusion.json => missing.csv: cannot be read
with.csv --reference missing.json --inclusion inclusion.json => palpate solve
with.csv --reference inclusion.json --inclusion none.json => the other way round
with.csv --reference none.json --inclusion none.json => none.json: number of inclusions is 0, and 0
with.csv --reference inclusion.json --inclusion inclusion.json => number of inclusions is 1, and 1
with.csv --reference other-gel.json --inclusion inclusion.json => phantom.layer[0].material.youngs_modulus_pa is
with.csv --reference coarse.json --inclusion inclusion.json => mesh_size_m is
with.csv --reference with.csv --inclusion inclusion.json => with.csv:2: header
";

// Verifies: TRC-004, TRC-006, TRC-008, TRC-024, CLI-047.
#[test]
fn bad_files_are_refused_with_file_and_line() {
    let head = "position_mm,lateral_force_n,normal_force_n\n";
    for (name, rows) in [
        ("word.csv", "0,0,1\n1,zero,1\n"),
        ("nan.csv", "0,0,NaN\n"),
        ("unsorted.csv", "1,0,1\n0,0,1\n"),
        ("far.csv", "0,0,1\n9,0,1\n"),
        ("empty.csv", ""),
    ] {
        place().write(name, format!("{head}{rows}"));
    }
    place().write("latin1.csv", b"position_mm\xff");
    let mut other: Value = serde_json::from_str(&place().read("none.json")).unwrap();
    let mesh_size = other["certificate"]["mesh_size_m"].clone();
    other["certificate"]["mesh_size_m"] = 0.003.into();
    place().write("coarse.json", other.to_string());
    other["certificate"]["mesh_size_m"] = mesh_size;
    other["phantom"]["layer"][0]["material"]["youngs_modulus_pa"] = 7.5e4.into();
    place().write("other-gel.json", other.to_string());
    for case in REFUSED_FILES.trim().lines() {
        let (files, expected) = case.split_once(" => ").unwrap();
        let error = place().refused(&format!("detect {files} {USUAL}"));
        assert!(error.contains(expected), "{files}: {error}");
    }
}

// Verifies: CLI-047.
#[test]
fn maps_that_do_not_belong_together_are_taken_where_they_are_meant_and_told() {
    let maps = "--reference inclusion.json --inclusion inclusion.json --any-maps";
    let output = place().run(&format!("detect with.csv {maps} {USUAL}"));
    assert_eq!(output.status.code(), Some(2));
    let told = text(&output.stderr);
    for words in [
        "warning",
        "number of inclusions is 1",
        "the maps do not differ",
    ] {
        assert!(told.contains(words), "{told}");
    }
}
