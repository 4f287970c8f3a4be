//! Generators of valid values. Validity is by construction, never by rejection, so that each case
//! counts; under Kani a generator makes every value that its docstring promises. None loops but over
//! arrays of fixed size, and none computes in floating point where a choice does.

use core::ops::Bound::Included;

use bolero::{Driver, TypeGenerator};
use palpate_core::force::Force;
use palpate_core::servo::{
    Axis, FORCE_CEILING, Fault, Input, Limits, MIN_SLEW, Mode, Request, Sample, State,
    TABLE_FORCE_LIMIT, Table,
};

/// What is valid by construction; otherwise a panic that formats nothing, which a solver would have to follow.
fn valid<T, E>(made: Result<T, E>) -> T {
    match made {
        Ok(made) => made,
        Err(_) => panic!("it is valid by construction"),
    }
}

/// Any f32, one of the given size more often than its bits alone would make it.
fn number<D: Driver>(driver: &mut D, low: f32, high: f32) -> Option<f32> {
    const ODD: [f32; 8] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        0.0,
        -0.0,
    ];
    match driver.gen_variant(4, 0)? {
        0 => driver.produce(),
        1 => Some(ODD[driver.gen_variant(ODD.len(), 0)?]),
        _ => signed(driver, low, high),
    }
}

/// A number with a magnitude from `low` to `high`, 0 ≤ `low` ≤ `high`.
fn signed<D: Driver>(driver: &mut D, low: f32, high: f32) -> Option<f32> {
    let magnitude = driver.gen_f32(Included(&low), Included(&high))?;
    let negative = driver.produce()?;
    Some(if negative { -magnitude } else { magnitude })
}

/// `value` if its magnitude is at most `most`, else ±`most`: all of [−most, most], each from itself.
pub fn folded(value: f32, most: f32) -> f32 {
    if value.abs() <= most {
        value
    } else {
        most.copysign(value)
    }
}

/// Types of one value each, made by `|driver| …`.
macro_rules! generated {
    ($($(#[$doc:meta])+ $name:ident($of:ty): |$driver:ident| $value:expr;)+) => {$(
        $(#[$doc])+
        #[derive(Debug, Clone, Copy)]
        pub struct $name(pub $of);

        impl TypeGenerator for $name {
            fn generate<D: Driver>($driver: &mut D) -> Option<Self> {
                Some($name($value))
            }
        }
    )+};
}

generated! {
    /// Any f32; half of them near the positions of the axes below.
    Position(f32): |driver| number(driver, 0.0002, 0.5)?;
    /// Any f32; half of them moderate forces.
    Newtons(f32): |driver| number(driver, 0.01, 40.0)?;
    /// A force that a table may hold, N.
    Entry(f32): |driver| {
        let low = [0.0, 0.0625][driver.gen_variant(2, 0)?];
        signed(driver, low, TABLE_FORCE_LIMIT)?
    };
    /// A fraction that `locate` may give: all of [−1, 2].
    Fraction(f32): |driver| {
        let low = [0.0, 0.0625][driver.gen_variant(2, 0)?];
        let fraction = signed(driver, low, 2.0)?;
        if fraction < -1.0 { -1.0 } else { fraction }
    };
    /// Any mode.
    AnyMode(Mode): |driver| {
        const MODES: [Mode; 7] = [
            Mode::Armed,
            Mode::Armed, // twice: the one that plays
            Mode::Disarmed,
            Mode::Faulted(Fault::NotFinite),
            Mode::Faulted(Fault::Device),
            Mode::Faulted(Fault::Watchdog),
            Mode::Faulted(Fault::State),
        ];
        MODES[driver.gen_variant(MODES.len(), 0)?]
    };
    /// Any request.
    AnyRequest(Request): |driver| {
        const REQUESTS: [Request; 3] = [Request::None, Request::Arm, Request::Disarm];
        REQUESTS[driver.gen_variant(3, 0)?]
    };
    /// Any limits that are allowed, the release up to 10³⁰ N: what is larger still only tests the arithmetic of `Limits::new`.
    ValidLimits(Limits): |driver| {
        let watchdog = match driver.gen_variant(2, 0)? {
            0 => driver.gen_u16(Included(&1), Included(&100))?,
            _ => driver.gen_u16(Included(&1), Included(&3))?,
        };
        let release = driver.gen_f32(Included(&MIN_SLEW), Included(&1e30))?;
        limits(driver, 0.0625, release, watchdog)?
    };
    /// Limits with a watchdog of 1 or 2 cycles and a release of at least half the force, so that few cycles bring it to zero.
    QuickLimits(Limits): |driver| {
        let watchdog = driver.gen_u16(Included(&1), Included(&2))?;
        let release = driver.gen_f32(Included(&MIN_SLEW), Included(&FORCE_CEILING))?;
        limits(driver, 0.5, release, watchdog)?
    };
}

/// Any f32; half of them within the counts of a report, or just beyond.
#[derive(Debug, Clone, Copy)]
pub struct Count(pub f32);

impl TypeGenerator for Count {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let whole = match driver.gen_variant(2, 0)? {
            0 => return number(driver, 0.25, 40_000.0).map(Count),
            _ => driver.gen_u16(Included(&0), Included(&33_000))?,
        };
        // Halves, where the rule of the even one decides.
        let half = f32::from(whole) + 0.5;
        Some(Count(if driver.produce()? { -half } else { half }))
    }
}

/// An axis of N knots with a first knot of magnitude ≤ 1/4 m and widths from 2⁻¹⁹ to 1/4 m: valid for
/// N ≤ 4, since the sum stays within 1 m, and rounding it takes 2⁻²⁵ m at most off a width.
#[derive(Debug, Clone, Copy)]
pub struct AnyAxis<const N: usize, const CELLS: usize> {
    pub knots: [f32; N],
    pub reciprocals: [f32; CELLS],
}

impl<const N: usize, const CELLS: usize> TypeGenerator for AnyAxis<N, CELLS> {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let low = [0.0, 0.001][driver.gen_variant(2, 0)?];
        let mut knots = [signed(driver, low, 0.25)?; N];
        let mut reciprocals = [0.0; CELLS];
        for cell in 0..CELLS {
            let narrowest = [1.907_348_6e-6, 0.01][driver.gen_variant(2, 0)?]; // 2⁻¹⁹
            let width = driver.gen_f32(Included(&narrowest), Included(&0.25))?;
            knots[cell + 1] = knots[cell] + width;
            reciprocals[cell] = Axis::reciprocal_width(knots[cell], knots[cell + 1]);
        }
        Some(AnyAxis { knots, reciprocals })
    }
}

