//! The page as a document: headings, tables, contrast, print.

use super::run::*;
use crate::report::Run;
use crate::report::html::STYLE;
use palpate::chart::style::{GREY, INK, PALETTE, ramp};
use palpate::phantom::Phantom;
use palpate_asserts::assert_has;

// Verifies: REP-060, REP-061.
#[test]
fn headings_go_down_by_one_and_contents_lead_to_sections() {
    for run in [paper_run(), hostile_run()] {
        let page = made(&run).page;
        assert!(page.contains("<html lang=\"en\">"));
        let digit = |tag: &str| tag.chars().next().and_then(|c| c.to_digit(10));
        let mut last = 0;
        for level in page.split("<h").skip(1).filter_map(digit) {
            assert!(level <= last + 1, "h{level} after h{last}");
            assert!(level > 1 || last == 0, "a second h1");
            last = level;
        }
        let short = page.find("id=\"short\"").unwrap();
        assert!(short < page.find("<nav").unwrap());
        let cards = between(&page[short..], "", "</ul>").matches("<li>").count();
        assert!((1..=5).contains(&cards), "{cards}");
        let links = page.split("href=\"#").skip(1);
        let links: Vec<_> = links.map(|rest| between(rest, "", "\"")).collect();
        assert!(links.len() >= 8);
        for link in links {
            let sections = page.matches(&format!(" id=\"{link}\"")).count();
            assert_eq!(sections, 1, "{link}");
        }
    }
}

// Verifies: REP-061.
#[test]
fn tables_have_captions_and_scopes() {
    let page = made(&paper_run()).page;
    let tables: Vec<_> = page.split("<table").skip(1).collect();
    assert!(tables.len() >= 8, "{}", tables.len());
    for table in tables {
        let table = between(table, "", "</table>");
        let caption = between(table, "<caption>", "</caption>");
        assert!(caption.len() > 40, "{caption}");
        let heads = table.split("<th").skip(1);
        for head in heads.filter(|head| !head.starts_with("ead")) {
            assert!(head.starts_with(" scope=\""), "{head}");
        }
    }
}

/// The counts are those of the paper's Table 1, the sums those of its §5 to a millinewton.
// Verifies: REP-031, REP-041, REP-070.
#[test]
fn the_papers_tables_are_there() {
    let page = made(&paper_run()).page;
    let table = |id: &str| between(&page, &format!("<div id=\"{id}\">"), "</table>");
    let first = table("table-1");
    for (head, cells) in [
        ("1", ["30", "28", "27", "27"]),
        ("7", ["17", "15", "19", "18"]),
        ("mean", ["29.2", "27.7", "25.3", "18.9"]),
    ] {
        let cells = cells.map(|cell| format!("<td class=\"number\">{cell}</td>"));
        let row = format!(">{head}</th>{}", cells.concat());
        assert!(first.contains(&row), "{row} not in {first}");
    }
    // Sweeps of ±5 to ±10 mm, each with the peak and the whole, hold two positions or more.
    for (id, words, count) in [
        ("table-1", "<th scope=\"row\">", 3 * (10 + 6)),
        ("table-1", "scope=\"rowgroup\"", 3),
        ("table-2", "Sensor (ATI)", 1),
        ("table-bridge", "<th scope=\"row\"", 12),
        ("table-weights", "matched filter</td>", 6),
        ("table-weights", "the 36 ranges", 1),
    ] {
        assert_eq!(table(id).matches(words).count(), count, "{words} in {id}");
    }
    let noise = ">20<|>0.5<|>140<|>200<|>93<|>168.1<|>220.6<";
    assert_has(table("table-2"), noise);
    assert_has(table("table-weights"), "±5<|±10<| to ");
    assert_eq!(page.matches("36 ranges counted, it is rejected").count(), 3);
    assert!(page.contains("Figure 7 is not made again"));
    let mut run = paper_run();
    run.measured = vec![map_with("mine", |_| 0.1, |_| 0.0)];
    let page = made(&run).page;
    assert!(page.contains("Figure 7. Measured forces, “mine”"));
    assert!(!page.contains("Figure 7 is not made again"));
    run.maps.clear();
    assert!(made(&run).page.contains("are not set against the answers"));
}

type Colour = [f64; 3];

