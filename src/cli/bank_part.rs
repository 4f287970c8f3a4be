//! What is finished of a bank, in a file that grows by a line with each computation, so that one that was stopped goes on.
//!
//! The first line is what was asked for, each other one a number and the maps: 0 for the reference, then one for each solve.

use std::fs::{File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::CliError;
use super::output::note;
use crate::bank::BankPlan;
use crate::fem::arithmetic;
use crate::force_map::{ForceMap, parse};
use crate::phantom::Phantom;
use crate::refusal::Refusal;

/// How the first line of every such file begins.
const BEGINNING: &str = "{\"schema\":\"palpate-bank-part\"";

/// All that the maps of a bank depend on, lengths and moduli in SI.
#[derive(Debug, Serialize)]
pub struct PartRequest<'a> {
    schema: &'static str,
    schema_version: u64,
    program_version: &'static str,
    arithmetic: &'static str,
    phantom: &'a Phantom,
    offsets_m: &'a [f64],
    depths_m: &'a [f64],
    diameters_m: &'a [f64],
    youngs_moduli_pa: &'a [f64],
    probe_depth_m: f64,
    laterals_m: &'a [f64],
    mesh_size_m: f64,
    contact: &'static str,
}

/// One computation.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Finished<M> {
    number: usize,
    maps: M,
}

/// The maps of each computation that is finished.
pub type Taken = Vec<Option<Vec<ForceMap>>>;

/// The open file.
#[derive(Debug)]
pub struct Part {
    path: PathBuf,
    file: Mutex<File>,
}

impl<'a> PartRequest<'a> {
    pub fn new(
        phantom: &'a Phantom,
        plan: &'a BankPlan,
        probe_depth_m: f64,
        laterals_m: &'a [f64],
    ) -> PartRequest<'a> {
        PartRequest {
            schema: "palpate-bank-part",
            schema_version: 1,
            program_version: env!("CARGO_PKG_VERSION"),
            arithmetic: arithmetic(),
            phantom,
            offsets_m: &plan.positions,
            depths_m: &plan.depths,
            diameters_m: &plan.diameters,
            youngs_moduli_pa: &plan.moduli,
            probe_depth_m,
            laterals_m,
            mesh_size_m: plan.mesh_size,
            contact: plan.contact.name(),
        }
    }
}

/// A line of JSON.
fn line(document: &impl Serialize) -> String {
    // Keys are strings and a string takes all that is written: nothing here can fail.
    serde_json::to_string(document).unwrap_or_default() + "\n"
}

impl Part {
    /// Opens the file beside `out`, or begins it, and takes over what is finished of `count` computations. `is_right` says whether maps
    /// are those of a number.
    ///
    /// # Errors
    /// A file of another request, of which something is finished, or of something else; one that another process writes; a line that is
    /// no computation of this bank, unless it is the last and was cut off.
    ///
    /// Implements: CLI-156, CLI-157, CLI-167, CLI-169.
    pub fn open(
        out: &Path,
        request: &PartRequest<'_>,
        count: usize,
        is_right: impl Fn(usize, &[ForceMap]) -> bool,
    ) -> Result<(Part, Taken), CliError> {
        let mut name = out.as_os_str().to_owned();
        name.push(".part");
        let path = PathBuf::from(name);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(CliError::file("open", &path))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let reason = "another 'palpate bank' is at work on it, expected one at a time";
            return Err(CliError::refused(path.display())(reason));
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text)
            .map_err(CliError::file("read", &path))?;
        let whole = text.iter().rposition(|&byte| byte == b'\n');
        let (whole, torn) = text.split_at(whole.map_or(0, |last| last + 1));
        let header = line(request);
        let mut finished = vec![None; count];
        let mut length = whole.len();
        match whole.strip_prefix(header.as_bytes()) {
            Some(lines) => {
                let taken = take_over(lines, &mut finished, is_right);
                taken.map_err(|refusal| refusal.in_file(path.display().to_string()))?;
            }
            None if is_only_begun(whole, torn) => length = 0,
            None => {
                let reason = "of another request or version, expected this one: finish that one, or delete the file";
                return Err(CliError::refused(path.display())(reason));
            }
        }
        let begun = file.set_len(length as u64);
        let begun = begun.and_then(|()| file.seek(SeekFrom::End(0)));
        let begun = begun.and_then(|_| match length {
            0 => file.write_all(header.as_bytes()),
            _ => Ok(()),
        });
        begun.map_err(CliError::file("write", &path))?;
        let taken = finished.iter().flatten().count();
        if taken > 0 {
            let text = format!("{taken} of {count} computations taken over");
            note(path.display(), &text);
        }
        let file = Mutex::new(file);
        Ok((Part { path, file }, finished))
    }

    /// Notes a computation, in one piece.
    ///
    /// # Errors
    /// A file that cannot be written; then no part of the line stays.
    ///
    /// Implements: CLI-156.
    pub fn append(&self, number: usize, maps: &[ForceMap]) -> Result<(), CliError> {
        let line = line(&Finished { number, maps });
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let mut write = || {
            let before = file.stream_position()?;
            file.write_all(line.as_bytes()).inspect_err(|_| {
                // What failed first is told.
                let _ = file.set_len(before);
            })
        };
        write().map_err(CliError::file("write", &self.path))
    }

    /// Removes the file.
    ///
    /// # Errors
    /// If the system does not let it.
    pub fn remove(self) -> Result<(), CliError> {
        std::fs::remove_file(&self.path).map_err(CliError::file("remove", &self.path))
    }
}

/// Whether a file of `whole` lines and the beginning of another one is one of ours of which nothing is finished.
fn is_only_begun(whole: &[u8], torn: &[u8]) -> bool {
    let beginning = BEGINNING.as_bytes();
    match whole.iter().filter(|&&byte| byte == b'\n').count() {
        0 => torn.starts_with(beginning) || beginning.starts_with(torn),
        1 => whole.starts_with(beginning),
        _ => false,
    }
}

/// Puts the computations in `lines`, which follow the first, where they belong.
fn take_over(
    lines: &[u8],
    finished: &mut [Option<Vec<ForceMap>>],
    is_right: impl Fn(usize, &[ForceMap]) -> bool,
) -> Result<(), Refusal> {
    for (number, line) in (2..).zip(lines.split_inclusive(|&byte| byte == b'\n')) {
        let wrong = || {
            let found = "no computation of this bank";
            Refusal::state(found, "one: delete the file").at(number)
        };
        let text = std::str::from_utf8(line).map_err(|_| wrong())?;
        let Finished { number, maps } =
            parse::<Finished<Vec<ForceMap>>>(text).map_err(|refusal| refusal.at(number))?;
        match finished.get_mut(number) {
            Some(place) if is_right(number, &maps) => *place = Some(maps),
            _ => return Err(wrong()),
        }
    }
    Ok(())
}
