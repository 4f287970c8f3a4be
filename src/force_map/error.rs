//! What can be wrong with a force map.

use super::{SAME_POSITION, SYMMETRY_TOLERANCE, SmallestDet};
use crate::phantom::{InvalidPhantom, PoseError};

/// Why a force map, or an operation on one, is refused. Keys are those of the JSON file; rows and
/// columns count from 0.
///
/// ```
/// use palpate::force_map::{ForceTable, InvalidForceMap, Matrix};
///
/// let matrix = |value| Matrix::from_fn(1, 1, |_, _| value);
/// let error = ForceTable::new(vec![0.004], vec![0.0], matrix(f64::NAN), matrix(0.0)).unwrap_err();
/// assert!(matches!(error, InvalidForceMap::Force { key: "normal_force_n", row: 0, .. }));
/// assert_eq!(error.to_string(), "normal_force_n[0][0] = NaN, expected a finite number");
/// ```
///
/// Implements: MAP-013.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidForceMap {
    /// An axis has no entry.
    #[error("{key} is empty, expected at least one position")]
    EmptyAxis {
        /// The axis.
        key: &'static str,
    },
    /// An axis holds a NaN or an infinity.
    #[error("{key}[{index}] = {value}, expected a finite number")]
    AxisNotFinite {
        /// The axis.
        key: &'static str,
        /// Which entry.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// An axis does not increase.
    #[error(
        "{key}[{index}] = {value}, expected more than {SAME_POSITION:e} m above the entry before it, {previous}"
    )]
    AxisOrder {
        /// The axis.
        key: &'static str,
        /// Which entry.
        index: usize,
        /// The entry before it, m.
        previous: f64,
        /// Its value, m.
        value: f64,
    },
    /// A depth is above the undeformed surface.
    #[error("depths_m[0] = {value}, expected at least 0, the undeformed surface")]
    NegativeDepth {
        /// The depth, m.
        value: f64,
    },
    /// A pose asked for is no place.
    #[error("{key} = {value}, expected a finite number of metres")]
    PoseNotFinite {
        /// Which coordinate.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// An axis with one entry has no cell to interpolate in.
    #[error("{key} has a single entry, expected at least two to interpolate between")]
    SinglePosition {
        /// The axis.
        key: &'static str,
    },
    /// A force far outside the table that no f64 can hold.
    #[error(
        "the force at the depth {depth} m, {lateral} m lateral, is beyond the range of numbers"
    )]
    ForceTooLarge {
        /// The depth, m.
        depth: f64,
        /// The lateral position, m.
        lateral: f64,
    },
    /// A matrix does not fit the axes.
    #[error(
        "{key} has {} rows and {} columns, expected {} rows (one a depth) and {} columns (one a lateral position)",
        .found[0], .found[1], .expected[0], .expected[1]
    )]
    Shape {
        /// The matrix.
        key: &'static str,
        /// Its rows and columns.
        found: [usize; 2],
        /// The numbers of depths and lateral positions.
        expected: [usize; 2],
    },
    /// A matrix holds a NaN or an infinity.
    #[error("{key}[{row}][{column}] = {value}, expected a finite number")]
    Force {
        /// The matrix.
        key: &'static str,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A band is impossible.
    #[error("{key}[{row}][{column}] = {value}, expected a finite number, at least 0")]
    Band {
        /// The matrix.
        key: &'static str,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A number of the certificate is impossible.
    #[error("certificate.{key} = {value}, expected a finite number, at least 0")]
    Certificate {
        /// The number.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// The certificate names another smallest determinant than its matrix.
    #[error(
        "certificate.smallest_det = {} at depth {} m, lateral {} m, expected the smallest entry of min_det, {least}, and its pose",
        .stated.det, .stated.depth, .stated.lateral
    )]
    SmallestDet {
        /// What the certificate names.
        stated: SmallestDet,
        /// The smallest entry.
        least: f64,
    },
    /// A computed map without its phantom.
    #[error("phantom is missing, expected the phantom that the finite elements computed")]
    NoPhantom,
    /// The phantom cannot exist.
    #[error("phantom: {0}")]
    Phantom(#[from] InvalidPhantom),
    /// The probe cannot stand at a pose of the map.
    #[error("phantom: {0}")]
    Pose(#[from] PoseError),
    /// Only a map over x ≥ 0 can be mirrored.
    #[error("laterals_m[0] = {first}, expected 0 in a map to be extended by symmetry")]
    NotFromZero {
        /// The first lateral position, m.
        first: f64,
    },
    /// Only the map of a symmetric phantom can be mirrored.
    #[error(
        "phantom {name:?} is not its own mirror image, expected a map over negative lateral positions too: it cannot be extended by symmetry"
    )]
    AsymmetricPhantom {
        /// The phantom's name.
        name: String,
    },
    /// A lateral force at x = 0 is not the zero that symmetry demands.
    #[error(
        "lateral force {force} N at depth {depth} m, x = 0, expected at most {SYMMETRY_TOLERANCE:e} N in a symmetric map"
    )]
    NotSymmetric {
        /// The depth, m.
        depth: f64,
        /// The force, N.
        force: f64,
    },
    /// Two maps are not over the same poses.
    #[error(
        "{key}[{index}] is {} in one map and {} in the other, expected equal axes",
        position(.ours), position(.theirs)
    )]
    AxesDiffer {
        /// The axis.
        key: &'static str,
        /// The first entry that differs.
        index: usize,
        /// It in this map, m; `None` beyond the end.
        ours: Option<f64>,
        /// It in the reference, m; `None` beyond the end.
        theirs: Option<f64>,
    },
    /// No row of the map is at this depth.
    #[error("depth {depth} m is not in the map, expected one of {stored:?} m")]
    NoSuchDepth {
        /// The depth that was asked for, m.
        depth: f64,
        /// The depths of the map, m.
        stored: Vec<f64>,
    },
    /// The depth lies between no rows of the map.
    #[error("depth {depth} m is outside the map, expected {first} to {last} m")]
    OutsideDepths {
        /// The depth that was asked for, m.
        depth: f64,
        /// The first depth of the map, m.
        first: f64,
        /// The last depth of the map, m.
        last: f64,
    },
    /// The position lies between no columns of the map.
    #[error("lateral position {lateral} m is outside the map, expected {first} to {last} m")]
    OutsideLaterals {
        /// The lateral position that was asked for, m.
        lateral: f64,
        /// The first lateral position of the map, m.
        first: f64,
        /// The last lateral position of the map, m.
        last: f64,
    },
    /// No column of the map is at this lateral position.
    #[error("lateral position {lateral} m is not in the map, expected one of {stored:?} m")]
    NoSuchLateral {
        /// The lateral position that was asked for, m.
        lateral: f64,
        /// The lateral positions of the map, m.
        stored: Vec<f64>,
    },
}

fn position(position: &Option<f64>) -> String {
    position.map_or("not there".into(), |metres| format!("{metres} m"))
}
