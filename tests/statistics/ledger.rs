//! The ledger of the battery's errors: α and power of every check.

/// One row of `ledger.csv`.
pub struct Row {
    /// The check.
    pub name: &'static str,
    /// The largest probability that it fails for a detector without defect.
    pub alpha: f64,
    /// Its number of trials.
    pub trials: usize,
    /// The probability that it fails for each defect it is meant for.
    pub powers: Vec<(&'static str, f64)>,
}

fn rows() -> impl Iterator<Item = Row> {
    include_str!("ledger.csv").lines().skip(1).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        let [name, alpha, trials, powers] = fields[..] else {
            panic!("ledger: {line}")
        };
        let powers = powers
            .split(';')
            .map(|power| power.split_once('=').expect("defect=power"))
            .map(|(defect, power)| (defect, power.parse().expect("a power")))
            .collect();
        Row {
            name,
            alpha: alpha.parse().unwrap(),
            trials: trials.parse().unwrap(),
            powers,
        }
    })
}

/// The row of a check.
pub fn row(name: &str) -> Row {
    rows()
        .find(|row| row.name == name)
        .unwrap_or_else(|| panic!("{name} is not in the ledger"))
}

/// Runs a check on a detector without defect, and `REPLICATES` times with every defect that the
/// ledger names for it.
///
/// `rejects(defect, replicate, row)` draws a sample with that defect ("" for none) and tests it.
pub fn run(name: &str, rejects: impl Fn(&str, u64, &Row) -> bool) {
    /// A power of 0.999 or more misses one of three with probability 0.003 at most; seeds are
    /// fixed.
    const REPLICATES: u64 = 3;
    let row = row(name);
    assert!(
        !rejects("", 0, &row),
        "{name} rejects the detector at α = {:e}",
        row.alpha
    );
    // A lesser power is stated in the ledger, but three replicates cannot tell it from none.
    for (defect, _) in row.powers.iter().filter(|(_, power)| *power >= 0.999) {
        for replicate in 1..=REPLICATES {
            assert!(
                rejects(defect, replicate, &row),
                "{name} does not see {defect}"
            );
        }
    }
}

#[test]
fn all_alphas_add_up_to_one_in_a_million_at_most() {
    let total: f64 = rows().map(|row| row.alpha).sum();
    assert!(total <= 1e-6, "the battery's α is {total:e}");
}

#[test]
fn every_row_is_a_check_that_runs_and_every_named_defect_is_seen() {
    let source = [
        include_str!("bounds.rs"),
        include_str!("colour.rs"),
        include_str!("gaussian.rs"),
        include_str!("generator.rs"),
    ]
    .concat();
    for row in rows() {
        assert!(
            source.contains(&format!("\"{}\"", row.name)),
            "{} is not run",
            row.name
        );
        assert!(
            row.powers.iter().any(|(_, power)| *power >= 0.999),
            "{} sees nothing",
            row.name
        );
    }
    // DESIGN §8.
    for defect in [
        "variance_off_1_percent",
        "half_left_out",
        "template_shifted",
        "channels_swapped",
        "sd_for_variance",
    ] {
        let sees = |row: &Row| {
            row.powers
                .iter()
                .any(|(name, power)| *name == defect && *power >= 0.999)
        };
        assert!(rows().any(|row| sees(&row)), "no check sees {defect}");
    }
}
