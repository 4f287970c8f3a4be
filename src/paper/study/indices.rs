//! Sobol' indices: which share of a quantity's variance comes from each group of inputs (Saltelli et al., *Computer Physics
//! Communications* 181, 2010; Jansen, *Computer Physics Communications* 117, 1999).

use serde::{Deserialize, Serialize};

use palpate::stats::random::Generator;

/// Resamples of the rows, for the intervals.
///
/// Implements: STU-040.
const RESAMPLES: u64 = 400;
/// One of so many resamples is left out at each end of an interval of 95 %.
const LEFT_OUT: usize = 40;
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

/// The indices of each group of inputs, from the values of a quantity in rows: in the first sample, in the second one, and for each group
/// in the first with the inputs of the group from the second. `None` where the quantity is the same in all of them or in all rows of each
/// resample, or rows are fewer than two. `seed` draws the resamples.
///
/// ```
/// use palpate_paper::study::indices;
///
/// // y = 3a + 4b with independent a and b of the same variance: the shares are 9/25 and 16/25.
/// let y = |a: f64, b: f64| 3.0 * a + 4.0 * b;
/// let row = |row: u32| {
///     let [a, b, c, d] = [0, 1, 2, 3].map(|dimension| sobol_burley::sample(row, dimension, 1).into());
///     [y(a, b), y(c, d), y(c, b), y(a, d)]
/// };
/// let rows: Vec<[f64; 4]> = (0..256).map(row).collect();
/// let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
/// let found = indices(&rows, 1).ok_or("it varies")?;
/// assert!((found[0].first_order.value - 0.36).abs() < 0.01);
/// assert!((found[1].total.value - 0.64).abs() < 0.01);
/// # Ok::<(), &str>(())
/// ```
///
/// Implements: STU-040.
pub fn indices(rows: &[&[f64]], seed: u64) -> Option<Vec<Index>> {
    let found = estimates(rows)?;
    let generator = Generator::new(seed, STREAM);
    let mut resampled = vec![[Vec::new(), Vec::new()]; found.len()];
    for number in 0..RESAMPLES {
        let drawn = (0..rows.len() as u64).map(|row| {
            let [word, ..] = generator.words([number, row, 0, 0]);
            // A share of 2⁶⁴ of the rows.
            rows[((u128::from(word) * rows.len() as u128) >> 64) as usize]
        });
        // A resample of equal values says nothing.
        let Some(shares) = estimates(&drawn.collect::<Vec<_>>()) else {
            continue;
        };
        for (kept, shares) in resampled.iter_mut().zip(shares) {
            for (kept, share) in kept.iter_mut().zip(shares) {
                kept.push(share);
            }
        }
    }
    if resampled.iter().flatten().any(Vec::is_empty) {
        return None;
    }
    let estimate = |value: f64, mut kept: Vec<f64>| {
        kept.sort_by(f64::total_cmp);
        let left_out = kept.len() / LEFT_OUT;
        let (lower, upper) = (kept[left_out], kept[kept.len() - 1 - left_out]);
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

/// The first-order and the total index of each group over the rows; `None` without variance.
///
/// With μ and V the mean and the variance of both samples, by Saltelli S = ⟨(f_B − μ)(f_AB − f_A)⟩/V, by Jansen T = ⟨(f_A − f_AB)²⟩/2V.
fn estimates(rows: &[&[f64]]) -> Option<Vec<[f64; 2]>> {
    let count = rows.len() as f64;
    let both = || rows.iter().flat_map(|row| &row[..2]);
    // A mean is rounded, and what is left of equal values looks like variance.
    let first = rows.first()?[0];
    if both().all(|value| *value == first) {
        return None;
    }
    let mean = both().sum::<f64>() / (2.0 * count);
    let squares = both().map(|value| (value - mean) * (value - mean));
    let variance = squares.sum::<f64>() / (2.0 * count);
    // Written so that a NaN is none.
    if !(rows.len() > 1 && variance > 0.0) {
        return None;
    }
    let of_group = |group: usize| {
        let [mut first_order, mut total] = [0.0; 2];
        for row in rows {
            let change = row[2 + group] - row[0];
            first_order += (row[1] - mean) * change;
            total += change * change;
        }
        [
            first_order / (count * variance),
            total / (2.0 * count * variance),
        ]
    };
    Some((0..rows[0].len() - 2).map(of_group).collect())
}
