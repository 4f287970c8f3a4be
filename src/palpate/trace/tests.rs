use super::*;
use crate::force_map::{Hypotheses, Matrix};
use palpate_asserts::{assert_cases, assert_error};

mod judge;
mod path;
mod relations;

const EXAMPLE: &str = "position_mm,lateral_force_n,normal_force_n\n-1,0.25,1.5\n0.5,-0.5,1.25\n";

fn read(text: &str) -> Result<Record, String> {
    let trace = Trace::from_csv(text, "t.csv").map_err(|error| error.to_string())?;
    trace.record(None).map_err(|error| error.to_string())
}

/// A table at depths 1 and 3 mm over −3 … 3 mm by 1 mm: normal force 1 N, lateral 0.1 N, and with
/// `signal` times a bump at x = 0.
fn table(signal: f64) -> ForceTable {
    let laterals: Vec<f64> = (-3..=3).map(|k| f64::from(k) / 1e3).collect();
    let normal = [0.0, 0.125, 0.5, 1.0, 0.5, 0.125, 0.0];
    let lateral = [0.0, 0.25, 0.5, 0.0, -0.5, -0.25, 0.0];
    let matrix = |base: f64, bump: [f64; 7]| {
        let at = |row, column: usize| base + signal * (row + 1) as f64 * bump[column];
        Matrix::from_fn(2, 7, at)
    };
    let forces = Force::new(matrix(0.1, lateral), matrix(1.0, normal));
    ForceTable::new(vec![0.001, 0.003], laterals, forces).unwrap()
}

// Verifies: TRC-001.
#[test]
fn columns_units_and_lines() {
    let expected = read(EXAMPLE).unwrap();
    assert_eq!(expected.positions(), [-0.001, 0.0005]);
    assert_eq!(expected.forces().lateral, [0.25, -0.5]);
    assert_eq!(expected.forces().normal, [1.5, 1.25]);
    let same = [
        "\u{feff}# pass 3\r\n\r\nposition_mm , lateral_force_n,normal_force_n\r\n -1,0.25 ,1.5\r\n #\r\n0.5,-0.5,1.25",
        "normal_force_mn,position_m,lateral_force_mn\n1500,-1e-3,250\n1250,0.0005,-500\n",
    ];
    for text in same {
        let record = read(text).unwrap();
        assert_eq!(record.positions(), expected.positions());
        assert_eq!(record.forces(), expected.forces());
    }
}

// Verifies: TRC-001, TRC-004, TRC-008.
#[test]
fn malformed_traces_are_refused_with_their_line() {
    assert_cases("refused/trace.txt", "records", |text| {
        read(&text.replace("HEAD", EXAMPLE.lines().next().unwrap())).unwrap_err()
    });
}

// Verifies: TRC-001, TRC-004, TRC-010.
#[test]
fn positions_of_an_encoder_are_taken() {
    let positions = |rows: &str| {
        let row = |position| format!("9,{position},0,1\n");
        let rows = rows.split(' ').map(row);
        let head = "time_s,position_mm,lateral_force_n,normal_force_n\n";
        let trace = Trace::from_csv(&(head.to_string() + &rows.collect::<String>()), "t.csv")?;
        assert_eq!(trace.abscissa(), Abscissa::Position);
        assert_eq!(trace.notes(), ["column \"time_s\" is not used"]);
        Ok::<_, Refusal>(trace.record(None)?.positions().to_vec())
    };
    for (rows, expected) in [
        // Rounded to 1 mm; with jitter of 0.5 mm of 10 mm, the most that is allowed; at rest.
        ("-1 -1 0 0 1 1", &[-1e-3, -1e-3, 0.0, 0.0, 1e-3, 1e-3][..]),
        ("0 4.5 4 10 9.5", &[0.0, 4.5e-3, 4e-3, 10e-3, 9.5e-3]),
        ("2 2 2", &[2e-3, 2e-3, 2e-3]),
        ("2", &[2e-3]),
        // Towards −x.
        ("10 5 5.5 0", &[0.0, 5.5e-3, 5e-3, 10e-3]),
        ("1 0", &[0.0, 1e-3]),
    ] {
        assert_eq!(positions(rows).unwrap(), expected, "{rows}");
    }
    // The last two creep back in steps of which each is jitter.
    let wrong = "0 4.51 4 10|10 5 5.51 0|-1e308 1e308 -1e308|0 10 0|0 5 4.7 4.4 10|10 5 5.3 5.6 0";
    for rows in wrong.split('|') {
        assert!(positions(rows).is_err(), "{rows}");
    }
}

