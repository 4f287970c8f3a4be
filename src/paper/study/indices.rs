//! Sobol' indices: which share of a quantity's variance comes from each group of inputs (Saltelli et al., *Computer Physics
//! Communications* 181, 2010; Jansen, *Computer Physics Communications* 117, 1999).

use serde::{Deserialize, Serialize};

use palpate::stats::random::Generator;

/// Resamples of the rows, for the intervals.
///
/// Implements: STU-040.
const RESAMPLES: u64 = 400;
/// The resamples left out at each end of an interval of 95 %.
const LEFT_OUT: usize = 10;
/// The stream of the generator that draws the rows.
const STREAM: u64 = 0x50B0;

/// A number with its bootstrap interval of 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

/// The Sobol' indices of one group of inputs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Index {
    /// The share of the variance that goes away when the group is known, by itself.
    pub first_order: Estimate,
    /// The share that stays when all but the group is known: with what it does together with others.
    pub total: Estimate,
}

/// The values of one quantity: each slice has one for each row.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// In the first sample.
    pub first: &'a [f64],
    /// In the second sample.
    pub second: &'a [f64],
    /// In the first sample with the inputs of a group from the second, for each group.
    pub mixed: &'a [Vec<f64>],
}

/// The indices of each group, from rows of equal lengths; `None` where the quantity is the same in all of them, or rows are fewer than
/// two. `seed` draws the resamples.
///
/// ```
/// use palpate_paper::study::{Rows, indices};
///
/// // y = 3a + 4b with independent a and b of the same variance: the shares are 9/25 and 16/25.
/// let inputs = |row: u32| [0, 1, 2, 3].map(|dimension| f64::from(sobol_burley::sample(row, dimension, 1)));
/// let of = |y: fn([f64; 4]) -> f64| (0..256).map(inputs).map(y).collect::<Vec<f64>>();
/// let mixed = [of(|[_, b, c, _]| 3.0 * c + 4.0 * b), of(|[a, _, _, d]| 3.0 * a + 4.0 * d)];
/// let rows = Rows { first: &of(|[a, b, ..]| 3.0 * a + 4.0 * b), second: &of(|[.., c, d]| 3.0 * c + 4.0 * d), mixed: &mixed };
/// let found = indices(rows, 1).ok_or("it varies")?;
/// assert!((found[0].first_order.value - 0.36).abs() < 0.01);
/// assert!((found[1].total.value - 0.64).abs() < 0.01);
/// # Ok::<(), &str>(())
/// ```
///
/// Implements: STU-040.
pub fn indices(rows: Rows<'_>, seed: u64) -> Option<Vec<Index>> {
    let count = rows.first.len();
    let found = estimates(rows, 0..count)?;
    let generator = Generator::new(seed, STREAM);
    let mut resampled = vec![[Vec::new(), Vec::new()]; found.len()];
    for number in 0..RESAMPLES {
        let drawn = (0..count).map(|row| {
            let [word, ..] = generator.words([number, row as u64, 0, 0]);
            // A share of 2⁶⁴ of the rows.
            ((u128::from(word) * count as u128) >> 64) as usize
        });
        // A resample of equal values says nothing.
        for (kept, shares) in resampled.iter_mut().zip(estimates(rows, drawn)?) {
            kept.iter_mut()
                .zip(shares)
                .for_each(|(kept, share)| kept.push(share));
        }
    }
    let estimate = |value: f64, mut kept: Vec<f64>| {
        kept.sort_by(f64::total_cmp);
        let (lower, upper) = (kept[LEFT_OUT], kept[kept.len() - 1 - LEFT_OUT]);
        Estimate {
            value,
            lower,
            upper,
        }
    };
    let index = |([first_order, total], [of_first, of_total]): ([f64; 2], [Vec<f64>; 2])| Index {
        first_order: estimate(first_order, of_first),
        total: estimate(total, of_total),
    };
    Some(found.into_iter().zip(resampled).map(index).collect())
}

/// The first-order and the total index of each group over the rows drawn; `None` without variance.
///
/// With μ and V the mean and the variance of both samples, by Saltelli S = ⟨(f_B − μ)(f_AB − f_A)⟩/V, by Jansen T = ⟨(f_A − f_AB)²⟩/2V.
fn estimates(rows: Rows<'_>, drawn: impl Iterator<Item = usize>) -> Option<Vec<[f64; 2]>> {
    let drawn: Vec<usize> = drawn.collect();
    let count = drawn.len() as f64;
    let both = |row: &usize| [rows.first[*row], rows.second[*row]];
    let mean = drawn.iter().flat_map(both).sum::<f64>() / (2.0 * count);
    let squares = drawn
        .iter()
        .flat_map(both)
        .map(|value| (value - mean) * (value - mean));
    let variance = squares.sum::<f64>() / (2.0 * count);
    // Written so that a NaN is none.
    if !(drawn.len() > 1 && variance > 0.0) {
        return None;
    }
    let of_group = |mixed: &Vec<f64>| {
        let [mut first_order, mut total] = [0.0; 2];
        for &row in &drawn {
            let change = mixed[row] - rows.first[row];
            first_order += (rows.second[row] - mean) * change;
            total += change * change;
        }
        [
            first_order / (count * variance),
            total / (2.0 * count * variance),
        ]
    };
    Some(rows.mixed.iter().map(of_group).collect())
}
