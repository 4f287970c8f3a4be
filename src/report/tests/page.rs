//! The page as a document: headings, tables, contrast, print.

use super::study::*;
use super::{findings, html};
use crate::phantom::Phantom;
use crate::report::figures::{chart_ground, chart_inks};
use crate::report::html::STYLE;
use crate::report::{Study, figures};

fn page(study: &Study) -> String {
    let found = findings(study).unwrap();
    let drawn = figures(study, &found).unwrap();
    html(study, &found, &drawn)
}

// Verifies: REP-060, REP-066.
#[test]
fn headings_go_down_by_one_and_contents_lead_to_sections() {
    for study in [paper_study(), hostile_study()] {
        let page = page(&study);
        assert!(page.contains("<html lang=\"en\">"));
        let mut last = 0;
        for (place, _) in page.match_indices("<h") {
            let Some(level) = page[place + 2..]
                .chars()
                .next()
                .and_then(|c| c.to_digit(10))
            else {
                continue;
            };
            assert!(
                level <= last + 1,
                "h{level} after h{last}: {}",
                &page[place..place + 60]
            );
            assert!(level > 1 || last == 0, "a second h1");
            last = level;
        }
        let short = page.find("id=\"short\"").unwrap();
        assert!(short < page.find("<nav").unwrap());
        let cards = page[short..]
            .split_once("</ul>")
            .unwrap()
            .0
            .matches("<li>")
            .count();
        assert!((1..=5).contains(&cards), "{cards}");
        let links: Vec<_> = page
            .split("href=\"#")
            .skip(1)
            .map(|rest| rest.split_once('"').unwrap().0)
            .collect();
        assert!(links.len() >= 8);
        for link in links {
            assert_eq!(
                page.matches(&format!(" id=\"{link}\"")).count(),
                1,
                "{link}"
            );
        }
    }
}

// Verifies: REP-061.
#[test]
fn tables_have_captions_and_scopes() {
    let page = page(&paper_study());
    let tables: Vec<_> = page.split("<table").skip(1).collect();
    assert!(tables.len() >= 8, "{}", tables.len());
    for table in tables {
        let table = table.split_once("</table>").unwrap().0;
        let caption = table
            .split_once("<caption>")
            .unwrap()
            .1
            .split_once("</caption>")
            .unwrap()
            .0;
        assert!(caption.len() > 40, "{caption}");
        for head in table
            .split("<th")
            .skip(1)
            .filter(|head| !head.starts_with("ead"))
        {
            assert!(head.starts_with(" scope=\""), "{head}");
        }
    }
}

/// The counts are those of the paper's Table 1, the sums those of its §5 to a millinewton.
// Verifies: REP-036, REP-062, REP-063, REP-071.
#[test]
fn the_papers_tables_are_there() {
    let page = page(&paper_study());
    let table = |id: &str| {
        let start = page.find(&format!("<div id=\"{id}\">")).unwrap();
        page[start..].split_once("</table>").unwrap().0.to_string()
    };
    let first = table("table-1");
    for row in [
        ">1</th><td class=\"number\">30</td><td class=\"number\">28</td><td class=\"number\">27</td><td class=\"number\">27</td>",
        ">7</th><td class=\"number\">17</td><td class=\"number\">15</td><td class=\"number\">19</td><td class=\"number\">18</td>",
        ">mean</th><td class=\"number\">29.2</td><td class=\"number\">27.7</td><td class=\"number\">25.3</td><td class=\"number\">18.9</td>",
    ] {
        assert!(first.contains(row), "{row} not in {first}");
    }
    assert_eq!(first.matches("<th scope=\"row\">").count(), 3 * (10 + 6));
    assert_eq!(first.matches("scope=\"rowgroup\"").count(), 3);
    let second = table("table-2");
    for words in [
        "Sensor (ATI)",
        ">20<",
        ">0.5<",
        ">140<",
        ">200<",
        ">93<",
        ">168.1<",
        ">220.6<",
    ] {
        assert!(second.contains(words), "{words}");
    }
    let bridge = table("table-bridge");
    assert_eq!(bridge.matches("<th scope=\"row\"").count(), 12);
    // Sweeps of ±5 to ±10 mm, each with the peak and the whole, hold two positions or more.
    let weights = table("table-weights");
    assert_eq!(weights.matches("matched filter</td>").count(), 6);
    for words in ["±5<", "±10<", "the 36 ranges", " to "] {
        assert!(weights.contains(words), "{words} not in {weights}");
    }
    assert_eq!(page.matches("36 ranges counted, it is rejected").count(), 3);
    assert!(page.contains("Figure 7 is not made again"));
    let mut study = paper_study();
    study.measured = vec![map_with("mine", |_| 0.1, |_| 0.0)];
    let page = self::page(&study);
    assert!(page.contains("Figure 7. Measured forces, “mine”"));
    assert!(!page.contains("Figure 7 is not made again"));
    study.maps.clear();
    assert!(self::page(&study).contains("are not set against the answers"));
}

type Colour = [f64; 3];

