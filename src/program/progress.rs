//! What is told of long work.

use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::{note, shows_progress, tell};
use palpate::fem::{FemError, Mesh};
use palpate::phantom::{Phantom, Strain};

/// A mesh of so many nodes takes a while: five times those of the paper's phantoms.
const MANY_NODES: f64 = 50_000.0;

/// Says on standard error, before it is made, that a mesh will be large.
///
/// Implements: CLI-017.
pub fn tell_large_mesh(phantom: &Phantom, size: f64) -> Result<(), FemError> {
    let nodes = Mesh::expected_nodes(phantom, size)?;
    if nodes > MANY_NODES {
        tell(&format!(
            "phantom {}: a mesh of about {nodes:.0} nodes, where the paper's phantoms have 10000: a pose may take minutes",
            phantom.name()
        ));
    }
    Ok(())
}

/// Processor time of a pose at finite strain over the nodes of the mesh, s: 0.25 s with 7000 nodes.
const TIME_PER_NODE: f64 = 3.5e-5;

/// Says on standard error how long so many maps of so many poses will take at finite strain, before they are computed.
///
/// Implements: CLI-178.
pub fn tell_time(phantom: &Phantom, size: f64, [maps, poses]: [usize; 2]) -> Result<(), FemError> {
    if phantom.strain() == Strain::Finite {
        let seconds = TIME_PER_NODE * Mesh::expected_nodes(phantom, size)? * (maps * poses) as f64;
        let time = match seconds {
            0.0..120.0 => format!("{seconds:.1} s"),
            _ => format!("{:.0} minutes", seconds / 60.0),
        };
        tell(&format!(
            "{maps} maps of {poses} poses at finite strain take some {time} of processor time"
        ));
    }
    Ok(())
}

/// The bar of a computation that goes on with `done` of `total` pieces, which a note on `file` tells.
pub fn resumed_bar(file: &Path, done: usize, total: usize, what: &str) -> ProgressBar {
    if done > 0 {
        let text = format!("{done} of {total} {what} already computed");
        note(file.display(), &text);
    }
    let bar = bar(total, what);
    bar.inc(done as u64);
    // The estimate of the time left counts this run alone.
    bar.reset_eta();
    bar
}

/// A bar on standard error that counts `total` pieces of `what`; hidden where standard error is no
/// terminal.
///
/// Implements: CLI-006, CLI-224.
pub fn bar(total: usize, what: &str) -> ProgressBar {
    // The template is a constant: a mistake in it would show in every run.
    let style = ProgressStyle::with_template("{msg} [{bar:30}] {pos}/{len} {eta}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    let target = if shows_progress() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    ProgressBar::with_draw_target(Some(total as u64), target)
        .with_style(style.progress_chars("=> "))
        .with_message(what.to_string())
}
