//! `palpate run`, end to end: its files, and the report.

use std::fs;

use crate::program::{ASYMMETRIC, Place, contents, text};
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate_asserts::assert_has;

// Verifies: CLI-007, CLI-031, CLI-032, CON-006.
#[test]
fn a_configured_run_gives_the_same_bytes_with_any_number_of_threads() {
    let here = Place::new("threads");
    here.write("mine.toml", include_str!("../docs/phantom.toml"));
    let config = "phantoms = [\"2.6\", \"mine.toml\"]\ndepths_mm = \"0:3:1\"\nlaterals_mm = \"-4:4:1\"\n[mesh]\nsize_mm = 2.0\n[detection]\nnoise_sd_n = 0.1\n";
    here.write("run.toml", config);
    for threads in ["1", "2", "5"] {
        let out = format!("out-{threads}");
        let mut run = here.palpate(&format!("run --config run.toml --out {out}"));
        let output = run.env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains(&format!("{out}/report.html")));
    }
    let one = contents(&here.at("out-1"));
    assert!(one.iter().any(|(path, _)| path.ends_with("report.html")));
    let maps = one.iter().filter(|(path, _)| path.starts_with("maps"));
    assert_eq!(maps.count(), 3);
    for threads in ["2", "5"] {
        let other = contents(&here.at(&format!("out-{threads}")));
        assert_eq!(one.len(), other.len());
        for ((path, bytes), (other_path, other_bytes)) in one.iter().zip(&other) {
            assert_eq!(path, other_path);
            let is_same = bytes == other_bytes;
            assert!(is_same, "{path:?} differs between 1 and {threads} threads");
        }
    }
}

/// An independent study of the same gel found normal forces of 1.482 N at small and 2.33 N at finite strain, −1.0 N of lateral force
/// with a friction of 0.3, and changes by 7.3 and about 14 % for each per cent of ν.
// Verifies: CLI-179, REP-090, REP-092, CLI-015.
#[test]
#[ignore = "slow, and rarely breaks"]
fn theories_are_compared_by_forces_that_another_program_found() {
    let here = Place::new("theories");
    let config = "phantoms = [\"2.6\"]\ndepths_mm = \"4\"\nlaterals_mm = \"-4,0,4\"\n[mesh]\nsize_mm = 2.0\n";
    here.write("run.toml", config);
    let output = here.run("run --config run.toml --strain finite --compare-theories");
    assert!(output.status.success(), "{output:?}");
    // The run is at finite strain; a theory is not.
    let told = "warning: phantom 2.6|the small-strain model is at its limit";
    assert_has(text(&output.stderr), told);
    let summary = here.read("palpate-out/summary.json");
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let theories = summary["findings"]["theories"].as_array().unwrap();
    assert_eq!(theories.len(), 3);
    let expected = [(Some(1.482), 7.3), (Some(2.33), 14.0), (None, 13.0)];
    for (theory, (normal, leverage)) in theories.iter().zip(expected) {
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let found = number(&theory["reference"]["normal_force_at_centre_n"]);
        let is_near = |normal: f64| (found / normal - 1.0).abs() < 0.03;
        assert!(normal.is_none_or(is_near), "{found} for {normal:?}");
        let found = number(&theory["poisson_leverage"]);
        assert!((found - leverage).abs() < 1.5, "{found} for {leverage}");
    }
    let page = here.read("palpate-out/report.html");
    assert_has(&page, "On a gel of finite strain, friction 0.3,");
    let figure = here.read("palpate-out/figures/theories.svg");
    assert_has(&figure, "finite strain, friction 0.3");
}

const ONE_POSE: &str = "reference = \"gel.toml\"\nphantoms = []\ndepths_mm = \"1\"\nlaterals_mm = \"0\"\n[mesh]\nsize_mm = 3.0\n";

/// A gel with Poisson's ratio `ratio`, with the first line of its file.
fn gel(ratio: f64, first: &str) -> String {
    format!(
        "{first}name = \"gel\"\nwell = {{ width_mm = 34 }}\nprobe = {{ radius_mm = 6.5, length_mm = 30 }}\n[[layer]]\nthickness_mm = 15\nyoungs_modulus_kpa = 5\npoisson_ratio = {ratio}\n"
    )
}

