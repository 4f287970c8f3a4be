//! What a run found: numbers, figures and a page to read (`spec/report.md`).
//!
//! [`findings`] turns force maps into plain numbers, [`figures`] into pictures, and [`mod@html`] and
//! [`summary_json`] put them into files. Nothing here solves anything, and nothing depends on the date or the
//! machine: the same [`Run`] gives the same bytes.
//!
//! | file | content |
//! |---|---|
//! | `paper.rs` | the numbers that the paper prints |
//! | `maps.rs` | what each map says: signal, signal-to-noise ratios, thresholds |
//! | `gamma.rs` | γ of the matched filter |
//! | `hand.rs` | what is left of γ where a hand tracks the path |
//! | `nuisances.rs` | what is left of γ where more is unknown than the noise |
//! | `findings.rs` | what the run found, all together |
//! | `inputs.rs` | what a study says of the inputs' uncertainty |
//! | `theories.rs` | what finite strain and friction change |
//! | `people.rs` | the subjects of Table 1, and the bridge from forces to their answers |
//! | `quality.rs` | certificates in short, warnings |
//! | `comparison.rs` | "paper, here, why" |
//! | `figures/` | the paper's figures, the signals, as SVG |
//! | `html/`, `summary.rs` | the page, the JSON |
//! | `text.rs` | untrusted names in markup and file names; numbers as text |
//!
//! ```
//! use palpate::fem::{Contact, Model, Pose};
//! use palpate::phantom::Phantom;
//! use palpate_paper::report::{DeformedMesh, Settings, Run, figures, findings, html, summary_json};
//!
//! let model = |name| -> Result<Model, Box<dyn std::error::Error>> {
//!     Ok(Model::new(&Phantom::builtin(name)?, 2e-3, Contact::default())?)
//! };
//! let (gel, inclusion) = (model("none")?, model("6.6")?);
//! let (depths, laterals) = ([2e-3, 4e-3], [-5e-3, 0.0, 5e-3]);
//! let run = Run {
//!     reference: gel.map(&depths, &laterals, &|_| true)?,
//!     maps: vec![inclusion.map(&depths, &laterals, &|_| true)?],
//!     measured: vec![],
//!     changes: None,
//!     deformed: DeformedMesh::solve(&inclusion, Pose { depth: 4e-3, lateral: 0.0 })?,
//!     settings: Settings::default(),
//!     study: None,
//!     theories: vec![],
//! };
//! let findings = findings(&run)?;
//! assert!(findings.maps[0].gamma.both > 1.0);
//! let figures = figures(&run, &findings)?;
//! let page = html(&run, &findings, &figures);
//! assert!(page.contains("<svg") && summary_json(&findings, &run).contains("\"gamma\""));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod comparison;
mod figures;
mod findings;
mod gamma;
mod hand;
pub mod html;
mod inputs;
mod maps;
mod nuisances;
pub mod paper;
mod people;
mod quality;
mod summary;
#[cfg(test)]
mod tests;
pub mod text;
mod theories;

pub use comparison::{Comparison, Value};
pub use figures::figures;
pub use findings::{Findings, findings};
pub use gamma::GammaByChannel;
pub use hand::GammaOfHand;
pub use html::html;
pub use inputs::check_study;
pub use maps::{Detection, MapFindings, Peak, ReferenceFindings, Threshold};
pub use nuisances::{GammaBeside, GammaLeft};
use people::normal_approximation;
pub use quality::Quality;
pub use summary::summary_json;
pub use text::FileNames;
pub use theories::{Explanation, TemplateUse, TemplateUseAtDepth, TheoryFindings};

pub use crate::settings::Settings;
use crate::study::StudyResults;
use palpate::fem::element::CORNERS;
use palpate::fem::mesh::Region;
use palpate::fem::{FemError, Model, Pose};
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate::robust::GelChanges;

