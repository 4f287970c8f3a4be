//! The evidence that the program can give of itself (`palpate verify`).

pub mod build;
mod check;
#[cfg(feature = "std")]
pub mod supply;

pub mod statistics;

pub use check::{Check, Figure};
