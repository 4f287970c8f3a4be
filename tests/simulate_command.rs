//! `palpate simulate`, end to end.

use crate::program::{Place, text};
use palpate_asserts::assert_has;

const SHAKEN: &str = "--depths-mm 1,2 --from-mm -3 --to-mm 3 --hand 0.05,5,500 --tremor-mm 0.05 --relaxation 0.2,1 \
    --friction 0.2 --noise-sd-n 0.1 --correlation 0.5 --offset-sd-n 0.1 --drift-sd-n 0.1 --resolution-n 0.01 --depth-noise-mm 0.01";

// Verifies: CLI-230, CLI-231, CLI-232, SIM-003.
#[test]
fn a_record_is_the_same_alone_and_among_others_from_a_phantom_and_from_its_map() {
    let place = Place::new("simulate_command");
    // A row each 0.5 mm down to 1 mm below the path, a column each 0.5 mm to 1 mm beside it.
    let map = place
        .succeed("solve --phantom none --depths-mm 0:3:0.5 --laterals-mm=-4:4:0.5 --format json");
    place.write("map.json", map);
    let alone = place.succeed(&format!("simulate --phantom none {SHAKEN}"));
    assert_eq!(
        alone,
        place.succeed(&format!("simulate --map map.json {SHAKEN}"))
    );
    assert_eq!(alone.lines().count(), 1 + 2 * 61);
    place.succeed(&format!(
        "simulate --map map.json {SHAKEN} --records 3 --out records"
    ));
    assert_eq!(alone, place.read("records/record-0001.csv"));
    let others = [2, 3].map(|number| place.read(&format!("records/record-000{number}.csv")));
    assert!(others[0] != alone && others[1] != others[0]);
    let other_seed = place.succeed(&format!("simulate --map map.json {SHAKEN} --seed 2"));
    assert_ne!(alone, other_seed);
    let plain =
        "simulate --map map.json --depths-mm 2 --from-mm 3 --to-mm -3 --speed-mm-s 6 --rate-hz 1";
    let without = place.succeed(&format!("{plain} --no-depths"));
    assert_has(
        &without,
        "position_mm,lateral_force_n,normal_force_n\n3.000000,",
    );
    let lines: Vec<_> = without.lines().collect();
    assert!(
        lines[2].starts_with("-3.000000,") && lines.len() == 3,
        "{without}"
    );

    for (arguments, expected) in [
        (
            "--depths-mm 1 --records 2",
            "several records need --out DIR",
        ),
        (
            "--depths-mm 1 --out records",
            "records already exists; choose another --out",
        ),
        (
            "--depths-mm 1 --relaxation 1,2",
            "--relaxation needs a share below 1 and a time above 0",
        ),
        (
            "--depths-mm 1 --relaxation 0.1,0",
            "--relaxation needs a share below 1 and a time above 0",
        ),
        (
            "--depths-mm 5 --records 2 --out refused",
            "depth 5.0 mm is outside the map, which has 0.0 to 3.0 mm",
        ),
        (
            "--depths-mm 1 --from-mm -5",
            "lateral position -5.0 mm is outside the map, which has -4.0 to 4.0 mm",
        ),
        (
            "--depths-mm 1 --from-mm 0 --to-mm 0",
            "a path has no length, speed, rate or depth",
        ),
        ("--depths-mm 3 --hand 0,5,500", "a hand of 0 kg"),
        (
            "--depths-mm 1 --speed-mm-s 0.0001 --rate-hz 0.01 --hand 0.05,5,500",
            "a path of 60000 s with a hand",
        ),
        ("--depths-mm 3 --tremor-hz 3", "not provided: --tremor-mm"),
        ("--depths-mm 3 --correlation 0.9", "--noise-sd-n"),
        (
            "--depths-mm 3 --depth-noise-mm 1 --no-depths",
            "cannot be used with",
        ),
    ] {
        let ends = if arguments.contains("-mm -") || arguments.contains("to-mm") {
            ""
        } else {
            "--from-mm -3 --to-mm 3"
        };
        assert_has(
            &place.refused(&format!("simulate --map map.json {arguments} {ends}")),
            expected,
        );
    }
    // The same command may be tried again.
    assert!(!place.at("refused").exists());
}

