//! Samples that come line by line, as CSV or JSON.

use serde_json::Value;

use super::{COLUMNS, REQUIRED};
use crate::csv::{Column, Layout, Rows, is_comment};
use crate::file::Members;
use crate::refusal::Refusal;

/// Those of a trace over positions.
const LIVE: [Column; 4] = [&[COLUMNS[0][0]], COLUMNS[1], COLUMNS[2], COLUMNS[3]];
/// The headers that are right, for a person.
const EXPECTED: &str = "position_mm,lateral_force_n,normal_force_n, in any order, also position_m and forces as _mn, or say with --columns what each holds";

/// Reads samples from the lines of a stream: CSV with a header as of a trace over positions, or objects of JSON with its columns as keys.
///
/// ```
/// use palpate::trace::LiveSamples;
///
/// let mut csv = LiveSamples::new("-", Default::default());
/// assert_eq!(csv.sample("position_mm,normal_force_n")?, None);
/// let sample = csv.sample("-1,1.5")?.unwrap();
/// assert_eq!((sample.position, sample.depth, sample.lateral, sample.normal), (-1e-3, None, None, 1.5));
/// let mut json = LiveSamples::new("-", Default::default());
/// let sample = json.sample(r#"{"position_mm": -1, "depth_mm": 4, "normal_force_n": 1.5}"#)?;
/// assert_eq!(sample.unwrap().depth, Some(4e-3));
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
#[derive(Debug, Clone)]
pub struct LiveSamples {
    file: String,
    layout: Layout,
    /// Lines at the start that are no samples.
    skipped: usize,
    line: usize,
    /// The header of CSV, with the line of its units.
    header: Option<String>,
    /// Whether the line below the header was read, which may give the units.
    is_begun: bool,
    /// Whether the first sample has each of the columns.
    first: Option<[bool; 4]>,
    /// What a person should know of how the header was read.
    pub notes: Vec<String>,
}

/// A sample; NaN for a number that is missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiveSample {
    /// Lateral position, m.
    pub position: f64,
    /// Depth, m, if it is recorded.
    pub depth: Option<f64>,
    /// Lateral force, N, if the sensor has it.
    pub lateral: Option<f64>,
    /// Normal force, N.
    pub normal: f64,
}

impl LiveSamples {
    /// Before the first line; in messages `file` is where the lines come from.
    pub fn new(file: &str, mut layout: Layout) -> LiveSamples {
        LiveSamples {
            file: file.into(),
            skipped: std::mem::take(&mut layout.skipped),
            layout,
            line: 0,
            header: None,
            is_begun: false,
            first: None,
            notes: Vec::new(),
        }
    }

    /// A refusal of the last line.
    pub fn refused(&self, refusal: Refusal) -> Refusal {
        refusal.at(self.line).in_file(&*self.file)
    }

    /// The sample of the next line, with a lateral force and a depth if the header or the first object has them; nothing of a header, the
    /// units below it, a comment or a blank line.
    ///
    /// # Errors
    /// A header or object that does not name the columns, a field that is no finite decimal number, text that is no JSON; with the line.
    ///
    /// Implements: CLI-182.
    pub fn sample(&mut self, text: &str) -> Result<Option<LiveSample>, Refusal> {
        self.line += 1;
        // A tab separates, also at an end.
        let text = text
            .trim_start_matches('\u{feff}')
            .trim_matches([' ', '\r', '\n']);
        let content = text.trim();
        if is_comment(content) || self.line <= self.skipped {
            return Ok(None);
        }
        let read = match self.header.clone() {
            // After an object, all lines are.
            None if content.starts_with('{') || self.first.is_some() => {
                self.layout.is_of_objects = true;
                object(text).and_then(|[header, row]| Ok(Some(self.row(&header, &row)?.0)))
            }
            None => {
                self.header = Some(text.into());
                self.row(text, "").map(|_| None)
            }
            Some(header) => self.row(&header, text).and_then(|(sample, has_units)| {
                let is_of_units = has_units && !header.contains('\n');
                let wrong = Refusal::state("a line of units", "give it below the header");
                wrong.when(is_of_units && self.is_begun)?;
                self.is_begun = true;
                if is_of_units {
                    self.header = Some(format!("{header}\n{text}"));
                }
                Ok((!is_of_units).then_some(sample))
            }),
        };
        read.map_err(|refusal| self.refused(refusal))
    }

