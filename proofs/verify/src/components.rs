//! The components of the program (`spec/supply-chain.md`): as its bill of materials lists them, or else all packages of the lock
//! file.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::json;

/// The lock file.
const LOCK: &str = include_str!("../../../Cargo.lock");

/// The SHA-256 of the lock file of this build, in hexadecimal.
///
/// ```
/// let sum = palpate_verify::components::lock_sha256();
/// assert!(sum.len() == 64 && sum.chars().all(|digit| digit.is_ascii_hexdigit()));
/// ```
pub fn lock_sha256() -> String {
    palpate_conform::sha256(LOCK)
}

/// A crate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Component {
    /// Its name in the registry.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Its licence, an SPDX expression; `None` where nothing states it, as in the lock file.
    #[serde(skip_deserializing)]
    pub licence: Option<String>,
    /// SHA-256 of its package, in hexadecimal; `None` for a member of this workspace.
    #[serde(rename(deserialize = "checksum"))]
    pub sha256: Option<String>,
}

/// The components in the bill of materials that `cargo cyclonedx` wrote for the program.
///
/// # Errors
/// A line that names the file and what is wrong with it: that it is no bill of materials in CycloneDX's JSON, or that it lists a
/// component that this build's lock file does not hold with the same version and checksum.
pub fn bill_of_materials(path: &Path) -> Result<Vec<Component>, String> {
    let shown = path.display();
    let bill: Value = json(path)?;
    let listed = bill["components"].as_array();
    let listed = listed.filter(|listed| bill["bomFormat"] == "CycloneDX" && !listed.is_empty());
    let listed =
        listed.ok_or_else(|| format!("{shown}: this is no CycloneDX bill of materials in JSON"))?;
    let locked = locked();
    let component = |entry: &Value| {
        let text = |pointer: &str| Some(entry.pointer(pointer)?.as_str()?.to_string());
        let component = Component {
            name: text("/name").unwrap_or_default(),
            version: text("/version").unwrap_or_default(),
            licence: text("/licenses/0/expression").or_else(|| text("/licenses/0/license/id")),
            sha256: text("/hashes/0/content"),
        };
        let known = locked.iter().any(|known| {
            (&known.name, &known.version, &known.sha256)
                == (&component.name, &component.version, &component.sha256)
        });
        known.then_some(component).ok_or_else(|| {
            let [name, version] = ["name", "version"].map(|key| &entry[key]);
            format!("{shown}: this build's Cargo.lock does not hold {name} {version} with this checksum; write a new bill of materials")
        })
    };
    listed.iter().map(component).collect()
}

/// All packages of the lock file: those of the program, of its tests and of its tools.
pub fn locked() -> Vec<Component> {
    #[derive(Deserialize)]
    struct Lock {
        package: Vec<Component>,
    }
    let lock: Lock = toml::from_str(LOCK).expect("cargo's own file");
    lock.package
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_the_lock_file() {
        let output = std::process::Command::new("sha256sum")
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.lock"))
            .output()
            .expect("sha256sum is part of every Linux");
        let printed = String::from_utf8(output.stdout).expect("hexadecimal");
        assert_eq!(printed.split_whitespace().next(), Some(&*lock_sha256()));
    }

    #[test]
    fn the_lock_file_has_a_version_of_every_package_and_a_checksum_of_every_crate() {
        let locked = locked();
        assert!(locked.len() > 200, "{}", locked.len());
        let (crates, members): (Vec<_>, Vec<_>) =
            locked.iter().partition(|package| package.sha256.is_some());
        assert!(crates.iter().any(|package| package.name == "libm"));
        let is_ours = |member: &&Component| member.name.starts_with("palpate");
        assert!(members.iter().all(is_ours), "{members:?}");
        let is_named =
            |package: &Component| !package.name.is_empty() && !package.version.is_empty();
        assert!(locked.iter().all(is_named));
    }

    #[test]
    fn a_bill_of_materials_lists_what_the_lock_file_holds_or_is_refused() {
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        let with = |text: &str| {
            std::fs::write(&path, text).unwrap();
            bill_of_materials(&path)
        };
        let locked = locked();
        let mut crates = locked.iter();
        let libm = crates.find(|package| package.name == "libm").unwrap();
        let entry = serde_json::json!({
            "name": libm.name,
            "version": libm.version,
            "hashes": [{"alg": "SHA-256", "content": libm.sha256}],
            "licenses": [{"expression": "MIT"}],
        });
        let bill = serde_json::json!({"bomFormat": "CycloneDX", "components": [entry]}).to_string();
        let mut expected = libm.clone();
        expected.licence = Some("MIT".into());
        assert_eq!(with(&bill), Ok(vec![expected]));
        for (from, to, found) in [
            ("CycloneDX", "SPDX", "this is no CycloneDX"),
            ("\"components\"", "\"parts\"", "this is no CycloneDX"),
            (&*libm.version, "0.0.1", "does not hold \"libm\" \"0.0.1\""),
            (libm.sha256.as_deref().unwrap(), "0123", "does not hold"),
            ("\"libm\"", "7", "does not hold 7"),
            ("{", "", "trailing characters"),
        ] {
            let error = with(&bill.replacen(from, to, 1)).unwrap_err();
            assert!(error.starts_with(&path.display().to_string()), "{error}");
            assert!(error.contains(found), "{error}");
        }
    }
}