// Forces that grow with the depth, each channel at its own rate.
// Verifies: TRC-060.
#[test]
fn nuisances_have_the_forces_of_their_channels() {
    let rate = Force::new([100.0, -200.0, 300.0], [500.0, 700.0, 900.0]);
    let forces = |depth: f64| rate.map(|rate| rate.map(|rate| depth * rate).to_vec());
    let unknown = [Unknown::Offset, Unknown::Gain, Unknown::Depth];
    let found = nuisances(&unknown, &[1e-3, 3e-3], 2e-3, |depth| Ok(forces(depth))).unwrap();
    let [one, other, gain, depth] = &found[..] else {
        panic!("{found:?}")
    };
    let alone = |lateral, normal| Force::new(vec![lateral; 3], vec![normal; 3]);
    assert_eq!([one, other], [&alone(1.0, 0.0), &alone(0.0, 1.0)]);
    assert_eq!(*gain, forces(2e-3));
    for (found, rate) in depth.as_deref().zip(rate).into_array() {
        for (found, rate) in found.iter().zip(rate) {
            // The difference of two roundings of forces of 2 N over 0.1 µm or more.
            assert!((found / rate - 1.0).abs() < 1e-7, "{found} {rate}");
        }
    }
}

// Verifies: TRC-025.
#[test]
fn samples_outside_the_maps_are_left_out_on_request() {
    let sweep = "position_mm,lateral_force_n,normal_force_n\n-4,1,2\n-3,3,4\n0,5,6\n3.0000005,7,8\n3.1,9,0\n";
    let (trimmed, note) = read(sweep).unwrap().trimmed(&table(0.0)).unwrap();
    assert_eq!(trimmed.positions(), [-3e-3, 0.0, 3.0000005e-3]);
    assert_eq!(trimmed.forces().lateral, [3.0, 5.0, 7.0]);
    assert_eq!(trimmed.forces().normal, [4.0, 6.0, 8.0]);
    assert_eq!(trimmed.lines, [3, 4, 5]);
    let expected = "2 of 5 samples left out, which are outside the maps, -3.0 to 3.0 mm";
    assert_eq!(note.unwrap(), expected);
    assert_eq!(trimmed.clone().trimmed(&table(0.0)), Ok((trimmed, None)));
    let sweep = "position_m,lateral_force_n,normal_force_n\n-4,1,2\n-3,3,4\n";
    assert_error(
        read(sweep).unwrap().trimmed(&table(0.0)),
        "t.csv: all of 2 samples are outside the maps, which have -3.0 to 3.0 mm",
    );
}

