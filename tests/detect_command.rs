//! `palpate detect`, end to end: two solved maps or a small bank, a simulated sweep, the program, and its answer
//! against the library's and against plain sums.
#![cfg(feature = "cli")]

mod program;

use std::process::Output;
use std::sync::OnceLock;

use palpate::bank::Bank;
use palpate::detect::{Decision, decide, error_rates, theta_of_record};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable};
use palpate::stats::random::Generator;
use program::{Place, has, text};
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

fn detect(trace: &str, more: &str) -> Output {
    place().run(&format!("detect {trace} {MAPS} {more}"))
}

fn answer(trace: &str, more: &str) -> Value {
    let output = detect(trace, &format!("{USUAL} --format json {more}"));
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{output:?}"
    );
    serde_json::from_slice(&output.stdout).unwrap()
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
        let [f0, f1] = [&none, &inclusion].map(|map| map.row(0.003).unwrap());
        let statistic = theta_of_record(observed.as_deref(), f0, f1, NOISE).unwrap();
        let rates = error_rates(statistic.gamma, 4.0_f64.ln()).unwrap();
        for (key, expected) in [
            ("theta", theta),
            ("gamma", energy.sqrt()),
            ("gamma_nominal", energy.sqrt()),
            (
                "t_threshold",
                4.0_f64.ln() / energy.sqrt() + 0.5 * energy.sqrt(),
            ),
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
    let output = detect("with.csv", "--depth-mm 3 --format json");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
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
    let output = detect(
        "with.csv",
        "--depth-mm 3 --noise blank.csv --known depth,variance --format json",
    );
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    // The standard deviation of 300 samples is known to 1/√600.
    for (key, sd) in [
        ("noise_sd_lateral_n", NOISE.lateral),
        ("noise_sd_normal_n", NOISE.normal),
    ] {
        assert!(
            (number(&found, key) / sd - 1.0).abs() < 5.0 / 600_f64.sqrt(),
            "{found}"
        );
    }
    assert_eq!(found["noise"], "blank.csv");
    assert!(found["chi_square_limits"].is_array());
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
        let output = place().run(&format!("detect with.csv {arguments}"));
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let told: Vec<&str> = text(&output.stderr).lines().collect();
        let words = "palpate: with.csv: cannot be judged: there is more noise than was stated";
        assert!(told.len() == 1 && told[0].starts_with(words), "{told:?}");
        let table = text(&output.stdout);
        let first = "decision                           cannot be judged\n";
        assert!(table.starts_with(first), "{table}");
        assert!(!table.contains("posterior"), "{table}");
        let last = table.lines().last().unwrap();
        assert!(last.starts_with("The record cannot be judged: "));
        let output = place().run(&format!("detect with.csv {arguments} --format json"));
        assert_eq!(output.status.code(), Some(3));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let of = ["decision", "causes", "fits", "posterior_h1"].map(|key| found[key].clone());
        let expected = json!(["cannot_be_judged", ["misfit"], false, null]);
        assert_eq!(json!(of), expected);
    }
}

// Verifies: CLI-043.
#[test]
fn the_last_line_is_a_sentence() {
    let usual = "taken as known: depth; fitted: offset, drift, gain, variance.";
    let known = "taken as known: offset, drift, gain, depth, variance; fitted: nothing.";
    let fits = "in a record that fits the noise stated";
    let shown = "in the noise that the record itself shows";
    let white = format!("{USUAL} {KNOWN}");
    for (trace, more, found, noise, taken) in [
        ("with.csv", USUAL, "An inclusion", fits, usual),
        ("without.csv", USUAL, "No inclusion", fits, usual),
        ("with.csv", "--depth-mm 3", "An inclusion", shown, usual),
        ("with.csv", &white, "An inclusion", fits, known),
    ] {
        let table = place().succeed(&format!("detect {trace} {MAPS} {more}"));
        let expected = format!("{found} was found, {noise}; {taken}");
        assert_eq!(table.lines().last(), Some(&*expected));
    }
}

/// The usual noise, with the bank.
const BY_BANK: &str =
    "--bank bank.json --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12 --format json";

