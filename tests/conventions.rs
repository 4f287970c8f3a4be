//! The conventions of `spec/README.md`: units, axes and signs.

use std::collections::BTreeSet;
use std::process::Command;

use palpate::fem::mesh::Region;
use palpate::fem::{Contact, Model, Pose, PoseSolution};
use palpate::phantom::Phantom;

/// The mesh size, m. Points of the surface are at most as far apart.
const SIZE: f64 = 1e-3;

fn model(phantom: &Phantom) -> Model {
    Model::new(phantom, SIZE, Contact::default()).unwrap()
}

fn solve(model: &Model, depth: f64, lateral: f64) -> PoseSolution {
    model.solve(Pose { depth, lateral }).unwrap()
}

fn builtin(name: &str) -> Phantom {
    Phantom::builtin(name).unwrap()
}

fn help(arguments: &[&str]) -> String {
    let mut command = Command::new(crate::program::PROGRAM);
    let output = command.args(arguments).arg("--help").output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// Units in which the names of options and keys may end.
const UNITS: [&str; 7] = ["mm", "mm-s", "kpa", "us", "ms", "n", "s"];

/// Options whose value is no quantity, has no unit, or is in SI.
const NO_OTHER_UNIT: &str = "\
    allowed-misses allowed-run bank columns condition confidence-percent config contact correlation criterion cycles \
    device figure format friction from gel-uncertainty hand inclusion journal junit known layer map max-false-alarm max-force max-miss \
    model noise note observer only out path percentile phantom pid prior prior-h1 pvd rate-hz record records reference reference-sweep \
    relaxation replay tremor-hz samples seconds seed serial shard simulations skip-rows soak strain study subject sure trials uncertainty-out vectors vid vtu";

// Verifies: CON-002.
#[test]
fn options_and_keys_that_are_not_in_si_say_their_unit() {
    let list = help(&[]);
    let commands = list
        .split("Commands:")
        .nth(1)
        .unwrap()
        .lines()
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|name| !name.is_empty() && *name != "help");
    let mut options = BTreeSet::new();
    for command in commands {
        for line in help(&[command]).lines() {
            let named = line.trim().strip_prefix("--");
            let named = named.and_then(|option| option.split_once(" <"));
            options.extend(named.map(|(name, _)| name.trim_end_matches("...").to_string()));
        }
    }
    assert!(options.len() > 40, "{options:?}");
    let unit = |name: &str| UNITS.iter().any(|unit| name.ends_with(&format!("-{unit}")));
    let bare = options.iter().filter(|name| !unit(name));
    let known = |name: &&String| NO_OTHER_UNIT.split(' ').any(|known| known == *name);
    let unexpected: Vec<_> = bare.filter(|name| !known(name)).collect();
    assert_eq!(unexpected, [""; 0], "in which unit are these?");

    // Of the numbers of a phantom file, Poisson's ratio alone has no unit.
    let file = builtin("2.6").to_toml();
    let keys = file.lines().filter_map(|line| line.split_once(" = "));
    let numbers = keys.filter(|(_, value)| value.parse::<f64>().is_ok());
    let keys: BTreeSet<&str> = numbers.map(|(key, _)| key).collect();
    let with_unit = keys
        .iter()
        .filter(|key| key.ends_with("_mm") || key.ends_with("_kpa"));
    assert_eq!(with_unit.count(), keys.len() - 1, "{keys:?}");
    assert!(keys.contains("poisson_ratio") && keys.len() > 6, "{keys:?}");
}

// Verifies: CON-003.
#[test]
fn the_axes_are_those_of_the_specification() {
    let phantom = builtin("4.6");
    let model = model(&phantom);
    let mesh = model.mesh();
    // The outer surface is y = 0, and everything else below it.
    let at_surface = mesh.nodes.iter().filter(|at| at[1] == 0.0).count();
    assert_eq!(at_surface, mesh.surface.len());
    assert!(mesh.surface.iter().all(|&node| mesh.nodes[node][1] == 0.0));
    assert!(mesh.nodes.iter().all(|at| at[1] <= 0.0));
    // The disc lies around x = 0.
    let disc = mesh.elements().zip(&mesh.regions);
    let disc = disc.filter(|(_, region)| **region == Region::Inclusion(0));
    let x: Vec<f64> = disc
        .flat_map(|(nodes, _)| mesh.positions(nodes))
        .map(|position| position[0])
        .collect();
    let (least, most) = (
        x.iter().copied().fold(0.0, f64::min),
        x.iter().copied().fold(0.0, f64::max),
    );
    let [left, right, ..] = phantom.inclusions()[0].extent();
    // Two nodes on the circle are less than 0.5 mm apart; the outermost lies within half of that of the disc's end, and
    // within its radius less (0.25²/2 · 3.2) mm.
    assert!(least >= left - 1e-15 && least < left + 0.01e-3, "{least}");
    assert!(most <= right + 1e-15 && most > right - 0.01e-3, "{most}");
    // At lateral position x the lowest point of the gel lies there, at depth d: the circle rises by h²/2R at a point
    // that is h away from its lowest one.
    let (depth, lateral) = (2e-3, 4e-3);
    let solution = solve(&model, depth, lateral);
    let moved = &model.surface().positions;
    let deformed = moved
        .iter()
        .zip(&solution.contact().expect("small strain").displacements);
    let deformed = deformed.map(|(at, u)| [at[0] + u[0], at[1] + u[1]]);
    let lowest = deformed.min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    assert!((lowest[0] - lateral).abs() < SIZE, "{lowest:?}");
    let rise = SIZE * SIZE / (2.0 * phantom.probe().radius);
    assert!((lowest[1] + depth).abs() < rise, "{lowest:?}");
    assert_eq!(solve(&model, 0.0, lateral).force.normal, 0.0);
}

// Verifies: CON-004.
#[test]
fn forces_on_the_probe_point_out_of_the_gel_and_away_from_the_inclusion() {
    let [none, inclusion] = ["none", "2.6"].map(|name| model(&builtin(name)));
    for (lateral, side) in [(3e-3, 1.0), (-3e-3, -1.0)] {
        let [none, inclusion] = [&none, &inclusion].map(|model| solve(model, 2e-3, lateral));
        assert!(none.force.normal > 0.1, "{none:?}");
        assert!(inclusion.force.normal > none.force.normal);
        // Beside the hard disc the probe is pushed away from it.
        let pushed = side * (inclusion.force.lateral - none.force.lateral);
        assert!(pushed > 1e-3, "{pushed}");
    }
}

// Verifies: CON-004.
#[test]
fn a_probe_twice_as_long_has_twice_the_force() {
    let force = |length: f64| {
        let phantom = builtin("4.6").changed(|parts| parts.probe.length = length);
        let solution = solve(&model(&phantom.unwrap()), 2e-3, 3e-3);
        [solution.force.normal, solution.force.lateral]
    };
    let (once, twice) = (force(0.015), force(0.030));
    for (once, twice) in once.into_iter().zip(twice) {
        // Newton's method ends within 1e-9 N.
        assert!((twice - 2.0 * once).abs() < 2e-9, "{once} {twice}");
        assert!(once.abs() > 1e-3, "{once}");
    }
}
