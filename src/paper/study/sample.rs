//! One sample of a study: the phantoms with the sample's inputs, their forces, and what follows from them.

use serde::{Deserialize, Serialize};

use super::design::{Design, Role};
use super::{NOISE_SD, PROBE_DEPTH, StudyPlan};
use crate::psychophysics::bridge::{Convention, p_values};
use crate::psychophysics::{AnswerTable, FEM_PLAYBACK};
use crate::settings::Settings;
use palpate::bank::deepest;
use palpate::decimal::mm;
use palpate::detect::{MatchedFilter, error_rates, map_threshold, two_afc};
use palpate::fem::certify::MESH_RATIOS;
use palpate::fem::{FemError, Model};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable, peak};
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;

/// What is computed of each sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// The name of its phantom; empty for one that comes of several.
    pub phantom: String,
    /// What it is.
    #[serde(flatten)]
    pub kind: Kind,
}

/// A kind of quantity, named with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "quantity")]
pub enum Kind {
    /// The normal force at a lateral position, N.
    NormalForceN {
        /// The position, m.
        lateral_m: f64,
    },
    /// The lateral force at a lateral position, N.
    LateralForceN {
        /// The position, m.
        lateral_m: f64,
    },
    /// F_1 − F_0 of the normal force where it is largest in magnitude, N.
    PeakNormalN,
    /// F_1 − F_0 of the lateral force where it is largest in magnitude, N.
    PeakLateralN,
    /// γ of the sweep.
    Gamma,
    /// The standard deviation of the noise of a sample at which both error rates are just kept, N.
    NeededNoiseSdN,
    /// Pr(e) of the maximum a-posteriori rule.
    ErrorRate,
    /// The predicted share of right answers in pairs, by the whole sweep.
    TwoAfc,
    /// The same by the peak of the normal signal alone, which is what the paper predicts from.
    TwoAfcByPeak,
    /// The depth of the inclusion, m, beyond which the error rates are not kept: 0 if they are kept for none of the phantoms, and the
    /// depth of the deepest one if for all.
    DetectableDepthM,
    /// The p-value of a convention: that what it takes of the force explains the answers of the paper's Table 1, FEM playback.
    ConventionP {
        /// The convention in words.
        convention: String,
    },
}

/// The quantities of each signal, with their words.
const OF_SIGNAL: [(Kind, &str); 7] = [
    (Kind::PeakNormalN, "peak of the normal signal, N"),
    (Kind::PeakLateralN, "peak of the lateral signal, N"),
    (Kind::Gamma, "γ"),
    (Kind::NeededNoiseSdN, "largest noise, N"),
    (Kind::ErrorRate, "Pr(e)"),
    (Kind::TwoAfc, "right answers in pairs"),
    (Kind::TwoAfcByPeak, "right answers in pairs, by the peak"),
];

/// Computes the samples of a study.
///
/// Implements: STU-030.
#[derive(Debug)]
pub struct Sampler<'a> {
    plan: &'a StudyPlan,
    design: Design,
    quantities: Vec<Quantity>,
    answers: AnswerTable,
    /// The γ that both error rates need.
    needed: f64,
}

/// What the phantoms of one sample give.
struct Computed {
    maps: Vec<ForceMap>,
    /// F_1 − F_0 of each map but the reference's.
    signals: Vec<ForceTable>,
    /// Those of the plan, with the noise of the sample.
    settings: Settings,
    /// γ of each map but the reference's.
    gamma: Vec<f64>,
    /// The depth of the inclusions of each of them, m.
    depths: Vec<f64>,
    /// The p-value of each convention.
    p_values: Vec<f64>,
}

