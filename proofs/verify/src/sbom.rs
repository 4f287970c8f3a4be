//! The bill of materials: the components of the shipped program in CycloneDX 1.5, with the minimum elements of the NTIA.

use palpate::version::Build;
use palpate_conform::sha256;
use serde_json::{Value, json};

use super::supply::{Component, LOCK, Role};

/// The file `sbom.cdx.json` for components of this build, written at `time` (UTC); ends in a line feed.
///
/// Its serial number is made from commit and lock file, so that the same build has the same one.
pub fn sbom(components: &[Component], time: &str) -> String {
    let Build {
        version, commit, ..
    } = Build::THIS;
    let reference = |name: &str, version: &str| format!("pkg:cargo/{name}@{version}");
    let own = reference("palpate", version);
    let component = |component: &Component| {
        json!({
            "type": "library",
            "bom-ref": reference(component.name, &component.version),
            "supplier": {"name": format!("the maintainers of the crate {}", component.name)},
            "name": component.name,
            "version": component.version,
            "description": component.why,
            "scope": if component.role == Role::Program { "required" } else { "excluded" },
            "hashes": [{"alg": "SHA-256", "content": component.sha256}],
            "licenses": [{"expression": component.licence}],
            "purl": reference(component.name, &component.version),
        })
    };
    let needs = |component: &Component| {
        json!({
            "ref": reference(component.name, &component.version),
            "dependsOn": component.depends_on.iter().filter_map(|asked| found(components, asked)).map(|found| reference(found.name, &found.version)).collect::<Vec<_>>(),
        })
    };
    let all: Vec<String> = components
        .iter()
        .map(|component| reference(component.name, &component.version))
        .collect();
    let mut dependencies = vec![json!({"ref": own, "dependsOn": all})];
    dependencies.extend(components.iter().map(needs));
    let bom = json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": serial_number(commit),
        "version": 1,
        "metadata": {
            "timestamp": time,
            "authors": [{"name": "the palpate team"}],
            "supplier": {"name": "the palpate team"},
            "tools": {"components": [{"type": "application", "name": "palpate-verify", "version": version}]},
            "component": {
                "type": "application",
                "bom-ref": own,
                "name": "palpate",
                "version": version,
                "purl": own,
                "licenses": [{"expression": "MIT OR Apache-2.0"}],
                "properties": [{"name": "commit", "value": commit}],
            },
        },
        "components": components.iter().map(component).collect::<Vec<Value>>(),
        "dependencies": dependencies,
    });
    format!("{bom:#}\n")
}

/// The component that the lock file names, `name` or `name version`.
fn found<'a>(components: &'a [Component], asked: &str) -> Option<&'a Component> {
    let (name, version) = asked.split_once(' ').unwrap_or((asked, ""));
    components
        .iter()
        .find(|component| component.name == name && component.version.starts_with(version))
}

/// A UUID of version 8 from the commit and the lock file.
fn serial_number(commit: &str) -> String {
    let mut hex = sha256([commit, LOCK].concat());
    hex.replace_range(12..13, "8");
    hex.replace_range(16..17, "8");
    format!(
        "urn:uuid:{}-{}-{}-{}-{}",
        &hex[..8],
        &hex[8..12],
        &hex[12..16],
        &hex[16..20],
        &hex[20..32]
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::supply::components;

    #[test]
    fn every_component_has_the_minimum_elements_and_every_dependency_is_there() {
        let components = components().unwrap();
        let bom: Value = serde_json::from_str(&sbom(&components, "2026-11-23T18:00:00Z")).unwrap();
        assert_eq!(bom["metadata"]["timestamp"], "2026-11-23T18:00:00Z");
        for key in ["authors", "supplier"] {
            assert!(!bom["metadata"][key].is_null(), "{key}");
        }
        let serial = bom["serialNumber"].as_str().unwrap();
        let form = serial.strip_prefix("urn:uuid:").unwrap();
        let lengths: Vec<usize> = form.split('-').map(str::len).collect();
        assert_eq!(
            (lengths, &form[14..15], &form[19..20]),
            (vec![8, 4, 4, 4, 12], "8", "8")
        );
        let listed = bom["components"].as_array().unwrap();
        assert_eq!(listed.len(), components.len());
        let references: Vec<&Value> = listed
            .iter()
            .map(|component| &component["bom-ref"])
            .collect();
        for component in listed {
            for key in ["supplier", "name", "version", "hashes", "licenses", "purl"] {
                assert!(!component[key].is_null(), "{key} of {component}");
            }
        }
        let dependencies = bom["dependencies"].as_array().unwrap();
        assert_eq!(dependencies.len(), components.len() + 1);
        let needed = dependencies
            .iter()
            .flat_map(|row| row["dependsOn"].as_array().unwrap());
        assert!(needed.clone().count() > components.len());
        for needed in needed {
            assert!(references.contains(&needed), "{needed}");
        }
        let asked: usize = components
            .iter()
            .map(|component| component.depends_on.len())
            .sum();
        assert_eq!(needed_count(dependencies), asked);
    }

    /// The dependencies of the components, without those of the program itself.
    fn needed_count(dependencies: &[Value]) -> usize {
        dependencies[1..]
            .iter()
            .map(|row| row["dependsOn"].as_array().unwrap().len())
            .sum()
    }
}
