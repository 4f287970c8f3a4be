//! Judges another program against the vectors (`spec/oracle.md`, `spec/vectors.md`).
//!
//! | file | content |
//! |---|---|
//! | `text.rs` | messages: the error of a file, and text that is quoted |
//! | `outcome.rs` | the outcome of one case, and the classes of wrong answers |
//! | `tolerance.rs` | how far an answer may be off |
//! | `case.rs` | one case, and the cases of one file |
//! | `file.rs` | a file of vectors, read and checked |
//! | `embedded.rs`, `suite.rs` | the vectors that are part of this program; all files, hashed |
//! | `profile.rs` | the working precision in which a program is judged |
//! | `measure.rs` | what is required of a program, and the list of its known mistakes |
//! | `judge.rs` | one answer, judged against what is expected |
//! | `answers.rs` | the cases that are asked, and which case a line answers |
//! | `partner.rs`, `run.rs` | the program that is asked; all cases asked through a pipe, despite crashes and silence |
//! | `columns.rs`, `offline.rs` | questions and answers in files: a table, or lines of JSON |
//! | `program.rs` | the identity of the program |
//! | `diagnosis.rs` | the bugs that explain wrong answers |
//! | `counts.rs`, `verdict.rs` | the answers that are not right and the columns of counts; the verdict |
//! | `table.rs`, `junit.rs`, `page.rs` | the verdict for people, for CI, and to be signed |

mod answers;
mod case;
mod columns;
mod counts;
mod diagnosis;
mod embedded;
mod file;
mod judge;
mod junit;
mod measure;
mod offline;
mod outcome;
mod page;
mod partner;
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

pub use case::{Bug, BugAnswer, Case, Expected, Group, Question, Wanted};
pub use counts::{Counts, Finding};
pub use diagnosis::{Diagnosis, Explanation, NamedBug};
pub use judge::judge;
pub use junit::junit;
pub use measure::{Measure, Require, read_accepted};
pub use offline::{Form, judge_files, questions};
pub use outcome::{Class, Outcome, Traces, Wrong};
pub use page::page;
pub use profile::Profile;
pub use program::{Program, ProgramFile};
pub use run::{ConformError, Settings, run};
pub use suite::{Choice, Suite, sha256};
pub use table::table;
pub use text::Invalid;
pub use tolerance::{Condition, Tolerance};
pub use verdict::{GroupCounts, Verdict};
