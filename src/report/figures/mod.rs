//! The pictures: the paper's Figures 3, 4, 5, 6 and 9, and the signals.
//!
//! | file | content |
//! |---|---|
//! | `theory.rs` | Figures 3, 4, 9: the detector alone |
//! | `forces.rs` | Figure 5, and the signals |
//! | `mesh.rs` | Figure 6 |
//! | `chart.rs`, `style.rs` | how a chart is drawn and looks |

mod chart;
mod forces;
mod mesh;
mod style;
mod theory;

use super::findings::detect_error;
use super::text::{FileNames, escape, fixed, millimetres, name_of_map};
use super::{Figure, Findings, ReportError, Study};
use crate::force_map::ForceMap;
use chart::{DrawingResult, Panel, chart};
use style::UNIT;

const LATERAL_POSITION: &str = "Lateral position of the probe x (mm)";

/// The words around a picture.
struct Words {
    title: String,
    caption: String,
    alt: String,
}

/// All figures of a study, in the order of the page: signals, forces, mesh, then the detector's curves.
///
/// # Errors
/// [`ReportError`] if a map does not fit the reference, if the mesh contradicts itself, or if drawing fails.
///
/// Implements: REP-030, REP-031.
pub fn figures(study: &Study, findings: &Findings) -> Result<Vec<Figure>, ReportError> {
    let mut names = FileNames::default();
    let mut all = Vec::new();
    if !study.maps.is_empty() {
        let words = signal_words(findings);
        let panels = forces::signals(study, findings)?;
        all.push(figure(
            names.unique("signals", "", "svg"),
            words,
            chart(&panels, LATERAL_POSITION),
        )?);
    }
    for map in [&study.reference].into_iter().chain(&study.maps) {
        let words = force_words(map);
        let file_name = names.unique("figure-5", &name_of_map(map), "svg");
        let panels = forces::force_curves(map.forces());
        all.push(figure(file_name, words, chart(&panels, LATERAL_POSITION))?);
    }
    mesh::check(&study.deformed)?;
    let drawn = mesh::deformed_mesh(&study.deformed);
    all.push(figure(
        names.unique("figure-6", "", "svg"),
        mesh_words(study),
        drawn,
    )?);
    let [densities, roc, pairs] = theory_words();
    let detect = |source| detect_error("figures", source);
    for (prefix, words, panels, x_name) in [
        ("figure-3", densities, theory::densities(), "Statistic θ"),
        (
            "figure-4",
            roc,
            theory::roc().map_err(detect)?,
            "False alarms Pr(e | H = 0)",
        ),
        (
            "figure-9",
            pairs,
            theory::pairs().map_err(detect)?,
            "Signal-to-noise ratio γ",
        ),
    ] {
        let panels: Vec<Panel> = panels;
        all.push(figure(
            names.unique(prefix, "", "svg"),
            words,
            chart(&panels, x_name),
        )?);
    }
    Ok(all)
}

