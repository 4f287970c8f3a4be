//! `palpate bank`, end to end: the bank of a coarse mesh, stopped and resumed, and every refusal.

use std::fs::{self, File};
use std::process::Output;
use std::sync::OnceLock;

use crate::program::{Place, text};
use palpate::bank::{Bank, BankPlan};
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate_asserts::assert_has;

/// Three positions at two depths. Those at −2 mm are mirror images: five computations with the reference.
const SMALL: &str = "bank --phantom 6.6 --offsets-mm=-2,0,2 --depths-mm 4.6,6.6 --probe-depth-mm 3 --laterals-mm=-6:6:2 --mesh-mm 2";
const COMPUTATIONS: usize = 5;

/// What `SMALL` leaves behind where its bank cannot be written: all of its computations.
fn part() -> &'static str {
    static PART: OnceLock<String> = OnceLock::new();
    PART.get_or_init(|| {
        let place = Place::new("bank-part");
        // A link that leads into no folder is no file that is there, and none can be written.
        std::os::unix::fs::symlink("nowhere/bank.json", place.at("bank.json")).unwrap();
        let output = place.run(&format!("{SMALL} --out bank.json"));
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let part = place.read("bank.json.part");
        assert_eq!(part.lines().count(), 1 + COMPUTATIONS);
        part
    })
}

/// The bank of `SMALL` by the library, on one thread.
fn expected() -> &'static Bank {
    static BANK: OnceLock<Bank> = OnceLock::new();
    BANK.get_or_init(|| {
        let laterals = [-6e-3, -4e-3, -2e-3, 0.0, 2e-3, 4e-3, 6e-3];
        let phantom = Phantom::builtin("6.6").unwrap();
        let mut plan = BankPlan::new(phantom, 3e-3, &laterals).unwrap();
        plan.positions = vec![-2e-3, 0.0, 2e-3];
        plan.depths = vec![4.6e-3, 6.6e-3];
        plan.mesh_size = 2e-3;
        plan.bank().unwrap()
    })
}

fn run(place: &Place, threads: usize, line: &str) -> Output {
    let mut command = place.palpate(line);
    command.env("RAYON_NUM_THREADS", threads.to_string());
    command.output().unwrap()
}

// Verifies: CLI-178, CLI-177.
#[test]
fn a_bank_at_finite_strain_says_how_long_it_takes_and_has_its_law() {
    let place = Place::new("bank-finite");
    let line = "bank --phantom 6.6 --strain finite --offsets-mm=0,2 --depths-mm 6.6 --probe-depth-mm 2 --laterals-mm=-2:2:2 --mesh-mm 2";
    let output = run(&place, 2, &format!("{line} --out bank.json"));
    assert!(output.status.success(), "{output:?}");
    let told = text(&output.stderr)
        .strip_prefix("palpate: note: 3 maps of 3 poses at finite strain take some ");
    let told = told.and_then(|told| told.strip_suffix(" s of processor time\n"));
    // Nine poses on some 700 nodes.
    let seconds: f64 = told.expect("a time").parse().unwrap();
    assert!((0.1..1.0).contains(&seconds), "{seconds}");
    let bank = Bank::from_json(&place.read("bank.json"), "bank.json").unwrap();
    let has_law = |map: &ForceMap| map.certificate().unwrap().law.is_some();
    assert!(has_law(bank.reference()) && bank.maps().iter().all(has_law));
}

// Verifies: CLI-154, CLI-159, CLI-007.
#[test]
fn the_bank_is_that_of_the_library_with_any_number_of_threads() {
    let place = Place::new("bank-threads");
    for threads in [1, 2] {
        let file = format!("bank-{threads}.json");
        let output = run(&place, threads, &format!("{SMALL} --out {file}"));
        assert!(output.status.success(), "{output:?}");
        assert_eq!(text(&output.stderr), "");
        assert_eq!(place.read(&file), expected().to_json());
        assert!(!place.at(&format!("{file}.part")).exists());
    }
    let [_, _, diameters, moduli] = expected().axes();
    // Those of the paper's inclusion.
    assert_eq!((&diameters[..], &moduli[..]), (&[6.4e-3][..], &[1.2e6][..]));
}

