//! A force–depth curve beside its fit.

use super::chart;
use super::explanation::{residual_panel, roomy};
use super::panel::{Line, Panel};
use super::style::{BLUE, GREY, INK, VERMILION};
use crate::calibration::{Calibration, Interval};
use crate::refusal::Refusal;
use crate::text::trimmed;

/// Curves with their fits, the residuals below, over time if there are times, else over depth, as an SVG document. A curve that cannot be
/// judged says why.
///
/// # Errors
/// If drawing fails.
///
/// Implements: CAL-033.
pub fn calibration_figure(calibrations: &[Calibration<'_>]) -> Result<String, Refusal> {
    let mut panels = Vec::new();
    for calibration in calibrations {
        panels.extend(panels_of(calibration)?);
    }
    let alt: Vec<_> = panels
        .iter()
        .flat_map(|panel| panel.caption.clone())
        .collect();
    let alt = alt.join(" ");
    chart(
        &panels,
        ["calibration", "Force–depth curves and their fits", &alt],
    )
}

/// A curve beside its fit, and what the fit leaves.
fn panels_of(of: &Calibration<'_>) -> Result<Vec<Panel>, Refusal> {
    let curve = of.curve;
    let (x_name, abscissa): (_, Vec<f64>) = match curve.times() {
        Some(times) => ("Time t (s)", times.to_vec()),
        None => (
            "Depth on the curve (mm)",
            curve.depths().iter().map(|d| 1e3 * d).collect(),
        ),
    };
    let points = |forces: &[f64]| {
        abscissa
            .iter()
            .copied()
            .zip(forces.iter().copied())
            .collect()
    };
    let x = roomy(abscissa.iter().copied());
    let [expected, residuals] = of.expected().unwrap_or_default();
    let y = roomy(curve.forces().iter().chain(expected).copied());
    let dots = |colour, points| Line::new(colour, points).wide(0.0).dotted(2);
    let mut lines = vec![dots(GREY, points(curve.forces())).named("curve")];
    let mut panel = Panel::new("Normal force (N)", [x, y], 200, Vec::new());
    panel.caption = vec![format!("{}.", curve.file())];
    if let Some(cause) = of.cause {
        let words = format!("It cannot be judged: {}.", cause.in_words());
        panel.caption.push(words);
    }
    if let Some(contact) = of.contact()? {
        panel.caption.push(in_words(contact));
        let touched = curve
            .depths()
            .iter()
            .position(|depth| *depth >= contact.estimate);
        if let Some(sample) = touched {
            let place = abscissa[sample];
            let line = Line::new(INK, vec![(place, y[0]), (place, y[1])]).wide(1.0);
            lines.push(line.dashed(true).named("contact"));
        }
    }
    if !expected.is_empty() {
        let colour = if of.cause.is_none() { BLUE } else { VERMILION };
        lines.push(Line::new(colour, points(expected)).named("fit"));
    }
    panel.lines = lines;
    if expected.is_empty() {
        panel.x_name = x_name.into();
        return Ok(vec![panel]);
    }
    let noise_sd = of.noise_sd()?.map(|sd| sd.estimate);
    let noise_sd = noise_sd.unwrap_or_else(|| of.noise_of_steps());
    let mut left = residual_panel("What is left of the force (N)".into(), x, noise_sd);
    left.lines.push(dots(BLUE, points(residuals)));
    left.y = roomy(residuals.iter().copied().chain(left.y));
    left.x_name = x_name.into();
    Ok(vec![panel, left])
}

/// Where the probe touched the gel.
fn in_words(contact: Interval) -> String {
    let Interval { estimate, ends } = contact.map(|depth| 1e3 * depth);
    let [estimate, low, high] = [estimate, ends[0], ends[1]].map(|of| trimmed(of, 3));
    match ends[0] == ends[1] {
        true => format!("Contact at {estimate} mm, as given."),
        false => format!("Contact at {estimate} mm (95 %: {low} to {high} mm)."),
    }
}
