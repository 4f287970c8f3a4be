//! Where the hand wants to be.

use std::time::Duration;

/// A place and time on the way of the hand.
///
/// ```
/// use palpate::hid::simulated::{Trajectory, Waypoint};
/// use std::time::Duration;
///
/// let above = Waypoint { at: Duration::ZERO, lateral: 0.0, depth: -1e-3, held: false };
/// let below = Waypoint { at: Duration::from_secs(1), depth: 3e-3, held: true, ..above };
/// let way = Trajectory::new(vec![above, below]);
/// // Half-way, and along the normal: positive is out of the gel.
/// assert!((way.at(Duration::from_millis(500))[1] + 1e-3).abs() < 1e-12);
/// assert!(!way.held(Duration::from_millis(500)) && way.held(Duration::from_secs(1)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// When.
    pub at: Duration,
    /// Lateral position, m.
    pub lateral: f64,
    /// Depth, m; negative above the surface.
    pub depth: f64,
    /// The deadman is held from here on.
    pub held: bool,
}

/// A way through waypoints, from each to the next with the least jerk, and at rest in each.
///
/// ```
/// use palpate::hid::simulated::Trajectory;
/// use std::time::Duration;
///
/// let way = Trajectory::probing(4e-3, 10e-3, Duration::from_secs(1));
/// assert_eq!(way.duration(), Duration::from_secs(3));
/// assert_eq!(way.at(Duration::from_millis(1500)), [10e-3, -4e-3]);
/// assert!(!way.held(Duration::ZERO) && way.held(Duration::from_secs(1)));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    waypoints: Vec<Waypoint>,
}

impl Trajectory {
    /// The way through `waypoints`, put in the order of their times.
    ///
    /// ```
    /// use palpate::hid::simulated::{Trajectory, Waypoint};
    /// use std::time::Duration;
    ///
    /// let point = |milliseconds, depth| Waypoint {
    ///     at: Duration::from_millis(milliseconds), lateral: 0.0, depth, held: true,
    /// };
    /// let way = Trajectory::new(vec![point(200, 4e-3), point(100, 1e-3)]);
    /// assert_eq!(way.at(Duration::ZERO), [0.0, -1e-3]); // at the first, until it begins
    /// assert_eq!(way.duration(), Duration::from_millis(200));
    /// ```
    pub fn new(mut waypoints: Vec<Waypoint>) -> Trajectory {
        waypoints.sort_by_key(|waypoint| waypoint.at);
        Trajectory { waypoints }
    }

    /// A probing of the gel: rest above the surface, press to `depth` (m) at −`reach` (m), sweep to
    /// +`reach` and back, leave. The deadman is held from 0.1 s on; `sweep` is the time of one sweep.
    ///
    /// ```
    /// use palpate::hid::simulated::Trajectory;
    /// use std::time::Duration;
    ///
    /// let way = Trajectory::probing(4e-3, 10e-3, Duration::from_secs(1));
    /// assert_eq!(way.at(Duration::ZERO), [-10e-3, 1e-3]);
    /// assert_eq!(way.at(Duration::from_millis(500)), [-10e-3, -4e-3]);
    /// ```
    pub fn probing(depth: f64, reach: f64, sweep: Duration) -> Trajectory {
        let rest = -1e-3;
        let mut at = Duration::ZERO;
        let mut waypoints = Vec::new();
        let mut go = |time: Duration, lateral, depth, held| {
            at += time;
            waypoints.push(Waypoint {
                at,
                lateral,
                depth,
                held,
            });
        };
        let short = Duration::from_millis(100);
        go(Duration::ZERO, -reach, rest, false);
        go(short, -reach, rest, true);
        go(short * 4, -reach, depth, true);
        go(sweep, reach, depth, true);
        go(sweep, -reach, depth, true);
        go(short * 4, -reach, rest, true);
        go(short, -reach, rest, false);
        Trajectory::new(waypoints)
    }

    /// This way again and again, until it lasts `duration`.
    ///
    /// ```
    /// use palpate::hid::simulated::Trajectory;
    /// use std::time::Duration;
    ///
    /// let once = Trajectory::probing(4e-3, 10e-3, Duration::from_secs(1));
    /// let way = once.repeated(Duration::from_secs(5));
    /// assert_eq!(way.duration(), Duration::from_secs(6));
    /// let second = Duration::from_millis(500);
    /// assert_eq!(way.at(once.duration() + second), once.at(second));
    /// ```
    pub fn repeated(&self, duration: Duration) -> Trajectory {
        let mut waypoints = self.waypoints.clone();
        let once = self.duration();
        let mut begun = once;
        while begun < duration && !once.is_zero() {
            let again = self.waypoints.iter().map(|waypoint| Waypoint {
                at: waypoint.at + begun,
                ..*waypoint
            });
            waypoints.extend(again);
            begun += once;
        }
        Trajectory { waypoints }
    }

    /// When it ends.
    pub fn duration(&self) -> Duration {
        self.waypoints.last().map_or(Duration::ZERO, |last| last.at)
    }

    /// Where it is at a time, m: lateral, and along the normal, positive out of the gel.
    pub fn at(&self, time: Duration) -> [f64; 2] {
        let next = self.waypoints.partition_point(|point| point.at <= time);
        let place = |point: &Waypoint| [point.lateral, -point.depth];
        match (
            next.checked_sub(1).map(|at| &self.waypoints[at]),
            self.waypoints.get(next),
        ) {
            (Some(from), Some(to)) => {
                let whole = (to.at - from.at).as_secs_f64();
                let share = smooth((time - from.at).as_secs_f64() / whole);
                let (from, to) = (place(from), place(to));
                [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
            }
            (Some(only), None) | (None, Some(only)) => place(only),
            (None, None) => [0.0, 0.0],
        }
    }

    /// Whether the deadman is held at a time.
    pub fn held(&self, time: Duration) -> bool {
        let next = self.waypoints.partition_point(|point| point.at <= time);
        next > 0 && self.waypoints[next - 1].held
    }
}

/// From 0 to 1 with the least jerk: 10 t³ − 15 t⁴ + 6 t⁵.
fn smooth(t: f64) -> f64 {
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}
