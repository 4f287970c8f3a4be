//! Where the hand wants to be.

use std::time::Duration;

/// A place and time on the way of the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Waypoint {
    at: Duration,
    /// Lateral, and along the normal, positive out of the gel, m.
    place: [f64; 2],
    /// The deadman is held from here on.
    held: bool,
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
/// // Half-way of a sweep.
/// assert!(way.at(Duration::from_millis(1000))[0].abs() < 1e-15);
/// assert!(!way.held(Duration::ZERO) && way.held(Duration::from_secs(1)));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Of one probing, which ends where it began.
    waypoints: [Waypoint; 7],
    once: Duration,
    duration: Duration,
}

impl Trajectory {
    /// A probing of the gel: rest above the surface, press to `depth` (m) at −`reach` (m), sweep to
    /// +`reach` and back, leave. The deadman is held from 0.1 s on; `sweep` is the time of one sweep.
    pub fn probing(depth: f64, reach: f64, sweep: Duration) -> Trajectory {
        let (rest, short) = (1e-3, Duration::from_millis(100));
        let mut at = Duration::ZERO;
        let mut go = |time, lateral, normal, held| {
            at += time;
            let place = [lateral, normal];
            Waypoint { at, place, held }
        };
        Trajectory {
            waypoints: [
                go(Duration::ZERO, -reach, rest, false),
                go(short, -reach, rest, true),
                go(short * 4, -reach, -depth, true),
                go(sweep, reach, -depth, true),
                go(sweep, -reach, -depth, true),
                go(short * 4, -reach, rest, true),
                go(short, -reach, rest, false),
            ],
            once: at,
            duration: at,
        }
    }

    /// This way again and again, until it lasts `duration`.
    pub fn repeated(mut self, duration: Duration) -> Trajectory {
        while self.duration < duration {
            self.duration += self.once;
        }
        self
    }

    /// When it ends.
    pub fn duration(&self) -> Duration {
        self.duration
    }

    /// Where it is at a time, m: lateral, and along the normal, positive out of the gel.
    pub fn at(&self, time: Duration) -> [f64; 2] {
        let (time, [from, to]) = self.leg(time);
        let whole = (to.at - from.at).as_secs_f64();
        let share = smooth((time - from.at).as_secs_f64() / whole);
        [0, 1].map(|axis| from.place[axis] + share * (to.place[axis] - from.place[axis]))
    }

    /// Whether the deadman is held at a time.
    pub fn held(&self, time: Duration) -> bool {
        self.leg(time).1[0].held
    }

    /// The time in its probing, and the waypoints before and after it. The end is like the beginning.
    fn leg(&self, time: Duration) -> (Duration, [Waypoint; 2]) {
        let time = if time < self.duration {
            time
        } else {
            Duration::ZERO
        };
        let time = Duration::from_nanos((time.as_nanos() % self.once.as_nanos()) as u64);
        let next = self.waypoints.partition_point(|point| point.at <= time);
        (time, [self.waypoints[next - 1], self.waypoints[next]])
    }
}

/// From 0 to 1 with the least jerk: 10 t³ − 15 t⁴ + 6 t⁵.
fn smooth(t: f64) -> f64 {
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}
