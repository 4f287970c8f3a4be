//! `palpate solve`: the forces over depths and lateral positions of one phantom.

use std::path::{Path, PathBuf};

use askama::Template;
use clap::{Args, ValueEnum};

use super::error::refuse;
use super::numbers::{List, contact, depths, friction, length, positions};
use super::output::{file_of, print, warn, write};
use super::progress::{bar, tell_large_mesh};
use super::{CliError, Format};
use palpate::decimal::{format_scaled, mm};
use palpate::fem::certify::certified_map;
use palpate::fem::{Contact, MESH_SIZE, Model, Pose, PoseSolution, SMALL_STRAIN_LIMIT};
use palpate::force_map::{ForceMap, Matrix, SAME_POSITION, SmallestDet};
use palpate::phantom::{BUILTIN_NAMES, Phantom, Strain};

/// Arguments of `palpate solve`.
#[derive(Debug, Args)]
pub struct SolveArguments {
    /// Built-in phantom (none, 2.6, 4.6, 6.6, 8.6: the inclusion's depth in mm) or phantom file
    #[arg(long, value_name = "NAME|FILE")]
    phantom: String,
    #[command(flatten)]
    theory: TheoryArguments,
    /// Depths of the probe in mm: a,b,c or from:to:step
    #[arg(long = "depths-mm", value_parser = depths, allow_hyphen_values = true, value_name = "LIST")]
    depths: List,
    /// Lateral positions of the probe in mm: a,b,c or from:to:step
    #[arg(long = "laterals-mm", value_parser = positions, allow_hyphen_values = true, value_name = "LIST")]
    laterals: List,
    /// Contact law
    #[arg(long, value_parser = contact(), default_value = Contact::default().name())]
    contact: Contact,
    /// Mesh size in mm; up to 0.5 all element sizes scale with it, above not all [default: 0.5]
    #[arg(long = "mesh-mm", value_parser = length, value_name = "H")]
    mesh_size: Option<f64>,
    /// Also solves on two coarser meshes and states a discretisation error band for each force
    #[arg(long)]
    certify: bool,
    /// Writes the deformed mesh with stresses for ParaView; single pose only
    #[arg(long, value_name = "FILE")]
    vtu: Option<PathBuf>,
    /// Moves the probe down at the first lateral position, then to the right at the last depth; the surface sticks to the probe or slips
    #[arg(long, conflicts_with_all = ["certify", "vtu"])]
    path: bool,
    /// Writes the deformed mesh of each pose of the path for ParaView
    #[arg(long, value_name = "FILE.pvd", requires = "path", value_parser = file_of("pvd", "the list of the poses is PVD"))]
    pvd: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// The theory of a phantom, where it is not that of its file.
#[derive(Debug, Args)]
pub struct TheoryArguments {
    /// Theory of the gel [default: that of the phantom, small unless its file says finite]
    #[arg(long, value_enum, value_name = "THEORY")]
    strain: Option<Theory>,
    /// Coefficient of friction between probe and surface, at finite strain; the probe slides to the right [default: that of the phantom]
    #[arg(long, value_parser = friction, allow_hyphen_values = true, value_name = "MU")]
    friction: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Theory {
    /// Linear elasticity, as the paper's; without friction.
    Small,
    /// A neo-Hookean gel at finite strain.
    Finite,
}

impl TheoryArguments {
    /// The phantom under this theory.
    ///
    /// Implements: CLI-177.
    pub fn of(&self, phantom: &Phantom) -> Result<Phantom, CliError> {
        let changed = phantom.changed(|parts| {
            parts.strain = match self.strain {
                None => parts.strain,
                Some(Theory::Small) => Strain::Small,
                Some(Theory::Finite) => Strain::Finite,
            };
            parts.probe.friction = self.friction.unwrap_or(parts.probe.friction);
        });
        Ok(changed?)
    }
}

/// The built-in phantom of that name, or the one in the file.
///
/// Implements: CLI-012.
pub fn phantom(name: &str) -> Result<Phantom, CliError> {
    if let Ok(phantom) = Phantom::builtin(name) {
        return Ok(phantom);
    }
    let path = Path::new(name);
    if !path.exists() {
        let known = BUILTIN_NAMES.join(", ");
        refuse!("phantom {name:?} is neither built in ({known}) nor a file");
    }
    Ok(Phantom::read(path)?)
}

/// Runs the command.
///
/// Implements: CLI-012, CLI-013.
pub fn solve(arguments: &SolveArguments) -> Result<(), CliError> {
    let (depths, laterals) = (&arguments.depths[..], &arguments.laterals[..]);
    let pose = match (&arguments.vtu, depths, laterals) {
        (None, ..) => None,
        (Some(path), &[depth], &[lateral]) => Some((path, Pose { depth, lateral })),
        _ => refuse!("--vtu shows one pose: give one depth and one lateral position"),
    };
    let phantom = arguments.theory.of(&phantom(&arguments.phantom)?)?;
    let failed = CliError::fem(phantom.name());
    let size = arguments.mesh_size.unwrap_or(MESH_SIZE);
    tell_large_mesh(&phantom, size).map_err(&failed)?;
    let model = Model::new(&phantom, size, arguments.contact).map_err(&failed)?;
    if arguments.path {
        return along_path(&model, arguments);
    }
    let meshes = if arguments.certify { 3 } else { 1 };
    let columns = model.solved_laterals(laterals).len();
    let bar = bar(meshes * depths.len() * columns, phantom.name());
    let solved = |poses| {
        bar.inc(poses as u64);
        true
    };
    let map = if arguments.certify {
        certified_map(&model, depths, laterals, &solved)
    } else {
        model.map(depths, laterals, &solved)
    };
    let map = map.map_err(&failed)?;
    bar.finish_and_clear();
    if let Some((path, pose)) = pose {
        let solution = model.solve(pose).map_err(&failed)?;
        write(path, &model.vtu(&solution).map_err(&failed)?)?;
    }
    let strain = tell_large_strain(&map, phantom.name());
    print(&match arguments.format {
        // Writing to a String does not fail.
        Format::Table => Table { map: &map }.render().unwrap_or_default(),
        Format::Json => map.to_json(),
        Format::Csv => map.table().to_csv(),
    })?;
    strain
}

/// Leads the probe along the path, and prints a row for each pose.
///
/// Implements: CLI-180, CLI-015.
fn along_path(model: &Model, arguments: &SolveArguments) -> Result<(), CliError> {
    let (depths, laterals) = (&arguments.depths[..], &arguments.laterals[..]);
    let (Some(&last), Some((&first, others))) = (depths.last(), laterals.split_first()) else {
        refuse!("--path needs a depth and a lateral position");
    };
    if arguments.format == Format::Json {
        refuse!("--path prints no map; give --format table or csv");
    }
    let down = depths.iter().map(|&depth| (depth, first));
    let across = others.iter().map(|&lateral| (last, lateral));
    let poses: Vec<Pose> = down
        .chain(across)
        .map(|(depth, lateral)| Pose { depth, lateral })
        .collect();
    let failed = CliError::fem(model.phantom().name());
    let (path, checks) = model.path(&poses).map_err(&failed)?;
    if let Some(list) = &arguments.pvd {
        write_series(list, &model.vtu_series(&path).map_err(&failed)?)?;
    }
    print(&match arguments.format {
        // Writing to a String does not fail.
        Format::Table => PathTable { path: &path }.render().unwrap_or_default(),
        _ => {
            let row = |of: &PoseSolution| {
                let (pose, force) = (of.pose, of.force);
                let [x, d] = [pose.lateral, pose.depth].map(|length| format_scaled(length, 3));
                format!("{x},{d},{},{}\n", force.normal, force.lateral)
            };
            let rows: String = path.iter().map(row).collect();
            format!("lateral_mm,depth_mm,normal_force_n,lateral_force_n\n{rows}")
        }
    })?;
    let smallest = checks.iter().zip(&poses).map(|(check, pose)| SmallestDet {
        det: check.min_det,
        depth: pose.depth,
        lateral: pose.lateral,
    });
    let smallest = smallest.min_by(|a, b| a.det.total_cmp(&b.det));
    let is_small_strain = model.phantom().strain() == Strain::Small;
    let tell = |of| tell_smallest_det(of, is_small_strain, model.phantom().name());
    smallest.map_or(Ok(()), tell)
}

/// Writes a series of meshes beside the `list` of them, numbered from 0.
fn write_series(list: &Path, series: &[String]) -> Result<(), CliError> {
    let mut sets = String::new();
    for (at, text) in series.iter().enumerate() {
        let part = list.with_extension("");
        let name = part.file_name().unwrap_or_default().to_string_lossy();
        let name = format!("{name}-{at}.vtu");
        let shown = palpate::text::escape(&name);
        sets += &format!("<DataSet timestep=\"{at}\" file=\"{shown}\"/>\n");
        write(&list.with_file_name(name), text)?;
    }
    write(
        list,
        &format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n{sets}</Collection>\n</VTKFile>\n"
        ),
    )
}

/// Warns on standard error where the strain of `phantom` is too large for the model.
///
/// # Errors
/// The gel is turned inside out: whoever wrote the map ends with that.
///
/// Implements: CLI-015, CLI-003.
pub fn tell_large_strain(map: &ForceMap, phantom: &str) -> Result<(), CliError> {
    tell_large_strain_to(f64::INFINITY, map, phantom)
}

/// As [`tell_large_strain`], down to the depth `deepest`, m.
///
/// # Errors
/// As [`tell_large_strain`].
///
/// Implements: CLI-015, CLI-003.
pub fn tell_large_strain_to(deepest: f64, map: &ForceMap, phantom: &str) -> Result<(), CliError> {
    let Some(certificate) = map.certificate() else {
        return Ok(());
    };
    let table = map.table();
    let (min_det, depths) = down_to(deepest, &certificate.min_det, table.depths());
    let smallest = SmallestDet::of(&min_det, &depths, table.laterals());
    let tell = |of| tell_smallest_det(of, certificate.law.is_none(), phantom);
    smallest.map_or(Ok(()), tell)
}

/// The rows of `min_det` down to the depth `deepest`, m, with one there, and their depths, m. The value there is linear between the
/// rows around it, or between the gel at rest and the first row.
///
/// Implements: CLI-015.
fn down_to(deepest: f64, min_det: &Matrix, depths: &[f64]) -> (Matrix, Vec<f64>) {
    let count = depths.partition_point(|depth| *depth <= deepest + SAME_POSITION);
    let mut asked = depths[..count].to_vec();
    let above = asked.last().copied().unwrap_or(0.0);
    let mut share = 0.0;
    if let Some(below) = depths.get(count)
        && deepest > above + SAME_POSITION
    {
        share = (deepest - above) / (below - above);
        // To a nanometre, as it is told.
        asked.push((1e9 * deepest).round() / 1e9);
    }
    let det = |row: usize, column: usize| {
        if row < count {
            return min_det.row(row)[column];
        }
        let before = row.checked_sub(1);
        let before = before.map_or(1.0, |before| min_det.row(before)[column]);
        (1.0 - share) * before + share * min_det.row(row)[column]
    };
    let min_det = Matrix::from_fn(asked.len(), min_det.column_count(), det);
    (min_det, asked)
}

fn tell_smallest_det(
    smallest: SmallestDet,
    is_small_strain: bool,
    phantom: &str,
) -> Result<(), CliError> {
    let SmallestDet {
        det,
        depth,
        lateral,
    } = smallest;
    let (depth, lateral) = (mm(depth), mm(lateral));
    let found = format!(
        "phantom {phantom}: det(I + grad u) falls to {det:.3} at depth {depth} mm, lateral {lateral} mm"
    );
    if det <= 0.0 {
        return Err(CliError::Meaningless(format!(
            "{found}: the gel is turned inside out there, and the forces are meaningless; try smaller depths"
        )));
    }
    if det < SMALL_STRAIN_LIMIT && is_small_strain {
        warn(&format!(
            "{found}: the small-strain model is at its limit there"
        ));
    }
    Ok(())
}

/// The map for people.
#[derive(Template)]
#[template(path = "cli.txt", block = "solve")]
struct Table<'a> {
    map: &'a ForceMap,
}

/// The forces along a path for people.
#[derive(Template)]
#[template(path = "cli.txt", block = "path")]
struct PathTable<'a> {
    path: &'a [PoseSolution],
}

/// A length (m) as a number of mm.
fn in_mm(length: &f64) -> String {
    mm(*length).to_string()
}
