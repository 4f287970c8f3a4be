//! What the ops answer, and what they refuse.

use super::*;

// Verifies: ORA-008.
#[test]
fn a_refusal_names_the_argument_and_what_would_be_right() {
    assert_cases("refused/oracle.txt", "ops", |case| {
        let (op, args) = case.split_once(' ').unwrap();
        let (code, message) = refused(op, serde_json::from_str(args).unwrap());
        format!("{code}: {message}")
    });
}

// Verifies: ORA-020, ORA-009. Cases that are exact in binary, by hand.
#[test]
fn each_op_answers() {
    let ops = ok("capabilities", json!({}))["ops"].clone();
    let mut asked = ["capabilities", "element_stiffness"]
        .map(String::from)
        .to_vec();
    let (_, spec) = include_str!("../../spec/oracle.md")
        .split_once("## Ops")
        .unwrap();
    let triangle = json!([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]]);
    let element = json!({"nodes_m": triangle, "youngs_modulus_pa": 1, "poissons_ratio": 0});
    let stiffness = &ok("element_stiffness", element)["stiffness"][0][0];
    // ∫ (∂N₁/∂x)² + ½ (∂N₁/∂y)² = 3/2 · ½: both derivatives are 1 − 4q, and ∫ (1 − 4q)² = ½.
    let holds = (stiffness.as_f64().unwrap() - 0.75).abs() < 1e-15;
    assert!(holds, "{stiffness}");
    assert_cases("tables/oracle.txt", "answers", |case| {
        let (op, args) = case.split_once(' ').unwrap();
        asked.push(op.to_string());
        let args = serde_json::from_str(args).unwrap();
        let answer = ask(op, args);
        answer.get("ok").unwrap_or(&answer["error"]).to_string()
    });
    for op in ops.as_array().unwrap() {
        let op = op.as_str().unwrap();
        let is_asked = asked.iter().any(|asked| asked == op);
        assert!(is_asked, "{op} was not asked");
        let row = spec
            .lines()
            .find(|line| line.starts_with(&format!("| `{op}` |")));
        let row = row.unwrap_or_else(|| panic!("{op} is not in the specification"));
        // The arguments of these two depend on the first.
        if !["threshold", "report_encode"].contains(&op) {
            let (_, unknown) = refused(op, json!({"": 0}));
            let taken = unknown.split_once("``").expect("the unknown argument").1;
            let stated = row.split('|').nth(2).unwrap();
            assert_eq!(quoted(taken), quoted(stated), "{op}");
        }
    }
}

/// The names between backticks.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}
