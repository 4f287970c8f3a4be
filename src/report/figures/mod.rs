//! The pictures.
use super::{Figure, Findings, ReportError, Study};

/// All figures of a study, in the order of the page.
pub fn figures(_study: &Study, _findings: &Findings) -> Result<Vec<Figure>, ReportError> {
    Ok(Vec::new())
}
