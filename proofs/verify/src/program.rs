//! The shipped program `palpate`, judged from outside: it is run, and what it prints is held against other programs' results.

mod decisions;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use palpate::version::Build;
use palpate_conform::{Finding, Measure, Program, Settings, Suite, run};

use super::fem::largest;
use super::{Check, Figure, Measured};

/// Judges a program by its absolute path ([`judged`]).
pub type Judge = fn(&Path) -> Measured;

/// The checks of this part.
pub const CHECKS: &[Check<Judge>] = checks! {
    "program.identity" ["CLI-001"] => identity,
        "The program says that it is of the same version and commit as palpate-verify.",
        "None: equal or not. Fixed in 0.2.0.";
    "program.vectors" ["ORA-001", "ORA-046", "VEC-001"] => vectors,
        "The program answers every vector, asked through a pipe, within its tolerance, and refuses what it must refuse.",
        "Each case states its tolerance, derived in the file of its group from the program that computed it. Fixed in 0.1.0.";
    "program.scikit_fem" ["FEM-021", "CLI-013"] => |program| forces(program, "scikit-fem"),
        "The forces that the program prints are those of scikit-fem on meshes of its own.",
        "The band of scikit-fem's extrapolation and the error of the default mesh that the vectors state. Fixed in 0.1.0.";
    "program.calculix" ["FEM-080", "CLI-013"] => |program| forces(program, "CalculiX"),
        "The forces that the program prints are those of CalculiX on the same meshes.",
        "Penalty overlap of CalculiX and contact at nodes in place of Gauss points: FEM-080. Fixed in 0.1.0.";
    "program.decisions" ["CLI-055", "TRC-064"] => decisions::decisions,
        "T, Θ, χ² with its limits and the false-alarm rate with its tolerance of depth that palpate detect prints are those of \
         plain sums, on made-up maps.",
        "Sums: rounding of 82 terms. Probabilities: rounding of their arguments, 10⁻¹², times the slope of their logarithm, \
         below 10, and beyond the limits of χ² the step at which the program ends its search for them. Fixed in 0.2.0.";
    "program.refusals" ["CLI-048", "CLI-049", "PHA-030", "TRC-075"] => decisions::refusals,
        "Of a record that cannot be judged, of maps that do not differ and of a gel that nothing holds, palpate says so and \
         prints neither a decision nor a probability of an inclusion.",
        "None: each case is refused or not. Fixed in 0.2.0.";
};

/// Forces by other programs.
const OUTSIDE: &str = include_str!("outside.csv");

/// The absolute path of the program to judge: the file that was named, from the current folder and never from `PATH`, or
/// [`beside`].
///
/// # Errors
/// If the name is empty or the current folder is not known.
pub fn judged(named: Option<&Path>) -> std::io::Result<PathBuf> {
    std::path::absolute(named.map_or_else(beside, Path::to_path_buf))
}

/// The program beside the one that runs.
pub fn beside() -> PathBuf {
    let own = std::env::current_exe().unwrap_or_default();
    own.with_file_name(format!("palpate{}", std::env::consts::EXE_SUFFIX))
}

/// The SHA-256 of a program's file, in hexadecimal.
pub fn sha256(program: &Path) -> Option<String> {
    let identity = Program::of_command(&[program.into()], String::new());
    Some(identity.files.first()?.sha256.clone())
}

/// What the program does in a folder.
fn run_in(folder: &Path, program: &Path, arguments: &[&str]) -> Measured<Output> {
    let mut command = Command::new(program);
    let output = command.args(arguments).current_dir(folder).output();
    Ok(output.map_err(|error| {
        let shown = program.display();
        format!("cannot start {shown}: {error}; name the program palpate with --program FILE")
    })?)
}

/// What the program prints.
fn printed(program: &Path, arguments: &[&str]) -> Measured<String> {
    let shown = program.display();
    let output = run_in(Path::new("."), program, arguments)?;
    if !output.status.success() {
        let (asked, said) = (arguments.join(" "), String::from_utf8_lossy(&output.stderr));
        return Err(format!("{shown} {asked}: {}", said.trim_end()).into());
    }
    Ok(String::from_utf8(output.stdout).map_err(|error| format!("{shown}: {error}"))?)
}

fn identity(program: &Path) -> Measured {
    let said = printed(program, &["--version"])?;
    let Build {
        version, commit, ..
    } = Build::THIS;
    let own = [format!("palpate {version}"), format!("commit {commit}")];
    let differ = own
        .iter()
        .filter(|own| !said.lines().any(|said| said == **own));
    Ok(
        figures! { "of version and commit, different from palpate-verify's" => count(differ.count() as u64, 0); },
    )
}

