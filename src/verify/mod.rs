//! The evidence that the program can give of itself (`palpate verify`).

mod check;

pub mod statistics;

pub use check::{Check, Figure};
