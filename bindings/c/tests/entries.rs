//! Entries whose arguments have one type, and flags that are bytes: each against what its words say.

use std::mem::MaybeUninit;
use std::ptr;

use palpate_c::*;

/// What an entry writes where it is asked to.
fn given<T>(entry: impl FnOnce(*mut T) -> Error) -> Result<T, Error> {
    let mut place = MaybeUninit::uninit();
    match entry(place.as_mut_ptr()) {
        // SAFETY: an entry that succeeds has written its result.
        Error::Ok => Ok(unsafe { place.assume_init() }),
        error => Err(error),
    }
}

// η = ln[P(H = 0)(C10 − C00)/(P(H = 1)(C01 − C11))] of the paper's §2.
// Verifies: CLB-010.
#[test]
fn a_prior_is_that_of_an_inclusion() {
    let costs = Costs {
        c00: 0.5,
        c01: 4.5,
        c10: 2.5,
        c11: 1.5,
    };
    // SAFETY: the costs are there.
    let eta = given(|eta| unsafe { palpate_bayes_threshold(0.2, &raw const costs, eta) });
    let expected = f64::ln(0.8 * 2.0 / (0.2 * 3.0));
    assert!((eta.unwrap() - expected).abs() < 4.0 * f64::EPSILON);
}

/// A table of three depths and two positions (m): 1 N more each depth, 8 N more at the second position.
fn with_table<T>(check: impl FnOnce(&PreparedTable) -> T) -> T {
    let (depths, laterals) = ([0.0_f32, 0.125, 0.375], [-0.125_f32, 0.125]);
    let mut forces = Vec::new();
    for depth in [0.0, 1.0, 2.0] {
        forces.extend([0.0, 8.0].map(|more| ServoForce::new(0.0, depth + more)));
    }
    let mut scratch = [0.0; 3];
    // SAFETY: the lists are as long as stated, and stay as long as the table is used.
    let table = given(|table| unsafe {
        palpate_table_init(
            depths.as_ptr(),
            3,
            laterals.as_ptr(),
            2,
            forces.as_ptr(),
            scratch.as_mut_ptr(),
            3,
            table,
        )
    });
    check(&table.unwrap())
}

// Verifies: CLB-010.
#[test]
fn a_table_may_have_more_depths_than_positions() {
    with_table(|table| {
        for (depth, lateral, normal) in
            [(0.125, -0.125, 1.0), (0.25, -0.125, 1.5), (0.375, 0.0, 6.0)]
        {
            // SAFETY: the table is there.
            let force = given(|force| unsafe { palpate_table_force(table, depth, lateral, force) });
            assert_eq!(force.unwrap().normal, normal);
        }
    });
}

// Verifies: CLB-012.
#[test]
fn a_request_that_does_not_exist_disarms() {
    let limits = ServoLimits {
        force_n: 8.0,
        slew_n: 0.5,
        release_n: 0.5,
        watchdog_cycles: 10,
    };
    let armed = ServoState {
        force: ServoForce::ZERO,
        sequence: 7,
        missed: 0,
        mode: ServoMode::Armed as u8,
        has_sequence: 1,
        arming: 0,
        reserved: 0,
    };
    let after = |request: u8| {
        let (mut state, command) = (armed, &mut MaybeUninit::uninit());
        // SAFETY: table, limits and state are there, there is no sample, and there is room for a command.
        let error = with_table(|table| unsafe {
            palpate_step(
                table,
                &raw const limits,
                ptr::null(),
                request,
                &raw mut state,
                command.as_mut_ptr(),
            )
        });
        assert_eq!(error, Error::Ok);
        state.mode
    };
    assert_eq!(after(0), ServoMode::Armed as u8);
    for request in [2, 3, 4, 127, 255] {
        assert_eq!(after(request), ServoMode::Disarmed as u8, "{request}");
    }
}

// Verifies: CLB-003.
#[test]
fn evidence_is_not_written_over_the_memory_that_it_is_of() {
    let mut memory = [0.0_f64; 8];
    let start = memory.as_mut_ptr();
    // SAFETY: the memory is as long as stated, and stays as long as the detector is used.
    let mut detector =
        given(|place| unsafe { palpate_sequential_init(1, 0, start, 8, place) }).unwrap();
    let signal = 2.0;
    for offset in [0, 6] {
        // SAFETY: the place is within the memory, and is refused.
        let error = unsafe {
            let pushed = palpate_sequential_push(
                &raw mut detector,
                3.0,
                ptr::null(),
                0,
                &raw const signal,
                1,
            );
            assert_eq!(pushed, Error::Ok);
            palpate_sequential_evidence(&raw const detector, start.add(offset).cast(), 1)
        };
        assert_eq!(error, Error::Overlap);
    }
}

// 0.5 mN a count, as the device says.
// Verifies: CLB-010.
#[test]
fn the_forces_of_a_command_go_to_their_own_axes() {
    let device = Capabilities {
        version: 1,
        position_unit_nm: 1000,
        force_unit_un: 500,
        largest_force_mn: 8000,
        period_us: 1000,
        watchdog_ms: 15,
        damping_mn_s_per_m: 0,
        friction_mn: 0,
    };
    let command = ServoCommand {
        force: ServoForce::new(0.5, -1.0),
        playing: 1,
        reserved: [0; 3],
    };
    // SAFETY: device and command are there.
    let report = given(|report| unsafe {
        palpate_report_of_command(&raw const device, &raw const command, 9, report)
    });
    let ForceReport {
        lateral,
        normal,
        sequence,
        ..
    } = report.unwrap();
    assert_eq!((lateral, normal, sequence), (1000, -2000, 9));
}
