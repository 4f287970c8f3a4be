//! Figure 5 for every phantom, Figure 7 for measured maps, and the signals at one depth.

use super::bands::band_ends;
use super::plan::{Plan, Words, over};
use crate::report::inputs;
use crate::report::maps::signal;
use crate::report::text::{fixed, joined, millimetres, name_of_map, shortened};
use crate::report::{Findings, MapFindings, Run, Topic, paper};
use crate::study::Kind;
use palpate::chart::style::{PALETTE, ramp};
use palpate::chart::{Line, Panel, round_range};
use palpate::force_map::{ForceMap, Matrix, Source};
use palpate::refusal::Refusal;

/// The signals, if there are any, and the forces of every map: computed ones, then the measured ones.
///
/// # Errors
/// A map does not fit the reference.
///
/// Implements: REP-031.
pub fn figures(run: &Run, found: &Findings) -> Result<Vec<Plan>, Refusal> {
    let plan = |id, map: Option<&ForceMap>, words, panels: Vec<Panel>| {
        let picture = over("Lateral position of the probe x (mm)", panels);
        Plan {
            name: map.map(name_of_map).unwrap_or_default(),
            ..Plan::new(id, Topic::Forces, words, picture)
        }
    };
    let mut plans = Vec::new();
    if !run.maps.is_empty() {
        let panels = signals(run, found)?.into();
        plans.push(plan("signals", None, signal_words(run, found), panels));
    }
    let depth = run.study.as_ref().map(|study| study.plan.probe_depth);
    for map in run.reference_and_maps() {
        let bands = bands(run, map);
        let words = force_words(map, depth.filter(|_| !bands[0].is_empty()));
        let panels = forces(map, bands);
        plans.push(plan("figure-5", Some(map), words, panels));
    }
    for map in &run.measured {
        let panels = forces(map, Default::default());
        plans.push(plan("figure-7", Some(map), measured_words(map), panels));
    }
    Ok(plans)
}

/// A panel of the normal force, or of its signal, over one of the lateral one. One position alone gets some room.
pub fn panels(
    laterals: &[f64],
    headings: [&str; 2],
    [normal, lateral]: [Vec<Line>; 2],
) -> [Panel; 2] {
    let x = match laterals {
        [first, .., last] => [first * 1e3, last * 1e3],
        [only] => [only * 1e3 - 1.0, only * 1e3 + 1.0],
        [] => [-1.0, 1.0],
    };
    let panel = |heading, height, lines: Vec<Line>| {
        let points = lines.iter().flat_map(|line| &line.points);
        let y = round_range(points.map(|point| point.1));
        Panel::new(heading, [x, y], height, lines)
    };
    [
        panel(headings[0], 230, normal),
        panel(headings[1], 200, lateral),
    ]
}

/// Positions (m) in mm, and forces, as points.
pub fn points(laterals: &[f64], forces: &[f64]) -> Vec<(f64, f64)> {
    let laterals = laterals.iter().map(|x| x * 1e3);
    laterals.zip(forces.iter().copied()).collect()
}

/// Figure 5: the forces of a map that has both or the normal one, one curve for each depth of the probe, and the ends of a band of the
/// normal and of the lateral force.
fn forces(map: &ForceMap, [normal, lateral]: [Vec<Line>; 2]) -> Vec<Panel> {
    let table = map.table();
    let (depths, laterals) = (table.depths(), table.laterals());
    let curves = |matrix: &Matrix, band: Vec<Line>| {
        let rows = depths.iter().zip(matrix.rows()).enumerate();
        let curves = rows.map(|(row, (depth, forces))| {
            let curve = Line::new(ramp(row, depths.len()), points(laterals, forces));
            curve.named(format!("{} mm", millimetres(depth)))
        });
        curves.chain(band).collect()
    };
    let lateral = table.lateral().map(|forces| curves(forces, lateral));
    let channels = 1 + usize::from(lateral.is_some());
    let curves = [curves(table.normal(), normal), lateral.unwrap_or_default()];
    let headings = ["Normal force (N)", "Lateral force (N)"];
    let panels = panels(laterals, headings, curves).into_iter();
    panels.take(channels).collect()
}

/// The ends of the bands of the normal and of the lateral force that a study has for the phantom of a map.
///
/// Implements: REP-081.
fn bands(run: &Run, map: &ForceMap) -> [Vec<Line>; 2] {
    let Some(study) = &run.study else {
        return Default::default();
    };
    let kinds: [fn(f64) -> Kind; 2] = [
        |lateral_m| Kind::NormalForceN { lateral_m },
        |lateral_m| Kind::LateralForceN { lateral_m },
    ];
    kinds.map(|kind| {
        let at = |&x: &f64| Some((1e3 * x, inputs::band(run, map, &kind(x))?));
        let bands: Vec<_> = study.plan.laterals.iter().filter_map(at).collect();
        band_ends("", &bands, 1.0)
    })
}

