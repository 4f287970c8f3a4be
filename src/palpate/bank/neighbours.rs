//! Whether the noise of neighbouring samples is correlated, by what each hypothesis leaves of them (`spec/sequential.md`).

use std::iter::once;

/// The variance of the correlation ρ before the sweep.
///
/// Implements: SEQ-027.
const VARIANCE: f64 = 0.1;

/// What no inclusion and each inclusion leave of a sample, against the same of the sample before it in the same channel.
#[derive(Debug, Clone)]
pub(super) struct Neighbours {
    /// What is left of the last sample of each channel; 0 before the first.
    last: [Vec<f64>; 2],
    /// Σ of the products of neighbours.
    products: Vec<f64>,
}

impl Neighbours {
    pub(super) fn new(places: usize) -> Neighbours {
        let zeros = vec![0.0; places + 1];
        Neighbours {
            last: [zeros.clone(), zeros.clone()],
            products: zeros,
        }
    }

    /// Adds the innovation of a sample: of its residual, and of the signal of each place.
    ///
    /// Implements: SEQ-027.
    pub(super) fn push(&mut self, channel: usize, mut innovation: impl Iterator<Item = f64>) {
        let without = innovation.next().unwrap_or_default();
        let left = once(without).chain(innovation.map(|signal| without - signal));
        let sums = self.products.iter_mut().zip(&mut self.last[channel]);
        for ((product, last), left) in sums.zip(left) {
            *product += left * *last;
            *last = left;
        }
    }

    /// ln of the likelihood ratio of correlated to white noise, at most: without an inclusion or with that of a place, which leaves
    /// `squares` of all samples together.
    ///
    /// Implements: SEQ-027.
    pub(super) fn theta(&self, place: Option<usize>, squares: f64) -> f64 {
        let product = self.products[place.map_or(0, |place| place + 1)];
        let spread = 1.0 + VARIANCE * squares.max(0.0);
        0.5 * (VARIANCE * product * product / spread - libm::log(spread))
    }
}