/// `#abc` and `#aabbcc` as sRGB, 0 to 255.
fn colour(text: &str) -> Colour {
    let digits: Vec<_> = text
        .trim_start_matches('#')
        .chars()
        .map(|c| f64::from(c.to_digit(16).unwrap()))
        .collect();
    match digits[..] {
        [r, g, b] => [17.0 * r, 17.0 * g, 17.0 * b],
        [a, b, c, d, e, f] => [16.0 * a + b, 16.0 * c + d, 16.0 * e + f],
        _ => panic!("{text}"),
    }
}

/// Contrast as WCAG 2 defines it.
fn contrast(a: Colour, b: Colour) -> f64 {
    let luminance = |colour: Colour| {
        let linear = colour.map(|value| match value / 255.0 {
            v if v <= 0.04045 => v / 12.92,
            v => ((v + 0.055) / 1.055).powf(2.4),
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05
    };
    let (a, b) = (luminance(a), luminance(b));
    a.max(b) / a.min(b)
}

/// The custom properties of one `:root { … }`, from `start` of the stylesheet on.
fn property(start: &str, name: &str) -> Colour {
    let (_, rest) = start.split_once(&format!("--{name}: ")).unwrap();
    colour(rest.split_once(';').unwrap().0)
}

// Verifies: REP-067.
#[test]
fn words_stand_out_from_their_ground() {
    let dark = STYLE.find("prefers-color-scheme: dark").unwrap();
    let print = STYLE.find("@media print").unwrap();
    for (scheme, place) in [("light", 0), ("dark", dark), ("print", print)] {
        let style = &STYLE[place..];
        for ground in ["ground", "card", "note-ground", "warn-ground"] {
            for ink in ["ink", "soft", "accent"] {
                let found = contrast(property(style, ink), property(style, ground));
                assert!(found >= 4.5, "{scheme}: {ink} on {ground}: {found:.2}");
            }
        }
        if scheme == "print" {
            assert_eq!(property(style, "ground"), [255.0; 3]);
        }
    }
    assert_eq!(contrast([0.0; 3], [255.0; 3]), 21.0);
}

/// `invert(.88) hue-rotate(180deg)` as the standard for filters defines them, on sRGB values.
fn in_the_dark(colour: Colour) -> Colour {
    let inverted = colour.map(|value| 0.88 * 255.0 + (1.0 - 2.0 * 0.88) * value);
    let rows = [
        [-0.574, 1.43, 0.144],
        [0.426, 0.43, 0.144],
        [0.426, 1.43, -0.856],
    ];
    rows.map(|row| {
        let sum: f64 = row.iter().zip(inverted).map(|(a, b)| a * b).sum();
        sum.clamp(0.0, 255.0)
    })
}

// Verifies: REP-034.
#[test]
fn charts_stand_out_in_light_and_dark() {
    assert!(STYLE.contains("filter: invert(.88) hue-rotate(180deg)"));
    let ground = chart_ground();
    for (name, ink, needed) in chart_inks() {
        let light = contrast(ink, ground);
        let dark = contrast(in_the_dark(ink), in_the_dark(ground));
        assert!(light >= needed, "{name}: {light:.2}");
        assert!(dark >= needed, "{name} in the dark: {dark:.2}");
    }
}

// Verifies: REP-068.
#[test]
fn print_breaks_no_figure() {
    let print = STYLE.split_once("@media print").unwrap().1;
    let unbroken = print
        .lines()
        .find(|line| line.contains("break-inside: avoid"))
        .unwrap();
    for part in ["figure", "tr", ".note", ".warning", ".numbers li"] {
        assert!(unbroken.contains(part), "{part}");
    }
    // Dark colours are for screens alone.
    assert_eq!(
        STYLE.matches("prefers-color-scheme: dark").count(),
        STYLE
            .matches("screen and (prefers-color-scheme: dark)")
            .count()
    );
}

// Verifies: REP-060, PSY-087.
#[test]
fn the_page_begins_with_no_more_than_holds_over_every_sweep() {
    let mut study = paper_study();
    let opening = |study: &Study| {
        let page = page(study);
        page.split("<nav").next().unwrap().to_string()
    };
    // The force falls in proportion everywhere: whatever the subjects felt fits as well.
    assert!(opening(&study).contains("do not tell whether subjects feel the level"));
    // A level of 0.3 N over every inclusion, and a change that falls as right answers do.
    let changes = [("2.6", 0.6), ("4.6", 0.4), ("6.6", 0.25), ("8.6", 0.06)];
    study.maps = changes
        .map(|(name, change)| {
            let normal = move |x: f64| if x == 0.0 { 0.3 + change } else { 0.3 };
            let lateral = move |x: f64| {
                if x.abs() == 5e-3 {
                    change * x.signum()
                } else {
                    0.0
                }
            };
            map(Phantom::builtin(name).ok(), &DEPTHS, normal, lateral)
        })
        .into();
    let text = opening(&study);
    assert!(
        text.contains("are explained worst by the whole level"),
        "{text}"
    );
}