/// How a map is called in a figure: the inclusion's depth for the paper's phantoms, or else its name.
pub fn label(map: &MapFindings) -> String {
    match map.paper_phantom {
        Some("none") | None => shortened(&map.name, 14),
        Some(depth) => format!("{depth} mm"),
    }
}

/// F_1 − F_0 of every map at one depth of the probe.
///
/// # Errors
/// If a map does not fit the reference.
fn signals(run: &Run, found: &Findings) -> Result<[Panel; 2], Refusal> {
    let laterals = run.reference.table().laterals();
    let mut lines = [Vec::new(), Vec::new()];
    for (k, (map, of_map)) in run.maps.iter().zip(&found.maps).enumerate() {
        let signal = signal(&run.reference, map, found.probe_depth_m)?;
        for (lines, forces) in lines.iter_mut().zip([signal.normal, signal.lateral]) {
            let line = Line::nth(k, &PALETTE, points(laterals, &forces));
            lines.push(line.named(label(of_map)));
        }
    }
    let headings = ["Normal signal F₁ − F₀ (N)", "Lateral signal F₁ − F₀ (N)"];
    Ok(panels(laterals, headings, lines))
}

fn signal_words(run: &Run, found: &Findings) -> Words {
    let depth = millimetres(found.probe_depth_m);
    let phantom = run.reference.phantom();
    // On both sides of it.
    let laterals = run.reference.table().laterals();
    let reach = matches!(laterals, [first, .., last] if *first < 0.0 && *last > 0.0);
    let changes = match reach && phantom.is_some_and(|of| of.probe().friction == 0.0) {
        true => " The lateral force changes sign over an inclusion.",
        false => "",
    };
    let peaks = found.maps.iter().map(|map| {
        let [normal, lateral] = [map.peak_normal, map.peak_lateral].map(|of| fixed(of.force_n, 3));
        format!("{}: {normal} N normal, {lateral} N lateral", label(map))
    });
    [
        format!("Signals F₁ − F₀ at depth {depth} mm"),
        format!(
            "What inclusions add to the force on the probe as it sweeps over the gel at depth {depth} mm: the template of the matched \
             filter (2), (4). The paper shows no such figure, but its “roughly 0.5 N” and its 340 mN for 6.6 mm are peaks of such \
             curves.{changes}"
        ),
        format!(
            "Two line charts of force against lateral position, one curve for each phantom. Peaks: {}.",
            joined(peaks, "; ")
        ),
    ]
}

/// The words of Figure 5, with the depth of its bands, m, if there are any.
fn force_words(map: &ForceMap, depth: Option<f64>) -> Words {
    let inclusions = match map.phantom().map(|of| of.inclusions()) {
        None => "inclusion not known".into(),
        Some([]) => "no inclusion".into(),
        Some([one]) => format!("inclusion {} mm deep", millimetres(one.depth)),
        Some(several) => format!("{} inclusions", several.len()),
    };
    let made = match map.certificate() {
        Some(of) => format!(
            "Computed by finite elements ({}, contact {}).",
            of.element, of.contact
        ),
        None => "Measured.".into(),
    };
    let of_paper = match map.phantom().and_then(paper::name_of) {
        Some("2.6") => {
            "This is the paper's Figure 5; its curves come from an element and mesh that it does not name, and its numbers are not \
             printed, so only the shapes can be compared."
        }
        _ => "As the paper's Figure 5, which shows the 2.6 mm phantom alone.",
    };
    let bands = depth.map(|depth| {
        let depth = millimetres(depth);
        format!(" Between the dashed lines lie 95 % of the draws of the uncertain inputs, at {depth} mm.")
    });
    let bands = bands.unwrap_or_default();
    let forces = map.table().normal().values().iter();
    let largest = forces.copied().fold(0.0, f64::max);
    [
        format!(
            "Figure 5. Forces, phantom “{}”: {inclusions}",
            name_of_map(map)
        ),
        format!(
            "Force on the whole probe against its lateral position, one curve for each depth of the probe, the darker the deeper. {made} \
             Normal is positive out of the gel, lateral along +x. {of_paper}{bands}"
        ),
        format!(
            "Two line charts of normal and lateral force against lateral position, {} curves each. The largest normal force is {} N.",
            map.table().depths().len(),
            fixed(largest, 3)
        ),
    ]
}

fn measured_words(map: &ForceMap) -> Words {
    let note = match map.source() {
        Source::Measured(of) if !of.note.is_empty() => {
            format!(" It came with the note: “{}”.", of.note)
        }
        _ => String::new(),
    };
    [
        format!("Figure 7. Measured forces, “{}”", name_of_map(map)),
        format!(
            "A measured map that this run was given, at its own poses: force on the whole probe against its lateral position, one \
             curve for each depth.{note} The paper's Figure 7 shows its own measurement of the 2.6 mm gel; those data are not \
             available."
        ),
        format!(
            "{} against lateral position, {} curves each.",
            match map.table().lateral() {
                Some(_) => "Two line charts of measured normal and lateral force",
                None => "A line chart of measured normal force",
            },
            map.table().depths().len()
        ),
    ]
}
