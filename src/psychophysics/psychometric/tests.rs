//! Expected values: scipy, Nelder and Mead from 27 starts, and Brent's method (`reference.py`).

use super::*;
use crate::psychophysics::dispersion::overall_dispersion;
use crate::psychophysics::{Subject, Table};
use crate::stats::check::assert_near;

fn fitted(table: &Table, condition: usize) -> Option<Psychometric> {
    let condition = &table.conditions()[condition];
    let dispersion = overall_dispersion(condition, table.inclusions().len()).unwrap();
    let dispersion = dispersion.map(Overdispersion::from);
    psychometric(table.inclusions(), condition, dispersion).unwrap()
}

/// The golden section leaves ln s within 2 · 0.86 · 4·10⁻⁶ = 7·10⁻⁶, and with it m and λ, which move by less than 3 mm
/// and 0.1 for 1 of ln s; m by itself is within 2 · 1.3 mm · 4·10⁻⁶.
const OF_LENGTH: f64 = 5e-8;
const OF_LAPSE: f64 = 2e-6;

// Verifies: PSY-040, PSY-041, PSY-042.
#[test]
fn fits_of_table_1() {
    let table = Table::paper().unwrap();
    // Midpoint, spread (mm), lapse, deviance; for each parameter the ends, binomial and dispersed.
    for (condition, [midpoint, spread, lapse, deviance], ends) in [
        (
            0,
            [7.74500744, 2.46951371, 0.03225621, 0.1524763348321585],
            [
                [7.15452098617069, 8.335229662478492],
                [1.6778529457950633, 3.842789193931479],
                [0.0, 0.0650366615507864],
                [6.55394829536329, 9.277109050674452],
                [1.0706728176131655, 5.4209094834596305],
                [0.0, 0.1010487789060305],
            ],
        ),
        (
            1,
            [7.55886884, 2.10291766, 0.02584215, 2.42628961791695],
            [
                [7.103891398171133, 8.033207837740134],
                [1.421572952126431, 3.081611731717176],
                [0.0, 0.054849409737700874],
                [6.7426816241182905, 8.438275884460522],
                [1.0230577926942983, 3.7782608786706713],
                [0.0, 0.07662156191482597],
            ],
        ),
        (
            2,
            [5.60381255, 4.05806996, 0.0, 10.160874325978739],
            [
                [5.05570207997582, 7.526707459247028],
                [2.068416415261931, 5.394799663796417],
                [0.0, 0.14679076672760252],
                [4.6489548906971185, 8.355224143760363],
                [0.8675007281784124, 6.938642126670472],
                [0.0, 0.19841460666836233],
            ],
        ),
    ] {
        let found = fitted(&table, condition).unwrap();
        for (parameter, value, at, scale, tolerance) in [
            (found.midpoint, midpoint, 0, 1e-3, OF_LENGTH),
            (found.spread, spread, 1, 1e-3, OF_LENGTH),
            (found.lapse, lapse, 2, 1.0, OF_LAPSE),
        ] {
            assert_near(parameter.value, scale * value, tolerance);
            for (bounds, ends) in [
                (parameter.bounds, ends[at]),
                (parameter.dispersed_bounds, ends[at + 3]),
            ] {
                assert_near(bounds.lower.unwrap(), scale * ends[0], tolerance);
                assert_near(bounds.upper.unwrap(), scale * ends[1], tolerance);
            }
        }
        assert_near(found.deviance, deviance, 1e-7);
        assert_eq!(found.degrees, 1);
        // One degree of freedom: twice the normal tail.
        let tail = 2.0 * crate::stats::normal::upper_tail(deviance.sqrt()).unwrap();
        assert_near(found.p_value.unwrap(), tail, 1e-7);
    }
}

// φ of direct contact is (41.3194 + 47.3455 + 43.1060 + 22.2)/36 = 4.2770; scipy: f.sf(0.1524763/4.2769680, 1, 36).
// Verifies: PSY-034, PSY-043.
#[test]
fn dispersion_makes_deviances_smaller() {
    let table = Table::paper().unwrap();
    let (ratio, degrees) = overall_dispersion(&table.conditions()[0], 4)
        .unwrap()
        .unwrap();
    assert_near(ratio, 4.276968045639429, 1e-12);
    assert_eq!(degrees, 36);
    let p = fitted(&table, 0).unwrap().p_value_dispersed.unwrap();
    assert_near(p, 0.8512993614712892, 1e-6);
    // Never narrower than a binomial.
    assert_eq!(Overdispersion::from((0.5, 36)).factor, 1.0);
}

// Verifies: PSY-040, PSY-041.
#[test]
fn without_three_depths_or_wrong_answers_there_is_no_function() {
    let table = |header: &str, rows: &str| {
        Table::from_csv(&format!("subject,condition,trials,{header}\n{rows}"), "t").unwrap()
    };
    assert_eq!(
        fitted(&table("2,4", "1,x,30,30,20\n2,x,30,28,21\n"), 0),
        None
    );
    assert_eq!(
        fitted(&table("a 2,b 2,4", "1,x,30,30,29,20\n2,x,30,28,29,21\n"), 0),
        None
    );
    assert_eq!(
        fitted(&table("2,4,6", "1,x,30,30,30,30\n2,x,30,30,30,30\n"), 0),
        None
    );
    // Three depths leave no degree of freedom, and answers that do not fall set no bounds.
    let flat = fitted(&table("2,4,6", "1,x,30,25,25,26\n2,x,30,26,25,26\n"), 0).unwrap();
    assert_eq!((flat.degrees, flat.p_value), (0, None));
    assert_eq!(flat.midpoint.bounds.upper, None);
}

// Answers as the function has them are fitted by it, so that a midpoint taken for a threshold, or a spread for a slope,
// shows. Counts of 1000 trials are rounded: share to 5·10⁻⁴, and the parameters to some times that.
// Verifies: PSY-040.
#[test]
fn the_function_is_the_one_that_the_spec_states() {
    let depths = [2.0, 4.0, 5.0, 6.0, 8.0, 11.0];
    let (midpoint, spread, lapse) = (6.0, 2.0, 0.04);
    let inclusions: Vec<Inclusion> = depths
        .map(|depth| Inclusion {
            name: depth.to_string(),
            depth: depth * 1e-3,
        })
        .into();
    let right = depths.map(|depth| {
        let share = 0.5 + (0.5 - lapse) * lower_tail((midpoint - depth) / spread);
        (1000.0 * share).round() as u32
    });
    let subject = |name: &str| Subject {
        name: name.into(),
        trials: 1000,
        correct: right.into(),
    };
    let condition = Condition {
        name: "x".into(),
        subjects: vec![subject("1"), subject("2")],
    };
    let dispersion = Some(Overdispersion::from((1.0, 6)));
    let found = psychometric(&inclusions, &condition, dispersion)
        .unwrap()
        .unwrap();
    assert_near(found.midpoint.value, 1e-3 * midpoint, 2e-5);
    assert_near(found.spread.value, 1e-3 * spread, 4e-5);
    assert_near(found.lapse.value, lapse, 2e-3);
}
