//! The pictures: every figure of the paper that is no photograph, the signals, what is left of γ, γ of a tactile array, and the bridge to Table 1.
//!
//! Their words are in `templates/report/words.txt`.
//!
//! | file | content |
//! |---|---|
//! | `figure-2.svg`, `figure-8.svg` | the detection problem, the experiments: the same for every run |
//! | `setup.rs`, `mesh.rs` | Figures 1 and 6: phantom and probe to scale, and as the probe deforms it |
//! | `theory.rs` | Figures 3, 4, 9: the detector alone |
//! | `forces.rs` | Figures 5 and 7, and the signals |
//! | `gamma.rs` | γ of a sweep beside what may be unknown of it |
//! | `inputs.rs` | which input counts, by a study |
//! | `pressure.rs` | γ of a tactile array against its elements |
//! | `people.rs`, `bridge.rs` | Figures 10 to 13: Table 1; the forces against it |

mod bridge;
mod forces;
mod gamma;
mod inputs;
mod mesh;
mod people;
mod pressure;
mod setup;
mod theory;

use super::text::FileNames;
use super::{Figure, Findings, Run, Topic};
use crate::study::Band;
use askama::Template;
use palpate::chart::style::VERMILION;
use palpate::chart::{DrawingResult, Line, with_head};
use palpate::refusal::Refusal;
use std::fmt::Display;

/// The words around a picture: title, caption, and the picture in words.
type Words<'a> = [&'a dyn Display; 3];

/// The words of a figure from a template that is its title, with a block each for the others.
macro_rules! words {
    ($title:expr, $caption:ident, $alt:ident) => {
        [&$title, &$title.$caption(), &$title.$alt()]
    };
}
use words;

/// The words of the figures that are the same for every run: four paragraphs for each, the first its name.
#[derive(Template)]
#[template(path = "report/words.txt", block = "fixed")]
struct FixedWords;

/// The figures so far.
#[derive(Default)]
struct Figures {
    all: Vec<Figure>,
    names: FileNames,
}

impl Figures {
    /// Adds a figure with its words: an SVG document with any head, and the height of the picture, pixels. Its file name begins
    /// with `prefix` and goes on with `name`, which is untrusted and may be empty.
    fn add(
        &mut self,
        (prefix, name): (&str, &str),
        topic: Topic,
        words: Words<'_>,
        drawn: DrawingResult<(String, i32)>,
    ) -> Result<(), Refusal> {
        let file_name = self.names.unique(prefix, name, "svg");
        let [title, caption, alt] = words.map(ToString::to_string);
        let svg = drawn.and_then(|drawn| with_head(drawn, &file_name, &title, &alt));
        let svg = svg.map_err(Refusal::because(format!("figure {title:?}")))?;
        self.all.push(Figure {
            file_name,
            topic,
            title,
            caption,
            alt,
            svg,
        });
        Ok(())
    }

    /// Adds a figure that is the same for every run.
    fn add_fixed(
        &mut self,
        prefix: &str,
        topic: Topic,
        drawn: DrawingResult<(String, i32)>,
    ) -> Result<(), Refusal> {
        let all = FixedWords.to_string();
        let mut words = all.split("\n\n");
        words.find(|paragraph| *paragraph == prefix);
        let words = [(); 3].map(|()| words.next().unwrap_or_default());
        let [title, caption, alt] = &words;
        self.add((prefix, ""), topic, [title, caption, alt], drawn)
    }
}

/// All figures of a run, in the order of the page.
///
/// # Errors
/// If a map does not fit the reference, or if drawing fails.
///
/// Implements: REP-030, REP-031.
pub fn figures(run: &Run, findings: &Findings) -> Result<Vec<Figure>, Refusal> {
    let mut figures = Figures::default();
    setup::draw(&mut figures, run)?;
    mesh::draw(&mut figures, &run.deformed)?;
    forces::draw(&mut figures, run, findings)?;
    let fixed = (include_str!("figure-2.svg").into(), 560);
    figures.add_fixed("figure-2", Topic::Detection, Ok(fixed))?;
    theory::draw(&mut figures)?;
    gamma::draw(&mut figures, run, findings)?;
    pressure::draw(&mut figures, run, findings)?;
    inputs::draw(&mut figures, run)?;
    let fixed = (include_str!("figure-8.svg").into(), 436);
    figures.add_fixed("figure-8", Topic::People, Ok(fixed))?;
    people::draw(&mut figures, run, &findings.people)?;
    bridge::draw(&mut figures, findings)?;
    Ok(figures.all)
}

/// The ends of bands along x as two dashed lines, in units of 1/`scale`; none without bands.
fn band_ends(of: &str, bands: &[(f64, Band)], scale: f64) -> Vec<Line> {
    let line = |words: &str, end: fn(&Band) -> f64| {
        let points = bands.iter().map(|(x, band)| (*x, scale * end(band)));
        let line = Line::new(VERMILION, points.collect()).dashed(true);
        line.named(format!("{of}{words}"))
    };
    match bands {
        [] => Vec::new(),
        _ => vec![
            line("2.5 %", |band| band.lower.value),
            line("97.5 %", |band| band.upper.value),
        ],
    }
}
