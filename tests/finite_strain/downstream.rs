//! What takes maps takes those at finite strain: `bank`, `detect`, `run`, `study` and `play`.

use palpate::fem::{Contact, Model};
use palpate::stats::random::Generator;
use palpate_asserts::{assert_has, assert_near};
use serde_json::Value;

use crate::program::Place;

/// A folder with the phantoms `none` and `6.6` at finite strain, as files.
fn place(test: &str) -> Place {
    let here = Place::new(&format!("finite-{test}"));
    for name in ["none", "6.6"] {
        let phantom = super::phantom(name, 0.49).to_toml();
        here.write(&format!("finite-{name}.toml"), phantom);
    }
    here
}

// Verifies: CLI-177, CLI-043, CLI-154.
#[test]
fn a_bank_at_finite_strain_finds_the_depth_that_one_at_small_strain_misses() {
    let here = place("bank");
    // A record on a mesh that is not the banks', with half the noise that is stated.
    let laterals: Vec<f64> = (-5..=5).map(|at| f64::from(at) * 1e-3).collect();
    let model = Model::new(&super::phantom("6.6", 0.49), 1.5e-3, Contact::default()).unwrap();
    let map = model.map(&[3e-3], &laterals, &|_| true).unwrap();
    let row = map.table().row(3e-3).unwrap();
    let generator = Generator::new(20_261_126, 1);
    let mut record = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for (at, x) in laterals.iter().enumerate() {
        let noise = [0, 1].map(|channel| 0.005 * generator.normal(channel, at as u64));
        let [lateral, normal] = [row.lateral[at] + noise[0], row.normal[at] + noise[1]];
        record += &format!("{},{lateral},{normal}\n", 1e3 * x);
    }
    here.write("record.csv", record);
    let found = |strain: &str| {
        here.succeed(&format!(
            "bank --phantom 6.6 --strain {strain} --offsets-mm 0 --depths-mm 4.6:7.6:1 --probe-depth-mm 3 --laterals-mm=-5:5:1 \
             --mesh-mm 2 --out {strain}.json"
        ));
        let line =
            "--model exact --noise white --noise-sd-n 0.01 --depth-tolerance-mm 0.02 --format json";
        let said = here.succeed(&format!("detect record.csv --bank {strain}.json {line}"));
        let said: Value = serde_json::from_str(&said).unwrap();
        assert_eq!(said["decision"], "inclusion");
        1e3 * said["inclusion_depth"]["estimate"].as_f64().unwrap()
    };
    // By the Cramér–Rao bound the depth is uncertain by 0.1 mm in this noise. At small strain signals are weaker by a third, and the gain
    // that fits the level of the forces makes up for a part of it only: the disc seems shallower.
    let [finite, small] = ["finite", "small"].map(found);
    assert!((finite - 6.6).abs() < 0.25, "{finite}");
    assert!(small < 6.6 - 0.5, "{small}");
}

// Verifies: CLI-031, CLI-177.
#[test]
fn a_run_and_a_study_compare_phantoms_of_one_theory() {
    let here = place("study");
    let poses = "depths_mm = \"1\"\nlaterals_mm = \"-2:2:2\"\nmesh.size_mm = 2.0\n";
    let input = "[[input]]\nname = \"modulus\"\nkey = \"layer[1].youngs_modulus_kpa\"\nsource = \"a test\"\n\
                 distribution.uniform = { from = 4.9, to = 5.1 }\n";
    let study = |of: &str| format!("rows = 2\n[run]\n{of}\n{poses}{input}");
    here.write("mixed.toml", study("phantoms = [\"finite-6.6.toml\"]"));
    let error = here.refused("study run mixed.toml --out out");
    let expected = "mixed.toml:3: phantoms[0]: strain = \"finite\" with friction 0, but the reference has strain = \"small\"";
    assert_has(&error, expected);
    here.write(
        "run.toml",
        format!("phantoms = [\"finite-6.6.toml\"]\n{poses}"),
    );
    let error = here.refused("run --config run.toml");
    assert_has(&error, "run.toml:1: phantoms[0]: strain = \"finite\"");
    // One option for all of them.
    here.succeed("run --config run.toml --strain small");
    let both = "reference = \"finite-none.toml\"\nphantoms = [\"finite-6.6.toml\"]";
    here.write("study.toml", study(both));
    here.succeed("study run study.toml --out out");
    here.succeed("study merge out --out study.json");
    let results: Value = serde_json::from_str(&here.read("study.json")).unwrap();
    assert_eq!(results["failed"], 0);
    // At the median modulus, 5 kPa, the forces are the library's at finite strain, those of the reference too.
    for name in ["none", "6.6"] {
        let gel = super::phantom(name, 0.49);
        let model = Model::new(&gel, 2e-3, Contact::default()).unwrap();
        let map = model.sweep(&[1e-3], &[0.0]).unwrap();
        let expected = map.table().normal().row(0)[0];
        let mut quantities = results["quantities"].as_array().unwrap().iter();
        let force = quantities.find(|q| {
            q["phantom"] == name && q["quantity"] == "normal_force_n" && q["lateral_m"] == 0.0
        });
        let found = force.unwrap()["at_medians"].as_f64().unwrap();
        assert_near(found, expected, 1e-6);
    }
}

// Verifies: CLI-060, CLI-177.
#[test]
fn a_map_at_finite_strain_is_played() {
    let here = place("play");
    let poses = "--depths-mm 0:2:1 --laterals-mm=-2:2:2 --mesh-mm 2 --format json";
    let map = here.succeed(&format!("solve --phantom 6.6 --strain finite {poses}"));
    here.write("map.json", map);
    let said = here.succeed("play --map map.json --seconds 1");
    assert_has(&said, "ended as asked");
    here.succeed("timing --map map.json --cycles 3000 --budget-us 60000000");
}
