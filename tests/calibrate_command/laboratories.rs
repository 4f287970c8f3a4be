//! Files as laboratories write them: layouts of the project's own, and where they exist the laboratories' files themselves.

use std::path::Path;

use serde_json::Value;

use crate::ROOT;
use crate::program::{Place, text};

/// The forces of laboratories, beside the checkout: their licences differ, so they are not in it.
fn real() -> Option<std::path::PathBuf> {
    let folder = Path::new(ROOT).join("../shared/real");
    let is_there = folder.is_dir();
    if !is_there {
        eprintln!("SKIPPED: no folder ../shared/real, so that no laboratory's own file was read");
    }
    is_there.then_some(folder)
}

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of} is no number"))
}

/// Where the force is highest (mm) and how high it is (N), and the options of the command; the README of the folder has what is known.
const CURVES: [(&str, [f64; 2], &[&str]); 7] = [
    ("skin-100mN.csv", [1.77, 0.1068], &[]),
    ("skin-600mN.csv", [3.99, 0.6126], &[]),
    ("skin-1000mN.csv", [5.51, 1.0132], &[]),
    (
        "skin-600mN.ddf",
        [3.99, 0.6126],
        &[
            "--columns",
            "time=Sample*0.0005[s], depth=AI0*1[mm], normal=AI1*500[mN]",
        ],
    ),
    ("pig-perineum-FF1C.csv", [3.71, 1.165], &["--contact", "0"]),
    ("pig-perineum-RDG1A.csv", [3.81, 1.168], &["--contact", "0"]),
    (
        "asmi-well-E5.csv",
        [77.58, 10.003],
        &[
            "--columns",
            "depth=-Z_Position(mm), normal=-Corrected_Force(N)",
        ],
    ),
];

/// What is left of the highest force of a curve after 1, 3 and 10 s.
const LEFT: [(&str, &[(usize, f64)]); 2] = [
    ("pig-perineum-FF1C.csv", &[(0, 0.70), (1, 0.57), (2, 0.44)]),
    ("pig-perineum-RDG1A.csv", &[(2, 0.49)]),
];

// Verifies: CAL-001, CAL-020, CAL-021, CAL-032, CAL-040, MAP-045, MAP-046, MAP-047.
#[test]
fn each_curve_of_the_laboratories_is_read_by_one_command() {
    let (Some(real), place) = (real(), Place::new("laboratories")) else {
        return;
    };
    for (file, [depth, force], options) in CURVES {
        let mut command = place.palpate("calibrate --format json");
        command.arg(real.join(file)).args(options);
        let output = command.output().unwrap();
        let answer: Value = serde_json::from_slice(&output.stdout).expect(file);
        let curve = &answer["curves"][0];
        let highest = &curve["highest_force"];
        // The README has means of four samples, and the last digit.
        assert!(
            (number(&highest["force_n"]) / force - 1.0).abs() < 0.002,
            "{file}: {highest}"
        );
        assert!(
            (1e3 * number(&highest["depth_m"]) - depth).abs() < 0.006,
            "{file}: {highest}"
        );
        // The lever over skin swings, and presses with a force: no gel at rest does that.
        let cause = if file.starts_with("skin") {
            "misfit".into()
        } else {
            Value::Null
        };
        assert_eq!(curve["cause"], cause, "{file}");
        let code = if cause.is_null() { 0 } else { 3 };
        assert_eq!(
            output.status.code(),
            Some(code),
            "{file}: {}",
            text(&output.stderr)
        );
        for (_, left) in LEFT.iter().filter(|(of, _)| *of == file) {
            for (at, left) in *left {
                let found = number(&curve["held"][at]["left"]);
                // 2 %, and half of the last digit that is known.
                assert!(
                    (found - left).abs() < 0.02 * left + 0.005,
                    "{file}: {found} {left}"
                );
            }
        }
    }
}

// Verifies: ROB-040, CLI-175.
#[test]
fn no_sweep_over_a_gel_that_relaxes_or_bulges_is_judged_wrongly() {
    let (Some(real), place) = (real(), Place::new("laboratories")) else {
        return;
    };
    place.succeed("demo demo");
    for (file, decision) in [
        ("derived-with-relaxing.csv", "inclusion"),
        ("derived-with-relaxing-3s.csv", "inclusion"),
        ("derived-without-curved.csv", "cannot_be_judged"),
    ] {
        let maps = "--reference demo/none.json --inclusion demo/inclusion.json --depth-mm 4";
        let mut command = place.palpate(&format!("detect --format json {maps}"));
        let output = command.arg(real.join(file)).output().unwrap();
        let answer: Value = serde_json::from_slice(&output.stdout).expect(file);
        assert_eq!(answer["decision"], decision, "{file}");
    }
}
