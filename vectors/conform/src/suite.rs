//! Files of vectors, read and hashed.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;
use sha2::Digest;

use super::case::{Case, CaseText, ToleranceText};
use super::{check, embedded};
use palpate::refusal::Refusal;

/// What a bug is.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bug {
    /// What is wrong.
    pub bug: String,
    /// Where to look.
    pub notes: String,
}

/// The cases of one file.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// The op that is asked; empty for whole lines that every program must refuse.
    pub op: String,
    /// The bugs that its cases can show, by their flags.
    pub flags: BTreeMap<String, Bug>,
    /// The cases.
    pub cases: Vec<Case>,
}

/// All the files.
#[derive(Debug, Clone, PartialEq)]
pub struct Suite {
    /// One a file, in the order of the file names.
    pub groups: Vec<Group>,
    /// The SHA-256 of the whole, as VEC-007 says.
    pub sha256: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GroupText {
    schema: String,
    schema_version: u64,
    group: String,
    op: String,
    source: String,
    generator_version: String,
    tolerance: BTreeMap<String, ToleranceText>,
    flags: BTreeMap<String, Bug>,
    cases: Vec<Box<RawValue>>,
}

/// The manifest, of which only the sums are read.
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

fn error(file: &str, message: impl AsRef<str>) -> Refusal {
    Refusal::state(message.as_ref(), "").in_file(file)
}

impl Suite {
    /// The vectors that are part of this program.
    ///
    /// # Errors
    /// Never, as long as the tests pass.
    ///
    /// Implements: ORA-040.
    pub fn embedded() -> Result<Suite, Refusal> {
        let files = embedded::FILES
            .iter()
            .map(|(name, text)| (name.to_string(), text.to_string()));
        Suite::of_files(files.collect())
    }

    /// The vectors in a folder: every `.json` there but the manifest and what ends in `.data.json`.
    ///
    /// # Errors
    /// A file that cannot be read or is not valid; no file at all.
    ///
    /// Implements: ORA-040, ORA-041.
    pub fn read(folder: &Path) -> Result<Suite, Refusal> {
        let failed = |path: &Path, cause: std::io::Error| {
            error(&path.display().to_string(), cause.to_string())
        };
        let entries = std::fs::read_dir(folder).map_err(|cause| failed(folder, cause))?;
        let mut files = BTreeMap::new();
        for entry in entries {
            let path = entry.map_err(|cause| failed(folder, cause))?.path();
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            if name.ends_with(".json") && !name.ends_with(".data.json") {
                let text = palpate::input::read(&path).map_err(|cause| failed(&path, cause))?;
                files.insert(name, text);
            }
        }
        if !files.keys().any(|name| name != MANIFEST && name != SCHEMA) {
            return Err(error(
                &folder.display().to_string(),
                "no vectors (*.json) in this folder",
            ));
        }
        Suite::of_files(files)
    }

    /// The suite of files by name.
    ///
    /// # Errors
    /// As [`Suite::read`].
    ///
    /// Implements: VEC-002, VEC-007.
    pub fn of_files(mut files: BTreeMap<String, String>) -> Result<Suite, Refusal> {
        let manifest = files.remove(MANIFEST);
        let mut lines = String::new();
        let mut sums = BTreeMap::new();
        for (name, text) in &files {
            let sum = sha256(text);
            lines.push_str(&format!("{sum}  {name}\n"));
            sums.insert(&name[..], sum);
        }
        let sha256_of_all = sha256(&lines);
        if let Some(text) = manifest {
            check_manifest(&text, &sums, &sha256_of_all)?;
        }
        let mut groups: Vec<Group> = Vec::new();
        let mut ids = HashSet::new();
        for (name, text) in files.iter().filter(|(name, _)| *name != SCHEMA) {
            let group = group(name, text)?;
            if groups.iter().any(|other| other.name == group.name) {
                return Err(error(
                    name,
                    format!("the group {:?} is in another file too", group.name),
                ));
            }
            for case in &group.cases {
                if !ids.insert(case.id.clone()) {
                    return Err(error(name, format!("the id {:?} is used twice", case.id)));
                }
            }
            groups.push(group);
        }
        Ok(Suite {
            groups,
            sha256: sha256_of_all,
        })
    }

