//! Θ of many records against the same two forces: `palpate::detect::theta_of_record` with a record in each lane of a vector
//! register, and with what does not depend on the record computed once. Each lane does the operations of that function in their
//! order, so that the bits are its bits on any processor.

use palpate::detect::{DetectError, theta_of_record};
use palpate::force::Force;
use pulp::{Arch, Scalar, Simd, WithSimd};
use rayon::prelude::*;

use crate::convert::halves;

/// Partial sums of a sum, as in the crate.
const PARTS: usize = 4;
/// Records that a thread takes at a time.
const CHUNK: usize = 1024;
/// Noise of a sample, N, below which y(0) is finite wherever θ is: a force of which it would not be is 2^996 times the noise.
const MOST_NOISE: f64 = 1e8;
/// 2^27 + 1.
const VELTKAMP: f64 = 134_217_729.0;

/// The unevaluated sum of two numbers of each lane.
type Pair<S> = (<S as Simd>::f64s, <S as Simd>::f64s);

/// A sample of F_0 and of the template F_1 − F_0 in units of the noise.
struct Sample {
    minus_f0: f64,
    template: (f64, f64),
    halves: (f64, f64),
}

/// What records of one channel are compared with.
struct Channel {
    samples: Vec<Sample>,
    /// A power of two that brings the noise near 1.
    factor: f64,
    variance: f64,
    /// −½ΣΔ².
    minus_half_energy: (f64, f64),
}

/// The exact sum of two numbers.
#[inline(always)]
fn sum<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> Pair<S> {
    let high = simd.add_f64s(a, b);
    let b_seen = simd.sub_f64s(high, a);
    let a_seen = simd.sub_f64s(high, b_seen);
    let (a_lost, b_lost) = (simd.sub_f64s(a, a_seen), simd.sub_f64s(b, b_seen));
    (high, simd.add_f64s(a_lost, b_lost))
}

#[inline(always)]
fn plus<S: Simd>(simd: S, a: Pair<S>, b: Pair<S>) -> Pair<S> {
    let (high, low) = sum(simd, a.0, b.0);
    sum(simd, high, simd.add_f64s(low, simd.add_f64s(a.1, b.1)))
}

/// The two halves of a number, of 26 bits each.
#[inline(always)]
fn split<S: Simd>(simd: S, a: S::f64s) -> Pair<S> {
    let carried = simd.mul_f64s(simd.splat_f64s(VELTKAMP), a);
    let high = simd.sub_f64s(carried, simd.sub_f64s(carried, a));
    (high, simd.sub_f64s(a, high))
}

impl Sample {
    /// (F_p − F_0)(F_1 − F_0) of an observed force.
    #[inline(always)]
    fn product<S: Simd>(&self, simd: S, observed: S::f64s) -> Pair<S> {
        let (a, a_low) = sum(simd, observed, simd.splat_f64s(self.minus_f0));
        let b = simd.splat_f64s(self.template.0);
        let b_low = simd.splat_f64s(self.template.1);
        let (a1, a2) = split(simd, a);
        let b1 = simd.splat_f64s(self.halves.0);
        let b2 = simd.splat_f64s(self.halves.1);
        let high = simd.mul_f64s(a, b);
        let mut rest = simd.sub_f64s(high, simd.mul_f64s(a1, b1));
        rest = simd.sub_f64s(rest, simd.mul_f64s(a2, b1));
        rest = simd.sub_f64s(rest, simd.mul_f64s(a1, b2));
        let low = simd.sub_f64s(simd.mul_f64s(a2, b2), rest);
        let crossed = simd.add_f64s(simd.mul_f64s(a, b_low), simd.mul_f64s(a_low, b));
        (high, simd.add_f64s(low, crossed))
    }
}

impl Channel {
    fn new(f0: &[f64], f1: &[f64], noise_sd: f64) -> Channel {
        let exponent = libm::ilogb(noise_sd).clamp(-1023, 1023);
        let factor = libm::scalbn(1.0, -exponent);
        let sample = |(f0, f1): (&f64, &f64)| {
            let template = sum(Scalar, f1 * factor, -f0 * factor);
            Sample {
                minus_f0: -f0 * factor,
                template,
                halves: split(Scalar, template.0),
            }
        };
        let scaled = noise_sd * factor;
        let mut channel = Channel {
            samples: f0.iter().zip(f1).map(sample).collect(),
            factor,
            variance: scaled * scaled,
            minus_half_energy: (0.0, 0.0),
        };
        let (high, low) = channel.cross(Scalar, f1);
        channel.minus_half_energy = (-0.5 * high, -0.5 * low);
        channel
    }

