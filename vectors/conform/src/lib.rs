//! Another program against the vectors (`spec/oracle.md`, `spec/vectors.md`).
//!
//! | file | content |
//! |---|---|
//! | `embedded.rs` | the vectors that are part of this program |
//! | `suite.rs` | files of vectors, read and hashed |
//! | `case.rs` | one case, as it stands in a file |
//! | `check.rs` | whether a file is what it should be |
//! | `profile.rs` | the working precision in which a program is judged |
//! | `tolerance.rs` | how far an answer may be off |
//! | `plan.rs` | which cases are asked |
//! | `partner.rs` | the program that is asked |
//! | `run.rs` | all cases asked, in a pipeline, through crashes and silence |
//! | `offline.rs`, `columns.rs` | questions and answers in files: lines of JSON, or a table |
//! | `answers.rs` | which case a line answers |
//! | `judge.rs` | one answer against what was expected |
//! | `accepted.rs` | the list of known mistakes |
//! | `diagnosis.rs` | which bugs explain wrong answers |
//! | `program.rs` | which program it is |
//! | `verdict.rs` | what came out |
//! | `table.rs`, `junit.rs`, `page.rs` | the verdict for people, for CI and to be signed |
//! | `text.rs` | text that is quoted |

mod accepted;
mod answers;
mod case;
mod check;
mod columns;
mod diagnosis;
mod embedded;
mod judge;
mod junit;
mod offline;
mod page;
mod partner;
mod plan;
mod profile;
mod program;
mod run;
mod suite;
mod table;
#[cfg(test)]
mod tests;
mod text;
mod tolerance;
mod verdict;

pub use accepted::{Accepted, read_accepted};
pub use answers::judge_lines;
pub use case::{BugAnswer, Case, Expected, Question, Wanted};
pub use diagnosis::{Diagnosis, Explanation, NamedBug};
pub use judge::judge;
pub use junit::junit;
pub use offline::{Form, judge_files, questions};
pub use page::page;
pub use profile::Profile;
pub use run::{ConformError, Settings, run};
pub use suite::{Bug, Choice, Group, Invalid, Suite, Unknown, sha256};
pub use table::table;
pub use tolerance::{Condition, Tolerance};
pub use verdict::{
    Class, Count, Finding, Measure, Outcome, Program, ProgramFile, Require, Traces, Verdict, Wrong,
};
