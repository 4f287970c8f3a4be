//! Why a record cannot be judged.

use std::fmt;

use serde::Serialize;

/// Why a record cannot be judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The forces have the other sign.
    Sign,
    /// The forces are in another unit.
    ForceUnit,
    /// The forces are too large for this gel at this depth.
    Level,
    /// No hypothesis explains the forces, or the noise is not as stated.
    Misfit,
    /// The noise of a sample depends on that of the samples before it.
    Coloured,
    /// The sensor was at the end of its range.
    Saturated,
    /// Too many samples are far from their neighbours.
    Glitches,
    /// The forces are too small for this gel at this depth.
    NoContact,
    /// The probe does not touch at the start or at the end.
    InAir,
    /// The sweep is too short to show an inclusion.
    Narrow,
    /// The map with the inclusion has the smaller forces.
    Exchanged,
    /// The lateral forces are not what they are said to be: the normal ones alone, or those of the other sign, say the opposite, or they
    /// have too little noise.
    Channels,
    /// Some disturbance explains the record as well as an inclusion does.
    TooWeak,
    /// No inclusion explains the record, but neither does a gel alone: the sensor was set to zero on it.
    Zeroed,
}

/// What is wrong, and what to do; of [`Cause::TooWeak`] the likeliest class of disturbance says what to do.
///
/// Implements: CLI-143, PYT-049.
impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Cause::Sign => "the forces have the opposite sign to those of the maps: reverse it; a normal force that pushes the probe up is positive",
            Cause::ForceUnit => "the forces or the depth are not in the stated unit: state the right one, such as mN or m, or give N and mm",
            Cause::Level => "the forces are too large for the maps' gel at this depth: take maps of this gel, depth and probe",
            Cause::Misfit => "no hypothesis explains the forces, or the noise is not as stated: state the noise of a sample in N, take less as known, or take other maps",
            Cause::Coloured => "the noise of neighbouring samples is correlated, and the exact model needs white noise: use the robust model",
            Cause::Saturated => "many samples are at the end of the sensor's range: use a sensor with a larger range, or check that it still measures",
            Cause::Glitches => "too many samples are far from their neighbours: check the cable, or leave those samples out",
            Cause::NoContact => "the forces are too small for the maps' gel at this depth: check that the probe touches, or say that the sensor was set to zero on the gel",
            Cause::InAir => "samples at the start or at the end are in air: leave them out",
            Cause::Narrow => "the sweep is shorter than half the radius of the probe: check the unit of the positions, or make a longer sweep",
            Cause::Exchanged => "the map with the inclusion has smaller forces than the reference: swap the maps",
            Cause::Channels => "the lateral forces do not go with the normal ones: check their sign, unit and cable, or leave them out",
            Cause::TooWeak => "the record is too weak to tell an inclusion from a disturbance that looks like one",
            Cause::Zeroed => "a sensor that was set to zero on the gel records the same in air as over a gel without an inclusion: set it to zero above the gel",
        })
    }
}

/// The causes why a record cannot be judged, in words.
pub fn reasons(causes: &[Cause]) -> String {
    let causes: Vec<_> = causes.iter().map(Cause::to_string).collect();
    causes.join("; ")
}
