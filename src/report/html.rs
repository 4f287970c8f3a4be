//! The page.
use super::{Figure, Findings, Study};

/// A self-contained page.
pub fn html(_study: &Study, findings: &Findings, figures: &[Figure]) -> String {
    let _ = (findings, figures);
    String::new()
}
