//! The largest force, and how fast it may change.

use core::fmt;

/// No limit may allow a larger force, N (SRV-022).
pub const FORCE_CEILING: f32 = 20.0;

/// Smallest change of the force that a limit may allow in one cycle, N (SRV-022).
pub const MIN_SLEW: f32 = 1e-4;

/// A force at its limit is released in this many cycles, and one more for rounding (SRV-031).
pub const RELEASE_CYCLES: u16 = 16;

/// What the commands must keep to, component by component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    force: f32,
    slew: f32,
    release: f32,
    watchdog: u16,
}

/// Which limit is out of its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InvalidLimits {
    /// The force is not above 0 and at most [`FORCE_CEILING`].
    Force,
    /// The slew is not at least [`MIN_SLEW`] and at most the force.
    Slew,
    /// The release is below the slew, or takes longer than [`RELEASE_CYCLES`], or is not finite.
    Release,
    /// The watchdog is not 1 to 100 cycles.
    Watchdog,
}

impl fmt::Display for InvalidLimits {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            InvalidLimits::Force => {
                write!(
                    f,
                    "the force limit must be above 0 and at most {FORCE_CEILING} N"
                )
            }
            InvalidLimits::Slew => {
                write!(
                    f,
                    "the slew limit must be {MIN_SLEW} N a cycle to the force limit"
                )
            }
            InvalidLimits::Release => write!(
                f,
                "the release limit must be at least the slew limit and 1/{RELEASE_CYCLES} of the force limit"
            ),
            InvalidLimits::Watchdog => write!(f, "the watchdog must be 1 to 100 cycles"),
        }
    }
}

impl core::error::Error for InvalidLimits {}

impl Limits {
    /// Limits of `force` (N), of its growth in one cycle (`slew`, N), of its fall in one cycle (`release`, N), and of the run
    /// of cycles without a fresh sample (`watchdog`).
    ///
    /// # Errors
    /// [`InvalidLimits`].
    ///
    /// Implements: SRV-022.
    pub fn new(
        force: f32,
        slew: f32,
        release: f32,
        watchdog: u16,
    ) -> Result<Limits, InvalidLimits> {
        // Written so that NaN is refused.
        if !(force > 0.0 && force <= FORCE_CEILING) {
            return Err(InvalidLimits::Force);
        }
        if !(slew >= MIN_SLEW && slew <= force) {
            return Err(InvalidLimits::Slew);
        }
        let quickest = f32::from(RELEASE_CYCLES) * release;
        if !(release >= slew && quickest >= force && release.is_finite()) {
            return Err(InvalidLimits::Release);
        }
        if !(1..=100).contains(&watchdog) {
            return Err(InvalidLimits::Watchdog);
        }
        Ok(Limits {
            force,
            slew,
            release,
            watchdog,
        })
    }

    /// The limits with which `palpate play` plays on a device with a report each `period_us` (µs): `force` (N); a growth of 250 N/s, in
    /// a cycle at most an eighth of `force`; a release in 8 cycles; 20 cycles without a fresh sample. The stiffest spring of the paper's
    /// display, 1200 N/m, grows by 240 N/s under a hand of 0.2 m/s. A period of 0, which a session refuses, counts as 1 µs.
    ///
    /// # Errors
    /// [`InvalidLimits`].
    ///
    /// Implements: CLI-064.
    pub fn for_playback(force: f32, period_us: u16) -> Result<Limits, InvalidLimits> {
        let release = force / 8.0;
        let growth = f32::from(period_us.max(1)) / 4000.0;
        let slew = if release < growth { release } else { growth };
        Limits::new(force, slew, release, 20)
    }

    /// Largest magnitude of a component of the force, N.
    pub fn force(&self) -> f32 {
        self.force
    }

    /// Largest growth of a component in one cycle, N; also its largest fall in a cycle without a fresh sample.
    pub fn slew(&self) -> f32 {
        self.slew
    }

    /// Largest fall of a component in one cycle, N.
    pub fn release(&self) -> f32 {
        self.release
    }

    /// Longest run of cycles without a fresh sample that is no fault.
    pub fn watchdog(&self) -> u16 {
        self.watchdog
    }
}

/// `value` within ±`largest`; a NaN gives 0.
///
/// Implements: SRV-020.
#[inline]
pub fn limit(value: f32, largest: f32) -> f32 {
    let value = if value.is_nan() { 0.0 } else { value };
    between(value, -largest, largest)
}

/// From `last` towards `target` and never beyond it: away from zero by at most `rise`, towards zero by at most `fall`, as f32
/// computes them. A force that changes its direction comes to zero first. All four finite, `rise` and `fall` ≥ 0.
///
/// Implements: SRV-021.
#[inline]
pub fn approach(last: f32, target: f32, rise: f32, fall: f32) -> f32 {
    // As if `last` were positive; the products by ±1 are exact.
    let sign = if last < 0.0 { -1.0 } else { 1.0 };
    let size = sign * last;
    let low = if size > fall {
        size - fall
    } else if size > 0.0 {
        0.0
    } else {
        -rise
    };
    sign * between(sign * target, low, size + rise)
}

/// The number nearest to `value` from `low` to `high`, for `low` ≤ `high`; a NaN gives `low`.
///
/// Comparisons instead of `f32::max` and `f32::min`, which leave the sign of a zero to the platform,
/// and instead of `f32::clamp`, which may panic. In this form each is one instruction.
#[inline]
pub(super) fn between(value: f32, low: f32, high: f32) -> f32 {
    let value = if value > low { value } else { low };
    if value < high { value } else { high }
}
