//! The components of the program: what of others' is in it, or builds it, and why (`spec/supply-chain.md`).
//!
//! Version, checksum and dependencies are read from the lock file, licence and reason from `supply/components.csv`;
//! both are part of the library. They are those of the program as it is shipped, with its default features on
//! `x86_64-unknown-linux-gnu`, and not of another program that uses this library.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use palpate::build::Build;

/// The lock file.
pub const LOCK: &str = include_str!("../../../Cargo.lock");

/// What the program itself asks for: the lock file has that of its tests beside it.
const MANIFEST: &str = include_str!("../../../Cargo.toml");

/// The program whose components these are.
const PROGRAM: &str = "palpate";

/// Licence, layer, role and reason of each component.
const TABLE: &str = include_str!("../../../supply/components.csv");

/// What a component does when the program is made or run.
///
/// ```
/// use palpate_verify::supply::{Role, components};
///
/// let macros = components()?.into_iter().filter(|component| component.role == Role::Macro);
/// assert!(macros.map(|component| component.name).any(|name| name == "serde_derive"));
/// # Ok::<(), palpate_verify::supply::SupplyError>(())
/// ```
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
///
/// ```
/// let components = palpate_verify::supply::components()?;
/// let libm = components.iter().find(|component| component.name == "libm").unwrap();
/// assert_eq!((libm.licence, libm.layer), ("MIT", "core"));
/// assert!(libm.depends_on.is_empty() && libm.sha256.len() == 64);
/// # Ok::<(), palpate_verify::supply::SupplyError>(())
/// ```
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
    /// The first layer that has it, of core, std, fem, report, hid, verify, oracle, cli.
    pub layer: &'static str,
    /// What it does.
    pub role: Role,
    /// What it is there for.
    pub why: &'static str,
    /// The components that it depends on, by name; with the version too where the lock file has several.
    pub depends_on: Vec<String>,
}

/// Why the lock file and the table do not make a list of components.
///
/// ```
/// use palpate_verify::supply::SupplyError;
///
/// let error = SupplyError::Row { line: 7 };
/// assert!(error.to_string().starts_with("supply/components.csv:7: expected name,licence"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SupplyError {
    /// The lock file or the manifest is not one.
    #[error("Cargo.lock or Cargo.toml: {0}")]
    File(String),
    /// A row of the table that is none.
    #[error("supply/components.csv:{line}: expected name,licence,layer,role,why")]
    Row {
        /// Its line, from 1.
        line: usize,
    },
    /// A component that the lock file leads to no package for, or to several, or to one without a checksum.
    #[error(
        "{0} is in supply/components.csv, but Cargo.lock has not one package of the registry for it"
    )]
    Package(String),
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

#[derive(serde::Deserialize)]
struct Manifest {
    dependencies: BTreeMap<String, serde::de::IgnoredAny>,
}

/// A row of the table.
struct Row {
    /// `name`, or `name 1` or `name 0.2` for one of several versions.
    name: &'static str,
    licence: &'static str,
    layer: &'static str,
    role: Role,
    why: &'static str,
}

/// All components of the program, by name.
///
/// ```
/// let components = palpate_verify::supply::components()?;
/// assert!(components.is_sorted_by_key(|component| component.name));
/// # Ok::<(), palpate_verify::supply::SupplyError>(())
/// ```
///
/// # Errors
/// [`SupplyError`] if lock file and table do not fit.
///
/// Implements: EVD-060, EVD-061.
pub fn components() -> Result<Vec<Component>, SupplyError> {
    Ok(listed()?.0)
}

/// The components, and those that the program itself asks for, as the lock file names them.
fn listed() -> Result<(Vec<Component>, Vec<String>), SupplyError> {
    let rows = rows(TABLE)?;
    let broken = |error: toml::de::Error| SupplyError::File(error.to_string());
    let mut lock: Lock = toml::from_str(LOCK).map_err(broken)?;
    let manifest: Manifest = toml::from_str(MANIFEST).map_err(broken)?;
    let names: BTreeSet<&str> = rows.iter().map(|row| first_word(row.name)).collect();
    for package in &mut lock.package {
        let program = package.name == PROGRAM;
        package.dependencies.retain(|asked| {
            let asked = first_word(asked);
            names.contains(asked) && (!program || manifest.dependencies.contains_key(asked))
        });
    }
    let packages = reached(&lock)?;
    let mut components = Vec::new();
    for row in rows {
        let mut fitting = packages.values().filter(|package| {
            let package = format!("{} {}", package.name, package.version);
            let rest = package.strip_prefix(row.name);
            rest.is_some_and(|rest| rest.starts_with([' ', '.']))
        });
        let wrong = || SupplyError::Package(row.name.into());
        let (Some(package), None) = (fitting.next(), fitting.next()) else {
            return Err(wrong());
        };
        components.push(Component {
            name: first_word(row.name),
            version: package.version.clone(),
            sha256: package.checksum.clone().ok_or_else(wrong)?,
            licence: row.licence,
            layer: row.layer,
            role: row.role,
            why: row.why,
            depends_on: package.dependencies.clone(),
        });
    }
    components.sort_by(|a, b| (a.name, &a.version).cmp(&(b.name, &b.version)));
    let program = packages[PROGRAM];
    Ok((components, program.dependencies.clone()))
}