/// The answer by the bank.
fn located(trace: &str, more: &str) -> Value {
    let answer = place().succeed(&format!("detect {trace} {BY_BANK} {more}"));
    serde_json::from_str(&answer).unwrap()
}

/// θ of each map of the bank, in plain arithmetic.
fn thetas(trace: &str) -> Vec<f64> {
    let bank = Bank::read(&place().at("bank.json")).unwrap();
    let theta = |map: &ForceMap| plain(trace, [bank.reference().table(), map.table()]).0;
    bank.maps().iter().map(theta).collect()
}

/// ln Σ pₖ exp θₖ.
fn mixture(weighted: impl Iterator<Item = (f64, f64)>) -> f64 {
    weighted.map(|(p, theta)| p * theta.exp()).sum::<f64>().ln()
}

// Verifies: CLI-043, CLI-140, CLI-153.
#[test]
fn the_bank_finds_an_inclusion_that_was_moved() {
    let bound = "--criterion neyman-pearson-false-alarm --max-false-alarm 0.001";
    let found = located("moved.csv", &format!("{KNOWN} {bound}"));
    let thetas = thetas("moved.csv");
    let best = thetas.iter().copied().fold(f64::MIN, f64::max);
    assert_eq!(best, thetas[MOVED]);
    assert_near(number(&found, "theta_max"), best);
    let of_any = mixture(thetas.iter().map(|&theta| (0.1, theta)));
    assert_near(number(&found, "theta_mixture"), of_any);
    assert_eq!(found["decision"], "inclusion");
    assert_eq!(found["decided_by"], "theta_max");
    assert!(number(&found, "false_alarm_bound") <= 0.001);
    assert_eq!(number(&found, "hypotheses"), 10.0);
    assert_eq!(number(&found, "depth_m"), 0.003);
    for (key, truth) in [("position", 1.5e-3), ("inclusion_depth", 2.6e-3)] {
        let of = &found[key];
        let [estimate, sd] = ["estimate", "sd_bound"].map(|key| number(of, key));
        assert!((estimate - truth).abs() < 4.0 * sd, "{key}: {of}");
        assert!(sd > 1e-6 && sd < 1e-3, "{key}: {of}");
        let [low, high] = [0, 1].map(|end: usize| of["interval"][end].as_f64().unwrap());
        assert!(
            low < high && low - sd < truth && truth < high + sd,
            "{key}: {of}"
        );
        assert_eq!(of["unit"], "m");
    }
    // The bank has one diameter and one modulus.
    assert!(found.get("diameter").is_none() && found.get("youngs_modulus").is_none());
    let without = located("without.csv", &format!("{KNOWN} {bound}"));
    assert_eq!(without["decision"], "no_inclusion");
    let error = place().refused(&format!("detect moved.csv {BY_BANK} --depth-mm 3.1"));
    assert!(error.contains("0.003 m, for which the bank is"), "{error}");
    // Beside what is unknown by default, the same place.
    let found = located("moved.csv", "");
    assert_eq!(found["decision"], "inclusion");
    assert_eq!(found["decided_by"], "theta_mixture");
    let [estimate, sd] = ["estimate", "sd_bound"].map(|key| number(&found["position"], key));
    assert!((estimate - 1.5e-3).abs() < 4.0 * sd, "{found}");
}

// Verifies: CLI-040, BNK-012.
#[test]
fn a_prior_weighs_the_inclusions_of_the_bank() {
    let head = "position_mm,depth_mm,diameter_mm,youngs_modulus_kpa,weight\n";
    place().write(
        "prior.csv",
        format!("{head}1.5,2.6,6.4,1200,1\n-1.5,3.6,6.4,1200,3\n"),
    );
    let found = located("moved.csv", &format!("{KNOWN} --prior prior.csv"));
    let thetas = thetas("moved.csv");
    // Five positions, then those of the next depth: −1.5 mm is the second.
    let weighted = [(0.25, thetas[MOVED]), (0.75, thetas[5 + 1])];
    assert_near(
        number(&found, "theta_mixture"),
        mixture(weighted.into_iter()),
    );
    assert_eq!(found["prior"], "prior.csv");
    place().write("elsewhere.csv", format!("{head}1,2.6,6.4,1200,1\n"));
    let error = place().refused(&format!("detect moved.csv {BY_BANK} --prior elsewhere.csv"));
    has(
        &error,
        ["elsewhere.csv:2: an inclusion that is not in the bank"],
    );
}

