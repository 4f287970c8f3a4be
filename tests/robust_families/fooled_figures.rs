//! The figures of `docs/how-to/fooled.md`: what disturbs a sweep, without a disc and over one, and what `detect` makes of it.

use std::fs;
use std::path::Path;

use super::families::{DEPTH, Ends, GELS, Happens, MOTIONS, nothing, plain};
use super::{Gel, bank, detectors, fooled_page, gel, positions, recorded};
use crate::ROOT;
use palpate::chart::style::GREY;
use palpate::chart::{Line, Panel, answer_in_words, chart, record_panel};
use palpate::force::Force;
use palpate::force_map::ForceTable;
use palpate::robust::RobustDetector;
use palpate::stats::random::Generator;
use palpate::text::extremes;
use palpate::trace::Record;

/// The noise of the sweeps, N.
const SD: f64 = 0.02;

/// A family of `families.rs`, in words, by its first two numbers, and the channel in which it shows: 0 lateral, 1 normal.
#[rustfmt::skip]
const PICTURES: [(&str, &str, &str, [f64; 2], usize); 5] = [
    ("dome", "domed", "the surface is domed by 0.2 mm", [0.0, 1.0], 1),
    ("relaxation", "relaxes 10-20 %", "the gel relaxes by 15 %", [0.5, 0.5], 1),
    ("friction", "friction 0.1-0.3", "the probe rubs, with a coefficient of 0.2", [0.5, 0.5], 0),
    ("floor", "floor sliding", "the gel slides on its floor", [0.0, 0.0], 1),
    ("walk", "random walk", "the sensor wanders by 0.2 N", [0.5, 0.0], 1),
];

/// What happens to which gel in a family: that of the maps, unless the family is another gel.
fn family(name: &str, own: &Gel) -> (Gel, (Happens, Ends)) {
    match MOTIONS.iter().find(|of| of.0 == name) {
        Some((_, happens, ends)) => (own.clone(), (*happens, *ends)),
        None => {
            let (_, change) = GELS.iter().find(|of| of.0 == name).unwrap();
            (gel(*change, &[DEPTH]), (plain as Happens, nothing as Ends))
        }
    }
}

/// The record without (0) and with the disc 4.6 mm deep (1) in a panel each, and what is said of it.
fn picture(
    detector: &RobustDetector<'_>,
    [gel, own]: [&Gel; 2],
    how: (Happens, Ends),
    u: &[f64; 8],
    channel: usize,
) -> (Vec<Panel>, [Vec<String>; 2]) {
    let generator = Generator::new(1999, 2000);
    let of = |table: &ForceTable, how, sd| {
        let [lateral, normal] = recorded(table, how, u, [DEPTH, sd], &generator, 0);
        Record::new("sweep", &positions(), Force::new(&lateral, &normal)).unwrap()
    };
    let mut said = [Vec::new(), Vec::new()];
    let mut panels = Vec::new();
    for (disc, place) in ["No disc", "A disc 4.6 mm deep"].into_iter().enumerate() {
        let record = of(&gel[disc], how, SD);
        let answer = detector.judge(&[record.forces()]).unwrap();
        let mut panel = record_panel(&record, &answer, [0, channel]);
        let undisturbed = of(&own[disc], (plain, nothing), 0.0);
        let forces = undisturbed.forces().into_array()[channel];
        panel.y = extremes(panel.y.into_iter().chain(forces.iter().copied())).unwrap();
        let points = positions().into_iter().zip(forces);
        let points = points.map(|(x, force)| (1e3 * x, *force)).collect();
        panel
            .lines
            .insert(0, Line::new(GREY, points).named("undisturbed"));
        said[disc] = answer_in_words(&answer);
        panel.caption = [vec![format!("{place}.")], said[disc].clone()].concat();
        panels.push(panel);
    }
    panels[1].x_name = "Position x (mm)".into();
    (panels, said)
}

/// The decision, and the probability of an inclusion.
fn briefly(said: &[String]) -> String {
    let (decided, probability) = said[0]
        .split_once(" Probability of an inclusion: ")
        .unwrap();
    let decided = decided.split([':', '.']).next().unwrap_or_default();
    format!(
        "{}, {}",
        decided.to_lowercase(),
        probability.trim_end_matches('.')
    )
}

#[test]
#[ignore = "solves a bank and three gels: a minute without optimisation"]
fn the_figures_of_what_can_fool_it_are_those_of_the_program() {
    let bank = bank();
    let [_, detector] = detectors(&bank);
    let own = gel(|_| (), &[3.8e-3, 3.9e-3, 4e-3, 4.1e-3, 4.2e-3]);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fooled");
    fs::create_dir_all(&folder).unwrap();
    let page = fooled_page();
    let mut wrong = Vec::new();
    for (file, name, words, [first, second], channel) in PICTURES {
        let (gel, how) = family(name, &own);
        let u = [first, second, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5];
        let (panels, said) = picture(&detector, [&gel, &own], how, &u, channel);
        let alt = format!(
            "No disc: {} A disc: {}",
            said[0].join(" "),
            said[1].join(" ")
        );
        let svg = chart(&panels, [file, &format!("If {words}"), &alt]).unwrap();
        let path = folder.join(format!("{file}.svg"));
        fs::write(&path, &svg).unwrap();
        let [without, with] = said.each_ref().map(|said| briefly(said));
        let row = format!("| {words} | {without} | {with} |");
        println!("{row}");
        let kept = Path::new(ROOT).join(format!("docs/fooled/{file}.svg"));
        if fs::read_to_string(kept).is_ok_and(|kept| kept == svg) && page.contains(&row) {
            continue;
        }
        wrong.push(format!(
            "docs/fooled/{file}.svg is not {}, or the page has no row {row}",
            path.display()
        ));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
