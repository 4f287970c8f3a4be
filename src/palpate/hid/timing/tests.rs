//! What a timing counts. No assertion is about the speed of this machine.

use super::*;
use crate::hid::PositionReport;
use crate::hid::simulated::Defect;
use crate::hid::tests::{MS, limits, probing, table};

fn timing(
    cycles: u64,
    budget: Duration,
    faults: Vec<(Duration, Defect)>,
) -> Result<Timing, Refusal> {
    let device = probing(10_000 * MS, faults);
    measure(
        device,
        table(0.0),
        limits(),
        cycles,
        Budget::of(budget),
        None,
    )
}

// Verifies: HID-060, HID-062.
#[test]
fn a_budget_that_nothing_keeps_is_broken_and_one_that_all_keep_is_not() {
    let broken = timing(3000, Duration::ZERO, vec![]).unwrap().judged;
    assert_eq!((broken.misses, broken.longest_run), (3000, 3000));
    assert_eq!(broken.outcome, BudgetOutcome::Broken);
    let kept = timing(3000, Duration::from_secs(3600), vec![]).unwrap();
    assert_eq!((kept.judged.cycles, kept.judged.misses), (3000, 0));
    assert_eq!(kept.judged.outcome, BudgetOutcome::Kept);
    assert!(kept.compute_share > 0.0 && kept.compute_share < 1.0);
    assert!(kept.judged.response_us.p50 >= kept.compute_us.p50);
}

// Verifies: HID-060.
#[test]
fn a_paced_device_counts_how_late_it_was() {
    let late = Cell::default();
    let mut clock = HostClock {
        device: probing(Duration::ZERO, vec![]),
        began: Instant::now() - 20 * MS,
        period: Some(MS),
        due: Duration::ZERO,
        late: &late,
    };
    clock.read(MS).unwrap();
    assert!(late.get() >= 19 * MS);
    // What is lost is not made up for: the next is due after the waiting ended.
    let ended = clock.began.elapsed();
    assert!(clock.due >= 19 * MS && clock.due <= ended, "{ended:?}");
}

// Verifies: HID-060.
#[test]
fn the_time_in_which_a_paced_device_moves_counts() {
    let [late, of_device] = [Cell::default(), Cell::default()];
    let began = Instant::now();
    // Its report comes 5 ms after the beginning, but was due after 1 ms.
    let device = HostClock {
        device: probing(Duration::ZERO, vec![]),
        began,
        period: Some(5 * MS),
        due: Duration::ZERO,
        late: &of_device,
    };
    let mut clock = HostClock {
        device,
        began,
        period: Some(MS),
        due: Duration::ZERO,
        late: &late,
    };
    clock.read(MS).unwrap();
    assert!(late.get() >= 4 * MS, "{late:?}");
}

// Verifies: HID-060.
#[test]
fn a_timing_that_ends_early_is_an_error() {
    let told = |timing: Result<Timing, Refusal>| timing.unwrap_err().to_string();
    assert_eq!(
        timing(2995, Duration::ZERO, vec![]).unwrap().judged.cycles,
        2995
    );
    let few = told(timing(2994, Duration::ZERO, vec![]));
    let expected =
        "2994 cycles are too few; measure at least 2995 for this percentile and confidence";
    assert_eq!(few, expected);
    let unplug = (300 * MS, Defect::Unplug);
    let ended = told(timing(3000, Duration::ZERO, vec![unplug]));
    assert_eq!(ended, "after 299 cycles: stopped: the device is gone");
}

// Verifies: HID-060.
#[test]
fn the_round_trip_ends_with_the_report_that_says_played() {
    let budget = Duration::from_micros(9);
    let mut times = Times::new(Budget::of(budget), Some(Duration::from_millis(1)));
    let mut record = |at: u64, sequence, force_sequence, late| {
        let [woke, received, computed, written] =
            [0, 3, 4, 9].map(|more| Duration::from_micros(at + more));
        let cycle = Cycle {
            position: Some(PositionReport {
                force_sequence,
                ..PositionReport::default()
            }),
            force: ForceReport {
                sequence,
                ..ForceReport::default()
            },
            playing: true,
            woke,
            received,
            computed,
            written,
        };
        times.record(&cycle, Duration::from_micros(late));
        times.timing().unwrap()
    };
    // Reports 1 and 2 are answered after 991 and 1991 µs, 2 is said twice, and 200 and 67 were never sent: 67 has the
    // place of 3, which is not answered yet.
    record(0, 1, 200, 0);
    record(1000, 2, 1, 0);
    record(3000, 3, 2, 0);
    record(4000, 4, 2, 0);
    let timing = record(5000, 5, 67, 0);
    // Histograms keep three digits.
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-3;
    let round_trip = timing.round_trip_us.unwrap();
    let (first, last) = (round_trip.p50, round_trip.max);
    assert!(near(first, 991.0) && near(last, 1991.0), "{round_trip:?}");
    assert!(near(timing.write_us.max, 5.0) && near(timing.compute_us.max, 1.0));
    assert!(near(timing.judged.response_us.p99, 9.0));
    // The wait for the next cycle that ended late is a part of the response.
    let late = record(6000, 6, 200, 1);
    assert_eq!((timing.judged.misses, late.judged.misses), (0, 1));
    assert!(near(late.judged.response_us.max, 10.0));
    // One of the five intervals was 2 ms instead of 1.
    let jitter = late.judged.jitter_us.unwrap();
    assert!(jitter.p50 == 0.0 && near(jitter.max, 1000.0), "{jitter:?}");
    assert_eq!(times.others[2].times.len(), 2);
}
