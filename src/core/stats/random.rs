//! Normal deviates that are functions of their address alone: seed, stream, trial and index. So a
//! trial can be replayed alone, and results do not depend on threads or on how the work is split.
//!
//! The generator is Philox4x64-10 (J. K. Salmon et al., *Parallel random numbers: as easy as 1, 2,
//! 3*, SC 2011), the transformation Marsaglia and Tsang's ziggurat with `libm` for the few deviates
//! that need a transcendental function.

use super::ziggurat::{EDGES, TAIL};

/// Deviates made in one go: a multiple of 4, and one for each bit of a word.
const BATCH: usize = 64;

/// Four 64-bit words for each value of a 256-bit counter.
///
/// ```
/// use palpate_core::stats::random::Generator;
///
/// let generator = Generator::new(1999, 0);
/// let mut deviates = [0.0; 100];
/// generator.normals(7, 0, &mut deviates);
/// // Any of them alone, without those before it.
/// assert_eq!(deviates[42], generator.normal(7, 42));
/// assert!(deviates.iter().all(|deviate| deviate.abs() < 5.0));
/// ```
///
/// Implements: DET-110, DET-111.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Generator {
    key: [u64; 2],
}

impl Generator {
    /// The generator for `seed`; streams of one seed are independent of each other.
    pub const fn new(seed: u64, stream: u64) -> Self {
        Self {
            key: [seed, stream],
        }
    }

    /// Philox4x64-10 of one counter.
    #[inline]
    pub fn words(&self, counter: [u64; 4]) -> [u64; 4] {
        const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
        const KEY_STEPS: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];
        let [mut a, mut b, mut c, mut d] = counter;
        let mut key = self.key;
        for _ in 0..10 {
            let left = u128::from(MULTIPLIERS[0]) * u128::from(a);
            let right = u128::from(MULTIPLIERS[1]) * u128::from(c);
            a = (right >> 64) as u64 ^ b ^ key[0];
            b = right as u64;
            c = (left >> 64) as u64 ^ d ^ key[1];
            d = left as u64;
            key[0] = key[0].wrapping_add(KEY_STEPS[0]);
            key[1] = key[1].wrapping_add(KEY_STEPS[1]);
        }
        [a, b, c, d]
    }

    /// The standard normal deviate with number `index` of a trial.
    pub fn normal(&self, trial: u64, index: u64) -> f64 {
        let mut deviate = [0.0];
        self.batch(trial, index, &mut deviate);
        deviate[0]
    }

    /// Fills `deviates` with the standard normal deviates `first`, `first` + 1, … of a trial; 0
    /// follows 2⁶⁴ − 1.
    pub fn normals(&self, trial: u64, first: u64, deviates: &mut [f64]) {
        let mut index = first;
        for deviates in deviates.chunks_mut(BATCH) {
            self.batch(trial, index, deviates);
            index = index.wrapping_add(BATCH as u64);
        }
    }

    /// Up to [`BATCH`] deviates in three passes that keep the processor busier than one: all words, all candidates, and then the few
    /// candidates, 0.7 %, that do not lie in a rectangle that is wholly under the curve.
    fn batch(&self, trial: u64, first: u64, deviates: &mut [f64]) {
        // Four to an index that is a multiple of 4.
        let before = (first % 4) as usize;
        let mut words = [[0; 4]; BATCH / 4 + 1];
        let mut index = first;
        for words in &mut words[..(before + deviates.len()).div_ceil(4)] {
            *words = self.words([index / 4, trial, 0, 0]);
            index = index.wrapping_add(4);
        }
        let words = &words.as_flattened()[before..];
        let mut at_an_edge = 0_u64;
        for (number, (deviate, &word)) in deviates.iter_mut().zip(words).enumerate() {
            let (x, layer) = candidate(word);
            at_an_edge |= u64::from(x.abs() >= EDGES[layer + 1]) << number;
            *deviate = x;
        }
        while at_an_edge != 0 {
            let number = at_an_edge.trailing_zeros() as usize;
            at_an_edge &= at_an_edge - 1;
            let (x, layer) = candidate(words[number]);
            deviates[number] =
                self.deviate_at_an_edge(x, layer, trial, first.wrapping_add(number as u64));
        }
    }

    /// The other deviates: a wedge between rectangle and curve, or the tail. Each attempt draws
    /// from a counter of its own.
    #[cold]
    fn deviate_at_an_edge(&self, mut x: f64, mut layer: usize, trial: u64, index: u64) -> f64 {
        let mut attempt = 0;
        loop {
            attempt += 1;
            let [first, second, next, _] = self.words([index, trial, 1, attempt]);
            if layer == 0 {
                // Marsaglia's tail: an exponential beyond TAIL, taken with probability exp(−e²/2).
                let excess = -libm::log(uniform(first)) / TAIL;
                if -2.0 * libm::log(uniform(second)) > excess * excess {
                    return libm::copysign(TAIL + excess, x);
                }
            } else {
                let (floor, ceiling) = (height(EDGES[layer]), height(EDGES[layer + 1]));
                if floor + (ceiling - floor) * uniform(first) < height(x) {
                    return x;
                }
                (x, layer) = candidate(next);
                if x.abs() < EDGES[layer + 1] {
                    return x;
                }
            }
        }
    }
}

/// The curve over the layers, exp(−x²/2).
fn height(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// A point in a layer of the ziggurat: its abscissa and the layer, from disjoint bits.
#[inline]
fn candidate(word: u64) -> (f64, usize) {
    let layer = (word & 0x1FF) as usize;
    // An odd multiple of 2^-52 in (−1, 1): symmetric, never zero, exact.
    let signed = ((word as i64) >> 11 | 1) as f64 * (1.0 / (1_u64 << 52) as f64);
    (signed * EDGES[layer], layer)
}

/// A number in (0, 1), an odd multiple of 2^-53.
#[inline]
pub fn uniform(word: u64) -> f64 {
    (word >> 11 | 1) as f64 * (1.0 / (1_u64 << 53) as f64)
}

#[cfg(test)]
mod tests;
