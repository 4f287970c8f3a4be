//! Which pair comes when.

use crate::stats::random::Generator;

/// The stream of the generator that plans are drawn from.
const STREAM: u64 = 0x2AFC;

/// The two samples of a pair, in the order in which they are felt.
///
/// ```
/// use palpate::psychophysics::{Interval, Plan};
///
/// // As a fair coin has it: 500 of 1000, give or take four standard deviations of 16.
/// let plan = Plan::new(42, 1, 1000);
/// let first = plan.trials().iter().filter(|trial| trial.with_inclusion == Interval::First);
/// assert!(first.count().abs_diff(500) < 64);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interval {
    /// The first.
    First,
    /// The second.
    Second,
}

/// One pair.
///
/// ```
/// use palpate::psychophysics::{Interval, Plan, Trial};
///
/// let Trial { inclusion, with_inclusion } = Plan::new(42, 4, 30).trials()[0];
/// assert!(inclusion < 4);
/// assert!([Interval::First, Interval::Second].contains(&with_inclusion));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    /// Which inclusion, by its place in the list.
    pub inclusion: usize,
    /// Which of the two samples has it.
    pub with_inclusion: Interval,
}

/// All pairs of a subject, in random order.
///
/// ```
/// use palpate::psychophysics::Plan;
///
/// // The paper's: 30 pairs for each of four inclusions. The same seed gives the same plan.
/// let plan = Plan::new(42, 4, 30);
/// assert_eq!(plan.trials().iter().filter(|trial| trial.inclusion == 3).count(), 30);
/// assert_eq!(plan.trials().len(), 120);
/// assert_eq!(plan, Plan::new(42, 4, 30));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    trials: Vec<Trial>,
}

impl Plan {
    /// `trials` pairs for each of `inclusions`, mixed, each with the inclusion first or second as a
    /// fair coin has it.
    ///
    /// Implements: PSY-001, PSY-002.
    pub fn new(seed: u64, inclusions: usize, trials: usize) -> Plan {
        let generator = Generator::new(seed, STREAM);
        let mut plan: Vec<Trial> = (0..inclusions * trials)
            .map(|number| Trial {
                inclusion: number % inclusions,
                with_inclusion: match generator.words([number as u64, 0, 0, 0])[0] >> 63 {
                    0 => Interval::First,
                    _ => Interval::Second,
                },
            })
            .collect();
        // Fisher and Yates: every order is as likely as any other.
        for last in (1..plan.len()).rev() {
            let other = below(&generator, last as u64, last as u64 + 1);
            plan.swap(last, other as usize);
        }
        Plan { trials: plan }
    }

    /// The pairs in their order.
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }
}

/// A number from 0 to `bound` − 1, each as likely as any other; `place` tells the draws apart.
fn below(generator: &Generator, place: u64, bound: u64) -> u64 {
    let whole = u64::MAX - u64::MAX % bound;
    // Rejects what would favour small numbers: once in 2⁵⁰ draws.
    (0..)
        .map(|attempt| generator.words([place, attempt, 1, 0])[0])
        .find(|&word| word < whole)
        .map_or(0, |word| word % bound)
}
