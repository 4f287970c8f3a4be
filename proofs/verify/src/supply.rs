//! The components of the program: what of others' is in it, or builds it, and why (`spec/supply-chain.md`).
//!
//! Version, checksum and dependencies are read from the lock file, licence and reason from `supply/components.csv`;
//! both are part of the library. They are those of the program as it is shipped, with its default features on
//! `x86_64-unknown-linux-gnu`, and not of another program that uses this library.

use std::collections::BTreeSet;

/// The lock file.
pub const LOCK: &str = include_str!("../../../Cargo.lock");

/// Licence, layer, role and reason of each component.
const TABLE: &str = include_str!("../../../supply/components.csv");

/// What a component does when the program is made or run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Its code is in the program.
    Program,
    /// It writes code of the program while that is compiled: a macro, or what a macro is made of.
    Macro,
    /// It runs before a component is compiled.
    Build,
}

/// A crate of somebody else's.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Component {
    /// Its name in the registry.
    pub name: &'static str,
    /// Its version, from the lock file.
    pub version: String,
    /// SHA-256 of its package, from the lock file, in hexadecimal.
    pub sha256: String,
    /// Its licence, an SPDX expression.
    pub licence: &'static str,
    /// The first layer that has it, of core, std, fem, hid, cli.
    pub layer: &'static str,
    /// What it does.
    pub role: Role,
    /// What it is there for.
    pub why: &'static str,
    /// The components that it depends on, by name; with the version too where the lock file has several.
    pub depends_on: Vec<String>,
}

#[derive(serde::Deserialize)]
struct Lock {
    package: Vec<Package>,
}

#[derive(serde::Deserialize)]
struct Package {
    name: String,
    version: String,
    checksum: Option<String>,
    #[serde(default)]
    dependencies: Vec<String>,
}

/// All components of the program, by name.
///
/// ```
/// let components = palpate_verify::supply::components()?;
/// let libm = components.iter().find(|component| component.name == "libm").unwrap();
/// assert_eq!((libm.licence, libm.layer), ("MIT", "core"));
/// assert!(libm.depends_on.is_empty() && libm.sha256.len() == 64);
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// The row of the table that is none, or that the lock file has not one package of the registry for.
pub fn components() -> Result<Vec<Component>, String> {
    let lock: Lock = toml::from_str(LOCK).map_err(|error| format!("Cargo.lock: {error}"))?;
    let names: BTreeSet<&str> = TABLE.lines().map(name).collect();
    let rows = (2..).zip(TABLE.lines().skip(1));
    let components = rows.map(|(line, row)| {
        component(row, &lock, &names)
            .ok_or_else(|| format!("supply/components.csv:{line}: expected name,licence,layer,role,why of one package of Cargo.lock"))
    });
    let mut components = components.collect::<Result<Vec<_>, _>>()?;
    components.sort_by(|a, b| (a.name, &a.version).cmp(&(b.name, &b.version)));
    Ok(components)
}

/// The name at the beginning of a row, or of what the lock file calls a dependency.
fn name(text: &str) -> &str {
    text.split([' ', ',']).next().unwrap_or_default()
}

/// A row of the table: its first cell is `name`, or `name 1` or `name 0.2` where the lock file has several versions.
fn component(row: &'static str, lock: &Lock, names: &BTreeSet<&str>) -> Option<Component> {
    let [package, licence, layer, role, why] =
        row.split(',').collect::<Vec<_>>().try_into().ok()?;
    let mut fitting = lock.package.iter().filter(|known| {
        let known = format!("{} {}", known.name, known.version);
        let rest = known.strip_prefix(package);
        rest.is_some_and(|rest| rest.starts_with([' ', '.']))
    });
    let (Some(found), None) = (fitting.next(), fitting.next()) else {
        return None;
    };
    let asked = found.dependencies.iter();
    Some(Component {
        name: name(package),
        version: found.version.clone(),
        sha256: found.checksum.clone()?,
        licence,
        layer,
        role: match role {
            "program" => Role::Program,
            "macro" => Role::Macro,
            "build" => Role::Build,
            _ => return None,
        },
        why,
        depends_on: asked
            .filter(|asked| names.contains(name(asked)))
            .cloned()
            .collect(),
    })
}