/// The packages that lead from the program over what they ask for, by what the lock file calls them there: `name`, or
/// `name version` where it holds several.
fn reached(lock: &Lock) -> Result<BTreeMap<&str, &Package>, SupplyError> {
    let mut found = BTreeMap::new();
    let mut open = vec![PROGRAM];
    while let Some(wanted) = open.pop() {
        let fits = |package: &&Package| {
            package.name == wanted || format!("{} {}", package.name, package.version) == wanted
        };
        let package = lock.package.iter().find(fits);
        let package = package.ok_or_else(|| SupplyError::Package(wanted.into()))?;
        if found.insert(wanted, package).is_none() {
            open.extend(package.dependencies.iter().map(String::as_str));
        }
    }
    Ok(found)
}

fn first_word(text: &str) -> &str {
    text.split(' ').next().unwrap_or_default()
}

fn rows(table: &'static str) -> Result<Vec<Row>, SupplyError> {
    let lines = (1..).zip(table.lines()).skip(1);
    lines
        .map(|(line, text)| {
            let fields: Vec<&str> = text.split(',').collect();
            let role = |role: &str| match role {
                "program" => Some(Role::Program),
                "macro" => Some(Role::Macro),
                "build" => Some(Role::Build),
                _ => None,
            };
            match fields[..] {
                [name, licence, layer, named, why] => role(named).map(|role| Row {
                    name,
                    licence,
                    layer,
                    role,
                    why,
                }),
                _ => None,
            }
            .ok_or(SupplyError::Row { line })
        })
        .collect()
}

/// The bill of materials: CycloneDX 1.6 in JSON, the same bytes for the same build.
///
/// ```
/// let bill = palpate_verify::supply::sbom()?;
/// assert_eq!(bill["bomFormat"], "CycloneDX");
/// assert_eq!(bill, palpate_verify::supply::sbom()?);
/// # Ok::<(), palpate_verify::supply::SupplyError>(())
/// ```
///
/// # Errors
/// As [`components`].
///
/// Implements: EVD-065, EVD-066.
pub fn sbom() -> Result<Value, SupplyError> {
    let (components, direct) = listed()?;
    let build = Build::THIS;
    let program = purl(PROGRAM, build.version);
    // What the lock file may call it.
    let references: BTreeMap<String, String> = (components.iter())
        .flat_map(|Component { name, version, .. }| {
            let names = [name.to_string(), format!("{name} {version}")];
            names.map(|known| (known, purl(name, version)))
        })
        .collect();
    let known = |names: &[String]| -> Vec<&str> {
        let found = names.iter().map(|name| references.get(name));
        found.flatten().map(String::as_str).collect()
    };
    let mut asked = known(&direct);
    asked.push(STANDARD_LIBRARY);
    let mut dependencies = vec![json!({ "ref": program, "dependsOn": asked })];
    dependencies.extend(components.iter().map(|component| {
        let asked = known(&component.depends_on);
        json!({ "ref": purl(component.name, &component.version), "dependsOn": asked })
    }));
    let mut parts: Vec<Value> = components.iter().map(part).collect();
    parts.push(standard_library(build.compiler));
    Ok(json!({
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {
            "lifecycles": [{ "phase": "build" }],
            "component": {
                "type": "application",
                "bom-ref": program,
                "name": PROGRAM,
                "version": build.version,
                "licenses": [{ "expression": env!("CARGO_PKG_LICENSE") }],
                "purl": program,
                "properties": [
                    { "name": "palpate:commit", "value": build.commit },
                    { "name": "palpate:target", "value": build.target },
                ],
            },
        },
        "components": parts,
        "dependencies": dependencies,
    }))
}

/// How the bill of materials refers to Rust's standard library.
const STANDARD_LIBRARY: &str = "rust-standard-library";

/// Rust's standard library, which comes with the compiler and not through the lock file.
fn standard_library(compiler: &str) -> Value {
    json!({
        "type": "library",
        "bom-ref": STANDARD_LIBRARY,
        "name": STANDARD_LIBRARY,
        "version": compiler,
        "scope": "required",
        "licenses": [{ "expression": "MIT OR Apache-2.0" }],
        "properties": [{ "name": "palpate:why", "value": "The language's own library; linked into the program." }],
    })
}

/// A component as the bill of materials has it. What is not in the program itself has the scope `excluded`.
fn part(component: &Component) -> Value {
    let reference = purl(component.name, &component.version);
    let scope = match component.role {
        Role::Program => "required",
        Role::Macro | Role::Build => "excluded",
    };
    json!({
        "type": "library",
        "bom-ref": reference,
        "name": component.name,
        "version": component.version,
        "scope": scope,
        "hashes": [{ "alg": "SHA-256", "content": component.sha256 }],
        "licenses": [{ "expression": component.licence }],
        "purl": reference,
        "properties": [
            { "name": "palpate:layer", "value": component.layer },
            { "name": "palpate:role", "value": component.role },
            { "name": "palpate:why", "value": component.why },
        ],
    })
}

/// The package URL of a crate; the `+` of a version must be written in hexadecimal there.
fn purl(name: &str, version: &str) -> String {
    format!("pkg:cargo/{name}@{}", version.replace('+', "%2B"))
}
