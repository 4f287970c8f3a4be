//! `palpate-conform` against programs that answer rightly, wrongly, late, or not at all: `spec/oracle.md`.

#[path = "../../../../tests/witness/present.rs"]
mod present;

mod asking;
mod diagnosis;
mod files;
mod judging;
mod program;
mod suite;