    /// The groups of these names, or all if there are no names. The hash stays that of the whole.
    pub fn only(&self, names: &[String]) -> Suite {
        let wanted = |group: &&Group| names.is_empty() || names.contains(&group.name);
        Suite {
            groups: self.groups.iter().filter(wanted).cloned().collect(),
            sha256: self.sha256.clone(),
        }
    }

    /// The number of cases.
    pub fn cases(&self) -> usize {
        self.groups.iter().map(|group| group.cases.len()).sum()
    }
}

/// The SHA-256 of a text, in hexadecimal.
fn sha256(text: &str) -> String {
    let digest = sha2::Sha256::digest(text);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Implements: VEC-007.
fn check_manifest(text: &str, sums: &BTreeMap<&str, String>, sha256: &str) -> Result<(), Refusal> {
    let manifest: Manifest =
        serde_json::from_str(text).map_err(|cause| error(MANIFEST, cause.to_string()))?;
    for (name, sum) in sums {
        match manifest.files.iter().find(|file| file.name == **name) {
            None => return Err(error(name, "is not in manifest.json")),
            Some(file) if file.sha256 != *sum => {
                return Err(error(
                    name,
                    format!(
                        "has the SHA-256 {sum}, expected {} as in manifest.json",
                        file.sha256
                    ),
                ));
            }
            Some(_) => {}
        }
    }
    if let Some(file) = manifest
        .files
        .iter()
        .find(|file| !sums.contains_key(&file.name[..]))
    {
        return Err(error(&file.name, "is in manifest.json, but not there"));
    }
    if manifest.suite_sha256 != sha256 {
        return Err(error(
            MANIFEST,
            format!(
                "suite_sha256 is {}, expected {sha256}",
                manifest.suite_sha256
            ),
        ));
    }
    Ok(())
}

/// Reads one file.
///
/// Implements: VEC-001, VEC-002.
fn group(file: &str, text: &str) -> Result<Group, Refusal> {
    let read: GroupText =
        serde_json::from_str(text).map_err(|cause| error(file, cause.to_string()))?;
    if read.schema != "palpate-vectors" || read.schema_version != 1 {
        return Err(error(
            file,
            format!(
                "schema {:?} version {}, expected \"palpate-vectors\" version 1",
                read.schema, read.schema_version
            ),
        ));
    }
    for (key, value) in [
        ("group", &read.group),
        ("source", &read.source),
        ("generator_version", &read.generator_version),
    ] {
        if value.is_empty() {
            return Err(error(file, format!("{key} is empty")));
        }
    }
    let mut cases = Vec::with_capacity(read.cases.len());
    let mut used = BTreeSet::new();
    for (index, text) in read.cases.iter().enumerate() {
        let named = |message: String| {
            error(
                file,
                format!("case {}: {message}", name_of_case(index, text)),
            )
        };
        let case: CaseText =
            serde_json::from_str(text.get()).map_err(|cause| named(cause.to_string()))?;
        let case = check::case(case, &read.tolerance, |flag| read.flags.contains_key(flag))
            .map_err(named)?;
        if read.op.is_empty() && (case.expected.is_values() || case.question.is_arguments()) {
            return Err(named(
                "expected a line that must be refused, since the group has no op".into(),
            ));
        }
        used.extend(case.flags.iter().cloned());
        cases.push(case);
    }
    if cases.is_empty() {
        return Err(error(file, "no cases"));
    }
    if let Some(flag) = read.flags.keys().find(|flag| !used.contains(*flag)) {
        return Err(error(
            file,
            format!("the flag {flag:?} is explained, but no case has it"),
        ));
    }
    Ok(Group {
        name: read.group,
        op: read.op,
        flags: read.flags,
        cases,
    })
}

/// The id of a case, or its number if it has none.
fn name_of_case(index: usize, text: &RawValue) -> String {
    let value: Option<Value> = serde_json::from_str(text.get()).ok();
    let id = value
        .as_ref()
        .and_then(|value| value.get("id"))
        .and_then(Value::as_str);
    id.map_or_else(|| format!("number {}", index + 1), str::to_string)
}
