//! γ of a sweep of which more is unknown than the noise (`spec/nuisance.md`).

use serde::Serialize;

use super::gamma::GammaByChannel;
use palpate::detect::nuisance::Nuisances;
use palpate::force::Force;
use palpate::force_map::ForceMap;
use palpate::refusal::Refusal;
use palpate::trace::{Unknown, in_words, nuisances};

/// What may be unknown, from nothing on. The level of the noise, which may be unknown too, takes nothing from γ.
const UNKNOWN: [&[Unknown]; 6] = {
    use Unknown::{Drift, Gain, Offset};
    [&[], &[Offset], &[Offset, Drift], &[Gain], BY_DEFAULT, ALL]
};

/// What `palpate detect` takes as unknown, but for the level of the noise, unless it is told more.
pub(super) const BY_DEFAULT: &[Unknown] = &[Unknown::Offset, Unknown::Drift, Unknown::Gain];

/// All that it may take as unknown, but for the level of the noise.
pub(super) const ALL: &[Unknown] = {
    use Unknown::{Depth, Drift, Gain, Offset};
    &[Offset, Drift, Gain, Depth]
};

/// What is left of γ where more is unknown than the noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GammaLeft {
    /// With what is unknown unless `palpate detect` is told more: offset and drift of each channel, and the gain.
    #[serde(flatten)]
    pub by_default: GammaByChannel,
    /// γ of both channels with more and more unknown.
    pub beside: Vec<GammaBeside>,
}

/// γ of both channels beside something unknown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GammaBeside {
    /// What is unknown but the noise.
    pub unknown: &'static [Unknown],
    /// What is left of γ.
    pub gamma: f64,
}

impl GammaBeside {
    /// What is unknown, in words.
    pub(super) fn words(&self) -> String {
        in_words(self.unknown)
    }
}

/// The samples that are read.
type Read = fn(Force<&[f64]>) -> Vec<f64>;

/// Both channels.
pub(super) const BOTH: Read = |of| [of.lateral, of.normal].concat();

/// Series beside which a signal of a sweep at `depth` over the `reference` is found, of the samples that are read, one after another.
pub(super) fn columns(
    reference: &ForceMap,
    unknown: &[Unknown],
    depth: f64,
    read: Read,
) -> Result<Vec<f64>, Refusal> {
    let table = reference.table();
    let expected = |depth| Ok(table.row(depth)?.map(<[f64]>::to_vec));
    let columns = nuisances(unknown, table.depths(), depth, expected)?;
    Ok(columns.iter().flat_map(|of| read(of.as_deref())).collect())
}

/// The space of these columns of so many samples.
pub(super) fn space(columns: &mut [f64], samples: usize) -> Result<Nuisances<'_>, Refusal> {
    Nuisances::new(columns, samples).map_err(|error| Refusal::state(error.to_string(), ""))
}

impl GammaLeft {
    /// What is left of γ of `signal`, which a map adds to the `reference` at `depth`, a row of both, in noise of `noise_sd`, N.
    ///
    /// Implements: REP-016.
    pub(super) fn of(
        reference: &ForceMap,
        noise_sd: f64,
        signal: Force<&[f64]>,
        depth: f64,
    ) -> Result<GammaLeft, Refusal> {
        let gamma = |unknown: &[Unknown], read: Read| -> Result<f64, Refusal> {
            let mut columns = columns(reference, unknown, depth, read)?;
            let mut signal = read(signal);
            Ok(space(&mut columns, signal.len())?.project(&mut signal)? / noise_sd)
        };
        let has_slope = |unknown: &&&[Unknown]| {
            reference.table().depths().len() > 1 || !unknown.contains(&Unknown::Depth)
        };
        let beside = UNKNOWN.iter().filter(has_slope).map(|unknown| {
            let gamma = gamma(unknown, BOTH)?;
            Ok(GammaBeside { unknown, gamma })
        });
        Ok(GammaLeft {
            beside: beside.collect::<Result<_, Refusal>>()?,
            by_default: GammaByChannel {
                both: gamma(BY_DEFAULT, BOTH)?,
                normal: gamma(BY_DEFAULT, |of| of.normal.to_vec())?,
                lateral: gamma(BY_DEFAULT, |of| of.lateral.to_vec())?,
            },
        })
    }
}
