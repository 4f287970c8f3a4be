//! Θ of many hypotheses beside nuisances while the record is taken, and Wald's test, which ends as early as its error rates
//! allow (`spec/sequential.md`).
//!
//! [`super::nuisance`] needs the whole record. Here a row, one sample of one channel over the standard deviation of its noise, is
//! rotated into a triangle of what the nuisances explain; what is left of it, the innovation, adds to the sums of each hypothesis.
//! The rotations are Gentleman's, without square roots: each line of the triangle, and the row, has a weight, the square of the factor
//! that its numbers lack.

use super::{Decision, DetectError, ErrorRates, error_rates};
use crate::stats::error::{check_finite, check_length, check_probability, in_range};

/// The squares of the share of a nuisance's length, and of the number, up to which what is left of it is rounding.
///
/// Implements: SEQ-003.
const ROUNDING: (f64, f64) = (1e-24, 1e-160);
/// The largest number of a row: quotients, squares and their sums are far from overflow.
const LARGEST: f64 = 1e80;
/// The weight below which the numbers of a row take it over, lest they grow.
const LEAST_WEIGHT: f64 = 1e-20;
/// The part of |δ|² up to which the nuisances explain a signal.
const EXPLAINED: f64 = super::nuisance::DEPENDENT * super::nuisance::DEPENDENT;

/// Likelihood ratios that grow with each row.
///
/// `M` is the memory, of [`memory`] numbers: an array, a slice or a vector.
///
/// ```
/// use palpate_core::detect::sequential::{Sequential, memory};
///
/// // One signal beside an unknown offset, in noise of standard deviation 1.
/// let mut found = Sequential::new([0.0; memory(1, 1)], 1, 1)?;
/// for (record, template) in [100.0, 100.0, 103.0, 103.0, 100.0, 100.0].into_iter().zip([0.0, 0.0, 3.0, 3.0, 0.0, 0.0]) {
///     found.push(record, &[1.0], &[template])?;
/// }
/// // γ² = 12 is left of 18, and θ = γ²/2 of the signal itself.
/// let evidence = found.evidence().next().unwrap();
/// assert!((evidence.gamma_squared - 12.0).abs() < 1e-12);
/// assert!((evidence.theta() - 6.0).abs() < 1e-11);
/// # Ok::<(), palpate_core::detect::DetectError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sequential<M> {
    /// Lines of p + 1 + K numbers, one for each nuisance, the residual and each signal: the row at hand; the sums of squares of all
    /// rows, of nuisances alone; those of what is left; the products of what is left with that of the residual; then the triangle, a
    /// line a nuisance: 0 before its own column, there its weight, then its numbers.
    memory: M,
    nuisances: usize,
    hypotheses: usize,
    /// The largest magnitude of a signal in any row: |δ|² of none is above the number of rows times its square.
    largest: f64,
    /// The weight of what is left of the last row.
    weight: f64,
    rows: usize,
    missing: usize,
}

/// What the rows so far say of one hypothesis.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// (Pδ)ᵀz.
    pub along: f64,
    /// γ² = |Pδ|², 0 where the nuisances explain the signal.
    pub gamma_squared: f64,
}

impl Evidence {
    /// ln of the likelihood ratio.
    ///
    /// Implements: SEQ-001, SEQ-004.
    pub fn theta(self) -> f64 {
        self.along - 0.5 * self.gamma_squared
    }
}

/// How many numbers the detector of so many hypotheses beside so many nuisances needs; the largest `usize` if there are no so many.
///
/// Implements: SEQ-007.
pub const fn memory(hypotheses: usize, nuisances: usize) -> usize {
    let width = nuisances.saturating_add(1).saturating_add(hypotheses);
    nuisances.saturating_add(4).saturating_mul(width)
}

impl<M: AsRef<[f64]> + AsMut<[f64]>> Sequential<M> {
    /// The detector before the first row, of `hypotheses` signals beside `nuisances`.
    ///
    /// # Errors
    /// No hypothesis; another length of the memory than [`memory`].
    ///
    /// Implements: SEQ-006, SEQ-007.
    pub fn new(memory: M, hypotheses: usize, nuisances: usize) -> Result<Self, DetectError> {
        if hypotheses == 0 {
            return Err(DetectError::Empty { what: "hypotheses" });
        }
        let mut memory = memory;
        let length = self::memory(hypotheses, nuisances);
        check_length("memory", length, memory.as_ref().len())?;
        memory.as_mut().fill(0.0);
        Ok(Sequential {
            memory,
            nuisances,
            hypotheses,
            largest: 0.0,
            weight: 0.0,
            rows: 0,
            missing: 0,
        })
    }

