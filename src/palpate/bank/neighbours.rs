//! Whether the noise of neighbouring samples is correlated, by what each hypothesis leaves of them (`spec/sequential.md`).

use std::iter::once;

use crate::detect::correlation::theta_correlated;

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

    /// θ of correlated noise, without an inclusion or with that of a place, which leaves squares of this sum.
    ///
    /// Implements: SEQ-027.
    pub(super) fn theta(&self, place: Option<usize>, squares: f64) -> f64 {
        theta_correlated(self.products[place.map_or(0, |place| place + 1)], squares)
    }
}
