//! Files of vectors, read and hashed.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;
use sha2::Digest;

use super::case::{Case, CaseText, Expected, Question, ToleranceText};
use super::text::plain;
use super::{check, embedded};

/// A file that is not what it should be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {message}")]
pub struct Invalid {
    /// Its name.
    pub file: String,
    /// What is wrong, in one line.
    pub message: String,
}

impl Invalid {
    /// The error of a file.
    pub fn new(file: impl std::fmt::Display, message: impl AsRef<str>) -> Invalid {
        Invalid {
            file: file.to_string(),
            message: message.as_ref().chars().map(plain).collect(),
        }
    }
}

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

/// Which cases are asked; all, if nothing is chosen.
#[derive(Debug, Clone, Default, PartialEq, Eq, clap::Args)]
pub struct Choice {
    /// Asks the cases of this group alone; may be given several times
    #[arg(long, value_name = "GROUP")]
    pub only: Vec<String>,
    /// Asks this case alone; may be given several times
    #[arg(long, value_name = "ID")]
    pub case: Vec<String>,
    /// Leaves out this group or case; may be given several times
    #[arg(long, value_name = "NAME")]
    pub skip: Vec<String>,
}

/// A group or case that these vectors do not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no {what} {name:?} in these vectors, expected {known}")]
pub struct Unknown {
    what: &'static str,
    name: String,
    known: String,
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

    /// The vectors in a folder: every `.json` there but the manifest and what ends in `.data.json`.
    ///
    /// # Errors
    /// A file that cannot be read or is not valid; no file at all.
    ///
    /// Implements: ORA-040, ORA-041.
    pub fn read(folder: &Path) -> Result<Suite, Invalid> {
        let failed =
            |path: &Path, cause: std::io::Error| Invalid::new(path.display(), cause.to_string());
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
                let text = std::fs::read_to_string(&path).map_err(|cause| failed(&path, cause))?;
                files.insert(name, text);
            }
        }
        if !files.keys().any(|name| name != MANIFEST && name != SCHEMA) {
            return Err(Invalid::new(
                folder.display(),
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
    /// Implements: VEC-001, VEC-007.
    pub fn of_files(mut files: BTreeMap<String, String>) -> Result<Suite, Invalid> {
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
                return Err(Invalid::new(
                    name,
                    format!("the group {:?} is in another file too", group.name),
                ));
            }
            for case in &group.cases {
                if !ids.insert(case.id.clone()) {
                    return Err(Invalid::new(
                        name,
                        format!("the id {:?} is used twice", case.id),
                    ));
                }
            }
            groups.push(group);
        }
        Ok(Suite {
            groups,
            sha256: sha256_of_all,
        })
    }

    /// What is chosen. The hash stays that of the whole.
    ///
    /// # Errors
    /// A group or case that does not exist.
    ///
    /// Implements: ORA-040.
    pub fn select(&self, choice: &Choice) -> Result<Suite, Unknown> {
        let is_group = |name: &str| self.groups.iter().any(|group| group.name == name);
        if let Some(name) = choice.only.iter().find(|name| !is_group(name)) {
            let known: Vec<&str> = self.groups.iter().map(|group| &group.name[..]).collect();
            let known = known.join(", ");
            return Err(Unknown {
                what: "group",
                name: name.clone(),
                known,
            });
        }
        let missing = |name: &&String| !is_group(name) && !self.has(name);
        let cases = choice.case.iter().find(|name| !self.has(name));
        if let Some(name) = cases.or_else(|| choice.skip.iter().find(missing)) {
            let known = "one such as two_afc-001".into();
            return Err(Unknown {
                what: "case",
                name: name.clone(),
                known,
            });
        }
        let mut suite = self.clone();
        let wanted = |group: &Group| choice.only.is_empty() || choice.only.contains(&group.name);
        suite.groups.retain(wanted);
        if !choice.case.is_empty() {
            for group in &mut suite.groups {
                group.cases.retain(|case| choice.case.contains(&case.id));
            }
            suite.groups.retain(|group| !group.cases.is_empty());
        }
        Ok(suite)
    }

    /// Whether there is a case of this name.
    pub fn has(&self, id: &str) -> bool {
        self.groups
            .iter()
            .any(|group| group.cases.iter().any(|case| case.id == id))
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

/// Implements: VEC-007.
fn check_manifest(text: &str, sums: &BTreeMap<&str, String>, sha256: &str) -> Result<(), Invalid> {
    let manifest: Manifest =
        serde_json::from_str(text).map_err(|cause| Invalid::new(MANIFEST, cause.to_string()))?;
    for (name, sum) in sums {
        match manifest.files.iter().find(|file| file.name == **name) {
            None => return Err(Invalid::new(name, "is not in manifest.json")),
            Some(file) if file.sha256 != *sum => {
                return Err(Invalid::new(
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
        return Err(Invalid::new(
            &file.name,
            "is in manifest.json, but not there",
        ));
    }
    if manifest.suite_sha256 != sha256 {
        return Err(Invalid::new(
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
/// Implements: VEC-001.
fn group(file: &str, text: &str) -> Result<Group, Invalid> {
    let read: GroupText =
        serde_json::from_str(text).map_err(|cause| Invalid::new(file, cause.to_string()))?;
    if read.schema != "palpate-vectors" || read.schema_version != 1 {
        return Err(Invalid::new(
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
            return Err(Invalid::new(file, format!("{key} is empty")));
        }
    }
    let mut cases = Vec::with_capacity(read.cases.len());
    let mut used = BTreeSet::new();
    for (index, text) in read.cases.iter().enumerate() {
        let named = |message: String| {
            Invalid::new(
                file,
                format!("case {}: {message}", name_of_case(index, text)),
            )
        };
        let case: CaseText =
            serde_json::from_str(text.get()).map_err(|cause| named(cause.to_string()))?;
        let case = check::case(case, &read.tolerance, |flag| read.flags.contains_key(flag))
            .map_err(named)?;
        let is_refused_line = matches!(
            (&case.question, &case.expected),
            (Question::Line(_), Expected::Refusal { .. })
        );
        if read.op.is_empty() && !is_refused_line {
            return Err(named(
                "expected a line that must be refused, since the group has no op".into(),
            ));
        }
        used.extend(case.flags.iter().cloned());
        cases.push(case);
    }
    if cases.is_empty() {
        return Err(Invalid::new(file, "no cases"));
    }
    if let Some(flag) = read.flags.keys().find(|flag| !used.contains(*flag)) {
        return Err(Invalid::new(
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
