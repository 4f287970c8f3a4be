//! A headless Chromium that holds a page in a frame of a given width and tells what is wrong with it.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Names of the program on the systems that have it.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
/// What it is told beside the page: to show nothing, to ask nothing, to use no network, and to print what it made of the page.
const SWITCHES: &str = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --allow-file-access-from-files --enable-logging=stderr --dump-dom --hide-scrollbars";
/// A page takes a second or two; a browser that hangs shall not hang the tests.
const PATIENCE: Duration = Duration::from_secs(120);

/// What the page is asked to look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    Light,
    Dark,
}

/// What was seen of a page.
#[derive(Debug)]
pub struct Seen {
    /// Width that the page had, pixels.
    pub width: u32,
    /// Whether it was dark.
    pub is_dark: bool,
    /// Number of SVG figures.
    pub figures: usize,
    /// Number of pieces of text in them.
    pub texts: usize,
    /// Overflow, overlap, text that is cut off: one line each.
    pub faults: Vec<String>,
    /// What was said on the console.
    pub console: Vec<String>,
}

/// The program.
pub struct Browser {
    program: PathBuf,
}

impl Browser {
    /// The first that is installed; says so where there is none.
    ///
    /// # Panics
    /// If there is none although `PALPATE_REQUIRE_CHROMIUM` is set.
    pub fn find() -> Option<Browser> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let mut programs =
            std::env::split_paths(&path).flat_map(|folder| NAMES.map(|name| folder.join(name)));
        let found = programs.find(|program| program.is_file());
        if found.is_none() {
            let notice = "no Chromium is installed: the layout of the report was not checked";
            let is_required = std::env::var_os("PALPATE_REQUIRE_CHROMIUM").is_some();
            assert!(!is_required, "{notice}");
            eprintln!("{notice}");
        }
        found.map(|program| Browser { program })
    }

    /// Opens `page` in a frame of `width` pixels: a window cannot be as narrow as a phone.
    pub fn look(&self, page: &Path, width: u32, scheme: Scheme) -> Seen {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = page.parent().unwrap().join(format!("look-{count}"));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let wrapper = folder.join("wrapper.html");
        let markup = format!(
            "<!DOCTYPE html><title>wrapper</title><style>body{{margin:0}}iframe{{border:0;width:{width}px;height:900px}}</style>\
             <iframe src=\"file://{}\"></iframe><pre></pre><script>{}</script>",
            page.display(),
            include_str!("probe.js")
        );
        fs::write(&wrapper, markup).unwrap();
        let (dom, log) = self.run(&folder, &wrapper, scheme);
        let said = log.lines().filter(|line| line.contains("CONSOLE"));
        let result = dom
            .split_once("<pre>")
            .and_then(|(_, rest)| rest.split_once("</pre>"));
        let (result, _) = result.unwrap_or_else(|| panic!("no result: {dom}\n{log}"));
        // The DOM is printed as markup.
        let result = result
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&nbsp;", " ")
            .replace("&amp;", "&");
        let result: serde_json::Value = serde_json::from_str(&result)
            .unwrap_or_else(|error| panic!("{error}: {result:?}\n{log}"));
        let number = |key: &str| result[key].as_u64().unwrap();
        let faults = result["faults"].as_array().unwrap().iter();
        Seen {
            width: number("width") as u32,
            is_dark: result["dark"].as_bool().unwrap(),
            figures: number("figures") as usize,
            texts: number("texts") as usize,
            faults: faults.map(|fault| fault.as_str().unwrap().into()).collect(),
            console: said.map(String::from).collect(),
        }
    }

    /// The DOM of `page` after it has loaded, and the log.
    fn run(&self, folder: &Path, page: &Path, scheme: Scheme) -> (String, String) {
        let (dom, log) = (folder.join("dom.html"), folder.join("log.txt"));
        let profile = format!("--user-data-dir={}", folder.join("profile").display());
        let dark = match scheme {
            Scheme::Dark => "--blink-settings=preferredColorScheme=0",
            Scheme::Light => "--blink-settings=preferredColorScheme=1",
        };
        let mut child = Command::new(&self.program)
            .args(SWITCHES.split(' '))
            .args(["--window-size=1600,1000", dark, &profile])
            .arg(format!("file://{}", page.display()))
            .stdin(Stdio::null())
            .stdout(File::create(&dom).unwrap())
            .stderr(File::create(&log).unwrap())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if start.elapsed() > PATIENCE {
                let _ = child.kill();
                panic!("the browser hangs: {}", fs::read_to_string(&log).unwrap());
            }
            sleep(Duration::from_millis(20));
        }
        let read = |path: &Path| String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned();
        (read(&dom), read(&log))
    }
}