// Verifies: CLI-154.
#[test]
fn diameters_and_moduli_are_in_mm_and_kpa() {
    let place = Place::new("bank-axes");
    place.succeed(
        "bank --phantom 6.6 --offsets-mm 0 --depths-mm 6.6 --diameters-mm 4,6 --stiffnesses-kpa 44.1:300.1:256 \
         --probe-depth-mm 2 --laterals-mm 0,2 --mesh-mm 3 --contact vertical-gap --out bank.json",
    );
    let bank = Bank::read(&place.at("bank.json")).unwrap();
    let [positions, depths, diameters, moduli] = bank.axes();
    assert_eq!((&positions[..], &depths[..]), (&[0.0][..], &[6.6e-3][..]));
    assert_eq!(diameters, &[4e-3, 6e-3]);
    assert_eq!(moduli, &[44_100.0, 300_100.0]);
    assert_eq!(bank.depth(), 2e-3);
    assert_eq!(bank.reference().table().laterals(), [0.0, 2e-3]);
    let certificate = bank.maps()[0].certificate().unwrap();
    assert_eq!(certificate.mesh_size, 3e-3);
    assert_eq!(certificate.contact, "vertical-gap");
}

/// The first `lines` of what was kept, and `more` bytes of the next.
fn cut(lines: usize, more: usize) -> String {
    let whole: String = part().split_inclusive('\n').take(lines).collect();
    let rest = &part()[whole.len()..];
    whole + &rest[..more]
}

// Verifies: CLI-156, CLI-159.
#[test]
fn a_bank_that_was_stopped_goes_on_and_is_the_same() {
    let header = cut(1, 0);
    for (kept, taken) in [
        (part().to_string(), 5),
        (cut(4, 0), 3),
        // Killed in the middle of a line, at its end, and while the first was written.
        (cut(3, 1000), 2),
        (cut(3, 0).trim_end().to_string(), 1),
        (header.clone(), 0),
        (header[..300].to_string(), 0),
        (String::new(), 0),
    ] {
        let place = Place::new("bank-resume");
        place.write("bank.json.part", &kept);
        let output = run(&place, 2, &format!("{SMALL} --out bank.json"));
        assert!(output.status.success(), "{output:?}");
        let note = match taken {
            0 => String::new(),
            _ => format!("palpate: note: bank.json.part: {taken} of 5 maps already computed\n"),
        };
        assert_eq!(text(&output.stderr), note);
        assert_eq!(place.read("bank.json"), expected().to_json());
        assert!(!place.at("bank.json.part").exists());
    }
    // Nothing is lost by beginning another one where none was finished.
    let place = Place::new("bank-begun");
    place.write("bank.json.part", header.replace("0.003", "0.002"));
    assert_eq!(place.succeed(&format!("{SMALL} --out bank.json")), "");
    assert_eq!(place.read("bank.json"), expected().to_json());
}

/// A computation with the next number, from 0 again after the last.
fn renumbered(line: &str) -> String {
    let (number, maps) = line.split_once(",\"maps\"").unwrap();
    let number: usize = number.rsplit(':').next().unwrap().parse().unwrap();
    format!(
        "{{\"number\":{},\"maps\"{maps}",
        (number + 1) % COMPUTATIONS
    )
}

// Verifies: CLI-157.
#[test]
fn what_was_kept_of_another_bank_is_refused_and_stays() {
    let place = Place::new("bank-other");
    let other = "bank.json.part: belongs to a different request or version; finish that run or delete the file";
    let none = "bank.json.part: is no journal of 'palpate bank'; choose another file";
    let version = env!("CARGO_PKG_VERSION");
    let missing = "bank.json.part:2: column 2: number is missing";
    let wrong =
        "bank.json.part:2: this line is not a map of this bank; delete the file and run again";
    let replaced = |from: &str, to: &str| part().replacen(from, to, 1);
    let (mesh, arithmetic) = ("\"mesh_size_m\":0.002", "arithmetic\":\"");
    let lines: Vec<&str> = part().lines().collect();
    let with = |line: &str| format!("{}\n{line}\n{}\n", lines[0], lines[1]);
    for (kept, expected) in [
        (replaced(mesh, "\"mesh_size_m\":0.003"), other),
        (replaced(version, "9.9.9"), other),
        (replaced(arithmetic, "arithmetic\":\"not "), other),
        ("notes of mine".into(), none),
        ("notes\nof mine\n".into(), none),
        (with("{}"), missing),
        (with("{\"number\":9,\"maps\":[]}"), wrong),
        (with("{\"number\":0,\"maps\":[]}"), wrong),
        // The maps of one computation under the number of another.
        (with(&renumbered(lines[1])), wrong),
    ] {
        place.write("bank.json.part", &kept);
        let found = place.refused(&format!("{SMALL} --out bank.json"));
        assert_has(&found, expected);
        assert_eq!(place.read("bank.json.part"), kept);
        assert!(!place.at("bank.json").exists());
    }
    place.write("bank.json.part", part());
    let held = File::open(place.at("bank.json.part")).unwrap();
    held.lock().unwrap();
    let found = place.refused(&format!("{SMALL} --out bank.json"));
    assert_has(&found, "another 'palpate bank' is writing this file");
}