impl<const N: usize, const CELLS: usize> AnyAxis<N, CELLS> {
    pub fn axis(&self) -> Axis<'_> {
        valid(Axis::new(&self.knots, &self.reciprocals))
    }
}

/// Depths: of a force map (m), of unlike widths, and such as f32 holds exactly.
const DEPTHS: [[f32; 3]; 3] = [[0.0, 0.001, 0.004], [0.0, 0.3, 0.300_002], [0.0, 0.25, 1.0]];

/// Lateral positions, likewise.
const LATERALS: [[f32; 4]; 3] = [
    [-0.01, -0.005, 0.0, 0.01],
    [-1.0, -0.999_99, 0.7, 1.0],
    [-0.5, 0.0, 0.125, 0.25],
];

const fn reciprocals<const N: usize, const CELLS: usize>(knots: [f32; N]) -> [f32; CELLS] {
    let mut reciprocals = [0.0; CELLS];
    let mut cell = 0;
    while cell < CELLS {
        reciprocals[cell] = 1.0 / (knots[cell + 1] - knots[cell]);
        cell += 1;
    }
    reciprocals
}

const DEPTH_RECIPROCALS: [[f32; 2]; 3] = [
    reciprocals(DEPTHS[0]),
    reciprocals(DEPTHS[1]),
    reciprocals(DEPTHS[2]),
];
const LATERAL_RECIPROCALS: [[f32; 3]; 3] = [
    reciprocals(LATERALS[0]),
    reciprocals(LATERALS[1]),
    reciprocals(LATERALS[2]),
];

/// A table of 3 depths and 4 lateral positions, the axes of number AXES, with any forces in one component and none in the
/// other: a solver does not get through a choice among axes, nor through both components at once.
#[derive(Debug, Clone)]
pub struct Grid<const AXES: usize, const NORMAL: bool> {
    pub values: [f32; 12],
    forces: [Force<f32>; 12],
}

