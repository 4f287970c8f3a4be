//! Evidence row by row while the record is taken, and Wald's test of it.
//!
//! Implements: CLB-003, CLB-010.

use core::ops::Range;

use palpate_core::detect::Decision;
pub use palpate_core::detect::sequential::Evidence;
use palpate_core::detect::sequential::{self, Sequential, Wald};

use crate::Error;
use crate::memory::{Kept, bytes, check_apart, give, list, list_mut};

/// What `palpate_sequential_init` makes of the caller's memory, to which it keeps a pointer. Its content is the library's.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PreparedSequential {
    kept: Kept,
}

const TAG: usize = 0x5e90_e47a;

/// The detector, and where its memory lies.
type Detector<'a> = (Sequential<&'a mut [f64]>, Range<usize>);

/// The detector at an address.
///
/// # Safety
/// As the crate says; its memory is where it was when the detector was made.
unsafe fn detector<'a>(place: *const PreparedSequential) -> Result<&'a Detector<'a>, Error> {
    unsafe { Kept::get(place.cast(), TAG) }
}

/// How many numbers a detector of so many hypotheses beside so many nuisances needs.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_sequential_memory(hypotheses: usize, nuisances: usize) -> usize {
    sequential::memory(hypotheses, nuisances)
}

/// Makes a detector before its first row. It keeps a pointer to the `length` numbers of `memory`, as many as `palpate_sequential_memory`
/// says: they must stay where they are, unchanged by others, as long as it is used. A copy of the detector is no second one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_sequential_init(
    hypotheses: usize,
    nuisances: usize,
    memory: *mut f64,
    length: usize,
    detector: *mut PreparedSequential,
) -> Error {
    let make = || {
        let place = bytes(memory, length);
        check_apart(&[place.clone(), bytes(detector, 1)], &[])?;
        let memory = unsafe { list_mut(memory, length) }?;
        let made = Sequential::new(memory, hypotheses, nuisances)?;
        let kept = Kept::new::<Detector>(TAG, (made, place));
        Ok(PreparedSequential { kept })
    };
    unsafe { give(detector, make) }
}

/// Adds a row: one sample of one channel over the standard deviation of its noise. `residual` is F_p − F_0, NaN if it is missing;
/// `nuisances` what each adds for an amplitude of 1; `signals` F_k − F_0 of each hypothesis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_sequential_push(
    detector: *mut PreparedSequential,
    residual: f64,
    nuisances: *const f64,
    nuisance_count: usize,
    signals: *const f64,
    signal_count: usize,
) -> Error {
    let push = || {
        let row = [
            bytes(nuisances, nuisance_count),
            bytes(signals, signal_count),
        ];
        check_apart(&[bytes(detector, 1)], &row)?;
        let (found, memory) = unsafe { Kept::get_mut::<Detector>(detector.cast(), TAG) }?;
        check_apart(core::slice::from_ref(memory), &row)?;
        let nuisances = unsafe { list(nuisances, nuisance_count) }?;
        let signals = unsafe { list(signals, signal_count) }?;
        Ok(found.push(residual, nuisances, signals)?)
    };
    push().err().unwrap_or(Error::Ok)
}

/// What the rows so far say of each hypothesis, into `evidence`, a list of `count` that overlaps nothing. θ is along − gamma_squared/2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_sequential_evidence(
    prepared: *const PreparedSequential,
    evidence: *mut Evidence,
    count: usize,
) -> Error {
    let write = || {
        let (found, memory) = unsafe { detector(prepared) }?;
        check_apart(
            &[bytes(evidence, count)],
            &[bytes(prepared, 1), memory.clone()],
        )?;
        if count != found.evidence().count() {
            return Err(Error::Length);
        }
        let list = unsafe { list_mut(evidence, count) }?;
        list.iter_mut()
            .zip(found.evidence())
            .for_each(|(place, found)| *place = found);
        Ok(())
    };
    write().err().unwrap_or(Error::Ok)
}

/// What all hypotheses have in common.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SequentialRows {
    /// Σ of the squares that the nuisances do not explain.
    pub residual: f64,
    /// The rows so far, without the missing ones.
    pub rows: usize,
    /// The rows that were missing.
    pub missing: usize,
    /// How many nuisances the rows tell apart.
    pub rank: usize,
}

/// Counts the rows so far.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_sequential_rows(
    prepared: *const PreparedSequential,
    rows: *mut SequentialRows,
) -> Error {
    let found = || {
        let (found, _) = unsafe { detector(prepared) }?;
        Ok(SequentialRows {
            residual: found.residual(),
            rows: found.rows(),
            missing: found.missing(),
            rank: found.rank(),
        })
    };
    unsafe { give(rows, found) }
}

/// Wald's test with at most these rates of false alarms and of misses: 1 for an inclusion, −1 for none, 0 while it goes on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_wald(
    max_false_alarm: f64,
    max_miss: f64,
    theta: f64,
    decision: *mut i8,
) -> Error {
    let decide = || {
        Ok(match Wald::new(max_false_alarm, max_miss)?.decide(theta)? {
            Some(Decision::Inclusion) => 1,
            Some(Decision::NoInclusion) => -1,
            None => 0,
        })
    };
    unsafe { give(decision, decide) }
}
