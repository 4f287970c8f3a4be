//! The samples of a study in files: one for each shard, a line for each sample.

use std::collections::HashSet;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::CliError;
use crate::error::refuse;
use crate::output::{Envelope, files_in};
use palpate::file::from_json;
use palpate::journal::take_lines;
use palpate::refusal::{Refusal, shortened};
use palpate_paper::study::{Failure, Sampler, StudyPlan};

/// How the first line of each file begins.
const BEGINNING: &str = "{\"schema\":\"palpate-study-samples\"";
/// The keys of the first line whose values must be those that this program writes: its numbers may be others.
const OF_PROGRAM: [&str; 2] = ["schema_version", "program_version"];

/// What the first line says.
#[derive(Serialize)]
pub struct Header<'a> {
    pub shard: Shard,
    pub plan: &'a StudyPlan,
}

/// The samples that one process computes: those whose number leaves the remainder `number` − 1 when divided by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 1.
    pub number: usize,
    /// How many there are.
    pub of: usize,
}

impl Shard {
    /// Reads `k/n`.
    ///
    /// # Errors
    /// A message that says what the text must be.
    pub fn parse(text: &str) -> Result<Shard, String> {
        let parts = text.split_once('/');
        let numbers = parts.and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((number, of)) if number >= 1 && number <= of => Ok(Shard { number, of }),
            _ => Err(format!("{text:?} must be k/n with 1 ≤ k ≤ n, such as 3/17")),
        }
    }

    pub fn has(self, sample: usize) -> bool {
        sample % self.of == self.number - 1
    }

    /// The file of its samples.
    pub fn file(self, folder: &Path) -> PathBuf {
        folder.join(format!("samples-{}-of-{}.jsonl", self.number, self.of))
    }
}

/// One sample.
#[derive(Debug, Serialize, Deserialize)]
pub struct Record {
    pub sample: usize,
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// Its outcome: a value for each quantity, or why it failed.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    Values(Vec<f64>),
    Failed(String),
}

impl Record {
    pub fn is_failed(&self) -> bool {
        matches!(self.outcome, Outcome::Failed(_))
    }

    /// The record in a line of a study.
    ///
    /// # Errors
    /// Anything else.
    pub fn parse(text: &str, study: &Sampler) -> Result<Record, Refusal> {
        let record: Record = from_json(text)?;
        let fits = match &record.outcome {
            Outcome::Values(values) => values.len() == study.quantities().len(),
            Outcome::Failed(_) => true,
        };
        if record.sample < study.design().samples() && fits {
            return Ok(record);
        }
        let found = "this line is not a sample of this study; delete the file and run again";
        Err(Refusal::state(found, ""))
    }
}

/// The files of a study.
pub struct Records {
    /// What their first lines say, but for the shard.
    header: Value,
    files: Vec<PathBuf>,
}

impl Records {
    /// The files in `folders`, all of one study.
    ///
    /// # Errors
    /// A folder without samples; a file of another study or program, with what is different.
    ///
    /// Implements: STU-027.
    pub fn find(folders: &[PathBuf]) -> Result<Records, CliError> {
        let mut records: Option<Records> = None;
        for file in sample_files(folders)? {
            let header = header(&file)?;
            let records = records.get_or_insert_with(|| Records {
                header: header.clone(),
                files: Vec::new(),
            });
            if let Some(key) = difference(&records.header, &header) {
                let (file, first) = (file.display(), records.files[0].display());
                refuse!("{file}: belongs to a different study than {first}: {key} differs");
            }
            records.files.push(file);
        }
        records.ok_or_else(|| CliError::Usage("no folder".into()))
    }

    /// What was varied.
    ///
    /// # Errors
    /// A first line that holds no plan.
    pub fn plan(&self) -> Result<StudyPlan, CliError> {
        let plan = StudyPlan::deserialize(&self.header["plan"]);
        plan.map_err(CliError::refused(self.files[0].display()))
    }

    /// The arithmetic of the samples, which may not be that of this machine.
    ///
    /// # Errors
    /// A first line that names none.
    ///
    /// Implements: STU-050.
    pub fn arithmetic(&self) -> Result<&str, CliError> {
        let arithmetic = self.header["arithmetic"].as_str();
        let missing = "the first line names no arithmetic; compute the samples again";
        arithmetic.ok_or_else(|| CliError::refused(self.files[0].display())(missing))
    }

    /// Hands each record to `take`, with the number of its file.
    fn each(
        &self,
        study: &Sampler,
        mut take: impl FnMut(Record, usize) -> Result<(), Refusal>,
    ) -> Result<(), CliError> {
        for (number, path) in self.files.iter().enumerate() {
            let mut reader = open(path)?;
            let skipped = reader.skip_until(b'\n');
            skipped.map_err(CliError::file("read", path))?;
            take_lines(reader, path, 2, |text| {
                take(Record::parse(text, study)?, number)
            })?;
        }
        Ok(())
    }

