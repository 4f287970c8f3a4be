//! The trace from each requirement to its code, tests, proofs and vectors, as `proofs/verify/tests/traceability` found it in the
//! annotations of the sources (`spec/traceability.md`).

/// `spec/traceability.csv`.
const TABLE: &str = include_str!("../../../spec/traceability.csv");

const HEADER: &str = "requirement,chapter,text,code,tests,proofs,vectors,inspection";

/// Between the names in a cell.
const SEPARATOR: &str = "; ";

/// A requirement and what the annotations name for it.
///
/// ```
/// use palpate_verify::traceability::{Requirement, requirements};
///
/// let traced: Vec<Requirement> = requirements()?;
/// let decision = traced.iter().find(|requirement| requirement.id == "DET-020").expect("it is there");
/// assert_eq!(decision.chapter, "detector.md");
/// assert!(decision.code.contains(&"src/detect/decision.rs decide".to_string()));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Requirement {
    /// As `FEM-012`.
    #[serde(rename = "requirement")]
    pub id: String,
    /// The file of its chapter in `spec/`.
    pub chapter: String,
    /// Its sentence.
    pub text: String,
    /// What serves it: a file, and after a space the item in it, `src/fem/mesh.rs Mesh`.
    pub code: Vec<String>,
    /// What checks it: the root of a test program, `::` and the name of a test in it, or the path of a script or bench.
    pub tests: Vec<String>,
    /// What shows it for every input in a stated range, named likewise.
    pub proofs: Vec<String>,
    /// Files with cases of it for other implementations.
    pub vectors: Vec<String>,
    /// Where a person looks, and why no test can.
    pub inspection: Option<String>,
}

/// How many requirements have what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Summary {
    /// All of them.
    pub requirements: usize,
    /// Those with code.
    #[serde(rename = "with_code")]
    pub code: usize,
    /// Those with a test.
    #[serde(rename = "with_tests")]
    pub tests: usize,
    /// Those with a proof.
    #[serde(rename = "with_proofs")]
    pub proofs: usize,
    /// Those with vectors.
    #[serde(rename = "with_vectors")]
    pub vectors: usize,
    /// Those that a person inspects.
    #[serde(rename = "by_inspection")]
    pub inspection: usize,
}

/// All requirements with their evidence, in the order of their ids.
///
/// # Errors
/// The line of the table, from 1, that is not as it should be.
pub fn requirements() -> Result<Vec<Requirement>, String> {
    parse(TABLE)
}

/// Counts them.
pub fn summary(requirements: &[Requirement]) -> Summary {
    let count = |has: fn(&Requirement) -> bool| requirements.iter().filter(|r| has(r)).count();
    Summary {
        requirements: requirements.len(),
        code: count(|r| !r.code.is_empty()),
        tests: count(|r| !r.tests.is_empty()),
        proofs: count(|r| !r.proofs.is_empty()),
        vectors: count(|r| !r.vectors.is_empty()),
        inspection: count(|r| r.inspection.is_some()),
    }
}

fn parse(table: &str) -> Result<Vec<Requirement>, String> {
    let mut lines = (1..).zip(table.lines());
    if lines.next().map(|(_, header)| header) != Some(HEADER) {
        return Err(format!("line 1: expected the header {HEADER}"));
    }
    lines
        .map(|(number, line)| {
            let cells = cells(line).map(<[String; 8]>::try_from);
            let Some(Ok(cells)) = cells else {
                return Err(format!("line {number}: expected 8 cells: {line}"));
            };
            Ok(requirement(cells))
        })
        .collect()
}

fn requirement(cells: [String; 8]) -> Requirement {
    let [id, chapter, text, code, tests, proofs, vectors, inspection] = cells;
    Requirement {
        id,
        chapter,
        text,
        code: several(&code),
        tests: several(&tests),
        proofs: several(&proofs),
        vectors: several(&vectors),
        inspection: (!inspection.is_empty()).then_some(inspection),
    }
}

/// The table of these requirements.
pub fn csv(requirements: &[Requirement]) -> String {
    let lines = requirements.iter().map(|row| {
        let cells = [
            row.id.clone(),
            row.chapter.clone(),
            row.text.clone(),
            row.code.join(SEPARATOR),
            row.tests.join(SEPARATOR),
            row.proofs.join(SEPARATOR),
            row.vectors.join(SEPARATOR),
            row.inspection.clone().unwrap_or_default(),
        ];
        let quoted = cells.map(|cell| match cell.contains([',', '"']) {
            true => format!("\"{}\"", cell.replace('"', "\"\"")),
            false => cell,
        });
        quoted.join(",") + "\n"
    });
    format!("{HEADER}\n{}", lines.collect::<String>())
}

fn several(cell: &str) -> Vec<String> {
    let names = cell.split(SEPARATOR).filter(|name| !name.is_empty());
    names.map(String::from).collect()
}

/// The cells of a line of CSV; a quoted one holds its quotes twice. `None` for a quote that is not closed, or that
/// something follows.
fn cells(line: &str) -> Option<Vec<String>> {
    let mut cells = Vec::new();
    let mut rest = line;
    loop {
        let (cell, after) = match rest.strip_prefix('"') {
            Some(quoted) => quoted_cell(quoted)?,
            None => {
                let end = rest.find(',').unwrap_or(rest.len());
                (String::from(&rest[..end]), &rest[end..])
            }
        };
        cells.push(cell);
        match after.strip_prefix(',') {
            Some(next) => rest = next,
            None => return after.is_empty().then_some(cells),
        }
    }
}

/// A cell whose opening quote is gone, and what follows the closing one.
fn quoted_cell(mut rest: &str) -> Option<(String, &str)> {
    let mut cell = String::new();
    loop {
        let (before, after) = rest.split_once('"')?;
        cell.push_str(before);
        let Some(next) = after.strip_prefix('"') else {
            return Some((cell, after));
        };
        cell.push('"');
        rest = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_may_hold_commas_and_quotes() {
        let table =
            format!("{HEADER}\nAAA-001,a.md,\"says \"\"no\"\", twice\",x.rs f; y.rs,,,,why\n");
        let read = parse(&table).unwrap();
        assert_eq!(read[0].text, "says \"no\", twice");
        assert_eq!(read[0].code, ["x.rs f", "y.rs"]);
        assert_eq!(read[0].tests, [""; 0]);
        assert_eq!(read[0].inspection, Some("why".to_string()));
        assert_eq!(csv(&read), table);
    }

    #[test]
    fn a_malformed_line_is_named() {
        for line in [
            "AAA-001,a.md,t,c,t,p,v",
            "A,b,\"c,d,e,f,g,h",
            "A,\"b\"c,d,e,f,g,h,i,j",
        ] {
            let error = parse(&format!("{HEADER}\n{line}\n")).unwrap_err();
            assert!(error.starts_with("line 2: "), "{error}");
        }
        assert!(parse("id,text\n").unwrap_err().starts_with("line 1: "));
    }

    #[test]
    fn the_summary_counts_each_kind() {
        let table = format!("{HEADER}\nA,m,t,c,a; b,,,\nB,m,t,c,,p,v,\nC,m,t,c,,,,why\n");
        let expected = Summary {
            requirements: 3,
            code: 3,
            tests: 1,
            proofs: 1,
            vectors: 1,
            inspection: 1,
        };
        assert_eq!(summary(&parse(&table).unwrap()), expected);
    }
}
