//! Force maps.

use palpate::force_map::{ForceMap, ForceTable, Measurement, SAME_POSITION, Source};
use palpate::refusal::Refusal;
use palpate::servo::LoadedTable;

use crate::message::{check_file_message, lines};
use crate::{FILE, Outcome, judged};

/// An accepted map has increasing axes and finite forces, and is the same to the bit when it is
/// written and read again; a refusal names file and line, or the key.
pub fn map_json(text: &str) -> Outcome {
    let read = ForceMap::from_json(text, FILE);
    judged(read, check_map, |error| check_file_message(&error, text))
}

/// As [`map_json`] for CSV; what a refusal quotes stands in the line that it names.
pub fn map_csv(text: &str) -> Outcome {
    let read = ForceTable::from_csv(text, FILE).and_then(|table| {
        let source = Source::Measured(Measurement::new(FILE, "a note"));
        ForceMap::new(source, None, table).map_err(|refusal| refusal.in_file(FILE))
    });
    judged(read, check_map, |error| check_csv(&error, text))
}

/// Checks that what a refusal quotes stands in the line that it names.
pub fn check_csv(refusal: &Refusal, text: &str) {
    check_file_message(refusal, text);
    let Some((_, quoted)) = refusal.found.split_once('"') else {
        return;
    };
    let line = refusal.line.expect("a line");
    let content = lines(text).nth(line - 1).unwrap_or("");
    let quoted = quoted.strip_suffix('"').expect("a closing quote");
    let is_there = format!("{content:?}").contains(quoted);
    assert!(is_there, "{quoted:?} is not in line {line}, {content:?}");
}

fn check_map(map: ForceMap) {
    check_table(map.table());
    assert!(map.certificate().is_none() || map.phantom().is_some());
    let written = map.to_json();
    let again = ForceMap::from_json(&written, FILE).expect("what was written can be read");
    // Texts as well, since −0 = 0.
    assert_eq!((&again, again.to_json()), (&map, written));
    match map.mirrored() {
        Ok(whole) => {
            assert_eq!(
                whole.table().laterals().len(),
                2 * map.table().laterals().len() - 1
            );
            check_table(whole.table());
        }
        Err(error) if error.key == "laterals_m[0]" => assert!(map.table().laterals()[0] != 0.0),
        Err(error) if error.found.starts_with("lateral force ") => {}
        // The probe may stand at x and not at −x only by rounding; the phantom's own limits say so.
        Err(error) => panic!("{error}"),
    }
}

fn check_table(table: &ForceTable) {
    for axis in [table.depths(), table.laterals()] {
        assert!(!axis.is_empty());
        assert!(axis.iter().all(|x| x.is_finite() && x.to_bits() != 1 << 63));
        let mut steps = axis.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.all(|step| step > SAME_POSITION));
    }
    assert!(table.depths()[0] >= 0.0);
    let shape = (table.depths().len(), table.laterals().len());
    for forces in [Some(table.normal()), table.lateral()]
        .into_iter()
        .flatten()
    {
        assert_eq!((forces.row_count(), forces.column_count()), shape);
        assert!(forces.values().iter().all(|force| force.is_finite()));
    }
    let written = table.to_csv();
    let again = ForceTable::from_csv(&written, FILE).expect("what was written can be read");
    assert_eq!((&again, again.to_csv()), (table, written));
    check_between(table);
    if let Ok(loaded) = LoadedTable::new(table) {
        let kernel = loaded.table();
        let force = kernel.force(1e-3, 0.0);
        assert!(force.normal.is_finite() && force.lateral.is_finite());
    }
}

/// Forces are those of the map at its poses, and finite between them.
fn check_between(table: &ForceTable) {
    let (depth, lateral) = (table.depths()[0], table.laterals()[0]);
    match table.force(depth, lateral) {
        Ok(force) => {
            assert_eq!(force.normal, table.normal().row(0)[0]);
            assert_eq!(
                Some(force.lateral),
                table.lateral().map(|force| force.row(0)[0])
            );
        }
        Err(_) if table.lateral().is_none() => {}
        Err(error) if error.found.ends_with(" a single entry") => {}
        Err(error) if error.found.ends_with(" beyond the range of numbers") => {}
        Err(error) => panic!("{error}"),
    }
    if let Ok(force) = table.force(2e-3, 1e-3) {
        assert!(force.lateral.is_finite() && force.normal.is_finite());
    }
    match table.row(depth) {
        Ok(row) => assert_eq!(row.normal, table.normal().row(0)),
        Err(error) => assert!(table.lateral().is_none(), "{error}"),
    }
}
