//! `palpate simulate`: records of a path over a gel (`spec/simulation.md`).

use std::fs;
use std::path::{Path as FilePath, PathBuf};

use clap::Args;

use super::CliError;
use super::detect::arguments::NoiseSd;
use super::error::refuse;
use super::numbers::{at_least_0, length_or_zero, newtons_or_zero, several, share_below_1};
use super::output::{make_folder, print, write_new};
use super::path::PathArguments;
use super::solve::{phantom, tell_large_strain_to};
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate::simulation::{Hand, Motion, Path, Sensor, Simulation, Tremor};

/// The distance of the rows and columns of a phantom's map, and how much further than the path it reaches, m.
const STEP: f64 = 0.5e-3;
const MARGIN: f64 = 1e-3;
/// Positions are the same within this part of [`STEP`].
const SAME_STEP: f64 = 3e-6;

/// Arguments of `palpate simulate`.
#[derive(Debug, Args)]
pub struct SimulateArguments {
    /// Force map of the gel, which must have lateral forces and begin at depth 0
    #[arg(long, value_name = "MAP", required_unless_present = "phantom")]
    map: Option<PathBuf>,
    /// The gel, in place of its map: a built-in phantom or a phantom file
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "map")]
    phantom: Option<String>,
    #[command(flatten)]
    path: PathArguments,
    #[command(flatten)]
    motion: MotionArguments,
    #[command(flatten)]
    sensor: SensorArguments,
    /// Seed of all random numbers
    #[arg(long, value_name = "SEED", default_value_t = 1999)]
    seed: u64,
    /// Number of records, each with its own random numbers
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    records: u32,
    /// New folder for the records, record-0001.csv and so on [default: a single record is printed]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What leads the probe, and what the gel does beside its elastic force.
#[derive(Debug, Args)]
struct MotionArguments {
    /// A hand with a mass in kg, a damping in N·s/m and a stiffness in N/m tracks the path [default: a stage follows it]
    #[arg(long, value_name = "M,B,K", value_parser = several::<3>, allow_hyphen_values = true)]
    hand: Option<[f64; 3]>,
    /// Root mean square of the tremor along x and along the depth, in mm
    #[arg(long = "tremor-mm", value_name = "A", value_parser = length_or_zero, allow_hyphen_values = true, default_value = "0")]
    tremor: f64,
    /// Frequency of the tremor
    #[arg(long, value_name = "HZ", value_parser = at_least_0, allow_hyphen_values = true, default_value = "10", requires = "tremor")]
    tremor_hz: f64,
    /// Share of the force that relaxes, and its time constant in s
    #[arg(long, value_name = "G,S", value_parser = several::<2>, allow_hyphen_values = true)]
    relaxation: Option<[f64; 2]>,
    /// Coefficient of friction between probe and gel
    #[arg(long, value_name = "MU", value_parser = at_least_0, allow_hyphen_values = true, default_value = "0")]
    friction: f64,
}

/// The sensor.
#[derive(Debug, Args)]
struct SensorArguments {
    #[command(flatten)]
    noise_sd: NoiseSd,
    /// Correlation of the noise of neighbouring samples
    #[arg(long, value_name = "R", value_parser = share_below_1, allow_hyphen_values = true, default_value = "0", requires = "NoiseSd")]
    correlation: f64,
    /// Standard deviation of the offset of each force from record to record, in N
    #[arg(long, value_name = "S", value_parser = newtons_or_zero, allow_hyphen_values = true, default_value = "0")]
    offset_sd_n: f64,
    /// Standard deviation of the drift of each force over a record, in N
    #[arg(long, value_name = "S", value_parser = newtons_or_zero, allow_hyphen_values = true, default_value = "0")]
    drift_sd_n: f64,
    /// Resolution of the sensor in N: each force is rounded to a multiple of it
    #[arg(long, value_name = "Q", value_parser = newtons_or_zero, allow_hyphen_values = true, default_value = "0")]
    resolution_n: f64,
    /// Standard deviation of the error of each measured depth, in mm
    #[arg(long = "depth-noise-mm", value_name = "S", value_parser = length_or_zero, allow_hyphen_values = true, default_value = "0",
          conflicts_with = "no_depths")]
    depth_noise: f64,
    /// Writes no column depth_mm; give 'palpate detect' the depth with --depth-mm
    #[arg(long)]
    no_depths: bool,
}

/// Runs the command.
///
/// Implements: CLI-230, CLI-231, CLI-232, CLI-015.
pub fn simulate(arguments: &SimulateArguments) -> Result<(), CliError> {
    if arguments.records > 1 && arguments.out.is_none() {
        refuse!("several records need --out DIR");
    }
    if let Some(folder) = arguments.out.as_ref().filter(|folder| folder.exists()) {
        refuse!("{} already exists; choose another --out", folder.display());
    }
    let Some(path) = arguments.path.path()? else {
        refuse!("give --depths-mm or --path");
    };
    let map = match (&arguments.map, &arguments.phantom) {
        (Some(file), _) => {
            let map = ForceMap::read(file)?;
            map.phantom().map_or(Ok(()), check_elastic)?;
            map
        }
        (None, name) => map(name.as_deref().unwrap_or_default(), &path)?,
    };
    let (motion, sensor) = (&arguments.motion, &arguments.sensor);
    let simulation = Simulation {
        gel: map.table(),
        path: &path,
        motion: motion.motion(),
        relaxation: motion.relaxation()?,
        friction: motion.friction,
        sensor: sensor.sensor(),
        seed: arguments.seed,
    };
    let record = |number: u32| -> Result<String, CliError> {
        let record = simulation.record(number.into())?;
        Ok(record.to_csv(!sensor.no_depths))
    };
    match &arguments.out {
        None => print(&record(1)?)?,
        Some(folder) => write_all(folder, arguments.records, record)?,
    }
    if arguments.map.is_some() {
        return Ok(());
    }
    let ((_, deepest), name) = (path.extent(), map.phantom().map_or("", Phantom::name));
    tell_large_strain_to(deepest, &map, name)
}

