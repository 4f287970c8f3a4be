use super::*;

#[test]
fn all_alphas_add_up_to_one_in_a_million_at_most() {
    let total = total_alpha();
    assert!(total > 0.0 && total <= 1e-6, "the battery's α is {total:e}");
}

#[test]
fn every_row_is_a_check_and_every_check_has_one_row() {
    let mut rows: Vec<_> = ledger::ROWS.iter().map(|row| row.name).collect();
    let mut checks: Vec<_> = battery().map(|check| check.name).collect();
    rows.sort_unstable();
    checks.sort_unstable();
    assert_eq!(rows, checks);
    assert!(rows.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn every_check_sees_a_defect_and_every_named_defect_is_seen() {
    let shows = |power: f64| power >= SHOWN_POWER;
    for row in ledger::ROWS.iter() {
        let seen = row.powers.iter().any(|&(_, power)| shows(power));
        assert!(seen, "{} sees nothing", row.name);
    }
    for defect in [
        "variance_off_1_percent",
        "half_left_out",
        "template_shifted",
        "channels_swapped",
        "sd_for_variance",
    ] {
        let sees = |row: &Row| {
            let mut powers = row.powers.iter();
            powers.any(|&(name, power)| name == defect && shows(power))
        };
        assert!(ledger::ROWS.iter().any(sees), "no check sees {defect}");
    }
}

#[test]
fn a_check_that_rejects_fails_and_so_does_one_that_sees_nothing_or_cannot_run() {
    let name = "single_mean_h1";
    let failed = |measure| Check { name, measure }.run(7).unwrap_err();
    assert_eq!(
        failed(|_| Ok(Figure::at_most("share", 0.5, 0.25))),
        "check single_mean_h1 rejects the detector at alpha = 2.5e-8, seed 7: share: 0.5 (must be at most 0.25)"
    );
    assert_eq!(
        failed(|_| Err("no".into())),
        "check single_mean_h1 cannot run, seed 7: no"
    );
    let blind = Check {
        name,
        measure: |_| Ok(Figure::told("share", 0.5)),
    };
    assert_eq!(blind.run(7), Ok(()));
    assert_eq!(
        blind.run_negative_controls(7).unwrap_err(),
        "check single_mean_h1 does not see the defect half_left_out, seed 7"
    );
}

#[test]
fn draws_depend_on_the_seed() {
    let check = |seed| {
        let draw = Draw {
            seed,
            defect: "",
            replicate: 0,
            row: &ledger::ROWS[0],
        };
        draw.generator(3).normal(0, 0)
    };
    assert_eq!(check(1), check(1));
    assert_ne!(check(1), check(2));
}

#[test]
fn the_limits_of_a_count_are_the_last_counts_that_the_exact_test_accepts() {
    use palpate::stats::binomial::{at_least, at_most};
    for (n, p, alpha) in [(40, 0.5, 1e-3), (1000, 0.01, 1e-6), (12, 0.9, 0.05)] {
        let accepted: Vec<u64> = (0..=n)
            .filter(|&k| {
                let tails = [at_least(k, n, p), at_most(k, n, p)];
                tails
                    .iter()
                    .all(|tail| tail.as_ref().unwrap() >= &(0.5 * alpha))
            })
            .collect();
        let figure = checks::count_test(3, n, p, alpha).unwrap();
        assert_eq!(figure.at_least, accepted[0] as f64 / n as f64);
        assert_eq!(
            figure.at_most,
            accepted[accepted.len() - 1] as f64 / n as f64
        );
    }
}