fn figure(
    file_name: String,
    words: Words,
    drawn: DrawingResult<(String, [i32; 2])>,
) -> Result<Figure, ReportError> {
    let Words {
        title,
        caption,
        alt,
    } = words;
    let drawing = |problem| ReportError::Drawing {
        figure: title.clone(),
        problem,
    };
    let (drawing_of_library, size) = drawn.map_err(drawing)?;
    let svg = with_head(&drawing_of_library, size, &file_name, &title, &alt)
        .ok_or_else(|| drawing("the library wrote no SVG".into()))?;
    Ok(Figure {
        file_name,
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

fn signal_words(findings: &Findings) -> Words {
    let depth = millimetres(findings.probe_depth);
    let each: Vec<_> = findings
        .maps
        .iter()
        .map(|map| {
            format!(
                "{}: {} N normal, {} N lateral",
                forces::label(map),
                fixed(map.peak_normal.force, 3),
                fixed(map.peak_lateral.force, 3)
            )
        })
        .collect();
    Words {
        title: format!("Signals F₁ − F₀ at depth {depth} mm"),
        caption: format!(
            "What the inclusion adds to the force on the probe as it sweeps over the gel at depth {depth} mm: the \
             template of the matched filter (2), (4). The paper shows no such figure, but its “roughly 0.5 N” and \
             its 340 mN for 6.6 mm are peaks of such curves. The lateral force changes sign over the inclusion."
        ),
        alt: format!(
            "Two line charts of force against lateral position, one curve for each phantom. Peaks: {}.",
            each.join("; ")
        ),
    }
}

fn force_words(map: &ForceMap) -> Words {
    let name = name_of_map(map);
    let what = match map.phantom().map(|phantom| phantom.inclusion) {
        Some(Some(inclusion)) => format!("inclusion {} mm deep", millimetres(inclusion.depth)),
        Some(None) => "no inclusion".into(),
        None => "inclusion not known".into(),
    };
    let said = match map.phantom().and_then(super::paper::name_of) {
        Some("2.6") => {
            "This is the paper's Figure 5. Its curves come from an element and mesh that it does not name, and its \
             numbers are not printed, so only the shapes can be compared."
        }
        _ => "As the paper's Figure 5, which shows the 2.6 mm phantom alone.",
    };
    let source = match map.certificate() {
        Some(certificate) => format!(
            "Computed by finite elements ({}, contact {}).",
            certificate.element, certificate.contact
        ),
        None => "Measured.".into(),
    };
    let forces = map.normal_force().values();
    let largest = forces.iter().copied().fold(0.0, f64::max);
    Words {
        title: format!("Forces, phantom “{name}” ({what})"),
        caption: format!(
            "Force on the whole probe against its lateral position, one curve for each depth of the probe, named at \
             the right. {source} Normal is positive out of the gel, lateral along +x. {said}"
        ),
        alt: format!(
            "Two line charts of normal and lateral force against lateral position, {} curves each. The largest \
             normal force is {} N.",
            map.depths().len(),
            fixed(largest, 3)
        ),
    }
}

fn mesh_words(study: &Study) -> Words {
    let mesh = &study.deformed;
    let name = &mesh.phantom.name;
    let (depth, lateral) = (millimetres(mesh.pose.depth), millimetres(mesh.pose.lateral));
    let disc = match mesh.phantom.inclusion {
        Some(_) => {
            " The inclusion keeps its shape, since it is far stiffer than the gel, as the paper says of its Figure 6."
        }
        None => "",
    };
    Words {
        title: format!(
            "Deformed mesh, phantom “{name}”, probe at depth {depth} mm, x = {lateral} mm"
        ),
        caption: format!(
            "The mesh as the probe deforms it (paper's Figure 6, whose pose is not stated), to scale and not \
             exaggerated; elements are drawn with straight sides between their corners.{disc} The smallest \
             det(I + ∇u) is {}: 1 is undeformed, and below 0.2 small strain is at its limit.",
            fixed(mesh.min_det, 3)
        ),
        alt: format!(
            "A mesh of {} elements: gel under a thin skin, dented by a round probe from above.",
            mesh.corners.len()
        ),
    }
}

fn theory_words() -> [Words; 3] {
    [
        Words {
            title: "Probability distributions of the statistic Θ".into(),
            caption: "Equation (8) for γ = 1, 2 and 3: Θ is normal with mean −γ²/2 without inclusion (dashed) and \
                      +γ²/2 with one (solid), and standard deviation γ. The paper's Figure 3, which names no values \
                      of γ in print."
                .into(),
            alt: "Line chart of three pairs of bell curves, mirror images about θ = 0; the larger γ, the wider \
                  and the further apart."
                .into(),
        },
        Words {
            title: "Receiver operating characteristic".into(),
            caption: "Misses against false alarms as the threshold moves, in closed form: Φ(Φ⁻¹(1 − P_fa) − γ). The \
                      paper's Figure 4. Its 5 %/5 % point (dot) lies on the curve of γ = 3.29; the paper rounds to \
                      3.3."
                .into(),
            alt: "Line chart of misses against false alarms, four falling curves for γ from 1 to 3.29; the last runs \
                  through the point with 5 % of each."
                .into(),
        },
        Words {
            title: "Probability of choosing correctly in pairs".into(),
            caption: "Φ(γ/√2), the paper's Figure 9. The paper reads γ = 1.45 for its 84 %; the curve has 84 % at \
                      γ = 1.406 and 84.7 % at 1.45."
                .into(),
            alt: "Line chart rising from one half at γ = 0 towards 1, with 84 % marked at γ = 1.406.".into(),
        },
    ]
}
