//! The proved core of palpate: what decides and what moves a hand, without `std`, without allocation, and on `libm` alone.
//!
//! It goes into the C library and onto a microcontroller, and `proofs/` covers it: 3,200 lines of code. Read it in this order:
//!
//! | module | content | paper |
//! |---|---|---|
//! | [`force`] | a lateral and a normal component | |
//! | [`stats`] | the normal law, the laws of squares and counts, random numbers, and the arithmetic under them | |
//! | [`detect`] | the matched filter, Θ, thresholds and error rates | §2 |
//! | [`servo`] | from a force table to a force command, once a millisecond | §4 |
//! | [`hid`] | the reports of a haptic device, and their units | §4 |
//!
//! Lengths are metres, forces newtons throughout. The library `palpate` exports these modules under the same names.
#![cfg_attr(not(test), no_std)]

pub mod detect;
pub mod force;
pub mod hid;
pub mod servo;
pub mod stats;
