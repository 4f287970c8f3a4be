//! Which pair comes when.

use palpate::stats::random::Generator;

/// The stream of the generator that plans are drawn from.
const STREAM: u64 = 0x2AFC;

/// The two samples of a pair, in the order in which they are felt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interval {
    /// The first.
    First,
    /// The second.
    Second,
}

/// One pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    /// Which inclusion, by its place in the list.
    pub inclusion: usize,
    /// Which of the two samples has it.
    pub with_inclusion: Interval,
}

/// All pairs of a subject in random order: `trials` pairs for each of `inclusions`, each with the inclusion first or second as a
/// fair coin has it.
///
/// Implements: PSY-001.
pub fn plan(seed: u64, inclusions: usize, trials: usize) -> Vec<Trial> {
    let generator = Generator::new(seed, STREAM);
    let trial = |number: usize| Trial {
        inclusion: number % inclusions,
        with_inclusion: match generator.words([number as u64, 0, 0, 0])[0] >> 63 {
            0 => Interval::First,
            _ => Interval::Second,
        },
    };
    let mut plan: Vec<Trial> = (0..inclusions * trials).map(trial).collect();
    // Fisher and Yates: every order is as likely as any other.
    for last in (1..plan.len()).rev() {
        let other = below(&generator, last as u64, last as u64 + 1);
        plan.swap(last, other as usize);
    }
    plan
}

/// A number from 0 to `bound` − 1, each as likely as any other; `place` tells the draws apart.
fn below(generator: &Generator, place: u64, bound: u64) -> u64 {
    let whole = u64::MAX - u64::MAX % bound;
    // Rejects what would favour small numbers: once in 2⁵⁰ draws.
    let mut words = (0..).map(|attempt| generator.words([place, attempt, 1, 0])[0]);
    let word = words.find(|&word| word < whole);
    word.map_or(0, |word| word % bound)
}
