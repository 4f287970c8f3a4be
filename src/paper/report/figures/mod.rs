//! The pictures: every figure of the paper that is no photograph, the signals, what is left of γ, and the bridge to Table 1.
//!
//! Each file states its figures as data, words beside panels; [`figures`] draws them all.
//!
//! | file | content |
//! |---|---|
//! | `figure-2.svg`, `figure-8.svg` | the detection problem, the experiments: the same for every run |
//! | `setup.rs`, `mesh.rs` | Figures 1 and 6: phantom and probe to scale, and as the probe deforms it |
//! | `theory.rs` | Figures 2, 3, 4 and 9: the detector alone |
//! | `forces.rs` | Figures 5 and 7, and the signals |
//! | `gamma.rs` | γ of a sweep beside what may be unknown of it |
//! | `inputs.rs` | which input counts, by a study |
//! | `people.rs`, `bridge.rs` | Figures 8 and 10 to 13: Table 1; the forces against it |

mod bridge;
mod forces;
mod gamma;
mod inputs;
mod mesh;
mod people;
mod setup;
mod theory;

use super::text::FileNames;
use super::{Figure, Findings, Run, Topic};
use crate::study::Band;
use palpate::chart::style::VERMILION;
use palpate::chart::{Line, Panel, chart, with_head};
use palpate::refusal::Refusal;

/// A figure before it is drawn.
struct Plan {
    /// What its file name begins with,
    id: String,
    /// and an untrusted name that it goes on with, which may be empty.
    name: String,
    topic: Topic,
    words: Words,
    picture: Picture,
}

/// The words around a picture.
struct Words {
    title: String,
    caption: String,
    alt: String,
}

/// What is drawn.
enum Picture {
    /// Panels below one another over one x axis with a name.
    Panels(Vec<Panel>, String),
    /// A finished SVG document, and its height, pixels.
    Finished(&'static str, i32),
}

impl Words {
    fn new(title: impl Into<String>, caption: impl Into<String>, alt: impl Into<String>) -> Words {
        let (title, caption, alt) = (title.into(), caption.into(), alt.into());
        Words {
            title,
            caption,
            alt,
        }
    }
}

impl Plan {
    fn new(id: &str, topic: Topic, words: Words, panels: Vec<Panel>, x_name: &str) -> Plan {
        Plan {
            id: id.into(),
            name: String::new(),
            topic,
            words,
            picture: Picture::Panels(panels, x_name.into()),
        }
    }

    fn draw(self, names: &mut FileNames) -> Result<Figure, Refusal> {
        let file_name = names.unique(&self.id, &self.name, "svg");
        let Words {
            title,
            caption,
            alt,
        } = self.words;
        let drawn = match self.picture {
            Picture::Panels(panels, x_name) => chart(&panels, &x_name),
            Picture::Finished(svg, height) => Ok((svg.into(), height)),
        };
        let svg = drawn.and_then(|drawn| with_head(drawn, &file_name, &title, &alt));
        let svg = svg.map_err(Refusal::because(format!("figure {title:?}")))?;
        let topic = self.topic;
        Ok(Figure {
            file_name,
            topic,
            title,
            caption,
            alt,
            svg,
        })
    }
}

/// All figures of a run, in the order of the page.
///
/// # Errors
/// A map does not fit the reference, or drawing fails.
///
/// Implements: REP-030, REP-031.
pub fn figures(run: &Run, findings: &Findings) -> Result<Vec<Figure>, Refusal> {
    let mut plans = setup::figures(run);
    plans.push(mesh::figure(&run.deformed));
    plans.extend(forces::figures(run, findings)?);
    plans.extend(theory::figures().map_err(Refusal::because("figures"))?);
    plans.extend(gamma::figure(run, findings));
    plans.extend(inputs::figure(run));
    plans.extend(people::figures(run, &findings.people));
    plans.extend(bridge::figure(findings));
    let mut names = FileNames::default();
    plans
        .into_iter()
        .map(|plan| plan.draw(&mut names))
        .collect()
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
