//! What a timing counts. No assertion is about the speed of this machine.

use super::*;
use crate::hid::simulated::Defect;
use crate::hid::tests::{limits, probing, with_table};

fn timing(
    cycles: u64,
    budget: Duration,
    faults: Vec<(Duration, Defect)>,
) -> Result<Timing, Refusal> {
    let device = probing(Duration::from_secs(10), faults);
    with_table(0.0, |table| {
        measure(device, table, limits(), cycles, budget, None)
    })
}

// Verifies: HID-060, HID-062.
#[test]
fn a_budget_that_nothing_keeps_is_broken_and_one_that_all_keep_is_not() {
    let broken = timing(1000, Duration::ZERO, vec![]).unwrap();
    assert_eq!((broken.misses, broken.passed), (1000, false));
    let kept = timing(1000, Duration::from_secs(3600), vec![]).unwrap();
    assert_eq!((kept.cycles, kept.misses, kept.passed), (1000, 0, true));
    assert!(kept.compute_share > 0.0 && kept.compute_share < 1.0);
    assert!(kept.response_us.p50 >= kept.compute_us.p50);
}

// Verifies: HID-062.
#[test]
fn one_cycle_in_a_thousand_may_miss() {
    let times = Times::new().unwrap();
    let of = |misses| {
        let times = Times {
            misses,
            ..Times::new().unwrap()
        };
        times
            .timing(2000, Duration::from_millis(1), false)
            .unwrap()
            .passed
    };
    assert!(of(2) && !of(3));
    assert_eq!(times.timing(0, Duration::ZERO, false), None);
}

// Verifies: HID-061.
#[test]
fn a_paced_device_counts_how_late_it_was() {
    let short = Duration::from_millis(1);
    let device = probing(Duration::ZERO, vec![]);
    let mut clock = HostClock::new(device, Some(short));
    clock.began -= 20 * short;
    clock.read(short).unwrap();
    assert!(clock.late() >= 19 * short);
    // What is lost is not made up for: the next is due after this one ended.
    let ended = short + clock.late();
    assert!(clock.due > ended - short && clock.due <= ended, "{clock:?}");
}

// Verifies: HID-060.
#[test]
fn a_timing_that_ends_early_is_an_error() {
    let told = |timing: Result<Timing, Refusal>| timing.unwrap_err().to_string();
    let few = told(timing(999, Duration::ZERO, vec![]));
    assert_eq!(few, "999 cycles, expected at least 1000 for a p99.9");
    let unplug = (Duration::from_millis(300), Defect::Unplug);
    let ended = told(timing(1000, Duration::ZERO, vec![unplug]));
    assert_eq!(ended, "after 299 cycles: stopped: the device is gone");
}

// Verifies: HID-063.
#[test]
fn the_round_trip_ends_with_the_report_that_says_played() {
    let report = |force_sequence| crate::hid::PositionReport {
        lateral: 0,
        normal: 0,
        buttons: 0,
        status: 0,
        sequence: 0,
        force_sequence,
    };
    let cycle = |at: u64, sequence, played| {
        let time = |more| Duration::from_micros(at + more);
        Cycle {
            position: Some(report(played)),
            force: ForceReport {
                lateral: 0,
                normal: 0,
                sequence,
                flags: 1,
            },
            playing: true,
            woke: time(0),
            received: time(3),
            computed: time(4),
            written: time(9),
        }
    };
    let mut times = Times::new().unwrap();
    // Reports 1 and 2 are answered after 991 and 1991 µs, 2 is said twice, and 200 and 67 were never sent: 67 has the
    // place of 3, which is not answered yet.
    for (at, sequence, played) in [
        (0, 1, 200),
        (1000, 2, 1),
        (3000, 3, 2),
        (4000, 4, 2),
        (5000, 5, 67),
    ] {
        times.record(
            &cycle(at, sequence, played),
            Duration::ZERO,
            Duration::from_micros(9),
        );
    }
    let timing = times.timing(5, Duration::from_micros(9), true).unwrap();
    assert_eq!((timing.misses, times.round_trip.len()), (0, 2));
    // Histograms keep three digits.
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-3;
    let round_trip = timing.round_trip_us.unwrap();
    assert!(
        near(round_trip.p50, 991.0) && near(round_trip.max, 1991.0),
        "{round_trip:?}"
    );
    assert!(near(timing.write_us.max, 5.0) && near(timing.compute_us.max, 1.0));
    assert!(near(timing.response_us.p99, 9.0));
    // The wait for the next cycle that ended late is a part of the response.
    let budget = Duration::from_micros(9);
    times.record(&cycle(6000, 6, 200), Duration::from_micros(1), budget);
    let timing = times.timing(6, budget, true).unwrap();
    assert_eq!(timing.misses, 1);
    assert!(near(timing.response_us.max, 10.0));
}