// Verifies: TRC-010, TRC-004.
#[test]
fn times_become_positions_by_the_motion() {
    let trace = || {
        let text = "time_s,lateral_force_n,normal_force_n\n1,1,2\n1.5,3,4\n";
        Trace::from_csv(text, "t.csv").unwrap()
    };
    let record = |velocity, start| trace().record(Some(Motion { velocity, start }));
    let there = record(0.5, -0.25).unwrap();
    assert_eq!(there.positions(), [0.25, 0.5]);
    assert_eq!(there.forces().lateral, [1.0, 3.0]);
    let back = record(-0.5, 0.25).unwrap();
    assert_eq!(back.positions(), [-0.5, -0.25]);
    assert_eq!(back.forces().lateral, [3.0, 1.0]);
    assert_eq!(back.forces().normal, [4.0, 2.0]);
    let (velocity, start) = (1.0, 0.0);
    let example = Trace::from_csv(EXAMPLE, "t.csv").unwrap();
    let example = example.record(Some(Motion { velocity, start }));
    let most = f64::MAX;
    for (found, expected) in [
        (trace().record(None), "t.csv: the samples have times"),
        (record(0.0, 0.0), "t.csv: velocity = 0 m/s"),
        (record(f64::NAN, 0.0), "t.csv: velocity = NaN m/s"),
        (
            record(most, most),
            "t.csv:2: position = inf m from this time",
        ),
        (example, "t.csv: the samples have positions"),
    ] {
        let error = found.unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

proptest::proptest! {
    // Verifies: TRC-007, TRC-008.
    #[test]
    fn no_text_makes_the_reader_panic(text in "(position_mm|time_s|lateral_force_n|normal_force_mn|[-0-9e.,;\t\"#\r\n x\u{feff}]){0,40}") {
        if let Err(error) = Trace::from_csv(&text, "t.csv") {
            let error = error.to_string();
            proptest::prop_assert!(error.starts_with("t.csv") && !error.contains('\n'));
        }
        for separator in [",", ";", "\t"] {
            let head = ["position_mm", "lateral_force_n", "\"normal_force_n\""].join(separator);
            let trace = Trace::from_csv(&format!("{head}\n{text}"), "t.csv");
            let _ = trace.map(|trace| trace.record(None));
        }
    }
}

// Verifies: TRC-004, TRC-008.
#[test]
fn a_record_of_numbers_is_that_of_the_same_numbers_in_a_file() {
    let forces = Force::new(&[0.25, -0.5][..], &[1.5, 1.25][..]);
    let record = Record::new("t.csv", &[-0.001, 0.0005], forces).unwrap();
    let read = read(EXAMPLE).unwrap();
    assert_eq!(record.positions(), read.positions());
    assert_eq!(record.forces(), read.forces());
    let one = Force::new(&[0.0][..], &[f64::NAN][..]);
    let three = [0.0, 1e-3, 0.5e-3];
    let flat = Force::new(&three[..], &three[..]);
    for (positions, forces, words) in [
        (&[][..], Force::new(&[][..], &[][..]), "t.csv: positions"),
        (&[0.0, 1.0], one, "t.csv: lateral forces"),
        (&[0.0], one, "t.csv: normal forces"),
        (&three, flat, "t.csv:3: position 0.5 mm after 1.0 mm"),
    ] {
        let refusal = Record::new("t.csv", positions, forces).unwrap_err();
        assert!(refusal.to_string().starts_with(words), "{refusal}");
    }
}

// Verifies: TRC-011, MAP-048.
#[test]
fn a_file_may_lack_the_lateral_force() {
    let rows = |count: i32| {
        (0..count)
            .map(|k| format!("{k},{}.5\n", k % 3))
            .collect::<String>()
    };
    let text = format!("position_mm,Load (N)\n{}7.5,\n", rows(5));
    let trace = Trace::from_csv(&text, "t.csv").unwrap();
    let notes = [
        "column \"Load (N)\" is read as normal_force_n",
        "samples with a missing number are not used: 1",
        "there is no lateral force: the normal force alone counts",
    ];
    assert_eq!(trace.notes(), notes);
    let record = trace.record(None).unwrap();
    assert_eq!(
        record.forces(),
        Force {
            lateral: &[][..],
            normal: &[0.5, 1.5, 2.5, 0.5, 1.5]
        }
    );
    let blank = Trace::from_csv(&format!("position_mm,Fz\n{}", rows(200)), "b.csv").unwrap();
    let error = Noise::of_blank(&blank).unwrap_err().to_string();
    assert_eq!(
        error,
        "b.csv: a blank sweep without lateral forces; state the noise (--noise-sd-n)"
    );
    // A column that the user states must be there.
    let layout = "lateral=Fx".parse().unwrap();
    let error = Trace::from_csv_as(&text, "t.csv", &layout)
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("t.csv:1: no column \"Fx\" in the header"),
        "{error}"
    );
}