// Verifies: CLI-140.
#[test]
fn simulated_records_set_the_threshold() {
    let alarms = "--criterion neyman-pearson-false-alarm --max-false-alarm 0.05";
    let bound = located("moved.csv", &format!("{KNOWN} {alarms}"));
    let found = located("moved.csv", &format!("{KNOWN} {alarms} --simulations 2000"));
    // A sum of ten dependent tails is more than their union.
    assert!(number(&found, "eta") < number(&bound, "eta"), "{found}");
    assert_eq!(number(&found, "simulations"), 2000.0);
    let interval = &found["calibrated_false_alarm"];
    let [low, high] = [0, 1].map(|end: usize| interval[end].as_f64().unwrap());
    // Clopper-Pearson at 99 % of 100 of 2000: SciPy's beta.ppf gives 0.0382 and 0.0640.
    assert!(
        (low - 0.0382).abs() < 1e-4 && (high - 0.0640).abs() < 1e-4,
        "{interval}"
    );
    assert!(bound.get("simulations").is_none());
    let seeded = format!("{KNOWN} {alarms} --simulations 2000 --seed 1999");
    assert_eq!(located("moved.csv", &seeded), found);
}

// Verifies: CLI-163.
#[test]
fn a_figure_shows_where_the_inclusion_lies() {
    located("moved.csv", "--figure place.svg");
    let figure = place().read("place.svg");
    let words = "likeliest inclusion|Depth below the surface (mm)|Position x (mm)|Position x of the inclusion (mm)\
                 |Depth of the inclusion (mm)|Probability density (1/mm)";
    has(&figure, ["<svg "]);
    has(
        &figure,
        words.split('|').map(|words| format!(">\n{words}\n<")),
    );
    assert!(
        !figure.contains("iameter") && !figure.contains("odulus"),
        "{figure}"
    );
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
        let output = place().run(&format!("detect with.csv {maps} {USUAL} {more}"));
        assert_eq!(output.status.code(), Some(0));
        text(&output.stderr).to_string()
    };
    let expected = "palpate: warning: none-3.json: a single depth: what another depth within its tolerance does is not counted\n";
    assert_eq!(told(""), expected);
    assert_eq!(told("--depth-tolerance-mm 0"), "");
    let output = place().run(&format!("detect with.csv {maps} {USUAL} --format json"));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
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
    let table = place().succeed("detect with.csv --bank bank.json --noise-sd-n 0.1");
    assert!(table.starts_with("decision  "), "{table}");
    assert!(table.contains("position, mm"), "{table}");
    assert_eq!(detect("without.csv", USUAL).status.code(), Some(0));
}

/// The answer to `trace` in JSON but for its name, and what was said.
fn answer_and_notes(trace: &str, more: &str) -> (Value, String) {
    let output = detect(trace, &format!("{USUAL} --format json {more}"));
    assert!(output.status.success(), "{output:?}");
    let mut answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    answer["trace"] = Value::Null;
    (answer, text(&output.stderr).into())
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

/// Arguments, and words of the refusal.
const REFUSED: &str = "
--noise-sd-n 0.1 => --depth-mm
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
--depth-mm 3 --noise-sd-n 0.1 --tirm => --trim
--depth-mm 3 --noise-sd-n 0.1 --bank bank.json => cannot be used with
--depth-mm 3 --noise-sd-n 0.1 --figure place.svg => cannot be used with '--figure
--depth-mm 3 --noise-sd-n 0.1 --simulations 1000 => cannot be used with '--simulations
--depth-mm 3 --noise-sd-n 0.1 --prior prior.csv => cannot be used with '--prior
--depth-mm 3 --known ofset => \"ofset\" is none of offset, drift, gain, depth, variance, all and none
--depth-mm 3 --known variance => --known variance: expected --noise-sd-n, or --noise FILE
--depth-mm 3 --known all => --known variance: expected --noise-sd-n, or --noise FILE
--depth-mm 3 --noise pink => pink: cannot be read
--depth-mm 3 --noise with.csv => with.csv: 33 samples, expected at least 100
--depth-mm 3 --depth-tolerance-mm -1 => expected mm, at least 0
";

// Verifies: CLI-041, CLI-042, CLI-003, CLI-048, CLI-140.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    place().refuses(REFUSED, |words| format!("detect with.csv {MAPS} {words}"));
}