/// `#abc` and `#aabbcc` as sRGB, 0 to 255.
fn colour(text: &str) -> Colour {
    let digits = text.trim_start_matches('#');
    let each = digits.len() / 3;
    [0, 1, 2].map(|k| {
        let digits = digits[k * each..(k + 1) * each].repeat(2 / each);
        u8::from_str_radix(&digits, 16).unwrap().into()
    })
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

/// A custom property of one `:root { … }`, from `start` of the stylesheet on.
fn property(start: &str, name: &str) -> Colour {
    colour(between(start, &format!("--{name}: "), ";"))
}

// Verifies: REP-034.
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
    let [r, g, b] = inverted;
    let rotated = [
        -0.574 * r + 1.43 * g + 0.144 * b,
        0.426 * r + 0.43 * g + 0.144 * b,
        0.426 * r + 1.43 * g - 0.856 * b,
    ];
    rotated.map(|value| value.clamp(0.0, 255.0))
}

// Verifies: REP-034.
#[test]
fn charts_stand_out_in_light_and_dark() {
    assert!(STYLE.contains("filter: invert(.88) hue-rotate(180deg)"));
    let lines = PALETTE.into_iter().chain([GREY]);
    let lines = lines.chain((0..9).map(|k| ramp(k, 9)));
    let needed = lines.map(|colour| (colour, 3.0)).chain([(INK, 4.5)]);
    for (colour, needed) in needed {
        let ink = [colour.0, colour.1, colour.2].map(f64::from);
        let light = contrast(ink, [255.0; 3]);
        let dark = contrast(in_the_dark(ink), in_the_dark([255.0; 3]));
        assert!(light >= needed, "{colour:?}: {light:.2}");
        assert!(dark >= needed, "{colour:?} in the dark: {dark:.2}");
    }
}

// Verifies: REP-064.
#[test]
fn print_breaks_no_figure() {
    let (_, print) = STYLE.split_once("@media print").unwrap();
    let mut rules = print.lines();
    let unbroken = rules.find(|line| line.contains("break-inside: avoid"));
    for part in ["figure", "tr", ".note", ".warning", ".numbers li"] {
        assert!(unbroken.unwrap().contains(part), "{part}");
    }
    // Dark colours are for screens alone.
    let count = |words: &str| STYLE.matches(words).count();
    let dark = "(prefers-color-scheme: dark)";
    assert_eq!(count(dark), count(&format!("screen and {dark}")));
}

// Verifies: REP-060, PSY-085.
#[test]
fn the_page_begins_with_no_more_than_holds_over_every_sweep() {
    let mut run = paper_run();
    let opening = |run: &Run| between(&made(run).page, "", "<nav").to_string();
    // The force falls in proportion everywhere: whatever the subjects felt fits as well.
    let none = "are not explained worst by the whole level of the normal force, whose peak the paper's noise estimate rests on, over any \
                sweep of ±5 to ±10 mm";
    assert_has(&opening(&run), &none.replace('\'', "&#39;"));
    // A level of 0.3 N over every inclusion, and a change that falls as right answers do.
    let changes = [("2.6", 0.6), ("4.6", 0.4), ("6.6", 0.25), ("8.6", 0.06)];
    let changed = |(name, change): (&str, f64)| {
        let normal = move |x: f64| if x == 0.0 { 0.3 + change } else { 0.3 };
        let phantom = Phantom::builtin(name).ok();
        map(phantom, &DEPTHS, normal, at_5_mm(change))
    };
    run.maps = changes.map(changed).into();
    assert_has(&opening(&run), "are explained worst by the whole level");
    assert_has(&opening(&run), ", over every sweep of ±5 to ±10 mm, ");
}

// Verifies: REP-015, REP-020, REP-041.
#[test]
fn the_page_names_the_answers_that_count_and_a_map_of_another_gel() {
    let mut run = paper_run();
    run.maps = run.maps.drain(1..3).collect();
    let page = made(&run).page;
    assert_has(
        &page,
        "FEM playback at 4.6, 6.6 mm |the answers at 4.6, 6.6",
    );
    let alone = "The signal is not that of an inclusion alone: ";
    assert!(!page.contains(alone));
    let phantom = run.maps[0].phantom().unwrap();
    let other = phantom.changed(|parts| parts.layers[0].material.youngs_modulus *= 2.0);
    run.maps[0] = map(other.ok(), &DEPTHS, |_| 0.3, |_| 0.0);
    assert_has(&made(&run).page, alone);
}