/// The version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Everything that a run computed.
#[derive(Debug, Clone)]
pub struct Run {
    /// Reference map F_0 of the phantom without inclusion.
    pub reference: ForceMap,
    /// Maps F_1 of the phantoms with inclusion, over the same poses as the reference. Any number, any names.
    pub maps: Vec<ForceMap>,
    /// Measured maps, shown as Figure 7. Any number, any poses; nothing is computed from them.
    pub measured: Vec<ForceMap>,
    /// What is uncertain of the reference's gel at the depth of the signals; none if that is not shown.
    pub changes: Option<GelChanges>,
    /// The deformed mesh of one pose (Figure 6).
    pub deformed: DeformedMesh,
    /// What the detector assumes.
    pub settings: Settings,
    /// A study of the same phantoms at the depth of the bridge: what their inputs' uncertainty does to the numbers.
    pub study: Option<StudyResults>,
    /// The same phantoms under several theories of the gel, to be compared; none if they are not.
    pub theories: Vec<Theory>,
}

/// The phantoms of a run under one theory of the gel.
#[derive(Debug, Clone)]
pub struct Theory {
    /// Reference map of the phantom without inclusion.
    pub reference: ForceMap,
    /// Maps of the phantoms with inclusion, over the same poses.
    pub maps: Vec<ForceMap>,
    /// The deformed mesh of one pose.
    pub deformed: DeformedMesh,
    /// d ln F_n / d ln ν of the normal force without inclusion at the probe depth and x = 0.
    pub poisson_leverage: Option<f64>,
}

impl Run {
    /// The reference, then the maps over its poses.
    pub fn reference_and_maps(&self) -> impl Iterator<Item = &ForceMap> {
        std::iter::once(&self.reference).chain(&self.maps)
    }
}

/// The mesh of one phantom under the probe. It comes from a solution alone, so that its parts fit one another.
#[derive(Debug, Clone, PartialEq)]
pub struct DeformedMesh {
    phantom: Phantom,
    pose: Pose,
    /// Region of each element, and where its corners are under the probe, m, counter-clockwise.
    elements: Vec<(Region, Vec<[f64; 2]>)>,
    /// The smallest det(I + ∇u) at this pose.
    min_det: f64,
}

impl DeformedMesh {
    /// The mesh of `model` with the probe at `pose`.
    ///
    /// # Errors
    /// As [`Model::solve`] and [`Model::field`].
    pub fn solve(model: &Model, pose: Pose) -> Result<DeformedMesh, FemError> {
        let solution = model.solve(pose)?;
        let mesh = model.mesh();
        let check = model.checks(std::slice::from_ref(&solution))?;
        let displacements = model.field(&solution)?.displacements;
        let place = |&node: &u32| {
            let ([x, y], [u, v]) = (mesh.nodes[node as usize], displacements[node as usize]);
            [x + u, y + v]
        };
        let corners = mesh.elements().map(|nodes| &nodes[..CORNERS]);
        let corners = corners.map(|nodes| nodes.iter().map(place).collect());
        Ok(DeformedMesh {
            phantom: model.phantom().clone(),
            pose,
            elements: mesh.regions.iter().copied().zip(corners).collect(),
            min_det: check[0].min_det,
        })
    }
}

/// Where on the page a figure stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topic {
    /// Phantom, probe, problem.
    Setup,
    /// Forces and signals.
    Forces,
    /// The detector.
    Detection,
    /// Small and finite strain.
    Theories,
    /// What uncertain inputs do.
    Inputs,
    /// The subjects of the paper.
    People,
}

/// One picture with the words that go with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// A name of ASCII letters, digits, `.`, `-` and `_`, unique in the run; ends in `.svg`.
    pub file_name: String,
    /// Where on the page it stands.
    pub topic: Topic,
    /// What it is; begins with the number of the paper's figure that it makes again. Plain text: it may hold a phantom's
    /// name, which markup must escape.
    pub title: String,
    /// What it shows, what the paper says, and what differs and why. Plain text.
    pub caption: String,
    /// The picture in words, for those who do not see it. Plain text.
    pub alt: String,
    /// A complete SVG document.
    pub svg: String,
}
