//! `palpate import-map`, from outside.

use crate::program::{Place, text};
use palpate::force_map::{ForceMap, Source};
use palpate_asserts::assert_has;

// Verifies: MAP-080, MAP-081, MAP-082, CLI-020.
#[test]
fn samples_at_any_poses_become_a_map_that_says_so() {
    let place = Place::new("scattered");
    let row = |k: u32| {
        let (depth, x) = (1.0 + f64::from(k / 10) + 0.01, f64::from(k % 10) - 0.02);
        format!("{depth},{x},{},{}\n", 0.5 * depth, 0.1 * x)
    };
    let rows: String = (0..20).map(row).collect();
    let head = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n";
    place.write("rig.csv", format!("{head}{rows}1,3,,0\n"));
    let output = place.run("import-map rig.csv --grid-mm 1 --out rig.json");
    let said = text(&output.stderr);
    assert_has(said, "samples with a missing number are not used: 1");
    assert_has(
        said,
        "samples are at most 0.010 mm (depth) and 0.020 mm (lateral) from the grid",
    );
    let map = ForceMap::read(&place.at("rig.json")).unwrap();
    let Source::Measured(measurement) = map.source() else {
        panic!("{:?}", map.source());
    };
    assert_eq!(measurement.grid, Some([1e-3, 1e-3]));
    let table = map.table();
    assert_eq!(
        (table.depths(), table.laterals().len()),
        (&[1e-3, 2e-3][..], 10)
    );
    // The plane of the neighbours is that of the forces, along x and, with two depths in reach, down.
    assert!((table.lateral().unwrap().row(0)[4] - 0.4).abs() < 1e-9);
    // A step down and one across.
    place.run("import-map rig.csv --grid-mm 1,2 --out wide.json");
    let wide = ForceMap::read(&place.at("wide.json")).unwrap();
    let axes = [wide.table().depths(), wide.table().laterals()];
    assert_eq!(axes, [&[1e-3, 2e-3][..], &[0.0, 2e-3, 4e-3, 6e-3, 8e-3]]);
    let refused = place.refused("import-map rig.csv --grid-mm 1,2,3");
    assert_eq!(refused, "--grid-mm has 3 steps; give one or two");
}

// A lateral force of a tenth of the normal one has a tenth of its noise.
// Verifies: CLI-020, MAP-073.
#[test]
fn the_noise_of_each_force_is_told_by_its_name() {
    let place = Place::new("noise_of_each");
    let row = |k: i32| {
        let force = 2.0 + if k % 2 == 0 { 0.5 } else { -0.5 };
        format!("4,{k},{force},{}\n", 0.1 * force)
    };
    let rows: String = (-10..=10).map(row).collect();
    let head = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n";
    place.write("noisy.csv", format!("{head}{rows}"));
    let said = place.run("import-map noisy.csv --smooth-mm 3 --out smooth.json");
    let said = text(&said.stderr);
    let noise = |of: &str| -> f64 {
        let before = said.split(&format!(" N ({of})")).next().unwrap();
        before.rsplit(' ').next().unwrap().parse().unwrap()
    };
    assert!(noise("normal") > 0.4, "{said}");
    // To the digits that are told.
    assert!(
        (noise("normal") - 10.0 * noise("lateral")).abs() < 1e-3,
        "{said}"
    );
}
