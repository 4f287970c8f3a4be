//! How much the tests find: what became of the planted defects whose places were drawn by seed (`spec/verification-plan.md`).

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::json;

/// What the run of the ledger wrote, without its list of defects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Planted {
    /// The commit whose tests were tried, and whether the sources differed from it.
    pub commit: String,
    /// The confidence of the intervals.
    pub confidence: f64,
    /// The power on all drawn defects, by part of the project, and by class of defect.
    pub power: Vec<Power>,
}

/// The share of some defects that tests find.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Power {
    /// Which defects: `all`, a part or a class.
    pub of: String,
    /// How many they are.
    pub defects: u64,
    /// How many of them any test finds.
    pub found: u64,
    /// How many of these the tests of their own module find.
    pub by_own: u64,
    /// The interval of Clopper and Pearson for the share that any test finds.
    pub lower: f64,
    /// Its upper end.
    pub upper: f64,
}

impl Power {
    /// The share that any test finds.
    pub fn share(&self) -> f64 {
        self.found as f64 / self.defects as f64
    }
}

impl Planted {
    /// Reads `target/ledger.json`.
    ///
    /// # Errors
    /// A line that names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Planted, String> {
        json(path)
    }
}