    /// Adds a row: the residual (F_p − F_0)/s, what each nuisance adds for an amplitude of 1, and the signal of each hypothesis,
    /// all over s. A residual that is NaN is missing.
    ///
    /// # Errors
    /// Another length; NaN in a nuisance or signal; a number that is infinite or above 10⁸⁰ in magnitude. Nothing changes.
    ///
    /// Implements: SEQ-001, SEQ-003, SEQ-005, SEQ-006, SEQ-007.
    pub fn push(
        &mut self,
        residual: f64,
        nuisances: &[f64],
        signals: &[f64],
    ) -> Result<(), DetectError> {
        let p = self.nuisances;
        check_row("nuisances", nuisances, p)?;
        check_row("signals", signals, self.hypotheses)?;
        if residual.is_nan() {
            self.missing += 1;
            return Ok(());
        }
        check_row("residual", &[residual], 1)?;
        self.rows += 1;
        for signal in signals {
            if signal.abs() > self.largest {
                self.largest = signal.abs();
            }
        }
        let width = self.width();
        let (row, rest) = self.memory.as_mut().split_at_mut(width);
        let (squares, rest) = rest.split_at_mut(width);
        let (left, rest) = rest.split_at_mut(width);
        let (along, triangle) = rest.split_at_mut(width);
        row[..p].copy_from_slice(nuisances);
        row[p] = residual;
        row[p + 1..].copy_from_slice(signals);
        for (sum, value) in squares.iter_mut().zip(nuisances) {
            *sum += value * value;
        }
        let mut weight = 1.0;
        for (at, line) in triangle.chunks_exact_mut(width).enumerate() {
            let least = || f64::max(ROUNDING.0 * squares[at], ROUNDING.1);
            if line[at] > 0.0 || weight * row[at] * row[at] > least() {
                rotate(&mut line[at..], &mut row[at..], &mut weight);
            }
        }
        let innovation = row[p];
        let sums = left[p..].iter_mut().zip(&mut along[p..]);
        for ((left, along), value) in sums.zip(&row[p..]) {
            let weighted = weight * value;
            *left += weighted * value;
            *along += weighted * innovation;
        }
        self.weight = weight;
        Ok(())
    }

    /// The innovation: what the nuisances leave of the last row, of its residual and then of each signal; zeros before the first.
    ///
    /// Implements: SEQ-008.
    pub fn innovation(&self) -> impl Iterator<Item = f64> {
        let root = libm::sqrt(self.weight);
        self.line(0).iter().map(move |number| root * number)
    }

    fn width(&self) -> usize {
        self.nuisances + 1 + self.hypotheses
    }

    /// A line of the memory, from the residual on.
    fn line(&self, number: usize) -> &[f64] {
        let width = self.width();
        &self.memory.as_ref()[number * width + self.nuisances..(number + 1) * width]
    }

    /// What the rows say of each hypothesis, in their order.
    ///
    /// Implements: SEQ-001, SEQ-004.
    pub fn evidence(&self) -> impl Iterator<Item = Evidence> {
        let [left, along] = [2, 3].map(|number| &self.line(number)[1..]);
        let most = self.rows as f64 * self.largest * self.largest;
        let pairs = left.iter().zip(along).enumerate();
        pairs.map(move |(signal, (&gamma_squared, &along))| {
            // What the nuisances explain takes long to add up, and is seldom needed.
            let is_left = gamma_squared > EXPLAINED * most
                || gamma_squared > EXPLAINED * (gamma_squared + self.explained(signal));
            Evidence {
                along: if is_left { along } else { 0.0 },
                gamma_squared: if is_left { gamma_squared } else { 0.0 },
            }
        })
    }

    /// |δ|² − |Pδ|²: Σ of the squares of a signal's numbers in the triangle.
    fn explained(&self, signal: usize) -> f64 {
        let square = |nuisance: usize| {
            let number = self.line(4 + nuisance)[1 + signal];
            self.pivot(nuisance) * number * number
        };
        (0..self.nuisances).map(square).sum()
    }

    /// The weight of a nuisance's line, 0 where the rows do not tell it from those before it.
    fn pivot(&self, nuisance: usize) -> f64 {
        self.memory.as_ref()[(4 + nuisance) * self.width() + nuisance]
    }

    /// |Pz|²: Σ of the squares that the nuisances do not explain.
    ///
    /// Implements: SEQ-001.
    pub fn residual(&self) -> f64 {
        self.line(2)[0]
    }

    /// The rows so far, without the missing ones.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The rows that were missing.
    ///
    /// Implements: SEQ-005.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// How many nuisances the rows tell apart.
    ///
    /// Implements: SEQ-003.
    pub fn rank(&self) -> usize {
        (0..self.nuisances)
            .filter(|&nuisance| self.pivot(nuisance) > 0.0)
            .count()
    }
}

