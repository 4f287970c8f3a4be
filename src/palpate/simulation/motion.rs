//! Where a stage or a hand really is.

use std::f64::consts::TAU;

use super::elastic;
use super::path::Path;
use crate::force_map::ForceTable;
use crate::hid::simulated::{Handle, Mechanics};
use crate::refusal::Refusal;
use crate::stats::random::{Generator, uniform};

/// What leads the probe.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// The impedance of the hand, or a stage that is where it is sent.
    pub hand: Option<Hand>,
    /// What is added to where the probe is sent.
    pub tremor: Option<Tremor>,
}

/// The impedance of a hand with the probe in it: m a + b v + k (place − commanded place) = force of the gel, along x and along the depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hand {
    /// m, kg.
    pub mass: f64,
    /// b, N·s/m.
    pub damping: f64,
    /// k, N/m.
    pub stiffness: f64,
}

/// The hand that holds the simulated device.
impl Default for Hand {
    fn default() -> Hand {
        Hand {
            mass: Mechanics::PAPER.mass_kg,
            damping: Mechanics::PAPER.hand_n_s_per_m,
            stiffness: Mechanics::PAPER.hand_n_per_m,
        }
    }
}

/// Physiological tremor, the same along x and along the depth: eight tones of equal size about a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tremor {
    /// Root mean square along each axis, m.
    pub rms: f64,
    /// The frequency, Hz; the tones lie within a fifth of it.
    pub frequency: f64,
}

/// Tones of a tremor.
const TONES: u64 = 8;
/// How long the gel's force is held while a hand moves, s; the hand itself moves in ten steps of it.
const STEP: f64 = 1e-4;
/// The longest path along which a hand moves, s: some 10⁹ steps, a minute of computing.
const LONGEST: f64 = 1e4;
/// How long a hand holds the first place before the first sample, s.
const SETTLE: f64 = 1.0;
/// The share of its velocity that damping and stiffness may take from a hand in a step.
const MOST_PER_STEP: f64 = 0.1;
/// The damping of a hand at least, in steps of the gel's stiffness: a tenth of it may be missing.
const TIMES_STEPS: f64 = 5.0;
/// Phases are drawn apart from the deviates.
const PHASES: u64 = 2;

impl Motion {
    /// The position and the depth of the probe at each sample, m.
    ///
    /// # Errors
    /// A hand that leaves the map.
    ///
    /// Implements: SIM-020, SIM-021, SIM-022.
    pub(super) fn places(
        &self,
        gel: &ForceTable,
        path: &Path,
        generator: &Generator,
    ) -> Result<Vec<[f64; 2]>, Refusal> {
        let tones = self.tremor.map(|tremor| tremor.tones(generator));
        let target = |time: f64| {
            let [x, depth] = path.at(time);
            let [along, down] = tones.as_ref().map_or([0.0; 2], |tones| added(tones, time));
            [x + along, depth + down]
        };
        let samples = path.samples();
        let Some(hand) = self.hand else {
            return Ok(samples.iter().map(|&time| target(time)).collect());
        };
        hand.check(gel)?;
        let first = samples[0];
        let duration = samples[samples.len() - 1] - first;
        let found = format!("a path of {duration:.0} s with a hand");
        let remedy = format!("give one of at most {LONGEST} s, or a higher speed");
        Refusal::state(found, remedy).when(duration > LONGEST)?;
        let mut handles = target(first).map(|place| Handle::at(hand.mechanics(), place));
        let mut places = Vec::with_capacity(samples.len());
        // Of the first sample: a step would round beside a large time.
        let mut time = -SETTLE;
        for &sample in samples {
            let sample = sample - first;
            // The last step ends at the sample, but for rounding.
            while sample - time > 1e-6 * STEP {
                let step = STEP.min(sample - time);
                let place = handles.map(|handle| handle.position);
                let [lateral, normal] = elastic(gel, place)?;
                let forces = [lateral, -normal];
                let wanted = target(first + time);
                for (axis, handle) in handles.iter_mut().enumerate() {
                    handle.advance(step, wanted[axis], forces[axis]);
                }
                time += step;
            }
            places.push(handles.map(|handle| handle.position));
        }
        Ok(places)
    }
}

impl Hand {
    /// Refuses a hand whose motion the steps do not follow: the gel's force, held for a step, takes half a step's stiffness of its damping.
    ///
    /// Implements: CLI-232.
    fn check(&self, gel: &ForceTable) -> Result<(), Refusal> {
        let (depths, forces) = (gel.depths(), gel.normal());
        let slope = |row: usize, column: usize| {
            let [from, to] = [row, row + 1].map(|row| forces.row(row)[column]);
            (to - from) / (depths[row + 1] - depths[row])
        };
        let columns = 0..gel.laterals().len();
        let rows = 0..depths.len() - 1;
        let slopes = rows.flat_map(|row| columns.clone().map(move |column| slope(row, column)));
        let least = TIMES_STEPS * STEP * slopes.fold(0.0, f64::max);
        let found = format!("a hand of {} N·s/m", self.damping);
        let remedy =
            format!("give at least {least:.3} N·s/m on this gel, whose force is held for 0.1 ms");
        Refusal::state(found, remedy).when(self.damping < least)?;
        let step = 0.1 * STEP;
        let per_step = (self.damping + self.stiffness * step) * step / self.mass;
        let found = format!("a hand of {} kg", self.mass);
        let remedy = "give a mass above 0 that is heavier for its damping and stiffness";
        // NaN is no hand.
        Refusal::state(found, remedy).when(!(self.mass > 0.0 && per_step <= MOST_PER_STEP))
    }

    /// The hand alone, without a device.
    fn mechanics(&self) -> Mechanics {
        Mechanics {
            mass_kg: self.mass,
            damping_n_s_per_m: 0.0,
            friction_n: 0.0,
            backlash_m: 0.0,
            hand_n_per_m: self.stiffness,
            hand_n_s_per_m: self.damping,
        }
    }
}

/// Amplitude (m), frequency (Hz) and phase of each tone, of both axes.
type Tones = [Vec<[f64; 3]>; 2];

impl Tremor {
    fn tones(&self, generator: &Generator) -> Tones {
        let amplitude = self.rms * (2.0 / TONES as f64).sqrt();
        [0, 1].map(|axis| {
            let tone = |number: u64| {
                let share = 0.8 + 0.4 * (number as f64 + 0.5) / TONES as f64;
                let phase = TAU * uniform(generator.words([number, axis, PHASES, 0])[0]);
                [amplitude, share * self.frequency, phase]
            };
            (0..TONES).map(tone).collect()
        })
    }
}

/// What the tones add at a time, m.
fn added(tones: &Tones, time: f64) -> [f64; 2] {
    let at = |&[amplitude, frequency, phase]: &[f64; 3]| {
        amplitude * libm::sin(TAU * frequency * time + phase)
    };
    [0, 1].map(|axis: usize| tones[axis].iter().map(at).sum())
}
