//! Sums and products in twice the working precision, from IEEE-754 additions and multiplications
//! alone: T. Ogita, S. M. Rump, S. Oishi, *Accurate sum and dot product*, SIAM J. Sci. Comput. 26
//! (2005). A fused multiply-add would be quicker where there is one, and would tie the bits to it.

/// Independent partial sums of a dot product. The source fixes the number, so that the compiler may
/// use vector registers of any width without changing a bit.
const LANES: usize = 4;

/// Products formed in one pass, a multiple of [`LANES`].
const BATCH: usize = 64;

/// The unevaluated sum `high + low` of two numbers, where `low` is the rounding error of `high`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DoubleDouble {
    /// The value rounded to working precision.
    pub high: f64,
    /// What that rounding left out.
    pub low: f64,
}

impl DoubleDouble {
    /// The exact sum of two numbers (Knuth), unless it overflows.
    #[inline]
    pub fn new(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_seen = high - a;
        let a_seen = high - b_seen;
        let low = (a - a_seen) + (b - b_seen);
        Self { high, low }
    }

    /// The exact product of two numbers (Dekker, Veltkamp), if both are below 2^996 in size and the product does not overflow and
    /// is not below 2^-969.
    #[inline]
    pub fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let (a_high, a_low) = split(a);
        let (b_high, b_low) = split(b);
        let low = a_low * b_low - (((high - a_high * b_high) - a_low * b_high) - a_high * b_low);
        Self { high, low }
    }

    /// `self + other`, with an error of at most 4u²(|self| + |other|).
    #[inline]
    pub fn plus(self, other: Self) -> Self {
        let sum = Self::new(self.high, other.high);
        Self::new(sum.high, sum.low + (self.low + other.low))
    }

    /// `self · factor` for a power of two, exactly.
    #[inline]
    pub fn scaled(self, power_of_two: f64) -> Self {
        Self {
            high: self.high * power_of_two,
            low: self.low * power_of_two,
        }
    }

    /// The nearest number of working precision.
    #[inline]
    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

/// The two halves of a number, of 26 bits each, whose products are exact.
#[inline]
fn split(a: f64) -> (f64, f64) {
    /// 2^27 + 1.
    const VELTKAMP: f64 = 134_217_729.0;
    let carried = VELTKAMP * a;
    let high = carried - (carried - a);
    (high, a - high)
}

/// A running sum in twice the working precision, in four independent parts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Accumulator {
    high: [f64; LANES],
    low: [f64; LANES],
}

impl Accumulator {
    /// Adds the term with number `index` to part `index` mod 4.
    #[inline]
    pub fn add(&mut self, index: usize, term: DoubleDouble) {
        let lane = index % LANES;
        let sum = DoubleDouble::new(self.high[lane], term.high);
        self.high[lane] = sum.high;
        self.low[lane] += sum.low + term.low;
    }

    /// [`Accumulator::add`] of 64 products, in passes that compilers turn into vector code: the
    /// same operations in the same order for each part, so the same bits.
    #[inline]
    fn add_products(&mut self, a: &[f64; BATCH], b: &[f64; BATCH], power_of_two: f64) {
        let a = a.map(|a| a * power_of_two);
        let b = b.map(|b| b * power_of_two);
        let (mut high, mut low) = ([0.0; BATCH], [0.0; BATCH]);
        for index in 0..BATCH {
            let product = DoubleDouble::product(a[index], b[index]);
            (high[index], low[index]) = (product.high, product.low);
        }
        for part in 0..LANES {
            for index in (part..BATCH).step_by(LANES) {
                let (high, low) = (high[index], low[index]);
                self.add(part, DoubleDouble { high, low });
            }
        }
    }

    /// The sum of all the parts.
    pub fn total(self) -> DoubleDouble {
        let mut total = DoubleDouble::default();
        for (high, low) in self.high.into_iter().zip(self.low) {
            total = total.plus(DoubleDouble::new(high, low));
        }
        total
    }
}

/// Σ (k aᵢ)(k bᵢ) over two slices of the same length N (the longer one is cut), for a power of two
/// k.
///
/// The error is at most (N+16)²u² Σ|k² aᵢ bᵢ| with u = 2^-53, as long as no product overflows, plus
/// N·2^-1022 for products that underflow.
///
/// Implements: DET-014.
pub fn dot(a: &[f64], b: &[f64], power_of_two: f64) -> DoubleDouble {
    let length = a.len().min(b.len());
    let (a_batches, a_rest) = a[..length].as_chunks::<BATCH>();
    let (b_batches, b_rest) = b[..length].as_chunks::<BATCH>();
    let mut sum = Accumulator::default();
    for (a, b) in a_batches.iter().zip(b_batches) {
        sum.add_products(a, b, power_of_two);
    }
    for (index, (&a, &b)) in a_rest.iter().zip(b_rest).enumerate() {
        let term = DoubleDouble::product(a * power_of_two, b * power_of_two);
        sum.add(index, term);
    }
    sum.total()
}

/// Σᵢ term(i) for i = 0 … length−1, with the error bound of [`dot`] relative to Σ|term|.
#[inline]
pub fn sum(length: usize, mut term: impl FnMut(usize) -> DoubleDouble) -> DoubleDouble {
    let mut sum = Accumulator::default();
    for index in 0..length {
        sum.add(index, term(index));
    }
    sum.total()
}

/// The power of two 2^-e with 2^e ≤ |value| < 2^(e+1), at most 2^1023: it brings a finite value
/// that is not zero near 1 (into [2^-51, 2)), without rounding.
pub fn reciprocal_power_of_two(value: f64) -> f64 {
    let exponent = libm::ilogb(value).clamp(-1023, 1023);
    libm::scalbn(1.0, -exponent)
}