/// Gentleman's rotation of a line, which begins with its weight, and a row of this weight, of which the first number becomes 0.
fn rotate(line: &mut [f64], row: &mut [f64], row_weight: &mut f64) {
    let (Some((weight, line)), Some((head, row))) = (line.split_first_mut(), row.split_first_mut())
    else {
        return;
    };
    if *head == 0.0 {
        return;
    }
    let weighted = *row_weight * *head;
    let sum = *weight + weighted * *head;
    let (cosine, sine) = (*weight / sum, weighted / sum);
    let numbers = line.iter_mut().zip(&mut *row);
    if cosine > 0.25 {
        // A product less than below. The numbers of a line lose what rounds away at 1/cosine times their squares.
        for (line, row) in numbers {
            *row -= *head * *line;
            *line += sine * *row;
        }
    } else {
        for (line, row) in numbers {
            (*line, *row) = (cosine * *line + sine * *row, *row - *head * *line);
        }
    }
    (*weight, *row_weight, *head) = (sum, *row_weight * cosine, 0.0);
    if *row_weight < LEAST_WEIGHT {
        let root = libm::sqrt(*row_weight);
        row.iter_mut().for_each(|number| *number *= root);
        *row_weight = 1.0;
    }
}

/// Implements: SEQ-006.
fn check_row(what: &'static str, row: &[f64], length: usize) -> Result<(), DetectError> {
    check_length(what, length, row.len())?;
    // False for NaN.
    let is_right = |value: &f64| value.abs() <= LARGEST;
    match row.iter().find(|value| !is_right(value)) {
        None => Ok(()),
        Some(&value) => in_range(false, what, value, "at most 1e80 in magnitude").map(|_| ()),
    }
}

/// Wald's sequential test, by bounds of θ that keep each error rate.
///
/// ```
/// use palpate_core::detect::{Decision, sequential::Wald};
///
/// let test = Wald::new(0.01, 0.01)?;
/// assert_eq!(test.decide(4.7)?, Some(Decision::Inclusion));
/// assert_eq!(test.decide(4.5)?, None);
/// // The fixed-length test needs γ² = 21.65 in every record.
/// assert!((test.mean_gamma_squared(Decision::Inclusion) - 9.03).abs() < 0.01);
/// # Ok::<(), palpate_core::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wald {
    rates: ErrorRates,
    upper: f64,
    lower: f64,
}

impl Wald {
    /// The test with at most these rates of false alarms and of misses.
    ///
    /// # Errors
    /// A rate that is not strictly between 0 and 1; two with a sum of 1 or more.
    ///
    /// Implements: SEQ-010.
    pub fn new(max_false_alarm: f64, max_miss: f64) -> Result<Wald, DetectError> {
        let rates = ErrorRates {
            false_alarm: check_probability("max_false_alarm", max_false_alarm)?,
            miss: check_probability("max_miss", max_miss)?,
        };
        let sum = rates.false_alarm + rates.miss;
        in_range(sum < 1.0, "max_false_alarm + max_miss", sum, "below 1")?;
        Ok(Wald {
            rates,
            upper: -libm::log(rates.false_alarm),
            lower: libm::log(rates.miss),
        })
    }

    /// The rates.
    pub fn rates(&self) -> ErrorRates {
        self.rates
    }

    /// −ln α, the least θ of an inclusion.
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// ln β, the largest θ of none.
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// Ĥ; none while the test goes on.
    ///
    /// # Errors
    /// θ is not finite.
    ///
    /// Implements: SEQ-010.
    pub fn decide(&self, theta: f64) -> Result<Option<Decision>, DetectError> {
        check_finite("theta", theta)?;
        Ok(if theta >= self.upper {
            Some(Decision::Inclusion)
        } else if theta <= self.lower {
            Some(Decision::NoInclusion)
        } else {
            None
        })
    }

    /// The mean γ² at the end of the test if that is `truth`, without what θ jumps beyond the bounds.
    ///
    /// Implements: SEQ-011.
    pub fn mean_gamma_squared(&self, truth: Decision) -> f64 {
        let ErrorRates { false_alarm, miss } = self.rates;
        let both = 1.0 - false_alarm * miss;
        let false_alarm_rate = false_alarm * (1.0 - miss) / both;
        let miss_rate = miss * (1.0 - false_alarm) / both;
        let (upper, sign) = match truth {
            Decision::NoInclusion => (false_alarm_rate, -2.0),
            Decision::Inclusion => (1.0 - miss_rate, 2.0),
        };
        sign * (upper * self.upper + (1.0 - upper) * self.lower)
    }

    /// At most these rates of the test that is decided at η where the record ends, with γ, before it does.
    ///
    /// # Errors
    /// As [`error_rates`].
    ///
    /// Implements: SEQ-012.
    pub fn truncated(&self, gamma: f64, eta: f64) -> Result<ErrorRates, DetectError> {
        let at_end = error_rates(gamma, eta)?;
        Ok(ErrorRates {
            false_alarm: f64::min(self.rates.false_alarm + at_end.false_alarm, 1.0),
            miss: f64::min(self.rates.miss + at_end.miss, 1.0),
        })
    }
}

#[cfg(test)]
mod tests;
