//! palpate for Python: `bindings/python/palpate.pyi` has the names, `spec/python.md` the rules.
//!
//! | file | content |
//! |---|---|
//! | `convert.rs` | errors, units, arrays, tables |
//! | `docs.rs` | sections of docstrings |
//! | `classes.rs`, `phantom.rs`, `map.rs` | phantoms and force maps |
//! | `detector.rs`, `decision.rs` | the detector: records, and what follows from θ |
//! | `batch.rs` | θ of many records |
//! | `bank.rs` | banks of inclusions |
//! | `reach.rs` | how deep and how small an inclusion may be |
//! | `import_map.rs` | measured forces at any poses |
//! | `watch.rs` | a sweep against a bank while it is taken |
//! | `calibration.rs` | force–depth curves |
//! | `psychophysics.rs` | counts of right answers |
//! | `servo.rs` | the servo kernel |
//! | `oracle.rs` | every operation of the oracle by name |
//!
//! Implements: PYT-002, PYT-009, PYT-046.

#[macro_use]
mod docs;

mod bank;
mod batch;
mod calibration;
mod classes;
mod convert;
mod decision;
mod detector;
mod import_map;
mod map;
mod oracle;
mod phantom;
mod psychophysics;
mod reach;
mod servo;
mod watch;

use pyo3::prelude::*;

/// The force on a probe that presses into a gel, the decision whether a hard inclusion lies in it, and its playback. Lengths are mm, moduli
/// kPa, forces N; arrays of both forces are lateral first. What is refused raises Refused, a ValueError, with one line.
#[pymodule]
mod palpate {
    use super::convert::python;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::bank::Bank;
    #[pymodule_export]
    use super::calibration::calibrate;
    #[pymodule_export]
    use super::classes::{ForceMap, Phantom};
    #[pymodule_export]
    use super::convert::Refused;
    #[pymodule_export]
    use super::decision::{
        auc, bayes_threshold, decide, error_rates, gamma_from_two_afc, map_threshold,
        neyman_pearson_false_alarm_threshold, neyman_pearson_miss_threshold, noise_budget,
        posterior, required_gamma, roc_miss, two_afc,
    };
    #[pymodule_export]
    use super::detector::{
        MatchedFilter, Statistic, bank_posterior, scan, simulate_theta, statistic, theta,
        theta_coloured, theta_nuisances,
    };
    #[pymodule_export]
    use super::import_map::import_map;
    #[pymodule_export]
    use super::oracle::ask;
    #[pymodule_export]
    use super::phantom::ProbeForce;
    #[pymodule_export]
    use super::psychophysics::{analyse_answers, count_analysis};
    #[pymodule_export]
    use super::reach::reach;
    #[pymodule_export]
    use super::servo::{Limits, Sample, ServoState, ServoTable, step};
    #[pymodule_export]
    use super::watch::Watcher;

    #[pymodule_init]
    fn init(module: &Bound<PyModule>) -> PyResult<()> {
        let build = ::palpate::version::Build::THIS;
        module.add("__version__", build.version)?;
        module.add("build", python(module.py(), &build)?)
    }
}