// Verifies: CLI-015, CLI-003, CLI-231.
#[test]
fn a_path_that_turns_the_gel_inside_out_is_an_error_and_one_far_away_is_refused() {
    let place = Place::new("simulate-strain");
    let simulate = |depth: &str| {
        place.run(&format!(
            "simulate --phantom 2.6 --from-mm 0 --to-mm 1 --depths-mm {depth}"
        ))
    };
    // Between the rows at 4 and 4.5 mm of the map.
    let output = simulate("4.49");
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let told = text(&output.stderr);
    assert_has(told, "phantom 2.6|at depth 4.49 mm|inside out");
    // The map reaches 5 mm, where palpate solve finds a gel inside out, but the path does not.
    let output = simulate("4");
    assert!(output.status.success(), "{output:?}");
    let told = text(&output.stderr);
    assert_has(told, "warning: phantom 2.6|at depth 4.0 mm");
    let output = simulate("5");
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    assert_has(text(&output.stderr), "phantom 2.6|inside out");
    assert_eq!(text(&output.stdout).lines().count(), 12);
    // As it is asked, not the first pose on the way there.
    let refused = place.refused("simulate --phantom 2.6 --depths-mm 1000");
    assert_has(&refused, "phantom 2.6: depth_mm = 1000.0, but must be");
}

// Verifies: CLI-232.
#[test]
fn a_gel_with_the_friction_of_a_sweep_is_refused() {
    let place = Place::new("simulate-friction");
    let poses = "--depths-mm 0.5,1 --laterals-mm=-1,1 --mesh-mm 3 --format json";
    let map = place.succeed(&format!(
        "solve --phantom none --strain finite --friction 0.3 {poses}"
    ));
    place.write("rubs.json", map);
    let told = place.refused("simulate --map rubs.json --depths-mm 1 --from-mm -1 --to-mm 1");
    assert_has(
        &told,
        "phantom none|friction of a sweep to the right|--friction",
    );
}

// Verifies: CLI-231, CLI-232.
#[test]
fn a_path_may_go_where_its_margin_may_not() {
    let place = Place::new("simulate-wall");
    // The probe clears the walls up to 12.3 mm at 2 mm, not at 2.5 mm.
    for ends in ["--from-mm 11.5 --to-mm 12", "--from-mm 12.3 --to-mm -12.3"] {
        let line = format!("simulate --phantom none --depths-mm 2 {ends} --speed-mm-s 5");
        let record = place.succeed(&line);
        let position = |row: &str| row.split(',').next().unwrap().parse::<f64>().unwrap();
        let largest = record.lines().skip(1).map(position).fold(0.0, f64::max);
        let end = if ends.contains("12.3") { 12.3 } else { 12.0 };
        assert!((largest - end).abs() < 1e-6, "{record}");
    }
    let told = place.refused("simulate --phantom none --depths-mm 2 --from-mm 0 --to-mm 12.4");
    assert_has(&told, "phantom none: lateral_mm = 12.4, but must be");
}

// Verifies: CLI-010.
#[test]
fn the_depths_of_passes_are_a_list() {
    let place = Place::new("simulate-list");
    let map =
        place.succeed("solve --phantom none --depths-mm 0,4 --laterals-mm=-4,4 --format json");
    place.write("map.json", map);
    let record = |depths: &str| {
        place.succeed(&format!(
            "simulate --map map.json --from-mm -3 --to-mm 3 --depths-mm {depths}"
        ))
    };
    assert_eq!(record("1:4:1"), record("1,2,3,4"));
    assert_ne!(record("4,3"), record("3,4"));
}

// Verifies: CLI-235.
#[test]
fn what_comes_to_the_place_of_a_record_meanwhile_stays() {
    let place = Place::new("simulate-meanwhile");
    let map =
        place.succeed("solve --phantom none --depths-mm 0,2 --laterals-mm=-4,4 --format json");
    let line = "simulate --map map.json --depths-mm 1 --from-mm -3 --to-mm 3 --out new";
    let told = place.refused_meanwhile(line, ["map.json", &map], || {
        std::fs::create_dir(place.at("new")).unwrap();
        place.write("new/record-0001.csv", "mine");
    });
    let there = "palpate: write new/record-0001.csv: it is there by now; choose another name\n";
    assert_eq!(
        (&*told, &*place.read("new/record-0001.csv")),
        (there, "mine")
    );
}
