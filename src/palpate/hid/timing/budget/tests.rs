//! Verdicts on counts whose binomial tails are known from elsewhere. No assertion is about the speed of this machine.

use super::*;
use palpate_asserts::{assert_cases, row};

const MS: Duration = Duration::from_millis(1);

/// The outcome of `cycles` of which the first `misses` take longer than the budget.
fn outcome(budget: Budget, cycles: u64, misses: u64) -> BudgetOutcome {
    let mut responses = Responses::new(budget);
    for cycle in 0..cycles {
        let time = if cycle < misses { 2 * MS } else { MS / 2 };
        responses.record(time, None);
    }
    let judged = responses.judged().unwrap();
    assert_eq!((judged.cycles, judged.misses), (cycles, misses));
    assert_eq!(judged.passed, judged.outcome == BudgetOutcome::Kept);
    judged.outcome
}

// Verifies: HID-062, HID-064.
#[test]
fn outcomes_change_where_the_binomial_law_says() {
    let p99_9 = Budget::of(MS);
    let p95 = Budget::new(MS, 95.0, 95.0).unwrap();
    assert_cases("tables/budgets.txt", "outcomes", |case| {
        let [percentile, confidence, cycles, misses] = row(case)[..] else {
            panic!("{case}")
        };
        let budget = Budget::new(MS, percentile, confidence).unwrap();
        format!("{:?}", outcome(budget, cycles as u64, misses as u64))
    });
    assert_eq!(p99_9.least_cycles(), 2995);
    assert_eq!(p95.least_cycles(), 59);
}

// Verifies: HID-062.
#[test]
fn misses_and_runs_that_are_not_allowed_break_a_budget() {
    let with = |allowed_misses, allowed_run| Budget {
        allowed_misses,
        allowed_run,
        ..Budget::of(MS)
    };
    assert_eq!(outcome(with(Some(4), None), 10_000, 4), BudgetOutcome::Kept);
    for budget in [
        with(Some(3), None),
        with(None, Some(3)),
        with(Some(9), Some(3)),
    ] {
        assert_eq!(outcome(budget, 10_000, 4), BudgetOutcome::Broken);
    }
    // Allowed, but the percentile is not kept.
    let generous = with(Some(100), Some(100));
    assert_eq!(outcome(generous, 10_000, 16), BudgetOutcome::Broken);
}

// Verifies: HID-062.
#[test]
fn a_run_ends_with_a_cycle_in_time() {
    let mut responses = Responses::new(Budget::of(MS));
    // A cycle that takes just the budget keeps it.
    for time in [2, 2, 1, 2, 2, 2, 1, 2] {
        responses.record(time * MS, None);
    }
    let judged = responses.judged().unwrap();
    assert_eq!((judged.misses, judged.longest_run), (6, 3));
}

// Verifies: HID-062, HID-064.
#[test]
fn bounds_are_times_of_the_order() {
    let mut responses = Responses::new(Budget::new(MS, 50.0, 95.0).unwrap());
    for microseconds in (1..=20).rev() {
        responses.record(Duration::from_micros(microseconds), None);
    }
    // Of 20 times the 6th and the 15th bound the median: SciPy's binom.cdf(5, 20, 0.5) = 0.0207 and that of 6 is 0.0577.
    let judged = responses.judged().unwrap();
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 2e-3;
    assert!(near(judged.at_least_us.unwrap(), 6.0), "{judged:?}");
    assert!(near(judged.at_most_us.unwrap(), 15.0), "{judged:?}");
    assert!(near(judged.response_us.max, 20.0));
    // Two are too few for a lower bound, and the longest is not rounded.
    let mut few = Responses::new(Budget::new(MS, 50.0, 95.0).unwrap());
    for time in [1_250_001, 2] {
        few.record(Duration::from_nanos(time), None);
    }
    let judged = few.judged().unwrap();
    assert_eq!((judged.at_least_us, judged.at_most_us), (None, None));
    assert_eq!(judged.response_us.max, 1250.001);
    assert_eq!(judged.response_us.p99_9, 1250.001);
}

// Verifies: HID-064, HID-062.
#[test]
fn bounds_agree_with_the_budget_and_the_times() {
    let seconds = |seconds: f64| Duration::from_secs_f64(seconds);
    // No cycle, and each cycle, takes longer; the second is 1 ns beyond the budget.
    for (time, budget) in [(1e-3, 1e-3), (1.000_001e-3, 1e-3), (500.0, 200.0)] {
        let mut responses = Responses::new(Budget::of(seconds(budget)));
        for _ in 0..4000 {
            responses.record(seconds(time), None);
        }
        let judged = responses.judged().unwrap();
        let (least, most) = (judged.at_least_us.unwrap(), judged.at_most_us.unwrap());
        assert!(least <= 1e6 * time && 1e6 * time <= most, "{judged:?}");
        assert!(
            least / time > 0.999e6 && most / time < 1.001e6,
            "{judged:?}"
        );
        match judged.outcome {
            BudgetOutcome::Kept => assert!(most <= judged.budget_us, "{judged:?}"),
            _ => assert!(least >= judged.budget_us, "{judged:?}"),
        }
    }
}

// Verifies: HID-064.
#[test]
fn percents_are_below_100_and_a_bound_is_likelier_right_than_wrong() {
    for wrong in [0.0, 100.0, -1.0, f64::NAN] {
        let refusal = Budget::new(MS, wrong, 95.0).unwrap_err().to_string();
        let holds = refusal.ends_with("but must be above 0 and below 100");
        assert!(holds, "{refusal}");
    }
    for wrong in [49.9, 0.95, 100.0, f64::NAN] {
        let refusal = Budget::new(MS, 99.9, wrong).unwrap_err().to_string();
        let holds = refusal.ends_with("but must be at least 50 and below 100");
        assert!(holds, "{refusal}");
    }
}

// Verifies: HID-062.
#[test]
fn a_budget_is_printed_as_it_was_given() {
    let mut responses = Responses::new(Budget::of(Duration::from_micros(1001)));
    responses.record(MS, None);
    assert_eq!(responses.judged().unwrap().budget_us, 1001.0);
}
