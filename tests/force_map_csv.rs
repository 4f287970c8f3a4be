//! Measured force maps as CSV through the public interface.

use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable, Matrix, Measurement, Source};
use palpate::phantom::Phantom;
use palpate_asserts::{assert_cases, assert_error, axis, changed, finite, seeded};
use proptest::prelude::*;

const EXAMPLE: &str = "\
depth_mm,lateral_mm,normal_force_n,lateral_force_n
0.0,-2.6,0.0,0.0
0.0,0.0,0.0,0.0
0.0,2.6,0.0,0.0
1.5,-2.6,0.21,-0.034
1.5,0.0,0.25,0.0
1.5,2.6,0.22,0.033
";

fn table() -> ForceTable {
    let matrix = |rows: [[f64; 3]; 2]| Matrix::new(3, rows.concat()).unwrap();
    ForceTable::new(
        vec![0.0, 0.0015],
        vec![-0.0026, 0.0, 0.0026],
        Force::new(
            matrix([[0.0; 3], [-0.034, 0.0, 0.033]]),
            matrix([[0.0; 3], [0.21, 0.25, 0.22]]),
        ),
    )
    .unwrap()
}

fn read(text: &str) -> Result<ForceTable, String> {
    ForceTable::from_csv(text, "gel.csv").map_err(|error| error.to_string())
}

// Verifies: MAP-030, MAP-022, MAP-041.
#[test]
fn a_table_is_read_and_written() {
    assert_eq!(read(EXAMPLE), Ok(table()));
    assert_eq!(table().to_csv(), EXAMPLE);
}

// Verifies: MAP-030.
#[test]
fn columns_are_found_by_name_and_units_by_header() {
    let text = "\
        lateral_force_mn,depth_m,normal_force_mn,lateral_mm\n\
        0,0,0,-2.6\n0,0,0,0\n0,0,0,2.6\n\
        -34,0.0015,210,-2.6\n0,0.0015,250,0\n33,1.5e-3,220,2.6\n";
    assert_eq!(read(text), Ok(table()));
}

// Verifies: MAP-040, MAP-041, MAP-030, MAP-044.
#[test]
fn tables_of_spreadsheets_are_read() {
    let header = "\"\";Depth_mm;lateral_mm;T/°C;\"normal_force_N\";lateral_force_n";
    let rows = EXAMPLE.lines().skip(1).zip(0..).map(|(row, number)| {
        let row = row.replace(',', ";").replace('.', ",");
        let [depth, lateral, normal, sideways] = row.split(';').collect::<Vec<_>>()[..] else {
            panic!("{row}")
        };
        format!("{number};{depth};{lateral};20,5;\"{normal}\";{sideways}")
    });
    let text = format!("{header}\r\n{}", rows.collect::<Vec<_>>().join("\r\n"));
    let (found, notes) = ForceTable::from_csv_with_notes(&text, "gel.csv", None).unwrap();
    assert_eq!(found, table());
    let decimal = "commas in its numbers are decimal commas";
    assert_eq!(notes, ["column \"T/°C\" is not used", decimal]);
    let (found, notes) = ForceTable::from_csv_with_notes(EXAMPLE, "gel.csv", None).unwrap();
    assert_eq!((found, notes.len()), (table(), 0));
}

// Verifies: MAP-002, MAP-026, MAP-030, MAP-033.
#[test]
fn what_is_wrong_is_refused_with_line_column_and_value() {
    let refusal = |change: &str| read(&changed(EXAMPLE, change)).unwrap_err();
    assert_cases("refused/map_csv.txt", "changes", refusal);
    let empty = |text: &str| read(text).unwrap_err();
    assert_cases("refused/map_csv.txt", "empty files", empty);
    let expected = "gel.csv: depths_m is empty; give at least one position";
    assert_eq!(read(EXAMPLE.lines().next().unwrap()), Err(expected.into()));
}

// Verifies: MAP-032.
#[test]
fn order_comments_blanks_and_line_ends_do_not_matter() {
    let mut lines: Vec<&str> = EXAMPLE.lines().collect();
    lines[1..].reverse();
    lines.swap(2, 4);
    assert_eq!(read(&lines.join("\n")), Ok(table()));
    assert_eq!(read(&lines.join("\r\n")), Ok(table()));
    let lines = lines.join(" \n ");
    let noisy = format!("\u{feff}# a gel, 1\n\n  # b\r\n{lines}\n\t\n#");
    assert_eq!(read(&noisy.replace(',', " ,\t")), Ok(table()));
    assert_eq!(read(&EXAMPLE.replace("1.5,0.0", "1.5,-0")), Ok(table()));
    // A tenth of a nanometre away.
    let away = EXAMPLE.replace("1.5,0.0", "1.5000001,0.0000001");
    assert_eq!(read(&away), Ok(table()));
}

