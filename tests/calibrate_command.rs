//! `palpate calibrate`, on curves of the demo and on files as laboratories write them.

mod laboratories;

use crate::program::{Place, text};
use serde_json::Value;

fn place() -> Place {
    let place = Place::new("calibrate");
    place.succeed("demo demo");
    place
}

/// The answer of a command in JSON.
fn answer(place: &Place, line: &str) -> Value {
    let said = place.succeed(&format!("{line} --format json"));
    serde_json::from_str(&said).expect("JSON")
}

/// Whether an interval of an answer holds `truth`, and is at most `width` of it wide.
#[track_caller]
fn assert_holds(of: &Value, truth: f64, width: f64) {
    let ends: Vec<f64> = of["interval"]
        .as_array()
        .unwrap()
        .iter()
        .map(|end| end.as_f64().unwrap())
        .collect();
    assert!(ends[0] <= truth && truth <= ends[1], "{of} {truth}");
    assert!(ends[1] - ends[0] < width * truth.abs(), "{of}");
}

// Verifies: CLI-176, CAL-030, CAL-032, CAL-013, CAL-035, CLI-130.
#[test]
fn the_curve_of_the_demo_says_what_the_demo_put_into_it() {
    let place = place();
    let line = "calibrate demo/curve.csv --phantom none --out gel.toml --uncertainty-out known.toml --figure curve.svg";
    let answer = answer(&place, line);
    assert_eq!(answer["schema"], "palpate-calibration");
    let curve = &answer["curves"][0];
    assert_holds(&curve["contact"], 0.8e-3, 0.1);
    let moduli = curve["youngs_modulus"].as_array().unwrap();
    let none = palpate::phantom::Phantom::builtin("none").unwrap();
    let gel = palpate::phantom::Phantom::read(&place.at("gel.toml")).unwrap();
    for ((own, found), modulus) in none.layers().iter().zip(gel.layers()).zip(moduli) {
        let truth = 1.2 * own.material.youngs_modulus;
        assert_holds(modulus, truth, 0.1);
        let written = found.material.youngs_modulus;
        assert!((written / modulus["estimate"].as_f64().unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(found.thickness, own.thickness);
    }
    let relaxation = &curve["relaxation"];
    assert_eq!(relaxation["form"], "power_law");
    assert_holds(&relaxation["terms"][0]["tau_s"], 1.0, 1.5);
    assert_holds(&relaxation["terms"][0]["exponent"], (-2f64).exp(), 0.7);
    assert_holds(&curve["noise_sd"], 5e-3, 0.3);
    assert!(place.read("curve.svg").contains("95 %"));
    // The file is one that detect reads.
    place.succeed("detect demo/sweep-with.csv --reference demo/none.json --inclusion demo/inclusion.json --depth-mm 4 --gel-uncertainty known.toml");
}

// Verifies: CAL-042.
#[test]
fn a_curve_counts_once_whatever_its_name() {
    let place = place();
    let refused = place.refused("calibrate demo/curve.csv ./demo/curve.csv --phantom none");
    let expected = "./demo/curve.csv: the same samples as demo/curve.csv; name each curve once";
    assert!(refused.contains(expected), "{refused}");
}

// Verifies: CAL-034, CLI-176.
#[test]
fn several_curves_are_told_apart_and_together() {
    let place = place();
    let (text_of, line) = (
        place.read("demo/curve.csv"),
        "calibrate demo/curve.csv soft.csv --phantom none",
    );
    let mut soft = String::new();
    for (number, row) in text_of.lines().enumerate() {
        let fields: Vec<&str> = row.split(',').collect();
        let force = if number == 0 {
            fields[2].into()
        } else {
            (0.8 * fields[2].parse::<f64>().unwrap()).to_string()
        };
        soft += &format!("{},{},{force}\n", fields[0], fields[1]);
    }
    place.write("soft.csv", soft);
    let answer = answer(&place, line);
    let own = |curve: usize| {
        answer["curves"][curve]["youngs_modulus"][0]["estimate"]
            .as_f64()
            .unwrap()
    };
    assert!((own(1) / own(0) - 0.8).abs() < 1e-3);
    let both = answer["youngs_modulus"][0]["estimate"].as_f64().unwrap();
    assert!((both / (own(0) * own(1)).sqrt() - 1.0).abs() < 1e-12);
    let table = place.succeed(line);
    assert!(
        table.contains("soft.csv\n") && table.contains("all curves: Young's modulus, kPa"),
        "{table}"
    );
}

// Verifies: CLI-238.
#[test]
fn a_modulus_far_from_the_phantoms_is_told() {
    let place = place();
    let curve = place.read("demo/curve.csv");
    let line = "calibrate curve.csv --phantom none";
    for (power, is_told) in [("", false), ("e3", true), ("e-3", true)] {
        let rows = curve.lines().skip(1).map(|row| format!("{row}{power}\n"));
        let rows: String = rows.collect();
        place.write(
            "curve.csv",
            format!("time_s,depth_mm,normal_force_n\n{rows}"),
        );
        let output = place.run(line);
        let told = text(&output.stderr);
        assert_eq!(
            told.contains("check the unit of the forces"),
            is_told,
            "{power}: {told}"
        );
    }
}

// Verifies: CAL-040, CLI-176, CAL-033.
#[test]
fn a_curve_that_cannot_be_judged_writes_no_phantom() {
    let place = place();
    let rows = (0..100).map(|k| format!("{},{}\n", 0.05 * f64::from(k), 1e-3 * f64::from(k % 7)));
    place.write(
        "air.csv",
        format!("depth_mm,normal_force_n\n{}", rows.collect::<String>()),
    );
    let line = "calibrate demo/curve.csv air.csv --phantom none --out gel.toml --figure both.svg";
    let output = place.run(line);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    let message = "palpate: air.csv: cannot be judged: the force does not rise above offset, drift and noise; press deeper, or remove samples that are far from their neighbours\n";
    assert!(
        text(&output.stderr).ends_with(message),
        "{}",
        text(&output.stderr)
    );
    assert!(text(&output.stdout).contains("cannot be judged"));
    assert!(!place.at("gel.toml").exists());
    assert!(place.read("both.svg").contains("press deeper"));
    // Twice as strong: another curve, which cannot be judged either.
    let rows = (0..100).map(|k| format!("{},{}\n", 0.05 * f64::from(k), 2e-3 * f64::from(k % 7)));
    let rows = format!("depth_mm,normal_force_n\n{}", rows.collect::<String>());
    place.write("more.csv", rows);
    let output = place.run("calibrate air.csv demo/curve.csv more.csv --phantom none");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    let message =
        "palpate: 2 of 3 curves cannot be judged: air.csv, more.csv; the answer of each says why\n";
    assert!(
        text(&output.stderr).ends_with(message),
        "{}",
        text(&output.stderr)
    );
}

// Verifies: CLI-015, CLI-003, CLI-176.
#[test]
fn strain_is_judged_down_to_the_depth_of_the_curve() {
    let place = Place::new("calibrate-strain");
    let calibrate = |depth: &str| {
        let curve =
            format!("solve --phantom 2.6 --depths-mm 0:{depth}:0.05 --laterals-mm 0 --format csv");
        place.write("curve.csv", place.run(&curve).stdout);
        place.run("calibrate curve.csv --phantom 2.6 --contact 0 --out gel.toml")
    };
    // The gel is turned inside out at 4.5 mm, which only its table reaches.
    let output = calibrate("4.3");
    assert!(output.status.success(), "{output:?}");
    // A little beyond, between two rows of the table.
    for depth in ["4.6", "6"] {
        let output = calibrate(depth);
        assert_eq!(output.status.code(), Some(4), "{output:?}");
        assert!(text(&output.stdout).contains("Young's modulus"));
        assert!(text(&output.stderr).contains("phantom 2.6: det"));
    }
    assert!(place.at("gel.toml").exists());
}

// Verifies: CLI-176, CLI-003.
#[test]
fn what_is_asked_wrongly_is_refused() {
    let place = place();
    place.refuses("calibrate", |words| format!("calibrate {words}"));
}
