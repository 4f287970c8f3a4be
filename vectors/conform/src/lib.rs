//! Another program against the vectors (`spec/oracle.md`, `spec/vectors.md`).
//!
//! | file | content |
//! |---|---|
//! | `embedded.rs` | the vectors that are part of this program |
//! | `suite.rs` | files of vectors, read and hashed |
//! | `case.rs` | one case, as it stands in a file |
//! | `check.rs` | whether a file is what it should be |
//! | `tolerance.rs` | how far an answer may be off |
//! | `partner.rs` | the program that is asked |
//! | `run.rs` | all cases asked, in a pipeline, through crashes and silence |
//! | `judge.rs` | one answer against what was expected |
//! | `verdict.rs` | what came out, as counts, likely bugs and failures |
//! | `junit.rs`, `table.rs` | the verdict for CI and for people |

mod case;
mod check;
mod embedded;
mod judge;
mod junit;
mod partner;
mod run;
mod suite;
mod table;
#[cfg(test)]
mod tests;
mod tolerance;
mod verdict;

pub use case::{Case, Expected, Question};
pub use judge::judge;
pub use junit::junit;
pub use run::{ConformError, Settings, run};
pub use suite::Suite;
pub use table::table;
pub use tolerance::Tolerance;
pub use verdict::{Count, Outcome, Verdict};