// Verifies: MAP-026, MAP-033.
#[test]
fn every_missing_pose_is_named() {
    let count = EXAMPLE.lines().count();
    for missing in 1..count {
        let mut lines: Vec<&str> = EXAMPLE.lines().collect();
        let taken: Vec<&str> = lines.remove(missing).split(',').collect();
        let expected = format!(
            "gel.csv: no row for depth {} mm, lateral {} mm; give one for each of the 2 depths \
             at each of the 3 lateral positions in the file",
            taken[0], taken[1]
        );
        assert_eq!(read(&lines.join("\n")), Err(expected));
    }
}

// Verifies: MAP-002, MAP-026.
#[test]
fn a_measured_map_keeps_the_files_name_without_its_folder() {
    let phantom = Phantom::builtin("2.6").unwrap();
    let measured = |text: &str| {
        let source = Source::Measured(Measurement::new("lab/gel.csv", "ATI"));
        ForceMap::new(source, Some(phantom.clone()), read(text).unwrap())
    };
    let map = measured(EXAMPLE).unwrap();
    let source = Source::Measured(Measurement::new("gel.csv", "ATI"));
    assert_eq!((map.source(), map.phantom()), (&source, Some(&phantom)));
    assert_eq!(map.table(), &table());
    let deep = EXAMPLE.replace("\n1.5,", "\n15.5,");
    assert_error(
        measured(&deep),
        "phantom: depth_mm = 15.5, but must be [..]",
    );
}

// Verifies: MAP-037.
#[test]
fn a_diagonal_of_poses_is_refused_without_its_square() {
    // 200,000 depths × 200,000 lateral positions would be 320 GB a matrix.
    let rows: String = (0..200_000).map(|i| format!("{i},{i},0,0\n")).collect();
    let message = read(&format!("{}\n{rows}", EXAMPLE.lines().next().unwrap())).unwrap_err();
    assert!(message.starts_with("gel.csv: no row for depth 0.0 mm, lateral 1.0 mm"));
}

fn any_table() -> impl Strategy<Value = ForceTable> {
    let steps = || prop::collection::vec(1e-8..1e-2, 1..5);
    (steps(), steps(), prop::collection::vec(finite(), 32)).prop_map(
        move |(down, across, forces)| {
            let matrix = |skip: usize| {
                Matrix::from_fn(down.len(), across.len(), |row, column| {
                    forces[skip + 4 * row + column]
                })
            };
            let (depths, laterals) = (axis(0.0, &down), axis(-0.01, &across));
            ForceTable::new(depths, laterals, Force::new(matrix(16), matrix(0))).unwrap()
        },
    )
}

proptest! {
    #![proptest_config(seeded(5))]

    // Verifies: MAP-030, MAP-022, MAP-041.
    #[test]
    fn any_table_survives_the_file_to_the_bit(table in any_table()) {
        let back = read(&table.to_csv()).unwrap();
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(back.depths()), bits(table.depths()));
        prop_assert_eq!(bits(back.laterals()), bits(table.laterals()));
        let forces = |t: &ForceTable| {
            [bits(t.normal().values()), bits(t.lateral().unwrap().values())]
        };
        prop_assert_eq!(forces(&back), forces(&table));
    }

    // Verifies: MAP-026, MAP-037.
    #[test]
    fn mutated_files_never_panic(
        at in 0..EXAMPLE.len(),
        removed in 0usize..20,
        added in "([-+0-9eE.,;\\t\"\\n\\r#_ m]{0,8}|\\PC{0,4})",
        separator in "[,;\t]",
    ) {
        let end = (at + removed).min(EXAMPLE.len());
        let text = format!("{}{added}{}", &EXAMPLE[..at], &EXAMPLE[end..]).replace(',', &separator);
        if let Err(message) = read(&text) {
            prop_assert!(message.starts_with("gel.csv:"));
            prop_assert!(!message.contains('\n'), "{message:?}");
        }
    }
}
