//! `palpate bank`: force maps of many candidate inclusions (`spec/bank.md`).

use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::CliError;
use super::error::refuse;
use super::numbers::{List, contact, length, lengths, moduli, positions};
use super::output::{Envelope, write_new};
use super::progress::{resumed_bar, tell_large_mesh, tell_time};
use super::solve::{TheoryArguments, phantom, tell_large_strain};
use palpate::bank::{Bank, BankPlan, BankSolve, MESH_SIZE, Parameter};
use palpate::decimal::{kpa, mm};
use palpate::fem::{Contact, Model};
use palpate::file::from_json;
use palpate::force_map::ForceMap;
use palpate::journal::Journal;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;

/// Most forces of a bank, over all inclusions and lateral positions: its file takes some 100 bytes for each, and must be readable.
const MOST_FORCES: usize = 1_000_000;
/// A map takes as much of the file as so many more lateral positions would.
const PER_MAP: usize = 20;

/// Arguments of `palpate bank`.
#[derive(Debug, Args)]
pub struct BankArguments {
    /// Built-in phantom (2.6, 4.6, 6.6, 8.6) or phantom file; its one inclusion is varied
    #[arg(long, value_name = "NAME|FILE")]
    phantom: String,
    #[command(flatten)]
    theory: TheoryArguments,
    /// Lateral positions of the inclusion's centre in mm: a,b,c or from:to:step
    #[arg(long = "offsets-mm", value_parser = positions, allow_hyphen_values = true, value_name = "LIST")]
    positions: List,
    /// Depths of the inclusion's highest point in mm: a,b,c or from:to:step
    #[arg(long = "depths-mm", value_parser = positions, allow_hyphen_values = true, value_name = "LIST")]
    depths: List,
    /// Diameters of the inclusion in mm [default: that of the phantom]
    #[arg(long = "diameters-mm", value_parser = positions, allow_hyphen_values = true, value_name = "LIST")]
    diameters: Option<List>,
    /// Young's moduli of the inclusion in kPa [default: that of the phantom]
    #[arg(long = "stiffnesses-kpa", value_parser = moduli, allow_hyphen_values = true, value_name = "LIST")]
    moduli: Option<List>,
    /// Depth of the probe in mm, or a list of depths for sweeps whose depth varies: a,b,c or from:to:step
    #[arg(long = "probe-depth-mm", value_parser = lengths, allow_hyphen_values = true, value_name = "LIST")]
    probe_depths: List,
    /// Lateral positions of the probe in mm: a,b,c or from:to:step
    #[arg(long = "laterals-mm", value_parser = positions, allow_hyphen_values = true, value_name = "LIST")]
    laterals: List,
    /// Contact law
    #[arg(long, value_parser = contact(), default_value = Contact::default().name())]
    contact: Contact,
    /// Mesh size in mm; up to 0.5 all element sizes scale with it, above not all [default: 0.65]
    #[arg(long = "mesh-mm", value_parser = length, value_name = "H")]
    mesh_size: Option<f64>,
    /// Output file, which must not exist; FILE.part keeps finished maps, so that an aborted run can continue
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl BankArguments {
    /// The maps to compute.
    ///
    /// Implements: CLI-154, CLI-155.
    fn plan(&self, phantom: &Phantom) -> Result<BankPlan, CliError> {
        let number = phantom.inclusions().len();
        if number != 1 {
            refuse!(
                "phantom {} has {number} inclusions, but a bank varies exactly one; try --phantom 6.6",
                phantom.name()
            );
        }
        let mut plan = BankPlan::new(phantom.clone(), self.probe_depths[0], &self.laterals)?;
        plan.probe_depths.clone_from(&self.probe_depths);
        plan.positions.clone_from(&self.positions);
        plan.depths.clone_from(&self.depths);
        let (diameters, moduli) = (self.diameters.iter(), self.moduli.iter());
        diameters.for_each(|asked| plan.diameters.clone_from(asked));
        moduli.for_each(|asked| plan.moduli.clone_from(asked));
        plan.mesh_size = self.mesh_size.unwrap_or(MESH_SIZE);
        plan.contact = self.contact;
        let lists = [&plan.positions, &plan.depths, &plan.diameters, &plan.moduli];
        // Lists have 10⁴ entries at most: no overflow.
        let inclusions = lists.map(|list| list.len() as f64).iter().product::<f64>();
        let poses = self.laterals.len() * self.probe_depths.len();
        let most = MOST_FORCES / (poses + PER_MAP);
        if inclusions > most as f64 {
            refuse!(
                "{inclusions} inclusions are too many; at most {most} are possible with {poses} poses of the probe"
            );
        }
        Ok(plan)
    }
}

/// Runs the command.
///
/// Implements: CLI-154, CLI-155, CLI-159, CLI-015.
pub fn bank(arguments: &BankArguments) -> Result<(), CliError> {
    let out = &arguments.out;
    if out.exists() {
        let out = out.display();
        refuse!("{out}: already exists; choose another --out or delete it");
    }
    let phantom = arguments.theory.of(&phantom(&arguments.phantom)?)?;
    let plan = arguments.plan(&phantom)?;
    let solves = plan.solves()?;
    let failed = CliError::fem(phantom.name());
    tell_large_mesh(&phantom, plan.mesh_size).map_err(&failed)?;
    // The reference is one more.
    let work = [
        solves.len() + 1,
        arguments.laterals.len() * arguments.probe_depths.len(),
    ];
    tell_time(&phantom, plan.mesh_size, work).map_err(&failed)?;
    let (part, finished, bar) = open_part(&plan, arguments, &solves)?;
    let mut maps = compute(&plan, phantom.name(), &solves, &part, finished, &bar)?;
    bar.finish_and_clear();
    let det = |map: &ForceMap| map.certificate().map_or(1.0, |of| of.smallest_det.det);
    let worst = maps.iter().min_by(|a, b| det(a).total_cmp(&det(b)));
    let strain = worst.map_or(Ok(()), |map| {
        tell_large_strain(map, &name(phantom.name(), map.phantom()))
    });
    let reference = maps.remove(0);
    write_new(out, &Bank::new(reference, maps)?.to_json())?;
    part.remove()?;
    strain
}

/// One computation: 0 for the reference, then one for each solve.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Finished<M> {
    number: usize,
    maps: M,
}

