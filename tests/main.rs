//! What the program and the library must do, seen from outside: a file a subject.
//!
//! `NAME_command.rs` runs the program; the others use the library. What needs another program, such as CalculiX or a browser, is skipped
//! with a notice where that is not installed, and fails with `PALPATE_REQUIRE_WITNESSES=1`.

mod accuracy;
mod bank_command;
mod bank_of_the_paper;
mod calibrate_command;
mod command_line;
mod conventions;
mod demo_command;
mod detect_command;
mod detect_errata;
mod detect_laws;
mod detect_simulation;
mod docs;
mod finite_strain;
mod force_map_csv;
mod force_map_json;
mod help;
mod import_command;
mod oracle_command;
mod phantom_file;
mod playback_command;
mod program;
mod psychophysics_command;
mod reach_command;
mod report_page;
mod robust_families;
mod run_command;
mod second_opinion;
mod simulate_command;
mod study_command;
mod vectors_suite;
mod watch_command;
mod witness;

/// The folder of the checkout.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