// Verifies: CLI-179, REP-090.
#[test]
fn theories_are_compared_up_to_the_largest_poisson_ratio_of_all() {
    let here = Place::new("largest-ratio");
    here.write("run.toml", ONE_POSE);
    let leverages = |ratio: f64| -> Vec<f64> {
        here.write("gel.toml", gel(ratio, ""));
        let out = format!("out-{ratio}");
        here.succeed(&format!(
            "run --config run.toml --compare-theories --out {out}"
        ));
        let summary = here.read(&format!("{out}/summary.json"));
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let theories = summary["findings"]["theories"].as_array().unwrap();
        let leverage = |of: &serde_json::Value| of["poisson_leverage"].as_f64().unwrap();
        theories.iter().map(leverage).collect()
    };
    // From below at small strain, and on both sides at finite strain and just beneath the limit: a smooth function of the ratio.
    let (most, less) = (leverages(0.4995), leverages(0.4989));
    let pairs = most.iter().zip(&less);
    for (most, less) in pairs.clone() {
        assert!(
            *most > 0.0 && (most / less - 1.0).abs() < 0.05,
            "{most:?} {less:?}"
        );
    }
    assert_eq!(pairs.count(), 3);
}

// Verifies: CLI-179.
#[test]
fn what_a_theory_does_not_have_is_refused_at_once() {
    let here = Place::new("refused-theory");
    here.write("gel.toml", gel(0.4999, "strain = \"finite\"\n"));
    here.write("run.toml", ONE_POSE);
    let told = here.refused("run --config run.toml --compare-theories");
    let expected = "--compare-theories: at small strain, friction 0, phantom gel: layer[0].poisson_ratio = 0.4999, but must be above -1.0 and at most 0.4995";
    assert_eq!(told, expected);
    here.write("gel.toml", gel(0.49, ""));
    here.write(
        "run.toml",
        format!("{ONE_POSE}contact = \"vertical-gap\"\n"),
    );
    let told = here.refused("run --config run.toml --compare-theories");
    assert_has(
        &told,
        "at finite strain, friction 0, phantom gel: vertical-gap contact at finite strain",
    );
    // Before the folder is made.
    assert!(!here.at("palpate-out").exists());
}

// Verifies: CLI-180, FEM-016.
#[test]
fn a_path_prints_a_row_for_each_pose_and_writes_a_series() {
    let here = Place::new("path");
    let line = "solve --phantom none --strain finite --friction 0.3 --mesh-mm 2 --depths-mm 1,2 --laterals-mm 0,0.5,2 --path --pvd gel.pvd";
    let table = here.succeed(line);
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|row| {
            row.split_whitespace()
                .map(|word| word.parse().unwrap())
                .collect()
        })
        .collect();
    let poses: Vec<&[f64]> = rows.iter().map(|row| &row[..2]).collect();
    assert_eq!(poses, [[1.0, 0.0], [2.0, 0.0], [2.0, 0.5], [2.0, 2.0]]);
    // No drag on the way down; then against the way, the more the longer it is.
    let [down, soon, late] = [1, 2, 3].map(|row| rows[row][3]);
    assert!(down.abs() < 1e-3 && soon < -0.05 && late < soon, "{table}");
    let list = here.read("gel.pvd");
    for at in 0..4 {
        assert_has(
            &list,
            &format!("<DataSet timestep=\"{at}\" file=\"gel-{at}.vtu\"/>"),
        );
        assert_has(&here.read(&format!("gel-{at}.vtu")), "Name=\"slip_m\"");
    }
    let csv = here.succeed(&line.replace("--pvd gel.pvd", "--format csv"));
    let last = csv.lines().next_back().unwrap();
    assert!(
        csv.starts_with("lateral_mm,depth_mm,normal_force_n,lateral_force_n\n"),
        "{csv}"
    );
    assert!(last.starts_with("2.0,2.0,"), "{last}");
    for (more, told) in [
        ("--format json", "--path prints no map"),
        ("--certify", "cannot be used with"),
    ] {
        assert_has(&here.refused(&format!("{line} {more}")), told);
    }
}

// Verifies: CLI-031, CLI-032, REP-003, FEM-086.
#[test]
fn a_run_of_own_asymmetric_phantoms_shows_them() {
    let here = Place::new("own-run");
    here.write("own.toml", ASYMMETRIC);
    let (plain, _) = ASYMMETRIC.split_once("[[inclusion]]").unwrap();
    here.write("plain.toml", plain.replace("asymmetric", "plain"));
    let config = "reference = \"plain.toml\"\nphantoms = [\"own.toml\"]\ndepths_mm = \"1,2\"\nlaterals_mm = \"-4:4:2\"\n[mesh]\nsize_mm = 1.5\n";
    here.write("run.toml", config);
    here.succeed("run --config run.toml");
    let out = here.at("palpate-out");
    let map = ForceMap::read(&out.join("maps/map-asymmetric.json")).unwrap();
    let forces = map.table().normal().row(1);
    assert!(forces[0] > forces[4] + 0.02, "{forces:?}");
    // The mesh under the probe where it is nearest to the first inclusion.
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("probe at depth 2 mm, x = −4 mm"));
    assert!(page.contains("Figure 5. Forces, phantom “asymmetric”: 2 inclusions"));
    assert!(page.contains("walls sliding, floor fixed"));
    // Coarser meshes are too much alike for error bands.
    assert_eq!(map.certificate().unwrap().discretization, None);
    assert!(page.contains("not estimated"));
}

