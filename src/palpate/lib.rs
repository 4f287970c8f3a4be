//! Inclusion probing after Yan, Scott and Fearing (1999): the force on a rigid probe that presses into a gel, the decision whether a hard
//! inclusion lies in it, and its playback to a hand. This crate is what computes: 20,500 lines of code, on
//! the core, [`palpate_core`], whose modules it exports. Read it in this order:
//!
//! | module | content | paper |
//! |---|---|---|
//! | [`detect`], [`stats`], [`force`] | signal detection, on the normal law; mostly of the core | §2 |
//! | [`phantom`] | gels, inclusions and the probe; their files | §3 |
//! | [`fem`] | finite elements and contact | §3.1 |
//! | [`force_map`] | force tables and their files | §3, §4 |
//! | [`trace`], [`rows`] | a recorded sweep against two of them; the answer, for programs and for people | |
//! | [`robust`] | the same, whatever gel, motion and sensor do to the forces | §2 |
//! | [`bank`], [`chart`] | inclusions of any place and size; the charts of both | §5 |
//! | [`calibration`] | a force–depth curve: contact, moduli, relaxation, noise | |
//! | [`servo`] | from a table to a force; the kernel is of the core | §4 |
//! | [`hid`] | the device, the loop, the simulated display; the reports are of the core | §4 |
//! | [`oracle`] | questions and answers for other implementations | |
//! | [`mod@file`], [`csv`], [`decimal`], [`journal`], [`refusal`], [`text`], [`version`] | what all of them use | |
//!
//! Lengths are metres, forces newtons, moduli pascals throughout; `spec/README.md` has the signs.
//!
//! From a phantom to forces, from forces to a decision and to what a hand would feel:
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use palpate::force::Force;
//! use palpate::detect::{Decision, decide, theta_of_record};
//! use palpate::fem::{Contact, Model};
//! use palpate::phantom::Phantom;
//! use palpate::servo::LoadedTable;
//!
//! // Force maps of the gel alone, and with an inclusion under 6.6 mm of it.
//! let laterals: Vec<f64> = (-5..=5).map(|k| 2e-3 * f64::from(k)).collect();
//! let map = |name| -> Result<_, Box<dyn std::error::Error>> {
//!     let model = Model::new(&Phantom::builtin(name)?, 2e-3, Contact::default())?;
//!     Ok(model.map(&[2e-3, 4e-3], &laterals, &|_| true)?)
//! };
//! let (without, with) = (map("none")?, map("6.6")?);
//!
//! // A sweep at 4 mm, as it would come without noise over the inclusion. Samples in noise of 0.1 N.
//! let (f0, f1) = (without.table().row(4e-3)?, with.table().row(4e-3)?);
//! let found = theta_of_record(f1, f0, f1, Force { lateral: 0.1, normal: 0.1 })?;
//! assert_eq!(decide(found.theta, 0.0)?, Decision::Inclusion);
//! assert!((found.theta - found.gamma.powi(2) / 2.0).abs() < 1e-9);
//!
//! // The force on a hand that probes there, 3 mm deep: between the forces at 2 and at 4 mm.
//! let loaded = LoadedTable::new(with.table())?;
//! let force = loaded.table().force(3e-3, 0.0);
//! let [shallow, deep] = [0, 1].map(|row| with.table().normal().row(row)[5] as f32);
//! assert!(shallow < force.normal && force.normal < deep);
//! # Ok(())
//! # }
//! ```

pub use palpate_core::force;

pub mod bank;
pub mod calibration;
pub mod chart;
pub mod csv;
pub mod decimal;
pub mod detect;
pub mod fem;
pub mod file;
pub mod force_map;
pub mod hid;
pub mod journal;
pub mod oracle;
pub mod phantom;
pub mod refusal;
pub mod robust;
pub mod rows;
pub mod servo;
pub mod simulation;
pub mod stats;
pub mod text;
pub mod trace;
pub mod version;
