//! Inclusion probing after Yan, Scott and Fearing (1999): the force on a rigid probe that presses
//! into a gel, the decision whether a hard inclusion lies in it, and its playback to a hand.
//!
//! The modules follow the paper:
//!
//! | paper | module |
//! |---|---|
//! | §2 signal detection | [`detect`], on the normal law in [`stats`] |
//! | §3 phantoms | [`phantom`] |
//! | §3.1 finite elements | [`fem`] |
//! | §3, §4 force tables | [`force_map`] |
//! | a recorded sweep against two of them | [`trace`] |
//! | §4 playback: from a table to a force | [`servo`] |
//! | §4 playback: reports of the device | [`hid`] |
//! | §4 pairs of samples, felt and judged; §5 what the answers say | [`psychophysics`] |
//! | figures, tables | [`report`] |
//! | other implementations: questions and answers | `oracle`, `conform` |
//!
//! Lengths are metres, forces newtons, moduli pascals throughout; `spec/README.md` has the signs.
//!
//! With `default-features = false` the crate is `no_std`, does not allocate, and depends on `libm`
//! alone: that part holds [`stats`], [`detect`], [`servo`] and the reports of [`hid`].
#![cfg_attr(not(any(feature = "std", feature = "verify")), no_std)]

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
mod conform;
#[cfg(feature = "std")]
pub mod csv;
pub mod detect;
#[cfg(feature = "fem")]
pub mod fem;
#[cfg(feature = "std")]
pub mod force_map;
pub mod hid;
#[cfg(feature = "oracle")]
pub mod oracle;
#[cfg(feature = "std")]
pub mod phantom;
#[cfg(feature = "std")]
pub mod psychophysics;
#[cfg(feature = "report")]
pub mod report;
pub mod servo;
pub mod stats;
#[cfg(feature = "std")]
pub mod trace;
#[cfg(feature = "verify")]
pub mod verify;
