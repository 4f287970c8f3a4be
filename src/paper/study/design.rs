//! At which values of the inputs a study computes: the medians, each input by itself, and the two samples of Saltelli's scheme.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use palpate::fem::certify::MESH_RATIOS;
use palpate::refusal::Refusal;
use palpate::stats::normal;

/// Points of one Sobol' sequence: from there on another scrambling of it goes on.
const SEQUENCE: u32 = 1 << 16;
/// Rows at most, so that there is memory for the results. So many samples take years.
const MOST_ROWS: usize = 1 << 20;
/// Inputs at most: each takes two dimensions of the sequence.
pub const MOST_INPUTS: usize = sobol_burley::NUM_DIMENSIONS as usize / 2;
/// Meshes on which the medians are solved.
///
/// Implements: STU-021.
const MESHES: usize = MESH_RATIOS.len() + 1;
/// The probabilities between which the slope of a quantity is taken.
///
/// Implements: STU-021.
pub const BESIDE_MEDIAN: [f64; 2] = [0.25, 0.75];

/// How two inputs go together: the correlation of their normal scores, which is that of the inputs where both are normal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correlation {
    /// The names of the two.
    pub inputs: [String; 2],
    /// Between −1 and 1.
    pub coefficient: f64,
}

/// What a sample of a study is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// All inputs at their medians, on a mesh of this number: 0 is that of the study, the others are coarser.
    Median(usize),
    /// One input at its lower quartile, 0, or its upper one, 1.
    Slope(usize, usize),
    /// A row of the first sample.
    First(usize),
    /// A row of the second sample.
    Second(usize),
    /// A row of the first sample, with the inputs of a group from the second.
    Mixed(usize, usize),
}

/// The values of a quantity in all samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Values<'a> {
    /// With all inputs at their medians, on each mesh.
    pub medians: &'a [f64],
    /// With each input at its lower quartile, and at its upper one.
    pub quartiles: &'a [f64],
    /// Of each row: in the first sample, in the second one, and for each group in the first with the inputs of the group from the second.
    pub rows: Vec<&'a [f64]>,
}

/// The samples of a study. Each is a function of its number alone.
///
/// Implements: STU-020, STU-021.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    rows: usize,
    seed: u32,
    /// The inputs of each group, which are correlated with one another and with no others.
    groups: Vec<Vec<usize>>,
    /// For each group of several inputs the factor L of its correlation matrix LLᵀ.
    factors: Vec<DMatrix<f64>>,
    inputs: usize,
}

impl Design {
    /// The design with so many rows for inputs of these names.
    ///
    /// # Errors
    /// No input, or too many; no row, or more than a number of 32 bits counts; a correlation of unknown inputs, of one with itself, or of a pair twice; coefficients that no
    /// inputs can have.
    ///
    /// Implements: STU-012, STU-020.
    pub fn new(
        names: &[&str],
        correlations: &[Correlation],
        rows: usize,
        seed: u32,
    ) -> Result<Design, Refusal> {
        let inputs = names.len();
        if !(1..=MOST_INPUTS).contains(&inputs) {
            let expected = format!("give 1 to {MOST_INPUTS}");
            return Err(Refusal::state(format!("{inputs} inputs"), expected));
        }
        if !(2..=MOST_ROWS).contains(&rows) {
            return Err(Refusal::value("rows", rows, format!("2 to {MOST_ROWS}")));
        }
        let matrix = correlation_matrix(names, correlations)?;
        let groups = groups(&matrix);
        let factors = groups.iter().map(|group| factor(&matrix, group, names));
        Ok(Design {
            rows,
            seed,
            factors: factors.collect::<Result<_, _>>()?,
            groups,
            inputs,
        })
    }

