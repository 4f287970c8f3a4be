//! The normal law, the laws of squares and counts, and the arithmetic under them, without `std` and without allocation.
//!
//! Everything here gives the same bits on every machine: the only transcendental functions are
//! those of `libm`, sums run in an order that the source fixes, and no fused multiply-add is used.

pub mod binomial;
pub mod compensated;
pub mod error;
pub mod noncentral;
pub mod normal;
pub mod random;
pub mod tails;
mod ziggurat;

pub use error::NumericError;

/// The ends of an interval that holds a number with a stated probability.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Bounds {
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}
