//! Logs of other loops.

use super::*;
use crate::hid::timing::BudgetOutcome;
use palpate_asserts::assert_cases;

const MS: Duration = Duration::from_millis(1);

fn judged(text: &str) -> Judged {
    judge_log(text, Budget::new(MS, 50.0, 60.0).unwrap()).unwrap()
}

// Verifies: CLI-173.
#[test]
fn durations_and_time_stamps_are_read_in_every_unit() {
    // 0.5, 1.5 and 0.25 ms, as durations and as times that begin anywhere.
    let same = [
        "duration_us\n500\n1500\n250\n",
        "duration_ns\n500000\n1500000\n250000\n",
        "number;duration_ms\n1;0,5\n2;1,5\n3;0,25\n",
        "time_s,duration_s\n7,0.0005\n9,0.0015\n8,0.00025\n",
        "time_ms\n10\n10.5\n12\n12.25\n",
        "{\"time_us\": 10000}\n{\"time_us\": 10500}\n\n{\"time_us\": 12000, \"note\": 1}\n{\"time_us\": 12250}\n",
        "{\"duration_s\": 5e-4}\n{\"duration_s\": 1.5e-3}\n{\"duration_s\": 2.5e-4}",
    ];
    for text in same {
        let judged = judged(text);
        assert_eq!((judged.cycles, judged.misses), (3, 1), "{text}");
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-3;
        let response = judged.response_us;
        let holds = near(response.p50, 500.0) && near(response.max, 1500.0);
        assert!(holds, "{text}");
        assert_eq!(judged.jitter_us.is_some(), text.contains("12"), "{text}");
        // From the period, 0.5 ms.
        let largest = judged.jitter_us.map_or(1000.0, |jitter| jitter.max);
        assert!(near(largest, 1000.0), "{text}");
    }
}

// Verifies: CLI-173.
#[test]
fn unix_times_are_judged_where_their_resolution_does_not_decide() {
    let stamps = |from: u64, step: u64| {
        let rows = (0..50).map(|cycle| format!("{}\n", from + step * cycle));
        format!("time_ns\n{}", rows.collect::<String>())
    };
    for (step, misses) in [(900_000, 0), (1_100_000, 49)] {
        for from in [0, 1_700_000_000_000_000_000] {
            let judged = judged(&stamps(from, step));
            assert_eq!(
                (judged.cycles, judged.misses),
                (49, misses),
                "{from} {step}"
            );
        }
    }
    assert_eq!(judged(&stamps(0, 1_000_000)).misses, 0);
}

// Verifies: CLI-173.
#[test]
fn what_is_no_log_is_refused_with_its_line() {
    let refused = |text: &str| judge_log(text, Budget::of(MS)).unwrap_err().to_string();
    assert_cases("refused/timing_log.txt", "logs", refused);
}

// Verifies: HID-064, CLI-173.
#[test]
fn few_cycles_decide_nothing() {
    let judged = judge_log("duration_us\n1\n1\n", Budget::of(MS)).unwrap();
    assert_eq!(
        (judged.outcome, judged.at_most_us),
        (BudgetOutcome::Undecided, None)
    );
}
