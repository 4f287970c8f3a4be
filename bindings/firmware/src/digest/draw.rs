//! The inputs: Philox words of a counter, the same on every machine.

use palpate_core::force::Force;
use palpate_core::stats::random::{Generator, uniform};

/// Numbers that are easily mistaken.
const SPECIAL: [f64; 8] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    1e-40,
    f64::MAX,
];

/// Draws the inputs of one function.
pub struct Draw {
    generator: Generator,
    counter: u64,
    bytes: [u8; 20],
}

impl Draw {
    /// At the beginning of a stream.
    pub fn new(stream: u64) -> Draw {
        Draw {
            generator: Generator::new(1999, stream),
            counter: 0,
            bytes: [0; 20],
        }
    }

    /// Any 64 bits.
    pub fn word(&mut self) -> u64 {
        self.counter += 1;
        self.generator.words([self.counter, 0, 0, 0])[0]
    }

    /// True once in `count`.
    pub fn once_in(&mut self, count: u64) -> bool {
        self.word().is_multiple_of(count)
    }

    /// A number between two others.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * uniform(self.word())
    }

    /// A number between two others or, once in 16, a special one.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        if self.once_in(16) {
            SPECIAL[(self.word() % 8) as usize]
        } else {
            self.between(low, high)
        }
    }

    /// A single-precision number between two others, a special one or, once in 8, any bits but those of a signalling NaN, for which
    /// the compiler's code differs between processors.
    pub fn single(&mut self, low: f64, high: f64) -> f32 {
        if self.once_in(8) {
            let any = f32::from_bits(self.word() as u32);
            if any.is_nan() { f32::NAN } else { any }
        } else {
            self.number(low, high) as f32
        }
    }

    /// A rate, also a very small one and one near 1.
    pub fn rate(&mut self) -> f64 {
        let rate = self.number(0.0, 1.0);
        match self.word() % 4 {
            0 => rate * 1e-12,
            1 => 1.0 - rate * 1e-9,
            _ => rate,
        }
    }

    /// Samples of both components; in one of 32 series, one is special.
    pub fn series<const N: usize>(&mut self) -> Force<[f64; N]> {
        let mut series = Force::new((), ()).map(|()| [(); N].map(|()| self.between(-2.0, 2.0)));
        if self.once_in(32) {
            series.normal[0] = SPECIAL[(self.word() % 8) as usize];
        }
        series
    }

    /// The bytes of a report. The length and the number are mostly right, the first value is small.
    pub fn report(&mut self, number: u8, length: usize) -> &[u8] {
        self.bytes = [(); 20].map(|()| self.word() as u8);
        if !self.once_in(8) {
            self.bytes[0] = number;
            self.bytes[1] %= 4;
        }
        let length = if self.once_in(8) {
            (self.word() % 20) as usize
        } else {
            length
        };
        &self.bytes[..length]
    }
}
