//! γ of a sweep beside each class of disturbance of the robust detector.

use super::gamma;
use super::people::DEPTH;
use super::plan::{Picture, Plan, Words};
use crate::report::text::{fixed, joined, millimetres, trimmed};
use crate::report::{Findings, MapFindings, Run, Topic, maps::incomparable};
use palpate::chart::Panel;
use palpate::force::Force;
use palpate::force_map::{ForceMap, Hypotheses};
use palpate::refusal::Refusal;
use palpate::robust::{RobustQuestion, RobustSweep};
use palpate::trace::Record;

/// The noise of a good force sensor, N, and a sample for each so much of the sweep, m.
const NOISE_SD: f64 = 0.02;
const STEP: f64 = 0.1e-3;
/// Of each kind of disturbance the class that is drawn.
const SHOWN: [&str; 7] = [
    "the maps hold",
    "the probe rubs",
    "the gel relaxes",
    "the forces are off smoothly by 1.5 %",
    "the gel is another",
    "the surface is domed or dished",
    "several of these at once",
];
/// The shortest sweep that is drawn, and the step to the next, mm.
const SHORTEST: f64 = 8.0;
const LONGER: f64 = 2.0;

/// γ beside each of [`SHOWN`].
type Gammas = [f64; SHOWN.len()];

/// The figure, if what is uncertain of the gel is known, and the top of an inclusion that has a signal.
///
/// Implements: REP-035.
pub fn figure(run: &Run, found: &Findings) -> Option<Plan> {
    let laterals = run.reference.table().laterals();
    let longest = 2e3 * f64::min(-laterals[0], laterals[laterals.len() - 1]);
    if run.changes.is_none() || longest < SHORTEST {
        return None;
    }
    let of = |map: &ForceMap, length: f64| gammas(run, map, found.probe_depth_m, length).ok();
    let pairs = run.maps.iter().zip(&found.maps);
    let known = |(map, found): (_, &MapFindings)| {
        let depth = 1e3 * found.inclusion_depth_m?;
        Some((map, (depth, of(map, longest)?)))
    };
    let mut known: Vec<_> = pairs.filter_map(known).collect();
    known.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
    let (maps, by_depth): (Vec<&ForceMap>, Vec<(f64, Gammas)>) = known.into_iter().unzip();
    // The second inclusion from the top, or the only one.
    let second = maps.len().min(2).checked_sub(1)?;
    let (map, depth) = (maps[second], by_depth[second].0);
    let steps = ((longest - SHORTEST) / LONGER) as i32;
    let lengths = (0..=steps).map(|step| SHORTEST + LONGER * f64::from(step));
    let by_length: Vec<_> = lengths
        .filter_map(|length| Some((length, of(map, length)?)))
        .collect();
    let needed = found.required_gamma;
    let mut panels = [
        panel("γ, by depth of the inclusion", DEPTH, &by_depth, needed),
        panel(
            &format!(
                "γ, inclusion {} mm deep, by length of the sweep",
                trimmed(depth, 6)
            ),
            "length of the sweep (mm)",
            &by_length,
            needed,
        ),
    ];
    panels[1]
        .lines
        .iter_mut()
        .for_each(|line| line.name.clear());
    let words = words(found, longest, depth, &by_depth);
    let picture = Picture::Panels(panels.into());
    Some(Plan::new("disturbed", Topic::Detection, words, picture))
}

/// γ of the inclusion of `map` in a sweep of a `length`, mm.
fn gammas(run: &Run, map: &ForceMap, depth: f64, length: f64) -> Result<Gammas, Refusal> {
    // No sample beyond the map.
    let samples = (1e-3 * length / STEP + 1e-6).floor() as i32;
    let positions: Vec<f64> = (0..=samples)
        .map(|k| STEP * (f64::from(k) - 0.5 * f64::from(samples)))
        .collect();
    let record = Record::planned(&positions, &[])?;
    let sweep = RobustSweep::new(&record, depth, run.changes.as_ref());
    let (without, with) = (run.reference.table(), map.table());
    let hypotheses = Hypotheses::of_tables(without, with).map_err(incomparable(map))?;
    let noise_sd = Force::new(NOISE_SD, NOISE_SD);
    let question = RobustQuestion {
        noise_sd: Some(noise_sd),
        ..RobustQuestion::default()
    };
    let detector = question.detector(hypotheses, &[sweep])?;
    let found = detector.gammas(0, noise_sd);
    Ok(SHOWN.map(|name| {
        let of = found.iter().find(|(class, _)| class.name == name);
        of.map_or(f64::NAN, |(_, gamma)| *gamma)
    }))
}

/// A line for each class.
fn panel(heading: &str, x_name: &str, found: &[(f64, Gammas)], needed: f64) -> Panel {
    let left = SHOWN.iter().enumerate().map(|(class, name)| {
        let points = found.iter().map(|(x, gammas)| (*x, gammas[class]));
        (name.to_string(), points.collect())
    });
    Panel {
        x_name: x_name.into(),
        height: 300,
        ..gamma::gammas(heading, needed, left, |class| class % 2 == 1)
    }
}

fn words(found: &Findings, longest: f64, depth: f64, by_depth: &[(f64, Gammas)]) -> Words {
    let numbers = by_depth.iter().map(|(depth, gammas)| {
        let gammas = gammas.iter().map(|gamma| fixed(*gamma, 1));
        format!("{} at {} mm", joined(gammas, ", "), trimmed(*depth, 6))
    });
    [
        format!(
            "Signal-to-noise ratio γ of a sweep at depth {} mm beside each class of disturbance",
            millimetres(found.probe_depth_m)
        ),
        format!(
            "What a gel, a motion or a sensor may do to a record takes from γ the part of the signal that it resembles. Each line is the γ \
             that is left if this class of disturbance is possible and the others are not: palpate detect averages over all of them, \
             and --known leaves out what is known. Sweeps of {} mm above; of the inclusion {} mm deep below, because a surface or a gel \
             that is not known needs a sweep that reaches beyond the inclusion. Noise of {} N in every sample, {} samples per mm. The \
             paper has no such figure.",
            trimmed(longest, 6),
            trimmed(depth, 6),
            trimmed(NOISE_SD, 6),
            (1e-3 / STEP).round()
        ),
        format!(
            "Two line charts of γ, against the depth of the inclusion and against the length of the sweep, one line for each of these \
             classes: {}. From the shallowest to the deepest inclusion: {}. A dashed line at {} is what both error rates need.",
            joined(SHOWN.iter().map(ToString::to_string), "; "),
            joined(numbers, "; "),
            fixed(found.required_gamma, 2)
        ),
    ]
}
