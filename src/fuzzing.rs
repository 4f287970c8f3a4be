//! Inner readers of the crate for its own fuzz targets. No part of its interface: anything here may change at any time.

pub use crate::cli::arguments::{Asked, ContactName};
pub use crate::cli::config::Config;
pub use crate::cli::lists::{length, positions};
pub use crate::conform::{Expected, Question, Suite, Tolerance};
pub use crate::phantom::decimal::{format_scaled, parse_scaled};
pub use crate::psychophysics::journal::Journal;