impl<const AXES: usize, const NORMAL: bool> TypeGenerator for Grid<AXES, NORMAL> {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let mut grid = Grid {
            values: [0.0; 12],
            forces: [Force::ZERO; 12],
        };
        for (value, force) in grid.values.iter_mut().zip(&mut grid.forces) {
            Entry(*value) = driver.produce()?;
            *force = match NORMAL {
                true => Force::new(0.0, *value),
                false => Force::new(*value, 0.0),
            };
        }
        Some(grid)
    }
}

impl<const AXES: usize, const NORMAL: bool> Grid<AXES, NORMAL> {
    pub const DEPTHS: [f32; 3] = DEPTHS[AXES];
    pub const LATERALS: [f32; 4] = LATERALS[AXES];

    /// The axis of depths and that of lateral positions.
    pub fn axes() -> (Axis<'static>, Axis<'static>) {
        let depths = Axis::new(&DEPTHS[AXES], &DEPTH_RECIPROCALS[AXES]);
        let laterals = Axis::new(&LATERALS[AXES], &LATERAL_RECIPROCALS[AXES]);
        (valid(depths), valid(laterals))
    }

    pub fn table(&self) -> Table<'_> {
        let (depths, laterals) = Self::axes();
        valid(Table::new(depths, laterals, &self.forces))
    }

    /// The component that the table has, and the other one, which is 0.
    pub fn component(force: Force<f32>) -> f32 {
        let [value, other] = if NORMAL {
            [force.normal, force.lateral]
        } else {
            [force.lateral, force.normal]
        };
        assert!(other == 0.0);
        value
    }
}

/// Any position; two in three a knot, the middle of a cell, half a cell beyond the axis, or far from it.
pub fn near<D: Driver, const N: usize>(driver: &mut D, knots: [f32; N]) -> Option<f32> {
    let last = N - 1;
    let middles: [f32; N] = core::array::from_fn(|k| match k {
        0 => 1.5 * knots[0] - 0.5 * knots[1],
        k => 0.5 * (knots[k - 1] + knots[k]),
    });
    match driver.gen_variant(6, 0)? {
        0 => Some(knots[driver.gen_variant(N, 0)?]),
        1 => Some(middles[driver.gen_variant(N, 0)?]),
        2 => Some(1.5 * knots[last] - 0.5 * knots[last - 1]),
        3 => Some([4.0, -4.0][driver.gen_variant(2, 0)?]),
        _ => driver.produce::<Position>().map(|any| any.0),
    }
}

/// A table of one cell with fixed forces, for what does not depend on them.
pub fn plain_table() -> Table<'static> {
    const KNOTS: [f32; 2] = [0.0, 0.5];
    const RECIPROCAL: [f32; 1] = [2.0];
    const FORCES: [Force<f32>; 4] = [
        Force::ZERO,
        Force::ZERO,
        Force::new(-4.0, 32.0),
        Force::new(8.0, 16.0),
    ];
    let axis = valid(Axis::new(&KNOTS, &RECIPROCAL));
    valid(Table::new(axis, axis, &FORCES))
}

/// Limits with a release of at least `least_release` and `share` of the force, a power of 2.
fn limits<D: Driver>(
    driver: &mut D,
    share: f32,
    least_release: f32,
    watchdog: u16,
) -> Option<Limits> {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let low = [MIN_SLEW, 0.5][driver.gen_variant(2, 0)?];
    let force = driver.gen_f32(Included(&low), Included(&FORCE_CEILING))?;
    let slew = driver.gen_f32(Included(&MIN_SLEW), Included(&FORCE_CEILING))?;
    let slew = if slew > force { force } else { slew };
    let least = larger(slew, share * force);
    // As small as it may be, or anything above.
    let above: bool = driver.produce()?;
    let release = larger(least, if above { least_release } else { least });
    Some(valid(Limits::new(force, slew, release, watchdog)))
}

/// What one cycle is called with: any bits in state and input, valid limits.
#[derive(Debug, Clone)]
pub struct Cycle {
    pub limits: Limits,
    pub state: State,
    pub input: Input,
}

impl Cycle {
    pub fn parts(&self) -> (Limits, State, Input) {
        (self.limits, self.state, self.input)
    }
}

