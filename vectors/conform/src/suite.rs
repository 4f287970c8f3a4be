//! Files of vectors, read and hashed.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use serde::Deserialize;
use sha2::Digest;

use super::case::{Case, Group};
use super::embedded;
use super::file;
use super::text::{Invalid, ensure, read};

/// Which cases are asked; all if nothing is chosen.
#[derive(Debug, Clone, Default, PartialEq, Eq, clap::Args)]
pub struct Choice {
    /// Asks only this group; may be given several times
    #[arg(long, value_name = "GROUP")]
    pub only: Vec<String>,
    /// Asks only this case; may be given several times
    #[arg(long, value_name = "ID")]
    pub case: Vec<String>,
    /// Leaves out this group or case; may be given several times
    #[arg(long, value_name = "NAME")]
    pub skip: Vec<String>,
}

/// All groups of vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// One group for each file, in the order of the file names.
    pub groups: Vec<Group>,
    /// The SHA-256 of the whole, as VEC-007 defines it.
    pub sha256: String,
}

/// The manifest, of which only the hashes are read.
#[derive(Deserialize)]
struct Manifest {
    suite_sha256: String,
    files: Vec<ManifestFile>,
}

#[derive(Deserialize)]
struct ManifestFile {
    name: String,
    sha256: String,
}

const MANIFEST: &str = "manifest.json";
const SCHEMA: &str = "schema.json";

impl Suite {
    /// The vectors that are part of this program.
    ///
    /// # Errors
    /// Never, as long as the tests pass.
    ///
    /// Implements: ORA-040.
    pub fn embedded() -> Result<Suite, Invalid> {
        let files = embedded::FILES
            .iter()
            .map(|(name, text)| (name.to_string(), text.to_string()));
        Suite::of_files(files.collect())
    }

    /// The vectors in a folder: every `.json` file except the manifest and files that end in `.data.json`.
    ///
    /// # Errors
    /// A file that cannot be read or is not valid; a folder without vectors.
    ///
    /// Implements: ORA-040, ORA-041.
    pub fn read(folder: &Path) -> Result<Suite, Invalid> {
        let failed = |cause| Invalid::new(folder.display(), cause);
        let mut files = BTreeMap::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.ends_with(".json") && !name.ends_with(".data.json") {
                files.insert(name.into_owned(), read(&path)?);
            }
        }
        if !files.keys().any(|name| name != MANIFEST && name != SCHEMA) {
            let message = "no vectors (*.json) in this folder";
            return Err(Invalid::new(folder.display(), message));
        }
        Suite::of_files(files)
    }

    /// The suite of files by name.
    ///
    /// # Errors
    /// As [`Suite::read`].
    ///
    /// Implements: VEC-001, VEC-007.
    pub fn of_files(mut files: BTreeMap<String, String>) -> Result<Suite, Invalid> {
        let manifest = files.remove(MANIFEST);
        let sums: BTreeMap<&str, String> = files
            .iter()
            .map(|(name, text)| (&name[..], sha256(text)))
            .collect();
        let lines = sums.iter().map(|(name, sum)| format!("{sum}  {name}\n"));
        let suite_sha256 = sha256(lines.collect::<String>());
        if let Some(text) = manifest {
            check_manifest(&text, &sums, &suite_sha256)?;
        }
        let (mut groups, mut names, mut ids) = (Vec::new(), HashSet::new(), HashSet::new());
        for (name, text) in files.iter().filter(|(name, _)| *name != SCHEMA) {
            let mut read = || {
                let group = file::group(text)?;
                let is_new = names.insert(group.name.clone());
                ensure!(is_new, "the group {:?} is in another file too", group.name);
                for Case { id, .. } in &group.cases {
                    ensure!(ids.insert(id.clone()), "the id {id:?} is used twice");
                }
                Ok(group)
            };
            groups.push(read().map_err(|message| Invalid::new(name, message))?);
        }
        Ok(Suite {
            groups,
            sha256: suite_sha256,
        })
    }

    /// What is chosen. The hash remains that of the whole.
    ///
    /// # Errors
    /// A group or case that does not exist.
    ///
    /// Implements: ORA-040.
    pub fn select(mut self, choice: &Choice) -> Result<Suite, String> {
        let names: Vec<&str> = self.groups.iter().map(|group| &group.name[..]).collect();
        for name in &choice.only {
            ensure!(
                names.contains(&&name[..]),
                "no group {name:?} in these vectors; choose one of {}",
                names.join(", ")
            );
        }
        let skipped = choice.skip.iter();
        let skipped_cases = skipped.filter(|name| !names.contains(&&name[..]));
        for name in choice.case.iter().chain(skipped_cases) {
            ensure!(
                self.has(name),
                "no case {name:?} in these vectors; the cases have names such as two_afc-001"
            );
        }
        self.groups
            .retain(|group| choice.only.is_empty() || choice.only.contains(&group.name));
        Ok(self.part(|case| choice.case.is_empty() || choice.case.contains(&case.id)))
    }

    /// The part with these cases.
    pub(super) fn part(mut self, is_in: impl Fn(&Case) -> bool) -> Suite {
        for group in &mut self.groups {
            group.cases.retain(&is_in);
        }
        self.groups.retain(|group| !group.cases.is_empty());
        self
    }

    /// Each case in order, with the line of its request.
    pub fn requests(&self) -> impl Iterator<Item = (&Case, String)> {
        self.groups.iter().flat_map(|group| {
            let cases = group.cases.iter();
            cases.map(|case| (case, case.line(&group.op)))
        })
    }

    /// Whether there is a case of this name.
    pub fn has(&self, id: &str) -> bool {
        let mut groups = self.groups.iter();
        groups.any(|group| group.cases.iter().any(|case| case.id == id))
    }

    /// The number of cases.
    pub fn cases(&self) -> usize {
        self.groups.iter().map(|group| group.cases.len()).sum()
    }
}

/// The SHA-256 of bytes, in hexadecimal.
pub fn sha256(bytes: impl AsRef<[u8]>) -> String {
    let digest = sha2::Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Checks the hashes of all files and of the suite.
///
/// Implements: VEC-007.
fn check_manifest(
    text: &str,
    sums: &BTreeMap<&str, String>,
    suite_sha256: &str,
) -> Result<(), Invalid> {
    let manifest: Manifest =
        serde_json::from_str(text).map_err(|cause| Invalid::new(MANIFEST, cause))?;
    let files = manifest.files.iter();
    let listed: BTreeMap<_, _> = files.map(|file| (&file.name[..], &file.sha256)).collect();
    for &name in sums.keys().chain(listed.keys()) {
        let message = match (sums.get(name), listed.get(name)) {
            (Some(sum), Some(listed)) if sum == *listed => continue,
            (Some(sum), Some(listed)) => {
                format!("has the SHA-256 {sum}, but {MANIFEST} states {listed}")
            }
            (Some(_), None) => format!("is not in {MANIFEST}"),
            (None, _) => format!("is in {MANIFEST}, but does not exist"),
        };
        return Err(Invalid::new(name, message));
    }
    let stated = manifest.suite_sha256;
    if stated != suite_sha256 {
        let message = format!("suite_sha256 is {stated}, but should be {suite_sha256}");
        return Err(Invalid::new(MANIFEST, message));
    }
    Ok(())
}
