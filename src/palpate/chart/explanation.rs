//! A record beside what either hypothesis expects of it.

use plotters::style::RGBColor;

use super::bank::{posterior, words};
use super::chart;
use super::panel::{Cells, Line, Panel};
use super::style::{BLUE, GREY, INK, VERMILION};
use crate::bank::{Bank, Parameter};
use crate::detect::Decision;
use crate::force::Force;
use crate::refusal::Refusal;
use crate::robust::{RobustAnswer, RobustPlace};
use crate::text::{digits, extremes, trimmed};
use crate::trace::{Record, reasons};

/// The channels by their numbers.
const CHANNELS: [&str; 2] = ["Lateral force", "Normal force"];
/// The hypotheses by their numbers, with their colours.
const HYPOTHESES: [(&str, RGBColor); 2] = [
    ("without an inclusion", BLUE),
    ("with an inclusion", VERMILION),
];
/// Two standard deviations of the noise to either side.
const BAND: RGBColor = RGBColor(214, 219, 225);

/// Sweeps of one place beside what both hypotheses expect of them, and what each leaves, as an SVG document; by a bank, also the
/// probabilities of each parameter of the inclusion.
///
/// # Errors
/// If drawing fails.
///
/// Implements: CLI-163, ROB-044.
pub fn explanation_figure(
    records: &[Record],
    answer: &RobustAnswer,
    place: Option<(&Bank, &RobustPlace)>,
) -> Result<String, Refusal> {
    let mut panels = Vec::new();
    for (sweep, record) in records.iter().enumerate() {
        let channels = if record.forces().lateral.is_empty() {
            &[1][..]
        } else {
            &[1, 0]
        };
        for &channel in channels {
            let mut panel = record_panel(record, answer, [sweep, channel]);
            panel.heading = match records.len() {
                1 => format!("{} (N)", CHANNELS[channel]),
                _ => format!(
                    "{}, sweep {}{} (N)",
                    CHANNELS[channel],
                    sweep + 1,
                    how_deep(record)
                ),
            };
            panels.push(panel);
            panels.extend(left_panels(record, answer, [sweep, channel]));
        }
        if let Some(last) = panels.last_mut() {
            last.x_name = "Position x (mm)".into();
        }
    }
    if let Some((bank, place)) = place.filter(|_| answer.explanation.is_some()) {
        panels.extend((0..4).filter_map(|axis| marginal(bank, place, axis)));
    }
    let caption = answer_in_words(answer);
    let alt = caption.join(" ");
    if let Some(first) = panels.first_mut() {
        first.caption = caption;
    }
    chart(
        &panels,
        ["explanation", "A record and what explains it", &alt],
    )
}

/// The answer and what it rests on, a sentence each.
pub fn answer_in_words(answer: &RobustAnswer) -> Vec<String> {
    let posterior = match answer.posterior {
        p if p > 0.999 => "above 0.999".into(),
        p if p < 0.001 => "below 0.001".into(),
        p => trimmed(p, 3),
    };
    let decided = match answer.decision {
        Some(Decision::Inclusion) => "An inclusion".to_string(),
        Some(Decision::NoInclusion) => "No inclusion".into(),
        None => format!("It cannot be judged: {}", reasons(&answer.causes)),
    };
    let mut caption = vec![format!("{decided}.")];
    if let Some(explanation) = &answer.explanation {
        caption[0] += &format!(" Probability of an inclusion: {posterior}.");
        let amplitude = trimmed(explanation.amplitude, 2);
        let signal = [
            "".into(),
            format!("; its signal is {amplitude} times the computed one"),
        ];
        for (hypothesis, (name, _)) in HYPOTHESES.iter().enumerate() {
            if let Some(class) = answer.likeliest_class(hypothesis) {
                let (class, shares) = answer.classes[class];
                let class = class.name;
                let share = 100.0 * shares[hypothesis];
                let signal = &signal[hypothesis];
                caption.push(format!(
                    "Likeliest {name}: {class} ({share:.0}\u{a0}%){signal}."
                ));
            }
        }
    }
    caption
}

/// The depths of a record in words, if its samples have their own.
fn how_deep(record: &Record) -> String {
    let depths = record.depths().into_iter().flatten().copied();
    let words = extremes(depths).map(|ends| {
        let [low, high] = ends.map(|depth| trimmed(1e3 * depth, 1));
        format!(", {low} to {high} mm deep")
    });
    words.unwrap_or_default()
}

/// Points of a record at its positions, mm.
fn points<'a>(record: &'a Record, forces: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    let pairs = record.positions().iter().zip(forces);
    pairs.map(|(x, force)| (1e3 * x, *force))
}

/// What is less is rounding.
const LEAST: f64 = 1e-12;

/// A range with some room at both ends.
pub(super) fn roomy(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = extremes(values).unwrap_or_default();
    let size = low.abs().max(high.abs());
    let room = (0.05 * (high - low)).max(1e-6 * size).max(LEAST);
    match room.is_finite() {
        true => [low - room, high + room],
        false => [-1.0, 1.0],
    }
}

/// The series of one sweep and channel.
fn series(of: &[Force<Vec<f64>>], [sweep, channel]: [usize; 2]) -> &[f64] {
    of[sweep].as_deref().into_array()[channel]
}