/// Writes the records into a new folder, or leaves none where one is refused.
///
/// Implements: CLI-230, CLI-232.
fn write_all(
    folder: &FilePath,
    records: u32,
    record: impl Fn(u32) -> Result<String, CliError>,
) -> Result<(), CliError> {
    let file = |number| folder.join(format!("record-{number:04}.csv"));
    make_folder(folder)?;
    for number in 1..=records {
        let written = record(number).and_then(|text| write_new(&file(number), &text));
        if written.is_err() {
            // What is left would block another try; a folder with files of others stays.
            (1..number).for_each(|number| drop(fs::remove_file(file(number))));
            let _ = fs::remove_dir(folder);
        }
        written?;
    }
    Ok(())
}

/// The forces of a phantom along a path and a little beyond.
///
/// Implements: CLI-231, CLI-232.
fn map(name: &str, path: &Path) -> Result<ForceMap, CliError> {
    let phantom = phantom(name)?;
    check_elastic(&phantom)?;
    let ([low, high], depth) = path.extent();
    // Before the poses are laid out: a place far away has billions of them on the way.
    for lateral in [low, high] {
        let pose = phantom.check_pose(depth, lateral);
        pose.map_err(CliError::refused(format!("phantom {}", phantom.name())))?;
    }
    let [left, right, deepest] = with_margin(&phantom, [-low, high, depth]);
    let (depths, laterals) = (axis(0.0, deepest), axis(-left, right));
    let model = Model::new(&phantom, MESH_SIZE, Contact::default());
    let map = model.and_then(|model| model.map(&depths, &laterals, &|_| true));
    map.map_err(CliError::fem(phantom.name()))
}

/// Refuses a gel whose forces are those of a probe that slides to the right.
///
/// Implements: CLI-232.
fn check_elastic(phantom: &Phantom) -> Result<(), CliError> {
    if phantom.probe().friction != 0.0 {
        refuse!(
            "phantom {}: its forces have the friction of a sweep to the right; give a gel without probe.friction, and --friction",
            phantom.name()
        );
    }
    Ok(())
}

/// How far a map reaches to the left, to the right and down, m: from the ends of a path to the next multiples of [`STEP`], up to the
/// first that is `MARGIN` beyond, as long as the probe may stand there.
///
/// Implements: CLI-231.
fn with_margin(phantom: &Phantom, path: [f64; 3]) -> [f64; 3] {
    let may_stand = |[left, right, depth]: [f64; 3]| {
        let stands = |lateral| phantom.check_pose(depth, lateral).is_ok();
        stands(-left) && stands(right)
    };
    let mut reached = path;
    // In turn, so that no way takes the room of the others.
    for _ in 0..=(MARGIN / STEP) as u32 {
        for way in 0..3 {
            let mut farther = reached;
            farther[way] = STEP * ((reached[way] / STEP + SAME_STEP).floor() + 1.0);
            let is_margin = reached[way] < path[way] + MARGIN - STEP * SAME_STEP;
            if is_margin && may_stand(farther) {
                reached = farther;
            }
        }
    }
    reached
}

/// Two positions and the multiples of [`STEP`] between them, m.
fn axis(first: f64, last: f64) -> Vec<f64> {
    let between = (first / STEP + SAME_STEP).floor() as i32 + 1;
    let between = between..(last / STEP - SAME_STEP).ceil() as i32;
    let between = between.map(|k| STEP * f64::from(k));
    let mut axis: Vec<f64> = [first].into_iter().chain(between).chain([last]).collect();
    axis.dedup();
    axis
}

impl MotionArguments {
    fn motion(&self) -> Motion {
        let hand = self.hand.map(|[mass, damping, stiffness]| Hand {
            mass,
            damping,
            stiffness,
        });
        let tremor = Tremor {
            rms: self.tremor,
            frequency: self.tremor_hz,
        };
        Motion {
            hand,
            tremor: (self.tremor > 0.0).then_some(tremor),
        }
    }

    fn relaxation(&self) -> Result<Option<[f64; 2]>, CliError> {
        match self.relaxation {
            None => Ok(None),
            Some([share, time]) if share < 1.0 && time > 0.0 => Ok(Some([share, time])),
            Some(_) => refuse!("--relaxation needs a share below 1 and a time above 0"),
        }
    }
}

impl SensorArguments {
    fn sensor(&self) -> Sensor {
        Sensor {
            noise_sd: self.noise_sd.get().unwrap_or_default(),
            correlation: self.correlation,
            offset_sd: self.offset_sd_n,
            drift_sd: self.drift_sd_n,
            resolution: self.resolution_n,
            depth_sd: self.depth_noise,
        }
    }
}