impl<'a> Sampler<'a> {
    /// The samples of a plan.
    ///
    /// # Errors
    /// As [`StudyPlan::design`].
    pub fn new(plan: &'a StudyPlan) -> Result<Sampler<'a>, Refusal> {
        let answers = AnswerTable::paper()?;
        let design = plan.design()?;
        let quantities = quantities(plan, &answers);
        Ok(Sampler {
            plan,
            design,
            quantities,
            answers,
            needed: plan.settings.required_gamma()?,
        })
    }

    /// What is varied, and what is computed.
    pub fn plan(&self) -> &StudyPlan {
        self.plan
    }

    /// Which samples there are.
    pub fn design(&self) -> &Design {
        &self.design
    }

    /// What is computed of each sample, in this order.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// The values of the inputs in the sample with a number.
    ///
    /// Implements: STU-012.
    pub fn inputs(&self, index: usize) -> Vec<f64> {
        let probabilities = self.design.probabilities(index);
        let inputs = self.plan.inputs.iter().zip(probabilities);
        let values = inputs.map(|(input, p)| input.distribution.quantile(p));
        values.collect()
    }

    /// The quantities of the sample with a number.
    ///
    /// # Errors
    /// What could not be computed, and why: inputs that make no phantom, a pose that the probe cannot take, a solver that failed, a number
    /// that is not finite. The study counts it.
    ///
    /// Implements: STU-030, STU-031, STU-032.
    pub fn sample(&self, index: usize) -> Result<Vec<f64>, Refusal> {
        let computed = self.computed(index)?;
        let value = |quantity: &Quantity| {
            let named = |phantom: &Phantom| phantom.name() == quantity.phantom;
            let at = self.plan.all_phantoms().position(named).unwrap_or(0);
            let value = computed.value(&quantity.kind, at, self.needed)?;
            if !value.is_finite() {
                let key = quantity.to_string();
                return Err(Refusal::value(key, value, "a finite number"));
            }
            Ok(value)
        };
        self.quantities.iter().map(value).collect()
    }

    fn computed(&self, index: usize) -> Result<Computed, Refusal> {
        let mesh = match self.design.role(index) {
            Role::Median(mesh) => MESH_RATIOS[..mesh].iter().product(),
            _ => 1.0,
        };
        let values = self.inputs(index);
        let of_study = |key: &str, own: f64| {
            let inputs = self.plan.inputs.iter().zip(&values);
            let of_key = inputs.filter(|(input, _)| input.key == key);
            of_key.fold(own, |own, (input, &value)| input.change.of(own, value))
        };
        let depth = 1e-3 * of_study(PROBE_DEPTH, 1e3 * self.plan.probe_depth);
        let mut settings = self.plan.settings;
        settings.noise_sd_n = of_study(NOISE_SD, settings.noise_sd_n);
        let noise_sd = settings.noise_sd_n;
        let wrong = Refusal::value(NOISE_SD, noise_sd, "above 0 N in each sample");
        wrong.when(noise_sd.is_nan() || noise_sd <= 0.0)?;
        let (mut maps, mut depths) = (Vec::new(), Vec::new());
        for (at, own) in self.plan.all_phantoms().enumerate() {
            let solved = self.solved(own, &values, mesh * self.plan.mesh_size, depth);
            let of_phantom =
                |error| Refusal::state(error, "").of_part(&format!("phantom {}", own.name()));
            let (map, inclusion) = solved.map_err(of_phantom)?;
            maps.push(map);
            depths.extend(inclusion.filter(|_| at > 0));
        }
        let names = compared(self.plan, &self.answers).into_iter();
        let compared: Vec<_> = names.map(|(at, name)| (name, &maps[1 + at])).collect();
        let p_values = match compared.len() {
            0 | 1 => Vec::new(),
            _ => p_values(&self.answers, FEM_PLAYBACK, &maps[0], &compared)?,
        };
        let signals = maps[1..].iter().map(|map| map.signal(&maps[0]));
        let signals: Vec<ForceTable> = signals.collect::<Result<_, _>>()?;
        let gamma = signals.iter().map(|signal| {
            let noise_sd = Force::new(settings.noise_sd_n, settings.noise_sd_n);
            let filter = MatchedFilter::new(signal.row(depth)?, noise_sd)?;
            Ok(filter.gamma())
        });
        let gamma = gamma.collect::<Result<_, Refusal>>()?;
        Ok(Computed {
            maps,
            signals,
            settings,
            gamma,
            depths,
            p_values,
        })
    }

    /// The sweep at `depth` (m) over a phantom with the values of the inputs, on a mesh of a size (m), and how deep its inclusion lies (m).
    fn solved(
        &self,
        phantom: &Phantom,
        values: &[f64],
        mesh_size: f64,
        depth: f64,
    ) -> Result<(ForceMap, Option<f64>), FemError> {
        let phantom = self.plan.changed(phantom, values)?;
        let model = Model::new(&phantom, mesh_size, self.plan.contact)?;
        let map = model.sweep(&[depth], &self.plan.laterals)?;
        Ok((map, phantom.inclusion_depth()))
    }
}

impl Computed {
    /// A quantity of the phantom with a number, where both error rates need the γ `needed`. The plan, whose noise is not the sample's, is out
    /// of reach.
    ///
    /// Implements: STU-031.
    fn value(&self, kind: &Kind, at: usize, needed: f64) -> Result<f64, Refusal> {
        let map = &self.maps[at];
        let laterals = map.table().laterals();
        let place = |lateral: f64| laterals.iter().position(|&x| x == lateral).unwrap_or(0);
        let peak_of = |pick: fn(Force<&[f64]>) -> &[f64]| -> Result<f64, Refusal> {
            let signal = &self.signals[at - 1];
            let (force, _) = peak(laterals, pick(signal.row(signal.depths()[0])?));
            Ok(force)
        };
        let gamma = || self.gamma[at - 1];
        let row = map.table().row(map.table().depths()[0])?;
        Ok(match kind {
            Kind::NormalForceN { lateral_m } => row.normal[place(*lateral_m)],
            Kind::LateralForceN { lateral_m } => row.lateral[place(*lateral_m)],
            Kind::PeakNormalN => peak_of(|signal| signal.normal)?,
            Kind::PeakLateralN => peak_of(|signal| signal.lateral)?,
            Kind::Gamma => gamma(),
            Kind::NeededNoiseSdN => gamma() * self.settings.noise_sd_n / needed,
            Kind::ErrorRate => {
                let prior = self.settings.prior_h1;
                let rates = error_rates(gamma(), map_threshold(prior)?)?;
                prior * rates.miss + (1.0 - prior) * rates.false_alarm
            }
            Kind::TwoAfc => two_afc(gamma())?,
            Kind::TwoAfcByPeak => {
                let peak = peak_of(|signal| signal.normal)?.abs();
                two_afc(peak / self.settings.noise_sd_n)?
            }
            Kind::DetectableDepthM => {
                let mut pairs: Vec<_> = self.depths.iter().zip(&self.gamma).collect();
                pairs.sort_by(|a, b| a.0.total_cmp(b.0));
                let (depths, gamma): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
                deepest(&depths, &gamma, needed).unwrap_or(0.0)
            }
            Kind::ConventionP { convention } => {
                let mut named = Convention::all().zip(&self.p_values);
                let named = named.find(|(of, _)| of.text() == *convention);
                named.map_or(f64::NAN, |(_, &p)| p)
            }
        })
    }
}

/// Lateral positions at which the peak of a signal differs from its mean, also of a symmetric one.
const LEAST_POSITIONS: usize = 3;

/// The phantoms whose names are columns of the paper's Table 1, if each convention has a signal over the sweep: their places and names.
///
/// Implements: STU-031.
fn compared<'a>(plan: &'a StudyPlan, answers: &AnswerTable) -> Vec<(usize, &'a str)> {
    let phantoms = plan.phantoms.iter().enumerate();
    let is_column = |name: &str| answers.inclusions().iter().any(|of| of.name == name);
    let is_sweep = plan.laterals.len() >= LEAST_POSITIONS;
    let compared = phantoms.filter(|(_, phantom)| is_sweep && is_column(phantom.name()));
    compared.map(|(at, phantom)| (at, phantom.name())).collect()
}