fn vectors(program: &Path) -> Measured {
    let suite = Suite::embedded()?;
    let settings = Settings {
        command: vec![program.into(), "oracle".into()],
        skip: Vec::new(),
        lenient: false,
        timeout: Duration::from_secs(60),
    };
    let verdict = run(&suite, &settings, &Measure::exact(), |_| ())?;
    let first = verdict.findings.first().map(|first| {
        let Finding {
            case,
            group,
            reason,
            ..
        } = first;
        format!(", the first {case} of {group}: {reason}")
    });
    let first = first.unwrap_or_default();
    Ok(figures! {
        "groups of cases" => told(verdict.groups.len() as f64);
        "cases right" => count(verdict.totals.right as u64, suite.cases() as u64);
        "cases that are not right{first}" => count(verdict.findings.len() as u64, 0);
    })
}

/// One row of the table of forces: what was solved, and the normal and the lateral force with their limits, N.
struct Row<'a> {
    mesh: &'a str,
    phantom: &'a str,
    pose: [&'a str; 2],
    forces: [f64; 2],
    limits: [f64; 2],
}

impl Row<'_> {
    /// The rows of a program.
    fn of(by: &str) -> Measured<Vec<Row<'static>>> {
        let rows = OUTSIDE
            .lines()
            .filter(|line| line.split(',').next() == Some(by));
        let row = |line: &'static str| {
            let cells: Vec<&str> = line.split(',').collect();
            let [_, mesh, phantom, depth, lateral, numbers @ ..] = &cells[..] else {
                return None;
            };
            let numbers: Result<Vec<f64>, _> = numbers.iter().map(|text| text.parse()).collect();
            let [normal, lateral_force, normal_limit, lateral_limit] =
                numbers.ok()?.try_into().ok()?;
            Some(Row {
                mesh,
                phantom,
                pose: [depth, lateral],
                forces: [normal, lateral_force],
                limits: [normal_limit, lateral_limit],
            })
        };
        let wrong = |line| format!("outside.csv: {line:?} must have 9 cells");
        rows.map(|line| Ok(row(line).ok_or_else(|| wrong(line))?))
            .collect()
    }

    /// The normal and the lateral force that the program prints, N, for rows that are all poses of a phantom's depths and lateral positions.
    fn solved(rows: &[Row<'_>], program: &Path) -> Measured<Vec<[f64; 2]>> {
        let [depths, laterals] = [0, 1].map(|k| {
            let mut list: Vec<&str> = rows.iter().map(|row| row.pose[k]).collect();
            list.dedup();
            list.join(",")
        });
        let (mesh, phantom) = (rows[0].mesh, rows[0].phantom);
        let poses = ["--depths-mm", &depths, "--laterals-mm", &laterals];
        let model = format!("solve --phantom {phantom} --mesh-mm {mesh} --format csv");
        let model: Vec<&str> = model.split(' ').collect();
        let table = printed(program, &[&model[..], &poses].concat())?;
        let numbers = |line: &str| -> Option<[f64; 4]> {
            let cells: Option<Vec<f64>> = line.split(',').map(|cell| cell.parse().ok()).collect();
            cells?.try_into().ok()
        };
        let forces = rows
            .iter()
            .zip(table.lines().skip(1))
            .map_while(|(row, line)| {
                let [depth, lateral, forces @ ..] = numbers(line)?;
                let asked = row.pose.map(|text| text.parse().ok());
                (asked == [Some(depth), Some(lateral)]).then_some(forces)
            });
        let forces: Vec<[f64; 2]> = forces.collect();
        if forces.len() != rows.len() {
            let (shown, poses) = (program.display(), rows.len());
            let message = format!("{shown} solve printed {table:?}; it must print {poses} poses");
            return Err(message.into());
        }
        Ok(forces)
    }
}