/// The forces of a record, sweep `at[0]` of the answer, in channel `at[1]`, 0 lateral and 1 normal; what was left out as glitches, and
/// what either hypothesis expects.
pub fn record_panel(record: &Record, answer: &RobustAnswer, at: [usize; 2]) -> Panel {
    let forces = record.forces().into_array()[at[1]];
    let explanation = answer.explanation.as_ref();
    let cleaned = explanation.map_or(forces, |of| series(&of.records, at));
    let expected = explanation.map(|of| of.expected.each_ref().map(|of| series(of, at)));
    let expected = expected.as_ref().map_or(&[][..], |of| of);
    let y = roomy(expected.iter().copied().flatten().chain(cleaned).copied());
    let all = points(record, forces).zip(cleaned);
    let (kept, left_out): (Vec<_>, Vec<_>) = all.partition(|((_, force), kept)| force == *kept);
    let kept = kept.into_iter().map(|(point, _)| point).collect();
    let left_out = left_out.into_iter().map(|(point, _)| point);
    let left_out: Vec<_> = left_out.map(|(x, f)| (x, f.clamp(y[0], y[1]))).collect();
    let dots = |colour, radius, points| Line::new(colour, points).wide(0.0).dotted(radius);
    let mut lines = vec![dots(GREY, 2, kept).named("record")];
    if !left_out.is_empty() {
        lines.push(dots(INK, 5, left_out).named("left out as a glitch"));
    }
    for (hypothesis, series) in expected.iter().enumerate() {
        let (name, colour) = HYPOTHESES[hypothesis];
        let line = Line::new(colour, points(record, series).collect());
        lines.push(line.dashed(hypothesis == 1).named(name));
    }
    let x = roomy(record.positions().iter().map(|x| 1e3 * x));
    Panel::new(format!("{} (N)", CHANNELS[at[1]]), [x, y], 150, lines)
}

/// What each hypothesis leaves of a record, over the noise.
fn left_panels(record: &Record, answer: &RobustAnswer, at: [usize; 2]) -> Vec<Panel> {
    let Some(explanation) = &answer.explanation else {
        return Vec::new();
    };
    let cleaned = series(&explanation.records, at);
    let left = explanation.expected.each_ref().map(|expected| {
        let pairs = cleaned.iter().zip(series(expected, at));
        let left = pairs.map(|(force, expected)| force - expected);
        left.collect::<Vec<f64>>()
    });
    let noise_sd = answer.noise_sd[at[0]].into_array()[at[1]].unwrap_or_default();
    let sizes = left.iter().flatten().map(|left| left.abs());
    let most = 1.05 * sizes.fold(2.0 * noise_sd, f64::max).max(LEAST);
    let x = roomy(record.positions().iter().map(|x| 1e3 * x));
    let panel = |(hypothesis, left): (usize, &Vec<f64>)| {
        let (name, colour) = HYPOTHESES[hypothesis];
        let mut panel = residual_panel(format!("What is left {name} (N)"), x, noise_sd);
        let dots = Line::new(colour, points(record, left).collect());
        panel.lines.push(dots.wide(0.0).dotted(2));
        panel.y = [-most, most];
        // The key stands once.
        panel.key.truncate(1 - hypothesis);
        panel
    };
    left.iter().enumerate().map(panel).collect()
}

/// An empty panel for what is left of a record, with the band of two standard deviations of the noise.
pub(super) fn residual_panel(heading: String, x: [f64; 2], noise_sd: f64) -> Panel {
    let ([from, to], noise) = (x, 2.0 * noise_sd);
    let band = vec![(from, -noise), (to, -noise), (to, noise), (from, noise)];
    let zero = Line::new(INK, vec![(from, 0.0), (to, 0.0)]).wide(1.0);
    let words = format!("noise: two standard deviations, {} N", digits(noise));
    Panel {
        cells: vec![Cells {
            fill: BAND,
            edge: BAND,
            areas: vec![band],
        }],
        key: vec![Line::area(BAND, Vec::new()).named(words)],
        ..Panel::new(heading, [x, [-noise, noise]], 60, vec![zero])
    }
}

/// The probability of each value of a parameter that the bank varies, as a bar.
fn marginal(bank: &Bank, place: &RobustPlace, axis: usize) -> Option<Panel> {
    let interval = place.intervals[axis]?;
    let (_, _, scale) = words(Parameter::ALL[axis]);
    let values: Vec<f64> = bank.axes()[axis].iter().map(|x| scale * x).collect();
    let (count, half) = (values.len(), |a: f64, b: f64| 0.5 * (a + b));
    let ends = (0..=count).map(|at| match at {
        0 => values[0] - half(values[1], -values[0]),
        at if at == count => values[at - 1] + half(values[at - 1], -values[at - 2]),
        at => half(values[at - 1], values[at]),
    });
    let ends: Vec<f64> = ends.collect();
    let cells = ends.windows(2).map(|pair| [pair[0], pair[1]]);
    let bars: Vec<_> = cells.zip(place.marginals[axis].iter().copied()).collect();
    let x = [ends[0], ends[count]];
    Some(Panel {
        heading: "Probability, if there is one".into(),
        ..posterior(axis, &bars, x, interval, "mean")
    })
}
