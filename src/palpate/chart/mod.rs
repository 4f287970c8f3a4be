//! Line charts as SVG, and those that `palpate detect`, `calibrate` and `reach` draw.
//!
//! | file | content |
//! |---|---|
//! | `bank.rs`, `reach.rs` | where an inclusion lies by a bank, and how deep one can be found |
//! | `coverage.rs` | what a sweep has told of each place |
//! | `explanation.rs` | a record beside what explains it |
//! | `calibration.rs` | a force–depth curve beside its fit |
//! | `panel.rs` | what a chart is made of |
//! | `lines.rs` | how panels are drawn |
//! | `key.rs`, `style.rs` | the key above a plot; sizes and colours |

mod bank;
mod calibration;
mod coverage;
mod explanation;
mod key;
mod lines;
mod panel;
mod reach;
pub mod style;

pub use bank::place_figure;
pub use calibration::calibration_figure;
pub use coverage::coverage_figure;
pub use explanation::{answer_in_words, explanation_figure, record_panel};
pub use lines::{chart, round_range};
pub use panel::{Cells, Line, Panel, PanelKind};
pub use reach::reach_figure;

use style::{UNIT, WIDTH};

use crate::refusal::Refusal;
use crate::text::escape;

/// Chords that an ellipse is drawn with: a multiple of 4, so that a disc is drawn as high and wide as it is.
pub const CHORDS: usize = 120;

/// Corners (m) in the data coordinates of a drawing to scale, mm.
pub fn to_mm(corners: impl IntoIterator<Item = [f64; 2]>) -> Vec<(f64, f64)> {
    let corners = corners.into_iter();
    corners.map(|[x, y]| (1e3 * x, 1e3 * y)).collect()
}

/// An SVG document of `height` pixels with a head that scales and that a screen reader can read: its file name, title and alternative
/// text. The ids come from the file name, which is unique, since all figures of a report share one page.
///
/// # Errors
/// A document without a head.
///
/// Implements: REP-031.
pub fn with_head(
    svg: &str,
    height: i32,
    [file_name, title, alt]: [&str; 3],
) -> Result<String, Refusal> {
    let no_head = || Refusal::state(format!("figure {title:?} is no SVG"), "");
    let (_, body) = svg.split_once('>').ok_or_else(no_head)?;
    let id = file_name.trim_end_matches(".svg");
    let (wide, high) = (WIDTH * UNIT, height * UNIT);
    let (title, alt) = (escape(title), escape(alt));
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide} {high}\" width=\"{WIDTH}\" height=\"{height}\" \
         role=\"img\" aria-labelledby=\"{id}-title {id}-desc\">\n\
         <title id=\"{id}-title\">{title}</title>\n<desc id=\"{id}-desc\">{alt}</desc>{body}"
    ))
}
