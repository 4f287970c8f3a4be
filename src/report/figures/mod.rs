//! The pictures: every figure of the paper that is no photograph, the signals, and the bridge to Table 1.
//!
//! Their words are in `templates/report/words/`.
//!
//! | file | content |
//! |---|---|
//! | `figure-2.svg`, `figure-8.svg` | the detection problem, the experiments: the same for every study |
//! | `setup.rs`, `mesh.rs` | Figures 1 and 6: phantom and probe to scale, and as the probe deforms it |
//! | `theory.rs` | Figures 3, 4, 9: the detector alone |
//! | `forces.rs` | Figures 5 and 7, and the signals |
//! | `people.rs`, `bridge.rs` | Figures 10 to 13: Table 1; the forces against it |
//! | `chart.rs`, `names.rs`, `style.rs` | how charts are drawn and look |

mod bridge;
mod chart;
mod forces;
mod mesh;
mod names;
mod people;
mod setup;
mod style;
mod theory;

use super::findings::detect_error;
use super::text::{FileNames, escape};
use super::{Figure, Findings, ReportError, Study, Topic};
use chart::{DrawingResult, Panel, chart};
use style::{UNIT, WIDTH};

/// The words around a picture.
struct Words {
    title: String,
    caption: String,
    alt: String,
}

impl Words {
    /// From the blocks of a template: title, caption, and the picture in words.
    fn of(blocks: [&dyn std::fmt::Display; 3]) -> Words {
        let [title, caption, alt] = blocks.map(|block| block.to_string());
        Words {
            title,
            caption,
            alt,
        }
    }

    /// From a file of three paragraphs: title, caption, and the picture in words.
    fn read(file: &str) -> Words {
        let mut paragraphs = file.trim_end().split("\n\n");
        let [title, caption, alt] = [(); 3].map(|()| paragraphs.next().unwrap_or_default());
        Words::of([&title, &caption, &alt])
    }
}

/// A picture that has no file name yet.
struct Draft {
    /// What its file name begins with.
    prefix: &'static str,
    /// What its file name goes on with: untrusted, may be empty.
    name: String,
    topic: Topic,
    words: Words,
    /// The SVG document with any head, and the height of the picture, pixels.
    drawn: DrawingResult<(String, i32)>,
}

impl Draft {
    /// A chart of panels below one another over one x axis.
    fn chart(prefix: &'static str, topic: Topic, words: Words, panels: &[Panel], x: &str) -> Draft {
        Draft {
            prefix,
            name: String::new(),
            topic,
            words,
            drawn: chart(panels, x),
        }
    }

    /// A picture that is the same for every study.
    fn fixed(prefix: &'static str, topic: Topic, words: &str, svg: &str, height: i32) -> Draft {
        Draft {
            prefix,
            name: String::new(),
            topic,
            words: Words::read(words),
            drawn: Ok((svg.into(), height)),
        }
    }

    fn named(self, name: impl Into<String>) -> Draft {
        Draft {
            name: name.into(),
            ..self
        }
    }

    fn figure(self, names: &mut FileNames) -> Result<Figure, ReportError> {
        let file_name = names.unique(self.prefix, &self.name, "svg");
        let Words {
            title,
            caption,
            alt,
        } = self.words;
        let svg = self
            .drawn
            .and_then(|drawn| with_head(drawn, &file_name, &title, &alt))
            .map_err(|problem| ReportError::Drawing {
                figure: title.clone(),
                problem: problem.to_string(),
            })?;
        Ok(Figure {
            file_name,
            topic: self.topic,
            title,
            caption,
            alt,
            svg,
        })
    }
}

/// All figures of a study, in the order of the page.
///
/// # Errors
/// [`ReportError`] if a map does not fit the reference, or if drawing fails.
///
/// Implements: REP-030, REP-031.
pub fn figures(study: &Study, findings: &Findings) -> Result<Vec<Figure>, ReportError> {
    let mut drafts = setup::drafts(study);
    drafts.push(mesh::draft(&study.deformed));
    drafts.extend(forces::drafts(study, findings)?);
    drafts.push(Draft::fixed(
        "figure-2",
        Topic::Detection,
        include_str!("../../../templates/report/words/figure-2.txt"),
        include_str!("figure-2.svg"),
        560,
    ));
    drafts.extend(theory::drafts().map_err(|source| detect_error("figures", source))?);
    drafts.push(Draft::fixed(
        "figure-8",
        Topic::People,
        include_str!("../../../templates/report/words/figure-8.txt"),
        include_str!("figure-8.svg"),
        436,
    ));
    drafts.extend(people::drafts(findings));
    drafts.extend(bridge::draft(findings));
    let mut names = FileNames::default();
    drafts
        .into_iter()
        .map(|draft| draft.figure(&mut names))
        .collect()
}

/// The document with a head that scales and that a screen reader can read. The ids come from the file name, which
/// is unique, since all figures share one page.
///
/// Implements: REP-032, REP-033.
fn with_head(
    (svg, height): (String, i32),
    file_name: &str,
    title: &str,
    alt: &str,
) -> DrawingResult<String> {
    let (_, body) = svg.split_once('>').ok_or("the library wrote no SVG")?;
    let id = file_name.trim_end_matches(".svg");
    let (wide, high) = (WIDTH * UNIT, height * UNIT);
    let (title, alt) = (escape(title), escape(alt));
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide} {high}\" width=\"{WIDTH}\" height=\"{height}\" \
         role=\"img\" aria-labelledby=\"{id}-title {id}-desc\">\n\
         <title id=\"{id}-title\">{title}</title>\n<desc id=\"{id}-desc\">{alt}</desc>{body}"
    ))
}

/// The ground of every chart, sRGB.
#[cfg(test)]
pub(super) fn chart_ground() -> [f64; 3] {
    [255.0; 3]
}

/// Every colour of lines and words, sRGB, with the contrast that it needs.
#[cfg(test)]
pub(super) fn chart_inks() -> Vec<(String, [f64; 3], f64)> {
    use plotters::style::RGBColor;
    let values = |RGBColor(r, g, b): RGBColor| [r, g, b].map(f64::from);
    let lines = style::PALETTE.into_iter().chain([style::GREY]);
    let ramp = (0..9).map(|k| style::ramp(k, 9));
    let mut inks: Vec<_> = lines
        .chain(ramp)
        .map(|colour| (format!("{colour:?}"), values(colour), 3.0))
        .collect();
    inks.push(("words".into(), values(style::INK), 4.5));
    inks
}
