//! Entries of the C library: every pointer that C can pass by mistake and that can be told from a right one.

// SAFETY, of the whole file: each pointer is null, unaligned, or points to a value of its type that nothing else uses.
#![allow(unsafe_code)]

use core::ptr;

use bolero::{Driver, TypeGenerator};
use palpate_c::{Error, PositionReport, palpate_decide, palpate_position_report_decode};
use palpate_core::detect;

use crate::decision::Compared;
use crate::report::Bytes;

/// What is wrong with a call's pointers.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mistake {
    None,
    NoBytes,
    NoPlace,
    UnalignedPlace,
}

impl TypeGenerator for Mistake {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        Some(match driver.gen_variant(8, 0)? {
            1 => Mistake::NoBytes,
            2 => Mistake::NoPlace,
            3 => Mistake::UnalignedPlace,
            _ => Mistake::None,
        })
    }
}

// Verifies: CLB-003, CLB-014.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(66), kani::solver(cadical))]
fn decoding_from_c_is_refused_or_right() {
    harness!((Bytes, Mistake), |case| {
        let (bytes, mistake) = case;
        let bytes = &bytes.bytes[..bytes.length];
        let start = match mistake {
            Mistake::NoBytes => ptr::null(),
            _ => bytes.as_ptr(),
        };
        let before = PositionReport {
            lateral: 1,
            normal: 2,
            buttons: 3,
            status: 4,
            sequence: 5,
            force_sequence: 6,
        };
        let mut report = before;
        let place = match mistake {
            Mistake::NoPlace => ptr::null_mut(),
            Mistake::UnalignedPlace => (&raw mut report).wrapping_byte_add(1),
            _ => &raw mut report,
        };
        let error = unsafe { palpate_position_report_decode(start, bytes.len(), place) };
        let right = match mistake {
            Mistake::NoPlace => Err(Error::NullPointer),
            Mistake::UnalignedPlace => Err(Error::Unaligned),
            Mistake::NoBytes if !bytes.is_empty() => Err(Error::NullPointer),
            _ => PositionReport::decode(bytes).map_err(|_| Error::Report),
        };
        assert!(error == right.err().unwrap_or(Error::Ok));
        assert!(report == right.unwrap_or(before));
        reached! {
            "a report": right.is_ok(),
            "bytes that are no report": right == Err(Error::Report),
            "no bytes": *mistake == Mistake::NoBytes,
            "no place": *mistake == Mistake::NoPlace,
            "an unaligned place": *mistake == Mistake::UnalignedPlace,
        }
    });
}

// Verifies: CLB-003, CLB-014.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical))]
fn deciding_from_c_is_refused_or_right() {
    harness!((Compared, bool), |case| {
        let (&Compared { theta, eta }, without_place) = (&case.0, case.1);
        let mut inclusion = 7;
        let place = match without_place {
            true => ptr::null_mut(),
            false => &raw mut inclusion,
        };
        let error = unsafe { palpate_decide(theta, eta, place) };
        let decided = detect::decide(theta, eta);
        if without_place {
            assert!(error == Error::NullPointer && inclusion == 7);
        } else if let Ok(decision) = decided {
            let found = decision == detect::Decision::Inclusion;
            assert!(error == Error::Ok && inclusion == u8::from(found));
        } else {
            assert!(error != Error::Ok && inclusion == 7);
        }
        reached! {
            "a decision": decided.is_ok() && !without_place,
            "no place": without_place,
        }
    });
}