impl TypeGenerator for Cycle {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let ValidLimits(limits) = driver.produce()?;
        let any = any_force(driver)?;
        let sound = sound_force(driver, &limits)?;
        let force = if driver.produce()? { any } else { sound };
        cycle(driver, limits, force)
    }
}

/// The same with a state that a step may have left: its force is within the limits.
#[derive(Debug, Clone)]
pub struct SoundCycle(pub Cycle);

impl TypeGenerator for SoundCycle {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let ValidLimits(limits) = driver.produce()?;
        let force = sound_force(driver, &limits)?;
        cycle(driver, limits, force).map(SoundCycle)
    }
}

/// Any force.
pub fn any_force<D: Driver>(driver: &mut D) -> Option<Force<f32>> {
    let (Newtons(lateral), Newtons(normal)) = driver.produce()?;
    Some(Force { lateral, normal })
}

/// A force within the limits, one time in two zero.
pub fn sound_force<D: Driver>(driver: &mut D, limits: &Limits) -> Option<Force<f32>> {
    let force = any_force(driver)?.map(|value| folded(value, limits.force()));
    let zero: bool = driver.produce()?;
    Some(if zero { Force::ZERO } else { force })
}

fn cycle<D: Driver>(driver: &mut D, limits: Limits, force: Force<f32>) -> Option<Cycle> {
    let last: u16 = driver.produce()?;
    let missed = match driver.gen_variant(6, 0)? {
        0 => driver.produce()?,
        1 => u16::MAX,
        _ => driver.gen_u16(Included(&0), Included(&3))?,
    };
    let state = State {
        mode: driver.produce::<AnyMode>()?.0,
        force,
        sequence: usually(driver, last)?,
        missed,
        arming: driver.gen_variant(3, 0)? == 1,
    };
    let sample = sample(driver, last)?;
    let input = Input {
        sample: usually(driver, sample)?,
        request: driver.produce::<AnyRequest>()?.0,
    };
    let any = Cycle {
        limits,
        state,
        input,
    };
    let playing = playing(driver, any.clone(), last)?;
    let plays = driver.gen_variant(3, 0)? == 1;
    Some(if plays { playing } else { any })
}

/// The same cycle with everything there that playing needs, one time in four above the surface.
fn playing<D: Driver>(driver: &mut D, mut cycle: Cycle, last: u16) -> Option<Cycle> {
    cycle.state.mode = Mode::Armed;
    cycle.state.sequence = Some(last);
    cycle.input.request = Request::None;
    let depth = driver.gen_f32(Included(&0.0002), Included(&0.5))?;
    let above = driver.gen_variant(4, 0)? == 1;
    cycle.input.sample = Some(Sample {
        sequence: last.wrapping_add(1),
        deadman: true,
        device_fault: false,
        depth: if above { -depth } else { depth },
        lateral: signed(driver, 0.001, 0.5)?,
    });
    Some(cycle)
}

/// `Some` three times in four.
fn usually<D: Driver, T>(driver: &mut D, value: T) -> Option<Option<T>> {
    let there = driver.gen_variant(4, 0)? != 1;
    Some(if there { Some(value) } else { None })
}

/// Any sample, its number often near the border between fresh and stale as seen from `last`.
fn sample<D: Driver>(driver: &mut D, last: u16) -> Option<Sample> {
    let ahead: u16 = match driver.gen_variant(6, 0)? {
        0 => driver.produce()?,
        1 => driver.gen_u16(Included(&32_766), Included(&32_769))?,
        2 => driver.gen_u16(Included(&65_534), Included(&65_535))?,
        _ => driver.gen_u16(Included(&0), Included(&3))?,
    };
    Some(Sample {
        sequence: last.wrapping_add(ahead),
        deadman: driver.produce()?,
        device_fault: driver.gen_variant(5, 0)? == 1,
        depth: driver.produce::<Position>()?.0,
        lateral: driver.produce::<Position>()?.0,
    })
}

/// A sample that is not fresh as seen from `last`: 0 to 32768 behind; or none.
pub fn stale<D: Driver>(driver: &mut D, last: u16) -> Option<Option<Sample>> {
    let behind = driver.gen_u16(Included(&0), Included(&32_768))?;
    let sample = Sample {
        sequence: last.wrapping_sub(behind),
        ..sample(driver, last)?
    };
    usually(driver, sample)
}
