//! The report and the dossier as a browser lays them out: nothing overflows, nothing overlaps, nothing is said on the console.
//!
//! Needs Chromium. Without one it passes with a notice, unless `PALPATE_REQUIRE_CHROMIUM` is set.

mod browser;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::program::Place;
use browser::{Browser, Scheme, Seen};

/// A phone, a tablet, a screen.
const WIDTHS: [u32; 3] = [400, 800, 1400];

/// Runs the paper's phantoms on a coarse mesh, one more with a long name, and a measured map, and gives the page.
fn report(here: &Place) -> PathBuf {
    let name = "a_name_without_any_space_".repeat(3);
    let phantom = include_str!("../../docs/phantom.toml").lines();
    let lines = phantom.map(|line| match line.starts_with("name =") {
        true => format!("name = \"{name}\"\n"),
        false => format!("{line}\n"),
    });
    here.write("long.toml", lines.collect::<String>());
    let gel = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n0,0,0,0\n0,5,0,0\n3,0,0.9,0\n3,5,0.8,-0.1\n";
    here.write("gel.csv", gel);
    let config = "phantoms = [\"2.6\", \"4.6\", \"6.6\", \"8.6\", \"long.toml\"]\nmeasured = [\"gel.json\"]\n\
                  laterals_mm = \"-10:10:2\"\n[mesh]\nsize_mm = 2.0\n";
    here.write("run.toml", config);
    here.succeed("import-map gel.csv --note hand --out gel.json");
    here.succeed("run --config run.toml --out out");
    here.at("out/report.html")
}

/// Looks at a page on every device, light and dark, and finds no fault.
fn looks(browser: &Browser, page: &Path) -> Vec<Seen> {
    let schemes = [Scheme::Light, Scheme::Dark].into_iter();
    let looks = schemes.flat_map(|scheme| WIDTHS.map(|width| (scheme, width)));
    let look = |(scheme, width)| {
        let seen = browser.look(page, width, scheme);
        assert_eq!(seen.width, width);
        assert_eq!(seen.is_dark, scheme == Scheme::Dark);
        assert!(seen.faults.is_empty(), "{width} px: {:#?}", seen.faults);
        assert!(seen.console.is_empty(), "{:?}", seen.console);
        seen
    };
    looks.map(look).collect()
}

// Verifies: REP-064.
#[test]
fn the_page_fits_phones_and_screens() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = Place::new("report-page-fits");
    let page = report(&here);
    let figures = fs::read_dir(here.at("out/figures")).unwrap().count();
    for seen in looks(&browser, &page) {
        assert_eq!(seen.figures, figures);
        assert!(seen.texts > 10 * figures, "{}", seen.texts);
    }
}

#[test]
#[ignore = "slow, and rarely breaks"]
fn the_dossier_fits_phones_and_screens() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = Place::new("report-page-dossier");
    let program = Path::new(crate::program::PROGRAM).with_file_name("palpate-verify");
    assert!(program.exists(), "first: cargo build -p palpate-verify");
    let mut command = Command::new(program);
    command.args(["--only", "rates,timing", "--out"]);
    let output = command.arg(here.at("")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    looks(&browser, &here.at("dossier.html"));
}

/// The same look at pages with planted faults: it must see them.
// Verifies: REP-064.
#[test]
#[ignore = "slow, and rarely breaks"]
fn faults_are_seen() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = Place::new("report-page-faults");
    let wide = "<div style=\"width: 1500px\">wide</div>";
    let cut = "<div style=\"overflow: hidden; width: 9rem; white-space: nowrap\">a line that is too long for it</div>";
    let beyond = "<svg viewBox=\"0 0 9 9\"><text x=\"0\" y=\"5\">long text</text></svg>";
    let two = "<svg viewBox=\"0 0 900 99\"><text x=\"9\" y=\"50\">one</text><text x=\"14\" y=\"52\">two</text></svg>";
    let planted = [
        (wide, "outside"),
        (cut, "cut off"),
        (beyond, "outside its figure"),
        (two, "overlap"),
    ];
    let page = here.at("page.html");
    let write = |markup: &str| {
        let text = format!("<!DOCTYPE html><title>t</title><body>{markup}</body>");
        fs::write(&page, text).unwrap();
    };
    for (markup, word) in planted {
        write(markup);
        for width in WIDTHS {
            let faults = browser.look(&page, width, Scheme::Light).faults;
            let found = faults.iter().any(|fault| fault.contains(word));
            assert!(found, "{markup} at {width} px: {faults:?}");
        }
    }
    write("<script>console.error('planted')</script>");
    let seen = browser.look(&page, 400, Scheme::Light);
    assert!(seen.faults.is_empty(), "{:?}", seen.faults);
    let mut said = seen.console.iter();
    let holds = said.any(|line| line.contains("planted"));
    assert!(holds, "{:?}", seen.console);
}
