//! Force maps as JSON (`spec/force-map.md`).

use serde::{Deserialize, Serialize};

use super::{Certificate, ForceMap, ForceTable, Matrix, Measurement, Source};
use crate::file::{check_schema, from_json, to_json};
use crate::phantom::{Phantom, PhantomParts};
use crate::refusal::Refusal;

/// What the key `schema` of a force map says.
///
/// Implements: MAP-020.
pub const SCHEMA: &str = "palpate-force-map";

/// The version of the schema that this program writes and reads.
///
/// Implements: MAP-020.
pub const SCHEMA_VERSION: u64 = 1;

/// The source as it stands in the file; the certificate stands beside it.
#[derive(Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum SourceKey {
    FiniteElements {},
    Measured(Measurement),
}

/// The file's keys, in the order in which they are written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    schema: String,
    schema_version: u64,
    program_version: String,
    source: SourceKey,
    phantom: Option<PhantomParts>,
    depths_m: Vec<f64>,
    laterals_m: Vec<f64>,
    normal_force_n: Matrix,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lateral_force_n: Option<Matrix>,
    certificate: Option<Certificate>,
}

impl ForceMap {
    /// This map as JSON, each row of a matrix on one line.
    ///
    /// Implements: MAP-020, MAP-022.
    pub fn to_json(&self) -> String {
        to_json(self)
    }

    /// The map in `text`, the content of `file`, which is named in errors alone.
    ///
    /// # Errors
    /// The text is not JSON, has another schema or a newer version, a missing, unknown or repeated key, or anything but a number
    /// in a number's place, or makes a map that [`ForceMap::new`] or [`ForceTable::new`] refuses; with the file, and the line
    /// where there is one.
    ///
    /// Implements: MAP-020, MAP-024, MAP-002, MAP-026, MAP-037.
    pub fn from_json(text: &str, file: &str) -> Result<ForceMap, Refusal> {
        let read = || {
            check_schema(text, SCHEMA, SCHEMA_VERSION)?;
            from_json::<Document>(text)?.try_into()
        };
        read().map_err(|refusal: Refusal| refusal.in_file(file))
    }
}

impl From<ForceMap> for Document {
    fn from(map: ForceMap) -> Document {
        let (source, certificate) = match map.source {
            Source::FiniteElements { certificate } => {
                (SourceKey::FiniteElements {}, Some(certificate))
            }
            Source::Measured(measurement) => (SourceKey::Measured(measurement), None),
        };
        Document {
            schema: SCHEMA.into(),
            schema_version: SCHEMA_VERSION,
            program_version: map.program_version,
            source,
            phantom: map.phantom.map(PhantomParts::from),
            depths_m: map.table.depths().into(),
            laterals_m: map.table.laterals().into(),
            normal_force_n: map.table.normal().clone(),
            lateral_force_n: map.table.lateral().cloned(),
            certificate,
        }
    }
}

impl TryFrom<Document> for ForceMap {
    type Error = Refusal;

    fn try_from(document: Document) -> Result<ForceMap, Refusal> {
        let source = match (document.source, document.certificate) {
            (SourceKey::FiniteElements {}, Some(certificate)) => {
                Source::FiniteElements { certificate }
            }
            (SourceKey::Measured(measurement), None) => Source::Measured(measurement),
            (SourceKey::FiniteElements {}, None) => {
                let expected = "give it with a map from finite elements";
                return Err(Refusal::state("certificate is missing", expected));
            }
            (SourceKey::Measured(_), Some(_)) => {
                let expected = "leave it out of a measured map";
                return Err(Refusal::state("certificate is there", expected));
            }
        };
        let table = ForceTable::of_channels(
            document.depths_m,
            document.laterals_m,
            document.normal_force_n,
            document.lateral_force_n,
        )?;
        let phantom = document
            .phantom
            .map(Phantom::new)
            .transpose()
            .map_err(|refusal| refusal.of_part("phantom"))?;
        ForceMap::of_version(document.program_version, source, phantom, table)
    }
}