    /// A row below a header, and whether it is one of units.
    fn row(&mut self, header: &str, row: &str) -> Result<(LiveSample, bool), Refusal> {
        let text = format!("{header}\n{row}");
        // What the first one lacked is no column of the others, whatever they hold there.
        const NONE: Column = &[];
        let has = self.first.unwrap_or([true; 4]);
        let columns = std::array::from_fn(|at| if has[at] { LIVE[at] } else { NONE });
        let read = Rows::parse_optional(&text, columns, REQUIRED, EXPECTED, &self.layout, true)?;
        let (table, there) = read;
        self.layout.mark = table.mark;
        if row.is_empty() {
            self.notes = table.notes;
        }
        let first = *self.first.get_or_insert(there);
        // A sample without what the first one had is missing.
        let is_whole = there == first;
        let whole = table.rows.first().filter(|_| is_whole);
        let [position, normal, lateral, depth] =
            whole.map_or([f64::NAN; 4], |(_, numbers)| *numbers);
        let [.., has_lateral, has_depth] = first;
        let sample = LiveSample {
            position,
            depth: has_depth.then_some(depth),
            lateral: has_lateral.then_some(lateral),
            normal,
        };
        Ok((sample, table.has_units))
    }
}

/// An object as a header of its keys and a row of its values: text without the marks of CSV, lists and objects as a word.
fn object(text: &str) -> Result<[String; 2], Refusal> {
    // As Python writes it, though it is no JSON.
    let text = text.replace(": NaN", ": null").replace(":NaN", ":null");
    let Members(object) = serde_json::from_str(&text).map_err(|error| {
        let right = r#"give an object such as {"position_mm": -1, "normal_force_n": 1.5}"#;
        Refusal::state(crate::file::message(&error), right)
    })?;
    let quoted = |text: &str| format!("\"{}\"", text.replace(['"', '\n', '\r'], " "));
    let keys = object.keys().map(|key| quoted(key));
    let values = object.values().map(|value| match value {
        Value::Null => String::new(),
        Value::String(text) => quoted(text),
        Value::Array(_) => "[...]".into(),
        Value::Object(_) => "{...}".into(),
        value => value.to_string(),
    });
    Ok([keys.collect::<Vec<_>>(), values.collect()].map(|fields| fields.join(";")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(lines: &[&str]) -> Result<Vec<[f64; 3]>, String> {
        let mut samples = LiveSamples::new("-", Layout::default());
        let read = lines
            .iter()
            .filter_map(|line| samples.sample(line).transpose());
        let numbers = |of: LiveSample| [of.position, of.lateral.unwrap_or(0.0), of.normal];
        let read: Result<Vec<_>, Refusal> = read.map(|read| read.map(numbers)).collect();
        read.map_err(|refusal| refusal.to_string())
    }

    // Verifies: CLI-182.
    #[test]
    fn lines_of_csv_and_of_json_are_the_same_samples() {
        let expected = [[-1e-3, 0.02, 1.5], [5e-4, -0.03, 1.6]];
        let texts = [
            &[
                "# pass 3",
                "",
                "position_mm,lateral_force_n,normal_force_n",
                "-1,0.02,1.5",
                "0.5,-0.03,1.6",
            ][..],
            &[
                "\u{feff}note\tx [mm]\tFz(mN)\tFx(mN)\r",
                "a\t-1\t1500\t20\r",
                "b\t0.5\t1600\t-30\r",
            ],
            &[
                "normal_force_n;lateral_force_n;position_mm",
                "1,5;0,02;-1",
                "1,6;-0,03;0,5",
            ],
            &[
                r#"{"position_mm": -1, "lateral_force_n": 0.02, "normal_force_n": 1.5}"#,
                r#"{"stamp": "12:01;7", "note \"": "5\" \n", "of": ["a;\"b"], "normal_force_mn": 1.6e3, "lateral_force_n": -3e-2, "position_m": 5e-4}"#,
            ],
        ];
        for text in texts {
            assert_eq!(read(text).unwrap(), expected, "{text:?}");
        }
        assert_eq!(
            read(&["position_mm,normal_force_n", "2,1"]).unwrap(),
            [[2e-3, 0.0, 1.0]]
        );
        assert_eq!(
            read(&[r#"{"position_mm": 2, "normal_force_n": 1}"#]).unwrap(),
            [[2e-3, 0.0, 1.0]]
        );
    }

    // Verifies: CLI-182.
    #[test]
    fn a_sample_is_read_as_the_first_one() {
        let more = [
            r#"{"position_mm": 2, "normal_force_n": 1}"#,
            r#"{"position_mm": 3, "depth_mm": 9, "lateral_force_n": 7, "normal_force_n": 4}"#,
            r#"{"position_mm": 4, "depth_mm": null, "lateral_force_n": "off", "normal_force_n": 5}"#,
        ];
        let samples = [[2e-3, 0.0, 1.0], [3e-3, 0.0, 4.0], [4e-3, 0.0, 5.0]];
        assert_eq!(read(&more).unwrap(), samples);
    }

    // Verifies: CLI-182.
    #[test]
    fn a_header_of_numbers_is_told() {
        let layout = "position=1[mm],normal=2[N]".parse().unwrap();
        let mut samples = LiveSamples::new("-", layout);
        assert_eq!(samples.sample("-8,1.5").unwrap(), None);
        let note = "line 1, which holds numbers, is taken for the header";
        assert_eq!(samples.notes, [note]);
    }

    // Verifies: CLI-182, MAP-041, MAP-047.
    #[test]
    fn units_below_the_header_and_the_decimal_mark_hold_for_all_lines() {
        let lines = ["position_mm;Fz", "mm;mN", "0;1500", "1;1600,5"];
        assert_eq!(
            read(&lines).unwrap(),
            [[0.0, 0.0, 1.5], [1e-3, 0.0, 1.6005]]
        );
        // Nothing but numbers stands below them.
        let later = read(&["position_mm;Fz", "0;1", "mm;mN"]).unwrap_err();
        assert!(later.starts_with("-:3: "), "{later}");
        let other = read(&["position_mm;Fz", "0;1,5", "1;1.500"]).unwrap_err();
        assert!(
            other.starts_with("-:3: normal_force_n = \"1.500\""),
            "{other}"
        );
    }

    // Verifies: CLI-182.
    #[test]
    fn a_missing_number_makes_the_sample_missing() {
        let texts = [
            &[
                "position_mm,lateral_force_n,normal_force_n",
                "1,,2",
                "1,nan,2",
                "NaN,1,2",
            ][..],
            &[
                r#"{"position_mm": 1, "lateral_force_n": 1, "normal_force_n": null}"#,
                r#"{"position_mm": 1, "lateral_force_n": NaN, "normal_force_n": 1}"#,
                r#"{"position_mm": 1, "normal_force_n": 1}"#,
            ],
            // A tab at an end is before or after an empty field.
            &["\tposition_mm\tFz\tFx", "0\t1\t1.5\t", "\t1\t1.5\t"],
        ];
        for text in texts {
            let read = read(text).unwrap();
            assert!(
                read.iter()
                    .all(|numbers| numbers.iter().any(|number| number.is_nan())),
                "{text:?}: {read:?}"
            );
        }
    }

    // Verifies: CLI-182.
    #[test]
    fn lines_that_are_no_samples_are_refused_with_their_number() {
        for (lines, expected) in [
            (
                &["time_s,normal_force_n"][..],
                "-:1: no column position_mm or position_m in the header",
            ),
            (
                &["# a", "position_mm,force", "1,2", "1"],
                "-:4: 1 fields; give 2",
            ),
            (
                &["position_mm,normal_force_n", "1,2", "1,x"],
                "-:3: normal_force_n = \"x\", but must be",
            ),
            (
                &["position_mm,normal_force_n", "1,inf"],
                "-:2: normal_force_n = \"inf\", but must be",
            ),
            (
                &[r#"{"position_mm": 1}"#],
                "-:1: no key normal_force_n or normal_force_mn; give ",
            ),
            (
                &[r#"{"position_mm": 1, "normal_force_n": [1]}"#],
                "-:1: normal_force_n = \"[...]\", but must be",
            ),
            (
                &[r#"{"position_mm": 1, "normal_force_n": 2, "normal_force_n": 3}"#],
                "-:1: duplicate field `normal_force_n`",
            ),
            (&["{"], "-:1: "),
            (
                &[
                    r#"{"position_mm": 1, "normal_force_n": 2}"#,
                    "position_mm,normal_force_n",
                    "1,2",
                ],
                "-:2: ",
            ),
            (
                &["position_mm,normal_force_n", "#VALUE!,2"],
                "-:2: position_mm = \"#VALUE!\", but must be",
            ),
            (&["{}", ""], "-:1: no key position_mm"),
        ] {
            let error = read(lines).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