    /// The samples that failed, in their order.
    ///
    /// # Errors
    /// A sample that is missing or occurs twice; a line that is not a sample.
    ///
    /// Implements: STU-026, STU-027.
    pub fn failures(&self, study: &Sampler) -> Result<Vec<Failure>, CliError> {
        const NONE: u32 = u32::MAX;
        let samples = study.design().samples();
        let mut file_of = vec![NONE; samples];
        let mut failures = Vec::new();
        self.each(study, |Record { sample, outcome }, file| {
            let place = &mut file_of[sample];
            if let Some(other) = self.files.get(*place as usize) {
                let other = other.display();
                let found = format!("sample {sample} is also in {other}; delete one of them");
                return Err(Refusal::state(found, ""));
            }
            *place = file as u32;
            if let Outcome::Failed(reason) = outcome {
                failures.push(Failure { sample, reason });
            }
            Ok(())
        })?;
        let missing: Vec<usize> = (0..samples).filter(|&of| file_of[of] == NONE).collect();
        if let [first, ..] = missing[..] {
            refuse!(
                "{} of {samples} samples are missing, the first is {first}; run 'palpate study run' again for their shards",
                missing.len()
            );
        }
        failures.sort_by_key(|failure| failure.sample);
        Ok(failures)
    }

    /// The values of some quantities in all samples, a NaN for those that failed.
    ///
    /// # Errors
    /// As [`Records::failures`].
    pub fn columns(&self, study: &Sampler, range: Range<usize>) -> Result<Vec<Vec<f64>>, CliError> {
        let mut columns = vec![vec![f64::NAN; study.design().samples()]; range.len()];
        self.each(study, |record, _| {
            if let Outcome::Values(values) = record.outcome {
                for (column, value) in columns.iter_mut().zip(&values[range.clone()]) {
                    column[record.sample] = *value;
                }
            }
            Ok(())
        })?;
        Ok(columns)
    }
}

/// The files of samples in each folder, in the order of their names.
fn sample_files(folders: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
    let mut all = Vec::new();
    for folder in folders {
        if folder.is_file() {
            refuse!("{}: a file; give its folder", folder.display());
        }
        let mut files = files_in(folder, |path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("samples-") && name.ends_with(".jsonl")
        })?;
        if files.is_empty() {
            refuse!(
                "{}: the folder has no samples-K-of-N.jsonl; give one written by 'palpate study run'",
                folder.display()
            );
        }
        all.append(&mut files);
    }
    // A folder may be named twice, in two ways.
    let mut seen = HashSet::new();
    all.retain(|file| seen.insert(file.canonicalize().unwrap_or_else(|_| file.clone())));
    Ok(all)
}

fn open(path: &Path) -> Result<BufReader<File>, CliError> {
    let file = File::open(path).map_err(CliError::file("open", path));
    file.map(BufReader::new)
}

/// What the first line of a file says, but for the shard.
fn header(path: &Path) -> Result<Value, CliError> {
    let mut line = String::new();
    let read = open(path)?.read_line(&mut line);
    read.map_err(CliError::file("read", path))?;
    let header: Option<Value> = serde_json::from_str(&line).ok();
    match header {
        Some(Value::Object(mut header)) if line.starts_with(BEGINNING) => {
            header.remove("shard");
            let file = path.display().to_string();
            check_program(&header).map_err(|refusal| refusal.at(1).in_file(file))?;
            Ok(header.into())
        }
        _ => refuse!(
            "{}: the first line is not that of a file of study samples",
            path.display()
        ),
    }
}

/// Refuses the samples of another program.
///
/// Implements: STU-027.
fn check_program(header: &Map<String, Value>) -> Result<(), Refusal> {
    let own = Envelope::job("", Map::new());
    // Keys are strings, and there are no numbers that JSON lacks.
    let own = serde_json::to_value(own).unwrap_or_default();
    OF_PROGRAM.into_iter().try_for_each(|key| {
        let found = header.get(key).unwrap_or(&Value::Null);
        let expected = format!("{}, which is what this program merges", own[key]);
        let refusal = Refusal::value(key, shortened(&found.to_string()), expected);
        refusal.when(*found != own[key])
    })
}

/// The first key whose value differs, with those around it.
fn difference(one: &Value, other: &Value) -> Option<String> {
    if one == other {
        return None;
    }
    let mut keys = one.as_object().into_iter().flatten().map(|(key, _)| key);
    let inner = keys.find_map(|key| {
        let inner = difference(&one[key], &other[key])?;
        Some(format!("{key}.{inner}"))
    });
    Some(inner.unwrap_or_default().trim_end_matches('.').into())
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: STU-024.
    #[test]
    fn each_sample_has_one_shard_whatever_their_numbers() {
        for of in [
            1,
            2,
            3,
            (1 << 16) + 1,
            (1 << 32) - 1,
            (1 << 32) + 1,
            usize::MAX,
        ] {
            for sample in [
                0,
                1,
                65_535,
                65_536,
                65_537,
                (1 << 32) - 1,
                1 << 32,
                usize::MAX - 1,
            ] {
                let shard = |number| Shard { number, of };
                let own = sample % of + 1;
                assert!(shard(own).has(sample), "{sample} of {of}");
                let mut others = [1, 2, of / 2, of - 1, of].into_iter();
                assert!(!others.any(|number| (1..=of).contains(&number)
                    && number != own
                    && shard(number).has(sample)));
            }
        }
        let most = usize::MAX;
        let parsed = Shard::parse(&format!("{most}/{most}"));
        assert_eq!(
            parsed,
            Ok(Shard {
                number: most,
                of: most
            })
        );
        for wrong in [
            format!("1/{most}0"),
            format!("{most}/1"),
            "0/0".into(),
            "-1/2".into(),
        ] {
            assert!(Shard::parse(&wrong).is_err(), "{wrong}");
        }
    }
}
