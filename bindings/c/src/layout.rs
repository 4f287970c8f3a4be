//! Where the fields of the structures lie, for the C compiler to assert the same (`tests/layout.rs`).
//!
//! Implements: CLB-007.

use core::mem::offset_of;

// The names of the header, where they are others (`cbindgen.toml`).
use crate::{
    Bounds as Interval, ColouredStatistic as ThetaGamma, NuisanceStatistic as SubspaceStatistic,
    ServoForce as Force, *,
};

/// A structure's name, its size, and the name and offset of each field; what holds addresses is written in words.
pub type Layout = (&'static str, usize, &'static [(&'static str, usize)]);

macro_rules! layout {
    ($($name:ident { $($field:ident),* })*) => {
        /// The structures of the header.
        pub const LAYOUT: &[Layout] = &[
            $((stringify!($name), size_of::<$name>(), &[$((stringify!($field), offset_of!($name, $field))),*])),*
        ];
    };
}

layout! {
    Series { lateral, normal, samples }
    Components { lateral, normal }
    Filter { b, sigma, gamma }
    Statistic { y, theta, gamma }
    ThetaGamma { theta, gamma }
    ColouredEvidence { without, with, distance_without, distance_with }
    SubspaceStatistic { t, gamma, gamma_nominal, residual, theta, rates, rank, degrees }
    ScanMaximum { theta, gamma, shift, refined_shift }
    Evidence { along, gamma_squared }
    SequentialRows { residual, rows, missing, rank }
    Tails { lower, upper }
    Interval { lower, upper }
    Costs { c00, c01, c10, c11 }
    ErrorRates { false_alarm, miss }
    NoiseBudget { gamma, total_allowed_n, remaining_n }
    Force { lateral, normal }
    Cell { index, fraction }
    ServoLimits { force_n, slew_n, release_n, watchdog_cycles }
    ServoState { force, sequence, missed, mode, has_sequence, arming, reserved }
    ServoSample { depth_m, lateral_m, sequence, deadman, device_fault }
    ServoCommand { force, playing, reserved }
    PositionReport { lateral, normal, buttons, status, sequence, force_sequence }
    ForceReport { lateral, normal, sequence, flags }
    Capabilities {
        version, position_unit_nm, force_unit_un, largest_force_mn, period_us, watchdog_ms, damping_mn_s_per_m, friction_mn
    }
}