/// The forces that the program prints against those by another one.
fn forces(program: &Path, by: &str) -> Measured {
    use rayon::prelude::*;
    let rows = Row::of(by)?;
    let phantoms = rows.chunk_by(|one, next| one.phantom == next.phantom);
    let phantoms: Vec<&[Row<'_>]> = phantoms.collect();
    let solved = phantoms.par_iter().map(|rows| Row::solved(rows, program));
    let solved = solved.collect::<Measured<Vec<_>>>()?.concat();
    let mut figures = vec![Figure::told("poses", rows.len() as f64)];
    for (k, component) in ["normal", "lateral"].into_iter().enumerate() {
        let off = |(row, found): (&Row<'_>, &[f64; 2])| (found[k] - row.forces[k]).abs();
        let pairs = || rows.iter().zip(&solved);
        figures.extend(figures! {
            "largest difference of a {component} force, N" => told(largest(pairs().map(off)));
            "largest difference of a {component} force over its limit" => at_most(largest(pairs().map(|pair| off(pair) / pair.0.limits[k])), 1.0);
        });
    }
    Ok(figures)
}

#[cfg(test)]
pub(crate) mod tests {
    use std::fs;
    use std::io::Write;
    use std::os::unix::fs::PermissionsExt;

    use tempfile::{NamedTempFile, TempPath};

    use super::*;
    use crate::Outcome;

    /// A program that is a shell script; its file goes with it.
    pub fn script(text: &str) -> TempPath {
        let mut file = NamedTempFile::new().unwrap();
        write!(file, "#!/bin/sh\n{text}\n").unwrap();
        fs::set_permissions(file.path(), fs::Permissions::from_mode(0o755)).unwrap();
        file.into_temp_path()
    }

    /// One of the right version whose `solve` prints four poses with these forces.
    fn solver(forces: &str) -> TempPath {
        let Build {
            version, commit, ..
        } = Build::THIS;
        let text = format!(
            "case $1 in\n--version) echo 'palpate {version}'; echo 'commit {commit}';;\n\
             solve) echo head; for x in 0.0 2.5 6.0 10.0; do echo 4.0,$x,{forces}; done;;\n*) echo no >&2; exit 3;;\nesac"
        );
        script(&text)
    }

    fn judged_by(name: &str, program: &Path) -> Outcome {
        let found = CHECKS.iter().find(|check| check.claim.name == name);
        let check = found.unwrap();
        Outcome::measured(&check.claim, || (check.run)(program))
    }

    #[test]
    fn a_program_that_prints_other_forces_or_none_fails() {
        // Right at one pose of scikit-fem's, and so wrong at the others.
        for (forces, why) in [
            ("1.4826,0.0", "over its limit"),
            ("NaN,0.0", "over its limit"),
            ("1.4826", "must print 4 poses"),
        ] {
            let outcome = judged_by("program.scikit_fem", &solver(forces));
            assert!(!outcome.passed());
            assert!(outcome.complaint().unwrap().contains(why), "{outcome:?}");
        }
    }

    #[test]
    fn a_program_is_the_file_of_its_path() {
        let here = std::env::current_dir().unwrap();
        let of = |named: &str| judged(Some(Path::new(named))).unwrap();
        // A name that PATH knows, too.
        for named in ["sh", "./sh"] {
            assert_eq!(of(named), here.join("sh"));
        }
        assert_eq!(of("/bin/sh"), Path::new("/bin/sh"));
        assert_eq!(judged(None).unwrap(), beside());
        assert!(judged(Some(Path::new(""))).is_err());
    }

    #[test]
    fn a_program_of_another_version_or_none_fails() {
        assert!(judged_by("program.identity", &solver("")).passed());
        let echo = Path::new("/bin/echo");
        assert!(!judged_by("program.identity", echo).passed() && echo.exists());
        let missing = judged_by("program.identity", Path::new("/nowhere/palpate"));
        let complaint = missing.complaint().unwrap();
        assert!(
            complaint.contains("cannot start /nowhere/palpate")
                && complaint.contains("--program FILE")
        );
    }

    #[test]
    fn a_program_without_an_oracle_fails() {
        let silent = judged_by("program.vectors", &solver(""));
        assert!(silent.failure.is_some(), "{silent:?}");
    }

    #[test]
    fn every_row_of_the_table_is_of_a_program_and_has_a_limit() {
        let lines = OUTSIDE.lines().filter(|line| !line.starts_with('#'));
        let rows = lines.count() - 1;
        let [scikit_fem, calculix] = ["scikit-fem", "CalculiX"].map(|by| Row::of(by).unwrap());
        assert_eq!((scikit_fem.len(), calculix.len()), (20, 9));
        assert_eq!(rows, 29);
        let mut limits = scikit_fem
            .iter()
            .chain(&calculix)
            .flat_map(|row| row.limits);
        assert!(limits.all(|limit| limit > 0.0 && limit < 0.02));
    }
}