/// Implements: STU-031.
fn quantities(plan: &StudyPlan, answers: &AnswerTable) -> Vec<Quantity> {
    let mut quantities = Vec::new();
    let mut push = |phantom: &str, kind: Kind| {
        let phantom = phantom.into();
        quantities.push(Quantity { phantom, kind });
    };
    for (at, phantom) in plan.all_phantoms().enumerate() {
        let name = phantom.name();
        for &lateral_m in &plan.laterals {
            push(name, Kind::NormalForceN { lateral_m });
            push(name, Kind::LateralForceN { lateral_m });
        }
        if at > 0 {
            OF_SIGNAL.into_iter().for_each(|(kind, _)| push(name, kind));
        }
    }
    let phantoms = plan.phantoms.iter();
    let depths: Vec<_> = phantoms.filter_map(Phantom::inclusion_depth).collect();
    let is_apart = |&depth: &f64| depths.iter().filter(|&&other| other == depth).count() == 1;
    if depths.len() == plan.phantoms.len() && depths.len() > 1 && depths.iter().all(is_apart) {
        push("", Kind::DetectableDepthM);
    }
    if compared(plan, answers).len() > 1 {
        for convention in Convention::all().map(Convention::text) {
            push("", Kind::ConventionP { convention });
        }
    }
    quantities
}

impl std::fmt::Display for Quantity {
    /// In words, with the unit.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let what = match &self.kind {
            Kind::NormalForceN { lateral_m: x } => format!("normal force at {} mm, N", mm(*x)),
            Kind::LateralForceN { lateral_m: x } => format!("lateral force at {} mm, N", mm(*x)),
            Kind::DetectableDepthM => "detectable depth, m".into(),
            Kind::ConventionP { convention } => format!("p of the convention \"{convention}\"",),
            of_signal => {
                let named = OF_SIGNAL.iter().find(|(kind, _)| kind == of_signal);
                named.map_or("", |(_, words)| words).into()
            }
        };
        let of = match &*self.phantom {
            "" => what,
            phantom => format!("{phantom}: {what}"),
        };
        f.pad(&of)
    }
}
