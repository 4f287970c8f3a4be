//! The kernel and the reports allocate nothing.
#![cfg(not(any(kani, fuzzing)))]

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use palpate_core::force::Force;
use palpate_core::hid::{ForceReport, PAPER, PositionReport, Units};
use palpate_core::servo::{Axis, Input, Limits, Mode, Request, State, Table, step};

/// Counts the allocations within `assert_no_alloc`, for each thread by itself.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// A number that depends on the cycle, by the multiplicative method (Knuth, volume 2).
fn scrambled(cycle: u32) -> u32 {
    cycle.wrapping_mul(2_654_435_761)
}

/// From the bytes of a report to the bytes of the next; the count of cycles in which force played.
fn play(cycles: u32) -> u32 {
    let knots = [0.0, 0.004, 0.03];
    let reciprocals = [
        Axis::reciprocal_width(knots[0], knots[1]),
        Axis::reciprocal_width(knots[1], knots[2]),
    ];
    let axis = Axis::new(&knots, &reciprocals).unwrap();
    let forces: [Force<f32>; 9] =
        core::array::from_fn(|index| Force::new(index as f32 * -0.25, index as f32));
    let table = Table::new(axis, axis, &forces).unwrap();
    let limits = Limits::new(2.0, 0.01, 0.125, 5).unwrap();
    let units = Units::new(&PAPER).unwrap();
    let (mut state, mut played, mut sequence) = (State::default(), 0, 0u16);
    for cycle in 0..cycles {
        let random = scrambled(cycle);
        let [a, b, c, d] = random.to_le_bytes();
        let [e, f] = sequence.to_le_bytes();
        // Force comes only while the deadman is held, arming only while it is not.
        let deadman = u8::from(cycle % 64 > 32);
        let fault = u8::from(random % 509 == 3);
        let bytes = [1, a, b, c, d | 0x80, deadman, fault, e, f, 0, 0];
        let report = PositionReport::decode(&bytes).unwrap();
        let input = Input {
            sample: (random % 61 != 3).then(|| units.sample(&report)),
            request: match random % 7 {
                0 if state.mode != Mode::Armed => Request::Arm,
                1 if cycle % 4096 == 1 => Request::Disarm,
                _ => Request::None,
            },
        };
        let (next, command) = step(&table, &limits, state, input);
        let sent = units.report(&command, sequence).encode();
        assert!(ForceReport::decode(&sent).is_ok());
        played += u32::from(command.playing && command.force != Force::ZERO);
        state = next;
        // A number is left out now and then, or given twice.
        sequence = sequence.wrapping_add(u16::from(random % 97 != 1) + u16::from(random % 89 == 1));
    }
    played
}

// Verifies: SRV-001.
#[test]
fn a_hundred_thousand_cycles_allocate_nothing() {
    let played = assert_no_alloc(|| play(100_000));
    assert_eq!(violation_count(), 0);
    assert!(played > 10_000, "{played}");
}

// That the allocator would notice.
#[test]
fn an_allocation_is_noticed() {
    let length = assert_no_alloc(|| std::hint::black_box(vec![0u8; 100]).len());
    assert_eq!(length, 100);
    assert!(violation_count() > 0);
}
