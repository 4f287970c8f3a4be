//! The report and the dossier as a browser lays them out: nothing overflows, nothing overlaps, nothing is said on the console.
//!
//! Needs Chromium. Without one it passes with a notice, unless `PALPATE_REQUIRE_CHROMIUM` is set.

mod browser;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use browser::{Browser, Scheme};

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
    let phantom =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/phantom.toml"))
            .unwrap()
            .lines()
            .map(|line| match line.starts_with("name =") {
                true => format!("name = \"{}\"\n", "a_name_without_any_space_".repeat(3)),
                false => format!("{line}\n"),
            })
            .collect::<String>();
    fs::write(folder.join("long.toml"), phantom).unwrap();
    fs::write(
        folder.join("gel.csv"),
        "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n\
         0,0,0,0\n0,5,0,0\n3,0,0.9,0\n3,5,0.8,-0.1\n",
    )
    .unwrap();
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_palpate"))
            .current_dir(folder)
            .args(arguments)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
    };
    run(&[
        "import-map",
        "gel.csv",
        "--note",
        "by hand",
        "--out",
        "gel.json",
    ]);
    let config = "phantoms = [\"2.6\", \"4.6\", \"6.6\", \"8.6\", \"long.toml\"]\nmeasured = [\"gel.json\"]\n\
                  laterals_mm = \"-10:10:2\"\n[mesh]\nsize_mm = 2.0\n";
    fs::write(folder.join("run.toml"), config).unwrap();
    run(&["run", "--config", "run.toml", "--out", "out"]);
    folder.join("out/report.html")
}

// Verifies: REP-064, REP-065.
#[test]
fn the_page_fits_phones_and_screens() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = folder("fits");
    let page = report(&here);
    let figures = fs::read_dir(here.join("out/figures")).unwrap().count();
    for scheme in [Scheme::Light, Scheme::Dark] {
        for width in WIDTHS {
            let seen = browser.look(&page, width, scheme);
            assert_eq!(seen.width, width);
            assert_eq!(seen.is_dark, scheme == Scheme::Dark);
            assert_eq!(seen.figures, figures);
            assert!(seen.texts > 10 * figures, "{}", seen.texts);
            assert!(seen.faults.is_empty(), "{width} px: {:#?}", seen.faults);
            assert!(seen.console.is_empty(), "{:?}", seen.console);
        }
    }
}

// Verifies: EVD-006.
#[test]
fn the_dossier_fits_phones_and_screens() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let here = folder("dossier");
    let program = Path::new(env!("CARGO_BIN_EXE_palpate")).with_file_name("palpate-verify");
    assert!(program.exists(), "first: cargo build -p palpate-verify");
    let mut command = Command::new(program);
    command
        .args(["--only", "vectors,timing", "--out"])
        .arg(&here);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    for scheme in [Scheme::Light, Scheme::Dark] {
        for width in WIDTHS {
            let seen = browser.look(&here.join("dossier.html"), width, scheme);
            assert_eq!(seen.width, width);
            assert!(seen.faults.is_empty(), "{width} px: {:#?}", seen.faults);
            assert!(seen.console.is_empty(), "{:?}", seen.console);
        }
    }
}

/// The same look at pages with planted faults: it must see them.
// Verifies: REP-064, REP-065.
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
    for (markup, word) in planted {
        let page = here.join("page.html");
        fs::write(
            &page,
            format!("<!DOCTYPE html><title>t</title><body>{markup}</body>"),
        )
        .unwrap();
        for width in WIDTHS {
            let seen = browser.look(&page, width, Scheme::Light);
            let found = seen.faults.iter().any(|fault| fault.contains(word));
            assert!(found, "{markup} at {width} px: {:?}", seen.faults);
        }
    }
    let page = here.join("page.html");
    fs::write(
        &page,
        "<!DOCTYPE html><title>t</title><script>console.error('planted')</script>",
    )
    .unwrap();
    let seen = browser.look(&page, 400, Scheme::Light);
    assert!(seen.faults.is_empty(), "{:?}", seen.faults);
    assert!(
        seen.console.iter().any(|line| line.contains("planted")),
        "{:?}",
        seen.console
    );
}
