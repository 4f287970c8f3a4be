//! What the ops answer, and what they refuse.

use super::*;

// Verifies: ORA-008.
#[test]
fn a_refusal_names_the_argument_and_what_would_be_right() {
    // Op and arguments, and then the code of the refusal and words of its message.
    let cases = r#"
error_rates {"gamma": 1} => bad_argument: eta | missing
error_rates {"gamma": "1", "eta": 0} => bad_argument: gamma | string | f64
error_rates {"gamma": 1, "eta": 0, "gama": 1} => bad_argument: `gama` | `gamma` or `eta`
error_rates {"gamma": -1, "eta": 0} => out_of_range: gamma | -1 | at least 0
roc {"gamma": 1, "false_alarm": []} => bad_argument: false_alarm | empty
roc {"gamma": 1, "false_alarm": [0.5, null]} => bad_argument: false_alarm[1] | null | f64
roc {"gamma": 1, "false_alarm": 0.5} => bad_argument: false_alarm | a list
normal_quantile {"p": 1} => out_of_range: strictly between 0 and 1
gamma_from_two_afc {"p_correct": 0} => out_of_range: p_correct | strictly between 0 and 1
threshold {"criterion": "map", "prior_h1": 0.0} => out_of_range: prior_h1
threshold {"criterion": "map", "prior_h1": 1.0} => out_of_range: prior_h1
threshold {"criterion": "minimax", "prior_h1": 0.5} => out_of_range: minimax | neyman_pearson_miss
threshold {"criterion": "map", "prior_h1": 0.5, "gamma": 1} => bad_argument: `gamma` | `criterion` or `prior_h1`
threshold {"criterion": "neyman_pearson_false_alarm", "gamma": 0, "max_false_alarm": 0.1} => out_of_range: gamma is 0
threshold {"criterion": "neyman_pearson_miss", "gamma": 1e+200, "max_miss": 0.1} => overflow: eta
noise_budget {"signal_n": 1, "max_false_alarm": 0.5, "max_miss": 0.5, "sources_n": []} => overflow: total_allowed
matched_filter {"template_x": [1], "template_y": [1, 2], "noise_sd_x": 1, "noise_sd_y": 1} => bad_argument: template_y | length 2 | length 1
matched_filter {"template_x": [1], "template_y": [1], "noise_sd_x": 0, "noise_sd_y": 1} => out_of_range: noise_sd_x | greater than 0
theta_colored {"residual": [1, 1], "template": [1, 1], "covariance": [[1, 0.5], [0.4, 1]]} => out_of_range: not symmetric | (1, 0)
theta_colored {"residual": [1, 1], "template": [1, 1], "covariance": [[1, 2], [2, 1]]} => out_of_range: not positive definite
theta_colored {"residual": [1, 1], "template": [1, 1], "covariance": [[1, 0], [0]]} => bad_argument: covariance[1] | 1 entries | 2
theta_colored {"residual": [1, 1, 1], "template": [1, 1, 1], "covariance": []} => bad_argument: template | as many lateral as normal
theta_nuisances {"residual": [1, 2, 3], "template": [0, 1, 0], "nuisances": [[1, 1]], "level": "known", "bias": 0, "eta": 0} => bad_argument: nuisances[0] | 2 entries | 3
theta_nuisances {"residual": [1, 2], "template": [0, 1, 0], "nuisances": [], "level": "known", "bias": 0, "eta": 0} => bad_argument: residual | length 2 | length 3
theta_nuisances {"residual": [], "template": [], "nuisances": [], "level": "known", "bias": 0, "eta": 0} => bad_argument: template | at least one
theta_nuisances {"residual": [1, 2, 3], "template": [2, 2, 2], "nuisances": [[1, 1, 1]], "level": "known", "bias": 0, "eta": 0} => out_of_range: gamma is 0
theta_nuisances {"residual": [1, 2], "template": [0, 1], "nuisances": [[1, 1]], "level": "known", "bias": 0, "eta": 0} => out_of_range: degrees of freedom | greater than 0
theta_nuisances {"residual": [0, 0, 0], "template": [0, 1, 0], "nuisances": [], "level": "unknown", "bias": 0, "eta": 0} => out_of_range: noise of the residual | greater than 0
theta_nuisances {"residual": [1, 2, 3], "template": [0, 1, 0], "nuisances": [], "level": "guessed", "bias": 0, "eta": 0} => out_of_range: guessed | known or unknown
theta_nuisances {"residual": [1, 2, 3], "template": [0, 1, 0], "nuisances": [], "level": "known", "bias": -1, "eta": 0} => out_of_range: bias | -1 | at least 0
bank_posterior {"residual": [1, 2, 3], "templates": [[0, 1, 0]], "nuisances": [], "level": "known", "prior": [0.5, 0.5], "prior_h1": 0.5} => bad_argument: templates | 1 rows | 2
bank_posterior {"residual": [1, 2, 3], "templates": [[0, 1, 0], [1, 0]], "nuisances": [], "level": "known", "prior": [0.5, 0.5], "prior_h1": 0.5} => bad_argument: templates[1] | 2 entries | 3
bank_posterior {"residual": [], "templates": [[]], "nuisances": [], "level": "known", "prior": [1], "prior_h1": 0.5} => bad_argument: residual | at least one
bank_posterior {"residual": [1, 2, 3], "templates": [], "nuisances": [], "level": "known", "prior": [], "prior_h1": 0.5} => bad_argument: prior | at least one
bank_posterior {"residual": [1, 2, 3], "templates": [[0, 1, 0]], "nuisances": [], "level": "known", "prior": [0.9], "prior_h1": 0.5} => out_of_range: sum of prior | 0.9 | 1
bank_posterior {"residual": [1, 2, 3], "templates": [[2, 2, 2]], "nuisances": [[1, 1, 1]], "level": "known", "prior": [1], "prior_h1": 0.5} => out_of_range: gamma is 0
bank_posterior {"residual": [1, 2, 3], "templates": [[0, 1, 0]], "nuisances": [], "level": "known", "prior": [1], "prior_h1": 1} => out_of_range: prior_h1 | strictly between 0 and 1
bank_posterior {"residual": [0, -1e154, 0], "templates": [[0, 1.3e154, 0]], "nuisances": [], "level": "known", "prior": [1], "prior_h1": 0.5} => overflow: theta
proportion_interval {"successes": 2.5, "trials": 3, "confidence": 0.9, "method": "wilson"} => bad_argument: successes | whole
proportion_interval {"successes": 4, "trials": 3, "confidence": 0.9, "method": "wilson"} => out_of_range: 4 successes | 3 trials
chi_square_tail {"x": 1, "degrees": 0, "noncentrality": 0} => out_of_range: degrees | 0.1 to 2e6
chi_square_tail {"x": 1, "degrees": 3, "noncentrality": -1} => out_of_range: noncentrality | 0 to 1e8
chi_square_tail {"x": 1, "degrees": 3} => bad_argument: noncentrality | missing
f_tail {"x": -1, "numerator": 2, "denominator": 2, "noncentrality": 0} => out_of_range: x | 0 to 1e152
f_tail {"x": 1, "numerator": 2, "denominator": 3e6, "noncentrality": 0} => out_of_range: denominator | 0.1 to 2e6
student_tail {"x": 1, "degrees": 2, "noncentrality": 10001} => out_of_range: noncentrality | -1e4 to 1e4
interpolate {"depths_m": [0, 0], "laterals_m": [0, 1], "table_n": [[1, 2], [3, 4]], "depth_m": 0, "lateral_m": 0} => out_of_range: depths_m[1]
interpolate {"depths_m": [0], "laterals_m": [0, 1], "table_n": [[1, 2]], "depth_m": 0, "lateral_m": 0} => bad_argument: depths_m | at least 2
scan {"residual_x": [1], "residual_y": [1], "template_x": [1, 1], "template_y": [1, 1], "noise_sd_x": 1, "noise_sd_y": 1} => bad_argument: template_x
element_stiffness {"nodes_m": [[0, 0], [0, 1], [1, 0], [0, 0.5], [0.5, 0.5], [0.5, 0]], "youngs_modulus_pa": 1, "poissons_ratio": 0.3} => out_of_range: nodes_m | counter-clockwise
element_stiffness {"nodes_m": [[0, 0]], "youngs_modulus_pa": 1, "poissons_ratio": 0.3} => bad_argument: nodes_m | 1 rows | 6
element_stiffness {"nodes_m": [0], "youngs_modulus_pa": 1, "poissons_ratio": 0.3} => bad_argument: nodes_m[0] | a list
element_stiffness {"nodes_m": [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], "youngs_modulus_pa": 1, "poissons_ratio": -1} => out_of_range: poissons_ratio | above -1 and below 0.5
element_stiffness {"nodes_m": [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], "youngs_modulus_pa": 1, "poissons_ratio": 0.5} => out_of_range: poissons_ratio | above -1 and below 0.5
element_stiffness {"nodes_m": [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], "youngs_modulus_pa": 0, "poissons_ratio": 0.3} => out_of_range: youngs_modulus_pa | above 0
probe_force {"phantom": "5.0", "depth_m": 0, "lateral_m": 0} => out_of_range: 5.0 | 6.6
probe_force {"phantom": "none", "depth_m": -0.001, "lateral_m": 0} => out_of_range: depth
servo_axis {"knots": [0, 1], "coordinate_bits": "3f800000"} => bad_argument: coordinate_bits | 0x3f800000
servo_axis {"knots": [0, 2], "coordinate_bits": "0x3f800000"} => out_of_range: knots | within 1 m
report_decode {"bytes": "0"} => bad_argument: bytes | pairs
report_decode {"bytes": "0400 "} => bad_argument: bytes | pairs
report_decode {"bytes": "0403"} => out_of_range: 3
report_decode {"bytes": "05"} => out_of_range: 5 | 1 to 4
report_encode {"report": 2, "lateral": 32768, "normal": 0, "sequence": 0, "flags": 0} => out_of_range: lateral | -32768 to 32767
count_analysis {"correct": [[4]], "trials": 4} => out_of_range: p_correct
count_analysis {"correct": [[5], [1]], "trials": 4} => out_of_range: correct[0][0] | 0 to 4
"#;
    for case in cases.trim().lines() {
        let (asked, right) = case.split_once(" => ").unwrap();
        let (op, args) = asked.split_once(' ').unwrap();
        let (code, words) = right.split_once(": ").unwrap();
        let (found, message) = refused(op, serde_json::from_str(args).unwrap());
        assert_eq!(found, code, "{case}: {message}");
        for word in words.split(" | ") {
            assert!(message.contains(word), "{case}: {message} lacks {word}");
        }
    }
}

