//! What the entries for records add to the core: counts and codes.

use std::mem::MaybeUninit;

use palpate_c::{Error, NuisanceStatistic, palpate_theta_nuisances};

// Verifies: CLB-003.
#[test]
fn a_length_beyond_all_memory_is_refused() {
    let mut number = [0.0];
    let start = number.as_mut_ptr();
    let half = usize::MAX / 2 + 1;
    for (samples, count) in [
        (half, 2),
        (2, half),
        (1 << 33, 1 << 31),
        (usize::MAX, usize::MAX),
    ] {
        let mut found = MaybeUninit::uninit();
        // SAFETY: nothing is read of lists whose length is refused.
        let error = unsafe {
            palpate_theta_nuisances(
                start,
                start,
                samples,
                start,
                count,
                1,
                0.0,
                0.0,
                found.as_mut_ptr(),
            )
        };
        assert_eq!(error, Error::Length, "{samples} {count}");
    }
}

/// The statistic of a record of six samples beside these nuisances, in noise of standard deviation 1.
fn statistic(mut nuisances: Vec<f64>) -> NuisanceStatistic {
    let (mut residual, mut template) = (
        [5.0, 4.0, 8.0, 8.0, 4.0, 5.0],
        [0.0, 0.0, 3.0, 3.0, 0.0, 0.0],
    );
    let (count, mut found) = (nuisances.len() / 6, MaybeUninit::uninit());
    // SAFETY: all lists are as long as stated, and none overlaps another.
    unsafe {
        let error = palpate_theta_nuisances(
            residual.as_mut_ptr(),
            template.as_mut_ptr(),
            6,
            nuisances.as_mut_ptr(),
            count,
            1,
            0.0,
            0.0,
            found.as_mut_ptr(),
        );
        assert_eq!(error, Error::Ok);
        found.assume_init()
    }
}

// Verifies: CLB-003, NUI-001, NUI-003.
#[test]
fn a_nuisance_that_comes_twice_counts_once() {
    let offset = [1.0; 6];
    for nuisances in [
        offset.to_vec(),
        [offset, offset].concat(),
        [offset, offset.map(|one| -7.0 * one), offset].concat(),
    ] {
        let found = statistic(nuisances);
        // Six samples less the offset and the inclusion.
        assert_eq!((found.rank, found.degrees), (1, 4));
        // Without the mean the template is (−1, −1, 2, 2, −1, −1), of which γ² = 12; the record less its mean of 17/3 has Δᵀr = 14.
        let gamma = f64::sqrt(12.0);
        for (found, expected) in [
            (found.gamma, gamma),
            (found.gamma_nominal, f64::sqrt(18.0)),
            (found.t, 14.0 / gamma),
            (found.theta, 14.0 - 6.0),
            // Σr² = 210 − 6 (17/3)², of which the template explains 14²/12.
            (found.residual, 210.0 - 289.0 / 1.5 - 196.0 / 12.0),
        ] {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
