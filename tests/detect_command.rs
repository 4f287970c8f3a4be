//! `palpate detect`, end to end: two solved maps or a small bank, a simulated sweep, the program, and its answer
//! against the library's and against plain sums.

mod air;
mod bank;
mod many;
mod one_channel;
mod paths;
mod refused;
mod robust;

use std::sync::OnceLock;

use crate::program::{Place, text};
use palpate::bank::Bank;
use palpate::detect::{Decision, decide, error_rates, theta_of_record};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable};
use palpate::stats::random::Generator;
use palpate_asserts::assert_has;
use serde_json::{Value, json};

/// Standard deviation of the noise in the sweeps, N.
const NOISE: Force<f64> = Force::new(0.05, 0.12);
/// The map of the bank whose inclusion is in `moved.csv`: at 1.5 mm, 2.6 mm deep.
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
        let output = place.run(
            "bank --phantom 2.6 --offsets-mm=-3:3:1.5 --depths-mm 2.6,3.6 --probe-depth-mm 3 --laterals-mm=-8:8:0.5 \
             --mesh-mm 2 --out bank.json",
        );
        assert!(output.status.success(), "{output:?}");
        let bank = Bank::read(&place.at("bank.json")).unwrap();
        write_trace(&place, "moved.csv", &sweep(bank.maps()[MOVED].table()), 3);
        write_trace(&place, "disturbed.csv", &disturbed(inclusion.table()), 1);
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

