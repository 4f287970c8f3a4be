//! `palpate demo`: its files, which the other commands take.

use std::path::PathBuf;

use crate::program::{Place, contents};
use palpate::force_map::ForceMap;
use palpate::trace::Trace;

// Verifies: CLI-130, CLI-031.
#[test]
fn the_files_of_the_demo_are_the_same_each_time_and_can_be_used() {
    let here = Place::new("demo");
    let files = "run.toml none.json inclusion.json sweep-without.csv sweep-with.csv sweep-disturbed.csv blank.csv measured.csv curve.csv";
    let printed = here.succeed("demo first");
    let expected = files.split(' ').map(|file| format!("first/{file}\n"));
    assert_eq!(printed, expected.collect::<String>());
    here.succeed("demo second");
    let [first, second] = ["first", "second"].map(|folder| contents(&here.at(folder)));
    let bytes = |files: Vec<(PathBuf, Vec<u8>)>| files.into_iter().map(|(_, bytes)| bytes);
    assert_eq!(first.len(), files.split(' ').count());
    assert!(bytes(first).eq(bytes(second)));
    // The forces of the sensor without a gel are its offset and half its drift, within 5 standard deviations of a mean.
    let blank = here.read("first/blank.csv");
    let row = |row: &str| row.split(',').map(|field| field.parse().unwrap()).collect();
    let rows: Vec<Vec<f64>> = blank.lines().skip(1).map(row).collect();
    assert_eq!((rows.len(), rows[0][0], rows[400][0]), (401, -8.0, 8.0));
    for (channel, mean) in [(1, 0.05 - 0.025), (2, 0.3 + 0.05)] {
        let found = rows.iter().map(|row| row[channel]).sum::<f64>() / 401.0;
        assert!((found - mean).abs() < 0.5 / 401_f64.sqrt(), "{found}");
    }
    // Each sweep has noise of its own: of 0.1 N, and none of it in the other.
    let noise = |sweep: &str, map: &str| -> Vec<f64> {
        let trace = Trace::from_csv(&here.read(&format!("first/{sweep}")), sweep).unwrap();
        let map = ForceMap::read(&here.at(&format!("first/{map}"))).unwrap();
        let record = trace.record(None).unwrap();
        let exact = record.expected(map.table(), 4e-3).unwrap();
        let pairs = record.forces().normal.iter().zip(exact.normal);
        pairs.map(|(force, exact)| force - exact).collect()
    };
    let [without, with] = ["without", "with"].map(|name| {
        let map = if name == "with" {
            "inclusion.json"
        } else {
            "none.json"
        };
        noise(&format!("sweep-{name}.csv"), map)
    });
    let product =
        |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() / 401.0;
    // Five standard deviations of a mean of products; positions are rounded to 1 µm.
    for (one, other, expected) in [
        (&with, &with, 1.0),
        (&without, &without, 1.0),
        (&with, &without, 0.0),
    ] {
        let found = product(one, other) / 0.01;
        assert!(
            (found - expected).abs() < 5.0 * (2.0_f64 / 401.0).sqrt(),
            "{found}"
        );
    }
    // A configuration in another folder, with its files beside it.
    let own = "phantoms = [\"gel.toml\"]\nmeasured = [\"measured.csv\"]\ndepths_mm = \"1\"\nlaterals_mm = \"0\"\n[mesh]\nsize_mm = 3.0\n";
    here.write("first/own.toml", own);
    here.write("first/gel.toml", include_str!("../docs/phantom.toml"));
    here.succeed("run --config first/own.toml --out out");
    assert!(here.at("out/figures/figure-7-measured.csv.svg").exists());
}