    /// Σ rΔ of observed forces.
    #[inline(always)]
    fn cross<S: Simd>(&self, simd: S, observed: &[S::f64s]) -> Pair<S> {
        let (zero, factor) = (simd.splat_f64s(0.0), simd.splat_f64s(self.factor));
        let mut total = (zero, zero);
        for part in 0..PARTS {
            let (mut high, mut low) = (zero, zero);
            let mut index = part;
            while index < observed.len() {
                let factored = simd.mul_f64s(observed[index], factor);
                let product = self.samples[index].product(simd, factored);
                let added = sum(simd, high, product.0);
                high = added.0;
                low = simd.add_f64s(low, simd.add_f64s(added.1, product.1));
                index += PARTS;
            }
            total = plus(simd, total, sum(simd, high, low));
        }
        total
    }

    /// θ of observed forces.
    #[inline(always)]
    fn theta<S: Simd>(&self, simd: S, observed: &[S::f64s]) -> S::f64s {
        let (high, low) = self.minus_half_energy;
        let energy = (simd.splat_f64s(high), simd.splat_f64s(low));
        let (high, low) = plus(simd, self.cross(simd, observed), energy);
        simd.div_f64s(simd.add_f64s(high, low), simd.splat_f64s(self.variance))
    }
}

/// Some records and the places of their θ.
struct Work<'a> {
    channels: &'a [Channel; 2],
    records: &'a [f64],
    theta: &'a mut [f64],
}

impl WithSimd for Work<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = S::F64_LANES;
        let samples = self.channels[0].samples.len();
        let length = 2 * samples;
        let mut block = vec![simd.splat_f64s(0.0); length];
        let records = self.records.chunks(lanes * length);
        for (records, theta) in records.zip(self.theta.chunks_mut(lanes)) {
            let lanes_of_block: &mut [f64] = pulp::bytemuck::cast_slice_mut(&mut block);
            for (lane, record) in records.chunks(length).enumerate() {
                let places = lanes_of_block[lane..].iter_mut().step_by(lanes);
                for (place, &force) in places.zip(record) {
                    *place = force;
                }
            }
            let (lateral, normal) = block.split_at(samples);
            let lateral = self.channels[0].theta(simd, lateral);
            let found = [simd.add_f64s(lateral, self.channels[1].theta(simd, normal))];
            theta.copy_from_slice(&pulp::bytemuck::cast_slice(&found)[..theta.len()]);
        }
    }
}

/// θ of each of `records`, 2n numbers one after the other, as `theta_of_record` gives it; or why it refuses them, and the number of the
/// record if that is to blame.
///
/// Implements: PYT-020, PYT-023.
pub fn theta(
    records: &[f64],
    f0: Force<&[f64]>,
    f1: Force<&[f64]>,
    noise_sd: Force<f64>,
) -> Result<Vec<f64>, (Option<usize>, DetectError)> {
    // What it refuses of the rest, it refuses with any record.
    theta_of_record(f0, f0, f1, noise_sd).map_err(|error| (None, error))?;
    let channels = f0.zip(f1).zip(noise_sd);
    let channels = channels.map(|((f0, f1), noise_sd)| Channel::new(f0, f1, noise_sd));
    let channels = &channels.into_array();
    let length = 2 * f0.lateral.len();
    let mut theta = vec![f64::NAN; records.len() / length];
    if noise_sd.lateral.max(noise_sd.normal) < MOST_NOISE {
        let chunks = records.par_chunks(CHUNK * length);
        let chunks = chunks.zip(theta.par_chunks_mut(CHUNK));
        chunks.for_each(|(records, theta)| {
            Arch::new().dispatch(Work {
                channels,
                records,
                theta,
            })
        });
    }
    // A NaN, an infinity, an overflow, or so much noise: the function itself says.
    for (number, theta) in theta.iter_mut().enumerate() {
        if !theta.is_finite() {
            let record = halves(&records[number * length..][..length]);
            let found = theta_of_record(record, f0, f1, noise_sd);
            *theta = found.map_err(|error| (Some(number), error))?.theta;
        }
    }
    Ok(theta)
}
