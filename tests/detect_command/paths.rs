//! Records whose samples have depths of their own, against maps and banks of several depths.

use palpate::trace::Trace;

use super::*;

/// Four passes over the gel of a map, at 2 to 3 mm in steps of 0.25 mm between the rows, with noise.
fn path(table: &ForceTable, stream: u64) -> String {
    let generator = Generator::new(20_261_126, stream);
    let mut text = String::from("position_mm,depth_mm,lateral_force_n,normal_force_n\n");
    for pass in 0..4 {
        for step in 0..81 {
            let x = 0.2 * f64::from(step) - 8.0;
            let x = if pass % 2 == 0 { x } else { -x };
            let depth = 2.05 + 0.3 * f64::from(pass);
            let forces = table.path(&[1e-3 * depth], &[1e-3 * x]).unwrap();
            let noise =
                |channel| generator.normal(channel, u64::from(100 * pass as u32 + step as u32));
            let lateral = forces.lateral[0] + NOISE.lateral * noise(0);
            let normal = forces.normal[0] + NOISE.normal * noise(1);
            text += &format!("{x:.3},{depth:.3},{lateral},{normal}\n");
        }
    }
    text
}

/// The folder with maps and a bank of several depths, made once.
fn deep() -> &'static Place {
    static PLACE: OnceLock<Place> = OnceLock::new();
    PLACE.get_or_init(|| {
        let place = Place::new("detect_paths");
        for (phantom, file) in [("none", "none.json"), ("2.6", "inclusion.json")] {
            let poses = "--depths-mm 1.5:3.5:0.5 --laterals-mm=-8:8:0.5 --mesh-mm 2 --format json";
            place.write(
                file,
                place.succeed(&format!("solve --phantom {phantom} {poses}")),
            );
        }
        place.succeed(
            "bank --phantom 2.6 --offsets-mm=-3:3:3 --depths-mm 2.6 --probe-depth-mm 2,2.5,3 --laterals-mm=-8:8:0.5 \
             --mesh-mm 2 --out bank.json",
        );
        let [none, inclusion] = maps(&place);
        place.write("without.csv", path(none.table(), 1));
        place.write("with.csv", path(inclusion.table(), 2));
        place.write("sweep.csv", "position_mm,lateral_force_n,normal_force_n\n-1,0,1\n1,0,1\n");
        place
    })
}

fn answer(arguments: &str) -> Value {
    let output = deep().run(&format!("detect {arguments} --format json"));
    let said = text(&output.stderr).to_string();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{said}"))
}

const SD: &str = "--noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12";

// Verifies: CLI-200, CLI-202, CLI-045, ROB-083, ROB-080.
#[test]
fn a_record_of_several_passes_and_depths_is_judged_by_its_poses() {
    for hypotheses in [MAPS, "--bank bank.json"] {
        for model in ["--model exact", "--model robust"] {
            for (file, expected) in [("with.csv", "inclusion"), ("without.csv", "no_inclusion")] {
                let found = answer(&format!("{file} {hypotheses} {model} {SD}"));
                assert_eq!(found["decision"], expected, "{hypotheses} {model}: {found}");
                assert_eq!(found["depth_range_m"], json!([2.05e-3, 2.95e-3]));
                assert_eq!(found["samples"], 324);
                assert!(found.get("depth_m").is_none(), "{found}");
            }
        }
    }
    // The answer of the library for the same record.
    let found = answer(&format!(
        "with.csv {MAPS} --model exact {SD} --known all --noise white --depth-tolerance-mm 0"
    ));
    let record = Trace::read(&deep().at("with.csv"), &Default::default());
    let record = record.unwrap().record(None).unwrap();
    let [f0, f1] = maps(deep()).map(|map| record.expected(map.table(), 0.0).unwrap());
    let (f0, f1) = (f0.as_deref(), f1.as_deref());
    let theta = theta_of_record(record.forces(), f0, f1, NOISE)
        .unwrap()
        .theta;
    let off = (found["theta"].as_f64().unwrap() - theta).abs();
    assert!(off < 1e-9 * theta.abs(), "{found} {theta}");
    // Each of two files is judged by its own passes.
    let output = deep().run(&format!(
        "detect with.csv without.csv {MAPS} {SD} --format csv"
    ));
    let lines = text(&output.stdout).to_string();
    assert_has(&lines, "with.csv,inclusion,");
    assert_has(&lines, "without.csv,no_inclusion,");
}

