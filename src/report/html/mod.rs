//! The page: one file that opens from disk, without scripts and without anything from a network.
//!
//! | file | section |
//! |---|---|
//! | `opening.rs` | what was found, contents, set-up |
//! | `forces.rs`, `detection.rs`, `people.rs`, `bridge.rs`, `noise.rs` | the paper, part by part |
//! | `comparison.rs` | paper, here, why |
//! | `quality.rs`, `closing.rs` | certificates; how to rerun, limits |
//! | `table.rs`, `style.css` | how tables are written, how everything looks |

mod bridge;
mod closing;
mod comparison;
mod detection;
mod forces;
mod noise;
mod opening;
mod people;
mod quality;
pub mod table;

use super::text::{escape, prose};
use super::{Figure, Findings, Study, Topic};

/// How the page looks.
///
/// Implements: REP-034, REP-064, REP-067, REP-068.
pub const STYLE: &str = include_str!("style.css");
/// What the name of the SVG namespace is called inside HTML: nothing, since HTML knows `<svg>` by itself.
const NAMESPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

/// What the page is made of.
struct Page<'a> {
    study: &'a Study,
    findings: &'a Findings,
    figures: &'a [Figure],
}

/// The sections below the opening: what the contents link to, and their headings.
const CONTENTS: [(&str, &str); 8] = [
    ("setup", "Set-up"),
    ("forces", "Forces and signals"),
    ("detection", "Detection"),
    ("people", "People"),
    ("noise", "Noise"),
    ("comparison", "Paper | here | why"),
    ("quality", "Quality of the maps"),
    ("closing", "How to rerun, and limits"),
];

/// One self-contained page: what was found, the figures and tables, the comparison, the certificates.
///
/// ```
#[doc = include_str!("../study.example")]
/// use palpate::report::{figures, findings, html};
///
/// let findings = findings(&study)?;
/// let page = html(&study, &findings, &figures(&study, &findings)?);
/// // One file, which loads nothing.
/// assert!(page.starts_with("<!DOCTYPE html>") && !page.contains(" src="));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: REP-040, REP-041, REP-042, REP-043, REP-060, REP-065, REP-066.
pub fn html(study: &Study, findings: &Findings, figures: &[Figure]) -> String {
    let page = Page {
        study,
        findings,
        figures,
    };
    let sections = [
        opening::setup,
        forces::forces,
        detection::detection,
        people::people,
        noise::noise,
        comparison::comparison,
        quality::quality,
        closing::closing,
    ];
    let body: String = sections
        .into_iter()
        .zip(CONTENTS)
        .map(|(content, (id, heading))| section(id, heading, &content(&page)))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Inclusion probing: report of palpate</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{}<main>\n{}{body}</main>\n\
         <footer class=\"soft\">Written by palpate {}.</footer>\n</body>\n</html>\n",
        opening::header(),
        opening::opening(&page),
        env!("CARGO_PKG_VERSION")
    )
}

/// A section with its heading, which names it for a screen reader.
pub fn section(id: &str, heading: &str, markup: &str) -> String {
    format!(
        "<section id=\"{id}\" aria-labelledby=\"{id}-heading\">\n<h2 id=\"{id}-heading\">{}</h2>\n{markup}</section>\n",
        escape(heading)
    )
}

impl Page<'_> {
    /// All figures of a topic, in their order.
    fn figures(&self, topic: Topic) -> String {
        let figures = self.figures.iter().filter(|figure| figure.topic == topic);
        let figures: String = figures.map(picture).collect();
        format!("<div class=\"figures\">\n{figures}</div>\n")
    }
}

fn picture(figure: &Figure) -> String {
    format!(
        "<figure>\n<div class=\"picture\">{}</div>\n<figcaption><strong>{}</strong>{} <span class=\"file\">({})</span></figcaption>\n</figure>\n",
        figure.svg.replacen(NAMESPACE, "", 1),
        prose(&figure.title),
        prose(&figure.caption),
        escape(&figure.file_name)
    )
}
