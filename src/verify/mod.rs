//! Evidence that a stranger can produce again: what `palpate verify` runs.

pub mod statistics;