// Verifies: CLI-235.
#[test]
fn what_comes_to_the_place_of_a_bank_meanwhile_stays() {
    let place = Place::new("bank-meanwhile");
    let phantom = Phantom::builtin("6.6").unwrap().to_toml();
    let line = SMALL.replace("--phantom 6.6", "--phantom 6.6.toml") + " --out bank.json";
    let told = place.refused_meanwhile(&line, ["6.6.toml", &phantom], || {
        place.write("bank.json", "mine")
    });
    let there = "palpate: write bank.json: it is there by now; choose another name\n";
    assert_eq!((&*told, &*place.read("bank.json")), (there, "mine"));
    // No map is lost.
    fs::remove_file(place.at("6.6.toml")).unwrap();
    place.write("6.6.toml", phantom);
    fs::remove_file(place.at("bank.json")).unwrap();
    let output = place.run(&line);
    let note = "palpate: note: bank.json.part: 5 of 5 maps already computed\n";
    assert_eq!(text(&output.stderr), note);
    assert_eq!(place.read("bank.json"), expected().to_json());
}

// Verifies: CLI-155, BNK-020, BNK-021.
#[test]
fn what_makes_no_bank_is_refused_in_one_line() {
    let place = Place::new("bank-refused");
    place.write("there.json", "{}");
    let two = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/phantoms/two.toml");
    fs::copy(two, place.at("two.toml")).unwrap();
    // Its first inclusion alone, as an ellipse.
    let text = place.read("two.toml");
    let parts: Vec<&str> = text.split("[[inclusion]]").collect();
    let probe = parts[2].split_once("[probe]").unwrap().1;
    let ellipse = parts[1].replace("diameter_mm = 5.0", "width_mm = 5.0\nheight_mm = 4.0");
    let ellipse = format!("{}[[inclusion]]{ellipse}[probe]{probe}", parts[0]);
    place.write("ellipse.toml", ellipse);
    let small = SMALL.replace('=', " ");
    let small: Vec<&str> = small.split_whitespace().collect();
    place.refuses("bank", |arguments| {
        // An option counts once: those of `SMALL` that the case has are dropped.
        let has = |option: &str| arguments.split_whitespace().any(|word| word == option);
        let usual = small[1..].chunks(2).filter(|pair| !has(pair[0]));
        [
            &small[..1],
            &usual.collect::<Vec<_>>().concat(),
            &[arguments],
        ]
        .concat()
        .join(" ")
    });
    assert!(!place.at("b.json").exists() && !place.at("b.json.part").exists());
    assert_eq!(place.read("there.json"), "{}");
}

// Verifies: CLI-015.
#[test]
fn the_worst_strain_is_told_once_with_its_inclusion() {
    let place = Place::new("bank-strain");
    let output = place.run(
        "bank --phantom 2.6 --offsets-mm 0 --depths-mm 2.6,3 --probe-depth-mm 4 --laterals-mm 0,2 --mesh-mm 1 --out bank.json",
    );
    assert!(output.status.success(), "{output:?}");
    let bank = Bank::read(&place.at("bank.json")).unwrap();
    let det = |map: &ForceMap| map.certificate().unwrap().smallest_det.det;
    let dets: Vec<f64> = bank.maps().iter().map(det).collect();
    // Both are strained too much, and the second more.
    assert!(dets[1] < dets[0] && dets[0] < 0.2, "{dets:?}");
    let words = format!(
        "palpate: warning: phantom 2.6 with its inclusion at 0.0 mm, 3.0 mm deep, 6.4 mm wide, 1200.0 kPa: det(I + grad u) falls to {:.3} ",
        dets[1]
    );
    let told = text(&output.stderr);
    assert!(told.starts_with(&words), "{told}");
    assert_eq!(told.lines().count(), 1);
}
