//! Simulations give the same for any split of the work.

use palpate::detect::DetectError;
use palpate::detect::simulate::Simulation;
use palpate::force::Force;
use palpate::stats::random::Generator;

const TEMPLATE: Force<&[f64]> = Force::new(&[0.3, -0.2, 0.1], &[0.2, 0.4, 0.2]);
const F0: Force<&[f64]> = Force::new(&[0.0, 0.1, 0.0], &[1.5, 1.4, 1.5]);
const NOISE_SD: Force<f64> = Force::new(0.2, 0.3);

fn simulation() -> Simulation<'static> {
    Simulation::new(F0, TEMPLATE, NOISE_SD, Generator::new(4, 5)).unwrap()
}

// Verifies: DET-111, DET-113.
#[test]
fn trials_are_the_same_in_any_order_and_on_any_thread() {
    let theta = |trial: u64| simulation().trial(trial, F0, &mut [0.0; 6]).unwrap().theta;
    // One scratch for all: nothing of a trial may leak into the next.
    let mut scratch = [f64::NAN; 6];
    let forwards = (0..1000).map(|trial| simulation().trial(trial, F0, &mut scratch));
    let forwards: Vec<f64> = forwards.map(|found| found.unwrap().theta).collect();
    let mut backwards: Vec<f64> = (0..1000).rev().map(theta).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    for threads in [2, 3, 7] {
        let threaded: Vec<f64> = std::thread::scope(|scope| {
            let part = |part: u64| {
                let range = 1000 * part / threads..1000 * (part + 1) / threads;
                scope.spawn(move || range.map(theta).collect::<Vec<_>>())
            };
            let parts: Vec<_> = (0..threads).map(part).collect();
            let joined = parts.into_iter().flat_map(|part| part.join().unwrap());
            joined.collect()
        });
        assert_eq!(threaded, forwards);
    }
}

// Verifies: DET-113.
#[test]
fn a_record_is_the_force_and_the_deviates_of_its_trial() {
    let mut residual = [0.0; 6];
    let found = simulation().trial(77, F0, &mut residual).unwrap();
    let generator = Generator::new(4, 5);
    for i in 0..3 {
        // F_0 + s n − F_0, with two roundings at 1.5 N.
        let lateral = 0.2 * generator.normal(77, i as u64);
        let normal = 0.3 * generator.normal(77, 3 + i as u64);
        assert!((residual[i] - lateral).abs() < 4.0 * f64::EPSILON);
        assert!((residual[3 + i] - normal).abs() < 4.0 * f64::EPSILON);
    }
    let (x, y) = residual.split_at(3);
    let judged = simulation().filter().statistic(Force::new(x, y));
    assert_eq!(judged, Ok(found));
}

// Verifies: DET-005.
#[test]
fn simulations_that_cannot_be_are_refused() {
    let generator = Generator::new(1, 2);
    let short = Force::new(&F0.lateral[..2], F0.normal);
    assert!(Simulation::new(short, TEMPLATE, NOISE_SD, generator).is_err());
    let bad = Force::new(&[0.0, f64::NAN, 0.0][..], F0.normal);
    let found = Simulation::new(bad, TEMPLATE, NOISE_SD, generator).unwrap_err();
    let (what, index) = ("f0_x", 1);
    assert_eq!(found, DetectError::NotFinite { what, index });
    assert!(simulation().trial(0, short, &mut [0.0; 6]).is_err());
    assert!(simulation().trial(0, bad, &mut [0.0; 6]).is_err());
    assert!(simulation().trial(0, F0, &mut [0.0; 5]).is_err());
}