/// The sweep by a sensor with an offset and a drift of each channel.
fn disturbed(map: &ForceTable) -> Vec<[f64; 3]> {
    let sensor =
        |[x, lateral, normal]: [f64; 3]| [x, lateral + 0.3 - 0.01 * x, normal - 0.2 + 0.02 * x];
    sweep(map).into_iter().map(sensor).collect()
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
/// All is as the maps say.
const KNOWN: &str = "--known all --noise white --depth-tolerance-mm 0";
/// The two maps.
const MAPS: &str = "--reference none.json --inclusion inclusion.json";

/// The answer in JSON, what was said, and the code of the end.
fn asked(arguments: &str) -> (Value, String, Option<i32>) {
    let output = place().run(&format!("detect --model exact {arguments} --format json"));
    let said = text(&output.stderr).to_string();
    let answer = serde_json::from_slice(&output.stdout);
    (answer.expect(&said), said, output.status.code())
}

/// The answer by the two maps in the usual noise, beside which nothing is said.
fn answer(trace: &str, more: &str) -> Value {
    let (answer, said, code) = asked(&format!("{trace} {MAPS} {USUAL} {more}"));
    assert_eq!((&*said, code), ("", Some(0)));
    answer
}

fn number(answer: &Value, key: &str) -> f64 {
    let number = answer[key].as_f64();
    number.unwrap_or_else(|| panic!("{key} in {answer}"))
}

/// Σ (rΔ − Δ²/2)/s² and ΣΔ²/s² over both channels, in plain arithmetic from the rows of the maps.
fn plain(trace: &str, [none, inclusion]: [&ForceTable; 2]) -> (f64, f64) {
    let (without, with) = (sweep(none), sweep(inclusion));
    let observed = observed(trace);
    let (mut theta, mut energy) = (0.0, 0.0);
    let channels = observed.zip(NOISE).into_array();
    for (channel, (observed, sd)) in (1..).zip(channels) {
        for (i, observed) in observed.iter().enumerate() {
            let signal = with[i][channel] - without[i][channel];
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

// Verifies: CLI-040, CLI-041, CLI-043, CLI-045, CLI-003, CLI-140, TRC-021.
#[test]
fn where_all_is_known_theta_is_that_of_the_library_and_of_a_plain_sum() {
    let [none, inclusion] = maps(place());
    for (trace, decision, name) in [
        ("with.csv", Decision::Inclusion, "inclusion"),
        ("without.csv", Decision::NoInclusion, "no_inclusion"),
    ] {
        let found = answer(trace, &format!("{KNOWN} --prior-h1 0.2"));
        let (theta, energy) = plain(trace, [none.table(), inclusion.table()]);
        let observed = observed(trace);
        let [f0, f1] = [&none, &inclusion].map(|map| map.table().row(0.003).unwrap());
        let statistic = theta_of_record(observed.as_deref(), f0, f1, NOISE).unwrap();
        let rates = error_rates(statistic.gamma, 4.0_f64.ln()).unwrap();
        let threshold = 4.0_f64.ln() / energy.sqrt() + 0.5 * energy.sqrt();
        for (key, expected) in [
            ("theta", theta),
            ("gamma", energy.sqrt()),
            ("gamma_nominal", energy.sqrt()),
            ("t_threshold", threshold),
            ("posterior_h1", 1.0 / (1.0 + 4.0 * (-theta).exp())),
            ("theta", statistic.theta),
            ("false_alarm", rates.false_alarm),
            ("miss", rates.miss),
            ("amplitude", theta / energy + 0.5),
            ("amplitude_sd", 1.0 / energy.sqrt()),
            ("depth_m", 0.003),
            ("noise_sd_normal_n", NOISE.normal),
        ] {
            assert_near(number(&found, key), expected);
        }
        assert_eq!(decide(statistic.theta, 4.0_f64.ln()), Ok(decision));
        assert_eq!(found["decision"], name);
        assert_eq!(found["unknown"], Value::Array(Vec::new()));
    }
}

// Verifies: CLI-140, CLI-041.
#[test]
fn unless_told_otherwise_the_record_tells_what_is_unknown() {
    let unknown = |more: &str| answer("with.csv", more)["unknown"].clone();
    assert_eq!(unknown(""), json!(["offset", "drift", "gain", "variance"]));
    assert_eq!(
        unknown("--known offset,gain"),
        json!(["drift", "depth", "variance"])
    );
    let all = json!(["offset", "drift", "gain", "depth", "variance"]);
    assert_eq!(unknown("--known none"), all);
    let found = answer("disturbed.csv", "");
    assert_eq!(found["decision"], "inclusion");
    let same = answer("with.csv", "");
    // An offset and a drift of each channel change T by rounding of the positions' decimals alone.
    assert_near(number(&found, "t"), number(&same, "t"));
    assert!(number(&same, "gamma") < number(&same, "gamma_nominal"));
    // The noise is not stated: by 66 samples it is known to a tenth.
    let (found, ..) = asked(&format!("with.csv {MAPS} --depth-mm 3"));
    assert!((number(&found, "noise_sd_normal_n") / NOISE.normal - 1.0).abs() < 0.4);
    assert_eq!(found["chi_square_limits"], Value::Null);
    assert_eq!(found["decision"], "inclusion");
}

// Verifies: CLI-041, TRC-076.
#[test]
fn a_blank_sweep_tells_the_noise() {
    let generator = Generator::new(20_261_123, 1);
    let rows = (0..300).map(|i| {
        let (lateral, normal) = (generator.normal(0, i), generator.normal(1, i));
        let (lateral, normal) = (NOISE.lateral * lateral + 0.3, NOISE.normal * normal - 2.0);
        format!("{i},{lateral},{normal}\n")
    });
    let head = "time_ms,lateral_force_n,normal_force_n\n".to_string();
    place().write("blank.csv", head + &rows.collect::<String>());
    let blank = "--depth-mm 3 --noise blank.csv --known depth,variance";
    let (found, _, code) = asked(&format!("with.csv {MAPS} {blank}"));
    assert_eq!(code, Some(0), "{found}");
    // The standard deviation of 300 samples is known to 1/√600.
    let keys = Force::new("noise_sd_lateral_n", "noise_sd_normal_n");
    for (key, sd) in keys.zip(NOISE).into_array() {
        let ratio = number(&found, key) / sd;
        assert!((ratio - 1.0).abs() < 5.0 / 600_f64.sqrt(), "{found}");
    }
    assert_eq!(found["noise"], "blank.csv");
    assert!(found["chi_square_limits"].is_array());
    // That of the record is tested all the same: here it holds each sample for four.
    let held = place().read("with.csv");
    let held = held.lines().enumerate().map(|(line, row)| {
        let times = if line < 2 { 1 } else { 4 };
        format!("{row}\n").repeat(times)
    });
    place().write("held.csv", held.collect::<String>());
    let (found, _, code) = asked(&format!("held.csv {MAPS} --depth-mm 3 --noise blank.csv"));
    assert!(number(&found, "whiteness") < 1e-6, "{found}");
    assert_eq!((&found["causes"][0], code), (&json!("coloured"), Some(3)));
}

// Verifies: CLI-042, CLI-043.
#[test]
fn criteria_set_the_threshold_and_keep_their_rate() {
    for known in ["", KNOWN] {
        let miss = "--criterion neyman-pearson-miss --max-miss 0.01";
        let found = answer("with.csv", &format!("{known} {miss}"));
        assert!((number(&found, "miss") / 0.01 - 1.0).abs() < 1e-9);
        let false_alarm = "--criterion neyman-pearson-false-alarm --max-false-alarm 0.02";
        let found = answer("with.csv", &format!("{known} {false_alarm}"));
        assert!((number(&found, "false_alarm") / 0.02 - 1.0).abs() < 1e-9);
        assert_eq!(number(&found, "max_false_alarm"), 0.02);
        assert!(found.get("max_miss").is_none());
    }
}

// Verifies: CLI-003, CLI-055, CLI-143, CLI-043, TRC-070.
#[test]
fn a_record_that_cannot_be_judged_is_neither_and_says_why() {
    let [none, _] = maps(place());
    let found = answer("without.csv", KNOWN);
    let observed = observed("without.csv");
    let expected = sweep(none.table());
    let squares = (0..)
        .zip(expected)
        .map(|(i, [_, lateral, normal]): (usize, _)| {
            ((observed.lateral[i] - lateral) / NOISE.lateral).powi(2)
                + ((observed.normal[i] - normal) / NOISE.normal).powi(2)
        });
    // Less the one square that the template takes.
    let t = number(&found, "t");
    assert_near(number(&found, "chi_square"), squares.sum::<f64>() - t * t);
    // SciPy: χ² with 65 degrees of freedom, 5·10⁻⁷ to either side.
    let limits = &found["chi_square_limits"];
    assert_near(limits[0].as_f64().unwrap(), 23.549203479709945);
    assert_near(limits[1].as_f64().unwrap(), 136.7380108059163);
    assert_eq!(found["fits"], true);
    // The sweep was at 3 mm.
    let maps = format!("{MAPS} --depth-mm 2 --noise-sd-n 0.1 {KNOWN}");
    let bank = format!("--bank bank.json --noise-sd-n 0.03 {KNOWN}");
    for arguments in [maps, bank] {
        let output = place().run(&format!("detect --model exact with.csv {arguments}"));
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let told: Vec<&str> = text(&output.stderr).lines().collect();
        let words = "palpate: with.csv: cannot be judged: no hypothesis explains the forces";
        assert!(told.len() == 1 && told[0].starts_with(words), "{told:?}");
        let table = text(&output.stdout);
        let row = "\n\ndecision                           cannot be judged\n";
        assert!(table.contains(row), "{table}");
        assert!(!table.contains("posterior"), "{table}");
        assert!(table.starts_with("The record cannot be judged: "));
        let (found, _, code) = asked(&format!("with.csv {arguments}"));
        assert_eq!(code, Some(3));
        let of = ["decision", "causes", "fits", "posterior_h1"].map(|key| found[key].clone());
        let expected = json!(["cannot_be_judged", ["misfit"], false, null]);
        assert_eq!(json!(of), expected);
    }
}

// Verifies: CLI-043.
#[test]
fn the_first_line_says_what_was_decided_known_and_fitted() {
    let usual = "Known: depth. Fitted: offset, drift, gain, variance.";
    let known = "Known: offset, drift, gain, depth, variance. Fitted: nothing.";
    let stated = "and the record fits the stated noise";
    let estimated = "with the noise estimated from the record";
    let white = format!("{USUAL} {KNOWN}");
    for (trace, more, found, noise, taken) in [
        ("with.csv", USUAL, "Inclusion", stated, usual),
        ("without.csv", USUAL, "No inclusion", stated, usual),
        ("with.csv", "--depth-mm 3", "Inclusion", estimated, usual),
        ("with.csv", &white, "Inclusion", stated, known),
    ] {
        let table = place().succeed(&format!("detect --model exact {trace} {MAPS} {more}"));
        let expected = format!("{found} detected, {noise}. {taken}");
        assert_eq!(table.lines().next(), Some(&*expected));
    }
}

// Verifies: CLI-146.
#[test]
fn a_tolerance_that_no_map_can_count_is_told() {
    for map in ["none", "inclusion"] {
        let phantom = map.replace("inclusion", "2.6");
        let poses = "--depths-mm 3 --laterals-mm=-8:8:0.5 --mesh-mm 2 --format json";
        let solved = place().succeed(&format!("solve --phantom {phantom} {poses}"));
        place().write(&format!("{map}-3.json"), solved);
    }
    let maps = "--reference none-3.json --inclusion inclusion-3.json";
    let told = |more: &str| {
        let output = place().run(&format!(
            "detect --model exact with.csv {maps} {USUAL} {more}"
        ));
        assert_eq!(output.status.code(), Some(0));
        text(&output.stderr).to_string()
    };
    let expected = "palpate: warning: none-3.json: the map has a single depth: the depth tolerance has no effect\n";
    assert_eq!(told(""), expected);
    assert_eq!(told("--depth-tolerance-mm 0"), "");
    let (found, ..) = asked(&format!("with.csv {maps} {USUAL}"));
    assert_eq!(found["warnings"], json!(["single_depth"]));
}

// Verifies: TRC-010.
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

// Verifies: CLI-003.
#[test]
fn people_get_a_table_and_no_decision_is_a_failure() {
    let table = place().succeed("detect --model exact with.csv --bank bank.json --noise-sd-n 0.1");
    assert!(table.contains("\n\ndecision  "), "{table}");
    assert_has(&table, "position, mm|95 % interval");
    place().succeed(&format!("detect --model exact without.csv {MAPS} {USUAL}"));
}

/// The answer to `trace` but for its name, and what was said.
fn answer_and_notes(trace: &str, more: &str) -> (Value, String) {
    let (mut answer, said, code) = asked(&format!("{trace} {MAPS} {USUAL} {more}"));
    assert_eq!(code, Some(0), "{said}");
    answer["trace"] = Value::Null;
    // What is stated of the columns stands in the answer.
    let columns = answer.as_object_mut().unwrap().remove("columns");
    assert_eq!(columns.is_some(), more.contains("--columns"));
    (answer, said)
}

// Verifies: CLI-017, MAP-040, MAP-041, MAP-044, TRC-001.
#[test]
fn a_record_of_a_logger_is_the_same_record() {
    let rows = place().read("with.csv");
    let rows = rows.lines().skip(2).zip(0..).map(|(row, number)| {
        let row = row.replace(',', ";").replace('.', ",");
        format!("{number};0,{number};{row};21,5\r\n")
    });
    let head =
        "\"\";\"time_s\";\"Position_mm\";\"normal_force_mN\";\"lateral_force_N\";\"T, °C\"\r\n";
    place().write("logger.csv", head.to_string() + &rows.collect::<String>());
    let (found, notes) = answer_and_notes("logger.csv", "");
    assert_eq!(
        notes,
        "palpate: note: logger.csv: columns \"time_s\", \"T, °C\" are not used\n\
         palpate: note: logger.csv: commas in its numbers are decimal commas\n"
    );
    assert_eq!((found, String::new()), answer_and_notes("with.csv", ""));
    // The reader of a map has notes too.
    let map = maps(place())[0].table().to_csv();
    place().write("none.csv", map.replace("lateral_force_n", "Fx (N)"));
    let measured = MAPS.replace("none.json", "none.csv");
    let (_, notes, _) = asked(&format!("with.csv {measured} {USUAL}"));
    let expected = "palpate: note: none.csv: column \"Fx (N)\" is read as lateral_force_n\n";
    assert_eq!(notes, expected);
}

// Verifies: CLI-174, MAP-045, MAP-046, MAP-047.
#[test]
fn a_record_of_a_machine_is_the_same_record() {
    let rows = place().read("with.csv");
    let rows: String = rows.lines().skip(2).map(|row| format!("{row}\n")).collect();
    let foot = "Total time (s),10.0\n";
    let head = "Gel,7\nLimit (N),10\n\n";
    place().write(
        "named.csv",
        format!("{head}Position [mm],Fz (mN),Shear_Force\n{rows}{foot}"),
    );
    // The name of the first column stands in the preamble too, above numbers.
    let other = "Axis,Cell,Side Force\n1,2,3\n\nAxis,Cell,Side Force\nmm,mN,N\n";
    place().write("other.csv", format!("{other}{rows}{foot}"));
    place().write(
        "machine.toml",
        "[columns]\nposition = \"Axis\"\nnormal = \"Cell\"\nlateral = \"Side Force\"\n",
    );
    let expected = answer_and_notes("with.csv", "").0;
    let (found, notes) = answer_and_notes("named.csv", "");
    assert_eq!(found, expected);
    for told in [
        "the header is line 4: what is before it is not used",
        "column \"Fz (mN)\" is read as normal_force_mn",
        "column \"Shear_Force\" is read as lateral_force_n",
        "lines after the last row are not used: 1",
    ] {
        assert_has(&notes, told);
    }
    let (found, notes) = answer_and_notes("other.csv", "--columns machine.toml --skip-rows 2");
    assert_eq!(found, expected);
    assert_has(&notes, "line 5 gives the units");
    let stated = "position=Axis[mm],normal=Cell[mN],lateral=3[N]";
    place().write("plain.csv", format!("Axis,Cell,Side\n{rows}"));
    assert_eq!(
        answer_and_notes("plain.csv", &format!("--columns {stated}")).0,
        expected
    );
    let output = place().run(&format!(
        "detect plain.csv {MAPS} {USUAL} --columns position=Axis,normal=2[mN],lateral=3[N]"
    ));
    assert_eq!(output.status.code(), Some(2));
    assert_has(
        text(&output.stderr),
        "plain.csv:1: column 1 has no unit in the header \"Axis,Cell,Side\"",
    );
}

// Verifies: CLI-140, TRC-025.
#[test]
fn samples_beyond_the_maps_are_trimmed_and_counted() {
    let rows = place().read("with.csv");
    let more = format!("{rows}8.5,1,0\n9,1,0\n").replace("-8,", "-12,0,9\n-8,");
    place().write("long.csv", more);
    let (found, notes) = answer_and_notes("long.csv", "--trim");
    let expected = "3 of 36 samples left out, which are outside the maps, -8.0 to 8.0 mm";
    assert_eq!(notes, format!("palpate: note: long.csv: {expected}\n"));
    assert_eq!(found, answer_and_notes("with.csv", "").0);
    // Nothing to trim, nothing to tell.
    let untrimmed = answer_and_notes("with.csv", "--trim");
    assert_eq!(untrimmed, (found, String::new()));
}

// Verifies: CLI-047.
#[test]
fn maps_that_do_not_belong_together_are_taken_where_they_are_meant_and_told() {
    let maps = "--reference inclusion.json --inclusion inclusion.json --any-maps";
    let output = place().run(&format!("detect --model exact with.csv {maps} {USUAL}"));
    assert_eq!(output.status.code(), Some(2));
    let told = "warning|the reference map already contains an inclusion|the maps do not differ";
    assert_has(text(&output.stderr), told);
}