// Verifies: CLI-175, ROB-080.
#[test]
fn a_record_of_a_folder_is_judged_as_if_the_others_were_not_there() {
    // Passes at 2.05 and 2.35 mm, beside others down to 2.95 mm.
    let deeper = deep().read("with.csv");
    let shallow: Vec<_> = deeper.lines().take(1 + 2 * 81).collect();
    std::fs::create_dir_all(deep().at("depths")).unwrap();
    deep().write("depths/a.csv", shallow.join("\n"));
    deep().write("depths/b.csv", &deeper);
    let output = deep().run(&format!("detect depths {MAPS} {SD} --format json"));
    let lines = text(&output.stdout).lines();
    let lines: Vec<Value> = lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let alone = ["a", "b"].map(|file| answer(&format!("depths/{file}.csv {MAPS} {SD}")));
    assert_eq!(lines, alone);
}

// Verifies: CLI-200, CLI-201.
#[test]
fn each_sample_has_one_depth() {
    let refused = |arguments: &str| deep().refused(&format!("detect {arguments}"));
    for model in ["--model exact --noise-sd-n 1", "--noise-sd-n 1"] {
        for (arguments, expected) in [
            (
                format!("with.csv {MAPS} --depth-mm 2"),
                "with.csv: each sample has its depth; leave out --depth-mm",
            ),
            (
                format!("sweep.csv {MAPS}"),
                "sweep.csv: the samples have no depths; give --depth-mm, or a column depth_mm",
            ),
            (
                "sweep.csv --bank bank.json".into(),
                "sweep.csv: the samples have no depths, and the bank has 3; give --depth-mm, or a column depth_mm",
            ),
            (
                format!("sweep.csv {MAPS} --depth-mm 2 --depth-noise-mm 0.1"),
                "sweep.csv: the record has no depths, whose error is stated; give a column depth_mm, or leave the error out",
            ),
        ] {
            assert_has(&refused(&format!("{arguments} {model}")), expected);
        }
    }
    let found = |noise: &str| {
        let found = answer(&format!(
            "with.csv {MAPS} --model exact {SD} --known depth,variance {noise}"
        ));
        let stated = (!noise.is_empty()).then_some(0.5e-3);
        assert_eq!(found.get("depth_noise_m").and_then(Value::as_f64), stated);
        found["gamma"].as_f64().unwrap()
    };
    // Some 0.3 N/mm: 0.15 N in a normal force with noise of 0.12 N, and little in the lateral one.
    let (without, with) = (found(""), found("--depth-noise-mm 0.5"));
    assert!(
        with < 0.9 * without && with > 0.3 * without,
        "{with} {without}"
    );
}

// Verifies: SEQ-025, SEQ-030, CLI-182.
#[test]
fn lines_with_depths_are_watched() {
    let input = std::fs::File::open(deep().at("with.csv")).unwrap();
    let mut watch = deep().palpate(&format!("watch --bank bank.json {SD}"));
    let output = watch.stdin(input).output().unwrap();
    let last = text(&output.stdout)
        .lines()
        .last()
        .unwrap_or_default()
        .to_string();
    let last: Value = serde_json::from_str(&last).unwrap_or_else(|_| panic!("{output:?}"));
    let known = "--known depth,variance --depth-tolerance-mm 0 --model exact";
    let batch = answer(&format!("with.csv --bank bank.json {known} {SD}"));
    let [live, batch] = [&last["theta"], &batch["theta_mixture"]].map(|of| of.as_f64().unwrap());
    assert!((live - batch).abs() < 1e-9, "{live} {batch}");
    assert_eq!(last["decision"], "inclusion");
}
