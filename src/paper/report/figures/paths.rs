//! Which path of the probe tells most of an inclusion, of paths that take equally long.

use super::plan::{Plan, Words, over};
use crate::report::nuisances::{ALL, BY_DEFAULT};
use crate::report::text::{fixed, joined, millimetres};
use crate::report::{Findings, Run, Topic};
use palpate::chart::style::PALETTE;
use palpate::chart::{Line, Panel, PanelKind, round_range};
use palpate::force::Force;
use palpate::force_map::ForceMap;
use palpate::trace::{Record, Unknown, gammas_along, in_words};

/// Samples of each path.
const SAMPLES: u32 = 640;
/// Pixels for one path.
const ROW: i32 = 44;
/// What may be unknown.
const UNKNOWN: [&[Unknown]; 3] = [&[], BY_DEFAULT, ALL];

/// A path: where the probe is after a share of its time, as shares of its length and of its greatest depth.
type Shape = fn(f64) -> [f64; 2];

/// There and back in passes of equal time: how many are over, and the share of the way.
fn pass(share: f64) -> (f64, f64) {
    let over = (4.0 * share).floor().min(3.0);
    let way = 4.0 * share - over;
    (over, if over % 2.0 == 0.0 { way } else { 1.0 - way })
}

const PATHS: [(&str, Shape); 4] = [
    ("one slow pass", |share| [share, 1.0]),
    ("four passes at one depth", |share| [pass(share).1, 1.0]),
    ("four passes, each deeper", |share| {
        let (over, way) = pass(share);
        [way, (over + 1.0) / 4.0]
    }),
    ("five indentations", |share| {
        let over = (5.0 * share).floor().min(4.0);
        let way = 5.0 * share - over;
        [(over + 0.5) / 5.0, 1.0 - (2.0 * way - 1.0).abs()]
    }),
];

/// γ of an inclusion along each path, for each of [`UNKNOWN`].
type Gammas = [[f64; UNKNOWN.len()]; PATHS.len()];

/// The figure, for the inclusion that is the hardest to find, if the maps have rows from the surface on and more than one position.
///
/// Implements: REP-036.
pub fn figure(run: &Run, found: &Findings) -> Option<Plan> {
    let gammas = |map| Some((map, gammas(run, map, found)?));
    let all: Vec<(&ForceMap, Gammas)> = run.maps.iter().filter_map(gammas).collect();
    let hardest = all.iter().min_by(|a, b| a.1[0][1].total_cmp(&b.1[0][1]))?;
    let picture = over("γ", [panel(&hardest.1)]);
    let words = words(found, hardest);
    Some(Plan::new("paths", Topic::Detection, words, picture))
}

fn gammas(run: &Run, map: &ForceMap, found: &Findings) -> Option<Gammas> {
    let (without, depth) = (run.reference.table(), found.probe_depth_m);
    let laterals = without.laterals();
    let [first, .., last] = laterals else {
        return None;
    };
    let noise_sd = Force::new(run.settings.noise_sd_n, run.settings.noise_sd_n);
    let mut gammas = Gammas::default();
    for ((_, shape), row) in PATHS.iter().zip(&mut gammas) {
        let places = (0..SAMPLES).map(|k| shape((f64::from(k) + 0.5) / f64::from(SAMPLES)));
        let place = |[x, d]: [f64; 2]| (first + x * (last - first), d * depth);
        let (positions, depths): (Vec<_>, Vec<_>) = places.map(place).unzip();
        let sweep = Record::planned(&positions, &depths).ok()?;
        for (unknown, gamma) in UNKNOWN.iter().zip(row) {
            // All maps of a run have the same depths.
            let over = (without, [map.table()]);
            let found = gammas_along((&sweep, depth), unknown, noise_sd, without, over);
            *gamma = *found.ok()?.first()?;
        }
    }
    Some(gammas)
}

/// For each path a bar for each of [`UNKNOWN`].
fn panel(gammas: &Gammas) -> Panel {
    let colours = || PALETTE.into_iter().cycle();
    let mut lines = Vec::new();
    for (rank, ((name, _), row)) in PATHS.iter().zip(gammas).rev().enumerate() {
        for (k, (&gamma, colour)) in row.iter().zip(colours()).enumerate() {
            let height = rank as f64 + 0.75 - 0.25 * k as f64;
            let bar = Line::new(colour, vec![(0.0, height), (gamma, height)]).wide(7.0);
            lines.push(bar.named(if k == 1 { *name } else { "" }));
        }
    }
    let sample = |(unknown, colour): (&&[Unknown], _)| {
        Line::new(colour, Vec::new())
            .wide(7.0)
            .named(format!("unknown: {}", in_words(unknown)))
    };
    let x = round_range([0.0].into_iter().chain(gammas.iter().flatten().copied()));
    Panel {
        kind: PanelKind::Ranked,
        key: UNKNOWN.iter().zip(colours()).map(sample).collect(),
        ..Panel::new(
            "",
            [x, [0.0, PATHS.len() as f64]],
            ROW * PATHS.len() as i32,
            lines,
        )
    }
}

fn words(found: &Findings, (map, gammas): &(&ForceMap, Gammas)) -> Words {
    let name = map.phantom().map_or("", |phantom| phantom.name());
    let depth = millimetres(found.probe_depth_m);
    let rows = PATHS.iter().zip(gammas).map(|((path, _), row)| {
        let gammas = joined(row.iter().map(|gamma| fixed(*gamma, 1)), ", ");
        format!("{path}: {gammas}")
    });
    [
        format!("Which path tells most of phantom {name}"),
        format!(
            "γ along four paths of {SAMPLES} samples each, down to {depth} mm: a slow pass, passes there and back at that depth, \
             passes at a quarter, a half, three quarters and all of it, and indentations at five places. A light pass feels the surface \
             and hardly the inclusion: it adds little to γ, but tells an unknown gain or depth from an inclusion. The paper has no \
             such figure."
        ),
        format!(
            "Bar charts of gamma with nothing unknown, with offset, drift and gain unknown, and with the depth unknown too. {}.",
            joined(rows, "; ")
        ),
    ]
}