    /// The inputs of each group: a group is what an index belongs to.
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }

    /// The number of samples.
    pub fn samples(&self) -> usize {
        self.first_row() + self.rows * self.row_length()
    }

    fn first_row(&self) -> usize {
        MESHES + 2 * self.inputs
    }

    fn row_length(&self) -> usize {
        2 + self.groups.len()
    }

    /// The values of a quantity in all samples, by what these are for.
    pub(super) fn split<'a>(&self, values: &'a [f64]) -> Values<'a> {
        let (medians, rest) = values.split_at(MESHES);
        let (quartiles, rows) = rest.split_at(2 * self.inputs);
        Values {
            medians,
            quartiles,
            rows: rows.chunks(self.row_length()).collect(),
        }
    }

    /// What the sample with a number is for.
    ///
    /// Implements: STU-021.
    pub fn role(&self, index: usize) -> Role {
        if index < MESHES {
            return Role::Median(index);
        }
        let Some(place) = index.checked_sub(self.first_row()) else {
            let place = index - MESHES;
            return Role::Slope(place / 2, place % 2);
        };
        let row = place / self.row_length();
        match place % self.row_length() {
            0 => Role::First(row),
            1 => Role::Second(row),
            group => Role::Mixed(row, group - 2),
        }
    }

    /// The probability of each input in the sample with a number: its value is the quantile.
    ///
    /// Implements: STU-012, STU-020, STU-021.
    pub fn probabilities(&self, index: usize) -> Vec<f64> {
        let mut point = vec![0.5; self.inputs];
        match self.role(index) {
            Role::Median(_) => return point,
            Role::Slope(input, side) => {
                point[input] = BESIDE_MEDIAN[side];
                return point;
            }
            Role::First(row) => self.fill(&mut point, row, |_| 0),
            Role::Second(row) => self.fill(&mut point, row, |_| 1),
            Role::Mixed(row, of) => self.fill(&mut point, row, |group| usize::from(group == of)),
        }
        point
    }

    /// A row, with the inputs of each group from the first sample or the second.
    fn fill(&self, point: &mut [f64], row: usize, sample: impl Fn(usize) -> usize) {
        for (number, (group, factor)) in self.groups.iter().zip(&self.factors).enumerate() {
            let first = sample(number) * self.inputs;
            let uniform = |input: &usize| self.uniform(row, first + input);
            if let [input] = group[..] {
                point[input] = uniform(&input);
                continue;
            }
            // Each is strictly between 0 and 1, where the quantile is defined.
            let score = |input| normal::quantile(uniform(input)).unwrap_or(0.0);
            let scores: Vec<f64> = group.iter().map(score).collect();
            for (i, &input) in group.iter().enumerate() {
                let score = (0..=i).map(|j| factor[(i, j)] * scores[j]).sum();
                let share = normal::cdf(score).unwrap_or(0.5);
                point[input] = share.clamp(f64::EPSILON, 1.0 - f64::EPSILON);
            }
        }
    }

    /// A coordinate of the scrambled Sobol' sequence, in the middle of one of 2²³ cells.
    ///
    /// Implements: STU-020.
    fn uniform(&self, row: usize, dimension: usize) -> f64 {
        // As many as a number of 32 bits counts.
        let row = row as u32;
        let seed = self.seed.wrapping_add(row / SEQUENCE);
        let corner = sobol_burley::sample(row % SEQUENCE, dimension as u32, seed);
        f64::from(corner) + f64::from(f32::EPSILON) / 2.0
    }
}

/// The matrix of all correlations.
///
/// Implements: STU-012.
fn correlation_matrix(
    names: &[&str],
    correlations: &[Correlation],
) -> Result<DMatrix<f64>, Refusal> {
    let mut matrix = DMatrix::identity(names.len(), names.len());
    for (at, correlation) in correlations.iter().enumerate() {
        let refused = |key: &str, found: String, expected: String| {
            let key = format!("correlation[{at}].{key}");
            Err(Refusal::value(key, found, expected))
        };
        let (inputs, coefficient) = (&correlation.inputs, correlation.coefficient);
        let pair = inputs.join(", ");
        let place = |name: &String| names.iter().position(|known| known == name);
        let [Some(one), Some(other)] = inputs.each_ref().map(place) else {
            return refused("inputs", pair, format!("two of {}", names.join(", ")));
        };
        if one == other || matrix[(one, other)] != 0.0 {
            return refused(
                "inputs",
                pair,
                "two different inputs, each pair once".into(),
            );
        }
        if !(coefficient.abs() < 1.0 && coefficient != 0.0) {
            let expected = "a number strictly between −1 and 1 that is not 0";
            return refused("coefficient", coefficient.to_string(), expected.into());
        }
        matrix[(one, other)] = coefficient;
        matrix[(other, one)] = coefficient;
    }
    Ok(matrix)
}

/// The factor L of the correlation matrix LLᵀ of a group.
fn factor(matrix: &DMatrix<f64>, group: &[usize], names: &[&str]) -> Result<DMatrix<f64>, Refusal> {
    let of_group = matrix.select_rows(group).select_columns(group);
    let factor = of_group.cholesky().map(|factor| factor.l());
    factor.ok_or_else(|| {
        let names: Vec<&str> = group.iter().map(|&input| names[input]).collect();
        let found = format!(
            "the correlations of {} contradict one another",
            names.join(", ")
        );
        Refusal::state(found, "give coefficients of a positive definite matrix")
    })
}

/// The inputs that are correlated with one another, directly or through others.
fn groups(correlations: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let inputs = correlations.nrows();
    let mut group_of: Vec<usize> = (0..inputs).collect();
    for one in 0..inputs {
        for other in 0..one {
            if correlations[(one, other)] != 0.0 {
                let (from, to) = (group_of[one], group_of[other]);
                let joined = group_of.iter_mut().filter(|group| **group == from);
                joined.for_each(|group| *group = to);
            }
        }
    }
    let mut groups = vec![Vec::new(); inputs];
    for (input, group) in group_of.into_iter().enumerate() {
        groups[group].push(input);
    }
    groups.retain(|group| !group.is_empty());
    groups
}
