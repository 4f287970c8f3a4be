//! The report and the dossier as a browser lays them out: nothing overflows, nothing overlaps, nothing is said on the console.
//!
//! Needs Chromium. Without one it passes with a notice, unless `PALPATE_REQUIRE_CHROMIUM` is set.
#![cfg(feature = "cli")]

mod browser;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use browser::{Browser, Scheme, Seen};

/// A phone, a tablet, a screen.
const WIDTHS: [u32; 3] = [400, 800, 1400];

/// A fresh folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("report-page-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs the paper's phantoms on a coarse mesh, one more with a long name, and a measured map, and gives the page.
fn report(folder: &Path) -> PathBuf {
    let phantom = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/phantom.toml");
    let phantom = fs::read_to_string(phantom).unwrap();
    let name = "a_name_without_any_space_".repeat(3);
    let lines = phantom
        .lines()
        .map(|line| match line.starts_with("name =") {
            true => format!("name = \"{name}\"\n"),
            false => format!("{line}\n"),
        });
    let long: String = lines.collect();
    let gel = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n0,0,0,0\n0,5,0,0\n3,0,0.9,0\n3,5,0.8,-0.1\n";
    let config = "phantoms = [\"2.6\", \"4.6\", \"6.6\", \"8.6\", \"long.toml\"]\nmeasured = [\"gel.json\"]\n\
                  laterals_mm = \"-10:10:2\"\n[mesh]\nsize_mm = 2.0\n";
    for (file, text) in [
        ("long.toml", &*long),
        ("gel.csv", gel),
        ("run.toml", config),
    ] {
        fs::write(folder.join(file), text).unwrap();
    }
    for arguments in [
        "import-map gel.csv --note hand --out gel.json",
        "run --config run.toml --out out",
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
        command.current_dir(folder).args(arguments.split(' '));
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
    }
    folder.join("out/report.html")
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
    let here = folder("fits");
    let page = report(&here);
    let figures = fs::read_dir(here.join("out/figures")).unwrap().count();
    for seen in looks(&browser, &page) {
        assert_eq!(seen.figures, figures);
        assert!(seen.texts > 10 * figures, "{}", seen.texts);
    }
}

#[test]
fn the_dossier_fits_phones_and_screens() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = folder("dossier");
    let program = Path::new(env!("CARGO_BIN_EXE_palpate")).with_file_name("palpate-verify");
    assert!(program.exists(), "first: cargo build -p palpate-verify");
    let mut command = Command::new(program);
    command.args(["--only", "vectors,timing", "--out"]);
    let output = command.arg(&here).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    looks(&browser, &here.join("dossier.html"));
}

/// The same look at pages with planted faults: it must see them.
// Verifies: REP-064.
#[test]
fn faults_are_seen() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = folder("faults");
    let planted = [
        ("<div style=\"width: 1500px\">wide</div>", "outside"),
        (
            "<div style=\"overflow: hidden; width: 9rem; white-space: nowrap\">a line that is too long for it</div>",
            "cut off",
        ),
        (
            "<svg viewBox=\"0 0 9 9\"><text x=\"0\" y=\"5\">long text</text></svg>",
            "outside its figure",
        ),
        (
            "<svg viewBox=\"0 0 900 99\"><text x=\"9\" y=\"50\">one</text><text x=\"14\" y=\"52\">two</text></svg>",
            "overlap",
        ),
    ];
    let page = here.join("page.html");
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
    assert!(
        said.any(|line| line.contains("planted")),
        "{:?}",
        seen.console
    );
}