/// Files and other arguments, and words of the refusal.
const REFUSED_FILES: &str = "
word.csv --reference none.json --inclusion inclusion.json => word.csv:3: lateral_force_n = \"zero\"
nan.csv --reference none.json --inclusion inclusion.json => nan.csv:2: normal_force_n = \"NaN\"
unsorted.csv --reference none.json --inclusion inclusion.json => unsorted.csv:4: position 0.5 mm after 1.0 mm
far.csv --reference none.json --inclusion inclusion.json => far.csv:3: position 9.0 mm is outside the maps, expected -8.0 to 8.0 mm (or use --trim)
away.csv --trim --reference none.json --inclusion inclusion.json => away.csv: all of 2 samples are outside the maps, expected -8.0 to 8.0 mm
twice.csv --reference none.json --inclusion inclusion.json => twice.csv:1: columns position_m and position_mm in the header
empty.csv --reference none.json --inclusion inclusion.json => empty.csv:1: no samples
latin1.csv --reference none.json --inclusion inclusion.json => latin1.csv: cannot be read
missing.csv --reference none.json --inclusion inclusion.json => missing.csv: cannot be read
with.csv --reference missing.json --inclusion inclusion.json => palpate solve
with.csv --reference inclusion.json --inclusion none.json => the other way round
with.csv --reference none.json --inclusion none.json => none.json: number of inclusions is 0, and 0
with.csv --reference inclusion.json --inclusion inclusion.json => number of inclusions is 1, and 1
with.csv --reference other-gel.json --inclusion inclusion.json => phantom.layer[0].material.youngs_modulus_pa is
with.csv --reference coarse.json --inclusion inclusion.json => mesh_size_m is
with.csv --reference with.csv --inclusion inclusion.json => with.csv:2: no column depth_mm or depth_m in the header
with.csv --bank missing.json => missing.json: cannot be read
";

// Verifies: TRC-004, TRC-008, TRC-024, TRC-025, CLI-047, CLI-140, MAP-033.
#[test]
fn bad_files_are_refused_with_file_and_line() {
    let head = "position_mm,lateral_force_n,normal_force_n\n";
    for (name, rows) in [
        ("word.csv", "0,0,1\n1,zero,1\n"),
        ("nan.csv", "0,0,NaN\n"),
        ("unsorted.csv", "0,0,1\n1,0,1\n0.5,0,1\n2,0,1\n"),
        ("far.csv", "0,0,1\n9,0,1\n"),
        ("away.csv", "9,0,1\n9.5,0,1\n"),
        ("empty.csv", ""),
    ] {
        place().write(name, format!("{head}{rows}"));
    }
    place().write("latin1.csv", b"position_mm\xff");
    place().write("twice.csv", format!("position_m,{head}0,0,0,1\n"));
    let mut other: Value = serde_json::from_str(&place().read("none.json")).unwrap();
    let mesh_size = other["certificate"]["mesh_size_m"].clone();
    other["certificate"]["mesh_size_m"] = 0.003.into();
    place().write("coarse.json", other.to_string());
    other["certificate"]["mesh_size_m"] = mesh_size;
    other["phantom"]["layer"][0]["material"]["youngs_modulus_pa"] = 7.5e4.into();
    place().write("other-gel.json", other.to_string());
    place().refuses(REFUSED_FILES, |words| format!("detect {words} {USUAL}"));
}

// Verifies: CLI-047.
#[test]
fn maps_that_do_not_belong_together_are_taken_where_they_are_meant_and_told() {
    let maps = "--reference inclusion.json --inclusion inclusion.json --any-maps";
    let output = place().run(&format!("detect with.csv {maps} {USUAL}"));
    assert_eq!(output.status.code(), Some(2));
    let told = "warning | number of inclusions is 1 | the maps do not differ";
    has(text(&output.stderr), told.split(" | "));
}
