//! Maps and records of a sensor that measures the normal force alone.

use super::*;

/// Writes the table of a map without its lateral forces.
fn write_normal(map: &ForceMap, file: &str) {
    let table = map.table();
    let rows = table.normal().entries().map(|(row, column, force)| {
        let [depth, lateral] = [table.depths()[row], table.laterals()[column]].map(|m| 1e3 * m);
        format!("{depth:.3},{lateral:.3},{force:e}\n")
    });
    let head = "depth_mm,lateral_mm,normal_force_n\n";
    place().write(file, format!("{head}{}", rows.collect::<String>()));
}

/// The answer of `palpate detect`, and what was said beside it.
fn detected(arguments: &str) -> (Value, String) {
    let output = place().run(&format!("detect {arguments} --format json"));
    let said = text(&output.stderr).to_string();
    (serde_json::from_slice(&output.stdout).expect(&said), said)
}

// Verifies: MAP-083, MAP-084, TRC-011, TRC-014, TRC-015, ROB-005, ROB-006, CLI-020.
#[test]
fn a_sensor_of_one_axis_is_enough_from_the_map_to_the_decision() {
    let two = maps(place());
    let absent = "there is no lateral force: the map is of the normal force alone";
    for (map, name) in two.iter().zip(["none", "inclusion"]) {
        write_normal(map, &format!("{name}-1.csv"));
        let imported = place().run(&format!("import-map {name}-1.csv --out {name}-1.json"));
        assert_has(text(&imported.stderr), absent);
        assert!(
            !place()
                .read(&format!("{name}-1.json"))
                .contains("lateral_force_n")
        );
    }
    let lines = place().read("with.csv");
    let rows = lines
        .lines()
        .skip(2)
        .map(|row| row.rsplit_once(',').unwrap().0);
    let rows = rows.collect::<Vec<_>>().join("\n");
    place().write(
        "with-1.csv",
        format!("position_mm,normal_force_mn\n{rows}\n"),
    );
    // By hand: the normal channel of the plain sum alone.
    let (without, with) = (sweep(two[0].table()), sweep(two[1].table()));
    let (mut theta, mut energy) = (0.0, 0.0);
    for (i, force) in observed("with.csv").normal.iter().enumerate() {
        let signal = with[i][2] - without[i][2];
        let variance = NOISE.normal * NOISE.normal;
        theta += ((force - without[i][2]) * signal - 0.5 * signal * signal) / variance;
        energy += signal * signal / variance;
    }
    let noted = "there is no lateral force: the normal force alone counts";
    let left_out = "the maps have no lateral forces: those of the record are left out";
    let of_one = "--reference none-1.json --inclusion inclusion-1.json";
    for (trace, maps, note) in [
        ("with-1.csv", MAPS, noted),
        ("with-1.csv", of_one, noted),
        ("with.csv", of_one, left_out),
        (
            "with.csv",
            "--reference none.json --inclusion inclusion-1.csv",
            left_out,
        ),
    ] {
        let exact = format!("{trace} --model exact {maps} {USUAL} {KNOWN}");
        let (found, said) = detected(&exact);
        assert_has(&said, note);
        assert_near(number(&found, "theta"), theta);
        assert_near(number(&found, "gamma"), energy.sqrt());
        // Of 33 samples the amplitude of the signal takes one.
        assert_eq!(
            (&found["degrees"], &found["noise_sd_lateral_n"]),
            (&json!(32.0), &Value::Null)
        );
        let (found, said) = detected(&format!("{trace} {maps} {USUAL} --known gel,support"));
        assert_has(&said, note);
        assert_eq!(found["noise_sd_lateral_n"], Value::Null);
        assert_eq!(found["decision"], "inclusion", "{trace} {maps}");
    }
    // A bank has both forces of each map.
    let (found, said) = detected(&format!(
        "with-1.csv --model exact --bank bank.json {USUAL} {KNOWN}"
    ));
    assert_has(&said, noted);
    assert_eq!(
        (&found["decision"], &found["noise_sd_lateral_n"]),
        (&json!("inclusion"), &Value::Null)
    );
    // What plays both refuses it.
    let refused = place().refused("play --map inclusion-1.json");
    let missing = "inclusion-1.json: the map has no lateral forces, which are needed here; give a map with both forces";
    assert_eq!(refused, missing);
}