/// The maps of each finished computation.
type Taken = Vec<Option<Vec<ForceMap>>>;

/// Opens FILE.part; the maps that it holds, and the bar of those that are left.
///
/// Implements: CLI-156, CLI-157.
fn open_part(
    plan: &BankPlan,
    arguments: &BankArguments,
    solves: &[BankSolve],
) -> Result<(Journal, Taken, ProgressBar), CliError> {
    let request = Envelope::job("palpate-bank-part", plan);
    let mut name = arguments.out.as_os_str().to_owned();
    name.push(".part");
    let path = PathBuf::from(name);
    let mut finished = vec![None; 1 + solves.len()];
    let part = Journal::open(path.clone(), &request, "palpate bank", |text| {
        let Finished { number, maps } = from_json::<Finished<Vec<ForceMap>>>(text)?;
        let solve = number.checked_sub(1).and_then(|solve| solves.get(solve));
        match finished.get_mut(number) {
            Some(place) if is_of(&maps, solve) => *place = Some(maps),
            _ => {
                let found = "this line is not a map of this bank; delete the file and run again";
                return Err(Refusal::state(found, ""));
            }
        }
        Ok(())
    })?;
    let taken = finished.iter().flatten().count();
    let bar = resumed_bar(&path, taken, finished.len(), "maps");
    Ok((part, finished, bar))
}

/// Whether `maps` are those of a solve, or that of the reference.
fn is_of(maps: &[ForceMap], solve: Option<&BankSolve>) -> bool {
    let phantom = maps.first().and_then(ForceMap::phantom);
    match solve {
        Some(solve) => {
            phantom == Some(&solve.phantom) && maps.len() == 1 + usize::from(solve.image)
        }
        None => phantom.is_some_and(|of| of.inclusions().is_empty()) && maps.len() == 1,
    }
}

/// The reference and the maps of all solves, in their order; computes those that are not `finished`.
///
/// Implements: CLI-007, CLI-156.
fn compute(
    plan: &BankPlan,
    phantom: &str,
    solves: &[BankSolve],
    part: &Journal,
    finished: Taken,
    bar: &ProgressBar,
) -> Result<Vec<ForceMap>, CliError> {
    let maps_of = |last: &mut Option<Model>, (number, finished): (usize, Option<Vec<ForceMap>>)| {
        if let Some(maps) = finished {
            return Ok(maps);
        }
        let solve = number.checked_sub(1).map(|solve| &solves[solve]);
        let solved = match solve {
            Some(solve) => plan.solve(solve, last),
            None => plan.reference().map(|map| vec![map]),
        };
        let name = || name(phantom, solve.map(|solve| &solve.phantom));
        let maps = solved.map_err(|error| CliError::fem(&name())(error))?;
        part.append(&Finished {
            number,
            maps: &maps,
        })?;
        bar.inc(1);
        Ok(maps)
    };
    let maps = finished.into_par_iter().enumerate();
    let maps = maps.map_init(|| None, maps_of);
    let maps = maps.collect::<Result<Vec<_>, CliError>>()?;
    Ok(maps.concat())
}

/// The name of a phantom with its inclusion varied.
fn name(name: &str, phantom: Option<&Phantom>) -> String {
    let inclusion = phantom.and_then(|phantom| phantom.inclusions().first());
    inclusion.map_or(name.into(), |inclusion| {
        let [x, depth, width, modulus] = Parameter::ALL.map(|of| of.of(inclusion));
        let [x, depth, width] = [x, depth, width].map(mm);
        let modulus = kpa(modulus);
        format!(
            "{name} with its inclusion at {x} mm, {depth} mm deep, {width} mm wide, {modulus} kPa"
        )
    })
}
