//! Sweeps whose inclusion is looked for by a bank.

use super::*;

/// The usual noise, with the bank.
const BY_BANK: &str = "--bank bank.json --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12";

/// The answer by the bank.
fn located(trace: &str, more: &str) -> Value {
    let (answer, said, code) = asked(&format!("{trace} {BY_BANK} {more}"));
    assert_eq!(code, Some(0), "{said}");
    answer
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
        // The truth is at an end of the bank's depths.
        let ends = [0, 1].map(|end: usize| of["interval"][end].as_f64());
        let (low, high) = (ends[0].unwrap_or(0.0), ends[1].unwrap_or(1.0));
        let holds = low < high && low - sd < truth && truth < high + sd;
        assert!(holds, "{key}: {of}");
        assert_eq!(of["unit"], "m");
    }
    // The bank has one diameter and one modulus.
    assert!(found.get("diameter").is_none() && found.get("youngs_modulus").is_none());
    let without = located("without.csv", &format!("{KNOWN} {bound}"));
    assert_eq!(without["decision"], "no_inclusion");
    let error = place().refused(&format!(
        "detect --model exact moved.csv {BY_BANK} --depth-mm 3.1"
    ));
    assert!(
        error.contains("the bank is for a depth of 3.0 mm, not 3.1 mm"),
        "{error}"
    );
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
    let error = place().refused(&format!(
        "detect --model exact moved.csv {BY_BANK} --prior elsewhere.csv"
    ));
    assert_has(&error, "elsewhere.csv:2: this inclusion is not in the bank");
}

// Verifies: CLI-140, CLI-045.
#[test]
fn simulated_records_set_the_threshold() {
    let alarms = "--criterion neyman-pearson-false-alarm --max-false-alarm 0.05";
    let bound = located("moved.csv", &format!("{KNOWN} {alarms}"));
    let found = located("moved.csv", &format!("{KNOWN} {alarms} --simulations 2000"));
    // A sum of ten dependent tails is more than their union.
    assert!(number(&found, "eta") < number(&bound, "eta"), "{found}");
    assert_eq!(
        ["simulations", "seed"].map(|key| number(&found, key)),
        [2000.0, 1999.0]
    );
    let interval = &found["calibrated_false_alarm"];
    let [low, high] = [0, 1].map(|end: usize| interval[end].as_f64().unwrap());
    // Clopper-Pearson at 99 % of 100 of 2000: SciPy's beta.ppf gives 0.0382 and 0.0640.
    let holds = (low - 0.0382).abs() < 1e-4 && (high - 0.0640).abs() < 1e-4;
    assert!(holds, "{interval}");
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
    assert_has(&figure, "<svg ");
    for words in words.split('|') {
        assert_has(&figure, &format!(">\n{words}\n<"));
    }
    let holds = !figure.contains("iameter") && !figure.contains("odulus");
    assert!(holds, "{figure}");
}

// The region of 50 % lies within that of 95 %.
// Verifies: CLI-163.
#[test]
fn the_key_of_a_figure_names_its_regions_and_depth_goes_down() {
    located("moved.csv", "--figure regions.svg");
    let figure = place().read("regions.svg");
    let before = |words: &str| figure.split(&format!(">\n{words}\n<")).next().unwrap();
    // The text has a colour too.
    let sample = |name: &str| &before(name).rsplit("fill=\"#").nth(1).unwrap()[..6];
    let region = |path: &str| {
        let [outline, colour] = ["\"", "fill=\"#"].map(|mark| path.split(mark));
        let numbers = outline
            .clone()
            .next()
            .unwrap()
            .split(|c: char| !c.is_numeric());
        let numbers: Vec<u32> = numbers.filter_map(|number| number.parse().ok()).collect();
        let across = numbers.iter().step_by(2);
        let width = across.clone().max().unwrap() - across.min().unwrap();
        (width, colour.clone().nth(1).unwrap()[..6].to_owned())
    };
    let mut regions: Vec<_> = figure.split("<path d=\"").skip(1).map(region).collect();
    regions.sort();
    let colours: Vec<&str> = regions.iter().map(|(_, colour)| &**colour).collect();
    assert_eq!(colours, [sample("its top: 50 %"), sample("95 %")]);
    let height = |number: &str| -> u32 {
        let of = before(number).rsplit(" y=\"").next().unwrap();
        of.split('"').next().unwrap().parse().unwrap()
    };
    assert!(height("0") < height("2") && height("2") < height("4"));
}

// Verifies: CLI-146, BNK-066.
#[test]
fn the_misses_of_a_bank_of_one_depth_are_told_to_hold_at_it_alone() {
    let miss = "--criterion neyman-pearson-miss --max-miss 0.05";
    for (more, warnings, expected) in [
        (
            "",
            json!(["single_depth"]),
            "palpate: warning: bank.json: its maps have a single depth of the probe: the misses keep their rate at this depth, not within the depth tolerance\n",
        ),
        ("--depth-tolerance-mm 0", json!([]), ""),
        ("--known offset", json!([]), ""),
    ] {
        let (found, said, _) = asked(&format!("moved.csv {BY_BANK} {miss} {more}"));
        assert_eq!(
            (&found["warnings"], &*said),
            (&warnings, expected),
            "{more}"
        );
    }
}

// Verifies: CLI-153.
#[test]
fn an_interval_is_open_where_the_bank_ends() {
    let poses = "--depths-mm 2,3 --laterals-mm=-8:8:0.5 --mesh-mm 2 --format json";
    let solved = place().succeed(&format!("solve --phantom 6.6 {poses}"));
    place().write("deeper.json", solved);
    let deeper = ForceMap::read(&place().at("deeper.json")).unwrap();
    write_trace(place(), "deeper.csv", &sweep(deeper.table()), 5);
    // The bank has depths of 2.6 and 3.6 mm.
    let asked = "detect deeper.csv --model exact --bank bank.json --noise-sd-n 0.05";
    let output = place().run(&format!(
        "{asked} --known offset,drift,gain,depth,variance --format json"
    ));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let depth = &found["inclusion_depth"];
    assert_eq!(depth["estimate"], 3.6e-3, "{found}");
    assert_eq!(depth["interval"][1], Value::Null);
    assert!(depth["interval"][0].as_f64().unwrap() < 3.6e-3);
    let table = place().run(&format!("{asked} --known offset,drift,gain,depth,variance"));
    let table = text(&table.stdout).to_string();
    assert_has(&table, "3.600, 95 % interval from |; the bank ends there");
    place().run(&format!(
        "{asked} --known offset,drift,gain,depth,variance --figure open.svg"
    ));
    let figure = std::fs::read_to_string(place().at("open.svg")).unwrap();
    let (_, words) = figure.split_once("Depth of the inclusion: ").unwrap();
    let interval = words.split(" mm").nth(1).unwrap();
    let is_open = interval.starts_with(", with 95 % probability from 3.");
    assert!(is_open && !interval.contains(" to "), "{interval}");
}
