//! Monte Carlo of the detector against its laws. Seeds are fixed, so nothing here is flaky; with
//! `PALPATE_SEED=<number>` the same battery runs on fresh seeds, and fails by chance with at most
//! the probability that `ledger.csv` adds up to.
//!
//! Every check has a row in the ledger: its α, its number of trials, and its power against named
//! defects. Each defect also runs as a negative control, which the check must reject as often as
//! the ledger says.

mod bounds;
mod checks;
mod colour;
mod gaussian;
mod generator;
mod ledger;

/// The seed of every generator in the battery.
fn seed() -> u64 {
    std::env::var("PALPATE_SEED")
        .ok()
        .and_then(|seed| seed.parse().ok())
        .unwrap_or(20_261_121)
}
