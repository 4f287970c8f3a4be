//! The evidence that the program can give of itself (`palpate verify`).

mod check;

pub mod statistics;
pub mod traceability;

pub use check::{Check, Figure};
