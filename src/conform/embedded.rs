//! The vectors that are part of this program, so that it can check others wherever it is.

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../vectors/", $name)))),*]
    };
}

/// Every file of `vectors/` that counts, by name.
///
/// Implements: ORA-040.
pub(super) const FILES: &[(&str, &str)] = files![];