// Verifies: ORA-020, ORA-009. Cases that are exact in binary, by hand.
#[test]
fn each_op_answers() {
    let ops = ok("capabilities", json!({}))["ops"].clone();
    let mut asked = vec!["capabilities", "element_stiffness"];
    let (_, spec) = include_str!("../../spec/oracle.md")
        .split_once("## Ops")
        .unwrap();
    let triangle = json!([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]]);
    let element = json!({"nodes_m": triangle, "youngs_modulus_pa": 1, "poissons_ratio": 0});
    let stiffness = &ok("element_stiffness", element)["stiffness"][0][0];
    // ∫ (∂N₁/∂x)² + ½ (∂N₁/∂y)² = 3/2 · ½: both derivatives are 1 − 4q, and ∫ (1 − 4q)² = ½.
    let holds = (stiffness.as_f64().unwrap() - 0.75).abs() < 1e-15;
    assert!(holds, "{stiffness}");
    // K = diag(4, 1) in theta_colored: 6·(1 − 3)/4 + 4·(3 − 2)/1, and 36/4 + 16/1 is 5². p = ½ in count_analysis:
    // χ² = (1² + 1²)/(4·½·½). In theta_nuisances the offset 3 leaves (1, −1, 0, 0): T = 2/2, R = 2 − 1;
    // in bank_posterior too, and the first template is the offset: both have θ = 0.
    let cases = r#"
