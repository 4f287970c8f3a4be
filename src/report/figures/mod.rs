//! The pictures: every figure of the paper that is no photograph, the signals, and the bridge to Table 1.
//!
//! | file | content |
//! |---|---|
//! | `setup.rs`, `setup_words.rs` | Figure 1: phantom and probe to scale |
//! | `overview.rs` | Figures 2, 8: the detection problem, the experiments |
//! | `theory.rs` | Figures 3, 4, 9: the detector alone |
//! | `forces.rs` | Figures 5 and 7, and the signals |
//! | `mesh.rs` | Figure 6 |
//! | `people.rs`, `bridge.rs` | Figures 10 to 13: Table 1; the forces against it |
//! | `chart.rs`, `names.rs`, `diagram.rs`, `style.rs` | how charts and diagrams are drawn and look |

mod bridge;
mod chart;
mod diagram;
mod forces;
mod mesh;
mod names;
mod overview;
mod people;
mod setup;
mod setup_words;
mod style;
mod theory;

use super::findings::detect_error;
use super::text::{FileNames, escape};
use super::{Figure, Findings, ReportError, Study, Topic};
use chart::DrawingResult;
use style::UNIT;

/// The words around a picture.
struct Words {
    title: String,
    caption: String,
    alt: String,
}

/// A picture that has no file name yet.
struct Draft {
    /// What its file name begins with.
    prefix: &'static str,
    /// What its file name goes on with: untrusted, may be empty.
    name: String,
    topic: Topic,
    words: Words,
    /// The document that the drawing library wrote, and its size in pixels.
    drawn: DrawingResult<(String, [i32; 2])>,
}

/// All figures of a study, in the order of the page.
///
/// ```
#[doc = include_str!("../study.example")]
/// use palpate::report::{figures, findings};
///
/// let figures = figures(&study, &findings(&study)?)?;
/// assert!(figures.iter().all(|figure| figure.file_name.ends_with(".svg")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReportError`] if a map does not fit the reference, if the mesh contradicts itself, or if drawing fails.
///
/// Implements: REP-030, REP-031.
pub fn figures(study: &Study, findings: &Findings) -> Result<Vec<Figure>, ReportError> {
    let detect = |source| detect_error("figures", source);
    mesh::check(&study.deformed)?;
    let mut drafts = setup::drafts(study);
    drafts.push(mesh::draft(&study.deformed));
    drafts.extend(forces::drafts(study, findings)?);
    drafts.push(overview::detection());
    drafts.extend(theory::drafts().map_err(detect)?);
    drafts.push(overview::experiments());
    drafts.extend(people::drafts(findings));
    drafts.extend(bridge::draft(findings));
    let mut names = FileNames::default();
    let figure = |draft: Draft| {
        let file_name = names.unique(draft.prefix, &draft.name, "svg");
        figure(file_name, draft)
    };
    drafts.into_iter().map(figure).collect()
}

fn figure(file_name: String, draft: Draft) -> Result<Figure, ReportError> {
    let Words {
        title,
        caption,
        alt,
    } = draft.words;
    let drawing = |problem| ReportError::Drawing {
        figure: title.clone(),
        problem,
    };
    let (drawing_of_library, size) = draft.drawn.map_err(drawing)?;
    let svg = with_head(&drawing_of_library, size, &file_name, &title, &alt)
        .ok_or_else(|| drawing("the library wrote no SVG".into()))?;
    Ok(Figure {
        file_name,
        topic: draft.topic,
        title,
        caption,
        alt,
        svg,
    })
}

/// The document with a head that scales and that a screen reader can read. The ids come from the file name, which
/// is unique, since all figures share one page.
///
/// Implements: REP-032, REP-033.
fn with_head(
    svg: &str,
    [width, height]: [i32; 2],
    file_name: &str,
    title: &str,
    alt: &str,
) -> Option<String> {
    let (_, body) = svg.split_once('>')?;
    let id = file_name.trim_end_matches(".svg");
    let (wide, high) = (width * UNIT, height * UNIT);
    let (title, alt) = (escape(title), escape(alt));
    Some(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide} {high}\" width=\"{width}\" height=\"{height}\" \
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