// Verifies: CLI-031.
#[test]
fn a_measured_map_is_shown_and_a_computed_one_refused() {
    let here = Place::new("measured");
    let csv = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n0,0,0,0\n0,3,0,0\n2,0,0.6,0\n2,3,0.5,-0.1\n";
    here.write("gel.csv", csv);
    here.succeed("import-map gel.csv --out gel.json");
    let config = "phantoms = []\nmeasured = [\"MAP\"]\ndepths_mm = \"1\"\nlaterals_mm = \"0\"\n[mesh]\nsize_mm = 3.0\n";
    let config = |measured: &str| config.replace("MAP", measured);
    here.write("run.toml", config("gel.json"));
    here.succeed("run --config run.toml");
    assert!(here.at("palpate-out/figures/figure-7-gel.csv.svg").exists());
    let page = here.read("palpate-out/report.html");
    assert!(page.contains("Figure 7. Measured forces, “gel.csv”"));
    here.write("run.toml", config("palpate-out/maps/map-none.json"));
    let message = here.refused("run --config run.toml");
    assert_has(&message, "map-none.json: this map was computed");
    // What the laboratory's columns hold, said once.
    let names = csv.replace("normal_force_n", "Cell").replace("0.6", "-600");
    let names = names.replace("0.5,", "-500,");
    here.write("lab.CSV", names.replace(",lateral_force_n", ",fx"));
    let columns = "columns = { normal = \"-Cell[mN]\" }\n";
    here.write("run.toml", columns.to_string() + &config("lab.CSV"));
    let output = here.run("run --config run.toml --out lab");
    let told = "note: lab.CSV: column \"fx\" is read as lateral_force_n";
    assert_has(text(&output.stderr), told);
    let [own, lab] = ["palpate-out/report.html", "lab/report.html"].map(|page| here.read(page));
    let figure = |page: &str, name: &str| {
        let (_, after) = page
            .split_once(&format!("Measured forces, “{name}”"))
            .unwrap();
        after.split_once("</figure>").unwrap().0.len()
    };
    assert_eq!(figure(&own, "gel.csv"), figure(&lab, "lab.CSV"));
    here.write("run.toml", "columns = { normal = 3 }\n");
    assert_has(
        &here.refused("run --config run.toml"),
        "run.toml:1: columns.normal",
    );
}

// Verifies: CLI-030, CLI-032, REP-030, REP-040.
#[test]
fn the_papers_run_writes_all_its_files_and_the_readmes_figure() {
    let here = Place::new("paper");
    let said = here.succeed("run");
    assert!(said.contains("palpate-out/report.html"), "{said}");
    let out = here.at("palpate-out");
    for name in ["none", "2.6", "4.6", "6.6", "8.6"] {
        let map = ForceMap::read(&out.join(format!("maps/map-{name}.json"))).unwrap();
        assert_eq!(map.phantom(), Some(&Phantom::builtin(name).unwrap()));
        assert_eq!(
            (map.table().depths().len(), map.table().laterals().len()),
            (9, 41)
        );
        let ends = [
            map.table().depths()[8],
            map.table().laterals()[0],
            map.table().laterals()[40],
        ];
        assert_eq!(ends, [4e-3, -10e-3, 10e-3]);
        assert!(out.join(format!("figures/figure-5-{name}.svg")).exists());
    }
    for number in [1, 2, 3, 4, 6, 8, 9, 10, 11, 12, 13] {
        let name = format!("figures/figure-{number}.svg");
        assert!(out.join(&name).exists(), "{name}");
    }
    let summary = here.read("palpate-out/summary.json");
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert!(summary.is_object());
    let page = fs::read(out.join("report.html")).unwrap();
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let drawn = "palpate-out/figures/figure-5-2.6.svg";
    let is_same = here.read(drawn) == include_str!("../docs/figure-5.svg");
    let holds = is_same;
    assert!(
        holds,
        "docs/figure-5.svg is not what the program draws: copy it from {drawn}"
    );
}