probe_force {"phantom": "none", "depth_m": 0, "lateral_m": 0} => {"normal_force_n": 0.0, "lateral_force_n": 0.0}
normal_cdf {"x": -50} => {"p": 0.0}
normal_quantile {"p": 0.5} => {"x": 0.0}
matched_filter {"template_x": [3, 4, 0, 0], "template_y": [0, 0, 0, 0], "noise_sd_x": 2, "noise_sd_y": 4} => {"b_x": 2.5, "b_y": 0.0, "sigma_x": 1.0, "sigma_y": 2.0, "gamma": 2.5}
theta {"observed_x": [4], "observed_y": [0], "f0_x": [1], "f0_y": [0], "f1_x": [3], "f1_y": [0], "noise_sd_x": 1, "noise_sd_y": 1} => {"theta": 4.0, "y_x": 3.0, "y_y": 0.0, "gamma": 2.0}
theta_colored {"residual": [1, 3], "template": [6, 4], "covariance": [[4, 0], [0, 1]]} => {"theta": 1.0, "gamma": 5.0}
theta_nuisances {"residual": [4, 2, 3, 3], "template": [1, -1, 1, -1], "nuisances": [[1, 1, 1, 1], [2, 2, 2, 2]], "level": "known", "bias": 0, "eta": 1e6} => {"t": 1.0, "gamma": 2.0, "gamma_nominal": 2.0, "rank": 1, "residual": 1.0, "degrees": 2, "theta": 0.0, "false_alarm": 0.0, "miss": 1.0}
bank_posterior {"residual": [4, 2, 3, 3], "templates": [[1, 1, 1, 1], [1, -1, 1, -1]], "nuisances": [[1, 1, 1, 1]], "level": "known", "prior": [0.75, 0.25], "prior_h1": 0.5} => {"theta": [0.0, 0.0], "theta_mixture": 0.0, "theta_max": 0.0, "hypothesis": 1, "posterior_h1": 0.5, "posterior": [0.75, 0.25]}
threshold {"criterion": "map", "prior_h1": 0.5} => {"eta": 0.0}
error_rates {"gamma": 0, "eta": 1} => {"false_alarm": 0.0, "miss": 1.0}
roc {"gamma": 0, "false_alarm": [0, 0.5, 1]} => {"miss": [1.0, 0.5, 0.0], "auc": 0.5}
required_gamma {"max_false_alarm": 0.5, "max_miss": 0.5} => {"gamma": 0.0}
two_afc {"gamma": 0} => {"p_correct": 0.5}
gamma_from_two_afc {"p_correct": 0.5} => {"gamma": 0.0}
proportion_interval {"successes": 0, "trials": 1, "confidence": 0.5, "method": "clopper_pearson"} => {"lower": 0.0, "upper": 0.75}
chi_square_tail {"x": 0, "degrees": 3, "noncentrality": 2} => {"lower": 0.0, "upper": 1.0}
f_tail {"x": 1e152, "numerator": 3, "denominator": 9, "noncentrality": 2} => {"lower": 1.0, "upper": 0.0}
student_tail {"x": -1e152, "degrees": 3, "noncentrality": 0} => {"lower": 0.0, "upper": 1.0}
noise_budget {"signal_n": 0, "max_false_alarm": 0.4, "max_miss": 0.4, "sources_n": []} => null
interpolate {"depths_m": [0, 1], "laterals_m": [0, 1], "table_n": [[1, 2], [3, 4]], "depth_m": 0.5, "lateral_m": 2} => {"force_n": 4.0}
scan {"residual_x": [0, 1, 2], "residual_y": [0, 0, 0], "template_x": [1, 2], "template_y": [0, 0], "noise_sd_x": 1, "noise_sd_y": 1} => {"theta": [-0.5, 2.5], "max_theta": 2.5, "argmax": 1}
servo_axis {"knots": [0, 0.5, 1], "coordinate_bits": "0x3F400000"} => {"cell": 1, "fraction_bits": "0x3f000000"}
servo_interpolate {"depth_knots": [0, 1], "lateral_knots": [0, 1], "table_bits": [["0x00000000", "0x3f800000"], ["0x00000000", "0x3f800000"]], "depth_bits": "0x00000000", "lateral_bits": "0x3f000000"} => {"force_bits": "0x3f000000"}
report_encode {"report": 1, "lateral": -2, "normal": 258, "buttons": 1, "status": 2, "sequence": 65535, "force_sequence": 3} => {"bytes": "01feff02010102ffff0300"}
report_decode {"bytes": "01FEFF02010102ffff0300"} => {"report": 1, "lateral": -2, "normal": 258, "buttons": 1, "status": 2, "sequence": 65535, "force_sequence": 3}
report_encode {"report": 3, "version": 1, "position_unit_nm": 2, "force_unit_un": 3, "largest_force_mn": 4, "period_us": 5, "watchdog_ms": 6, "damping_mn_s_per_m": 7, "friction_mn": 256} => {"bytes": "0301000200030004000500060007000001"}
report_decode {"bytes": "0301000200030004000500060007000001"} => {"report": 3, "version": 1, "position_unit_nm": 2, "force_unit_un": 3, "largest_force_mn": 4, "period_us": 5, "watchdog_ms": 6, "damping_mn_s_per_m": 7, "friction_mn": 256}
report_decode {"bytes": "02ff7f008001ff01"} => {"report": 2, "lateral": 32767, "normal": -32768, "sequence": 65281, "flags": 1}
report_encode {"report": 4, "control": 2} => {"bytes": "0402"}
count_analysis {"correct": [[3], [1]], "trials": 4.0} => {"pooled": [4], "rate": [0.5], "gamma": [0.0], "chi2": [2.0], "df": 1}
"#;
    for case in cases.trim().lines() {
        let (question, expected) = case.split_once(" => ").unwrap();
        let (op, args) = question.split_once(' ').unwrap();
        asked.push(op);
        let read = |text| -> Value { serde_json::from_str(text).unwrap() };
        if expected != "null" {
            assert_eq!(ok(op, read(args)), read(expected), "{case}");
        }
    }
    for op in ops.as_array().unwrap() {
        let op = op.as_str().unwrap();
        assert!(asked.contains(&op), "{op} was not asked");
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
