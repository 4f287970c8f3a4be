//! `palpate oracle` as another program meets it: `spec/oracle.md`.

mod ops;

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::thread;

use crate::program::text;
use palpate_asserts::assert_cases;
use serde_json::{Value, json};

fn start(command: &mut Command) -> Child {
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let child = piped.stderr(Stdio::piped()).spawn();
    child.expect("the program starts")
}

fn oracle() -> Child {
    start(Command::new(crate::program::PROGRAM).arg("oracle"))
}

/// The lines of answer to an input, written by a thread of its own so that no pipe fills up.
fn lines_of(mut child: Child, input: Vec<u8>) -> Vec<String> {
    let mut pipe = child.stdin.take().expect("its input");
    let writer = thread::spawn(move || pipe.write_all(&input));
    let output = child.wait_with_output().expect("it ends");
    let written = writer.join().expect("the writer ends");
    written.expect("it reads all");
    let stderr = text(&output.stderr);
    assert!(output.status.success(), "{:?} {stderr}", output.status);
    assert_eq!(stderr, "");
    let text = text(&output.stdout);
    assert!(text.is_empty() || text.ends_with('\n'));
    text.lines().map(str::to_string).collect()
}

fn answers(input: impl Into<Vec<u8>>) -> Vec<String> {
    lines_of(oracle(), input.into())
}

/// The line of a request.
fn line(id: impl Into<Value>, op: &str, args: Value) -> String {
    json!({"id": id.into(), "op": op, "args": args}).to_string()
}

/// The answer to one op.
fn ask(op: &str, args: Value) -> Value {
    let lines = answers(line(7, op, args));
    assert_eq!(lines.len(), 1, "{lines:?}");
    let answer: Value = serde_json::from_str(&lines[0]).expect("JSON");
    assert_eq!(answer["id"], 7);
    answer
}

fn ok(op: &str, args: Value) -> Value {
    let answer = ask(op, args);
    assert!(answer["error"].is_null(), "{op}: {answer}");
    answer["ok"].clone()
}

/// The code and message of a refusal.
fn refused(op: &str, args: Value) -> (String, String) {
    let answer = ask(op, args);
    let text = |key| answer["error"][key].as_str().map(str::to_string);
    let found = text("code").zip(text("message"));
    found.unwrap_or_else(|| panic!("{op}: {answer}"))
}

fn code_of(line: &str) -> String {
    let answer: Value = serde_json::from_str(line).expect("JSON");
    answer["error"]["code"].as_str().unwrap_or("ok").to_string()
}

/// Asserts that `child` answers each line with its code, and a good line after it as if nothing had been.
fn assert_codes(child: Child, cases: &[(Vec<u8>, &str)]) {
    let after = |(line, _): &(Vec<u8>, &str)| [line, GOOD.as_bytes()].join(&b'\n');
    // The last line has no end.
    let input = cases.iter().map(after).collect::<Vec<_>>().join(&b'\n');
    let lines = lines_of(child, input);
    assert_eq!(lines.len(), 2 * cases.len());
    for (pair, (line, code)) in lines.chunks(2).zip(cases) {
        let line = String::from_utf8_lossy(&line[..line.len().min(100)]);
        assert_eq!(code_of(&pair[0]), *code, "{line}: {}", pair[0]);
        assert_eq!(pair[1], GOOD_ANSWER, "after {line}");
        assert!(pair[0].len() < 3000, "{line}: the answer quotes it all");
    }
}

const GOOD: &str = r#"{"id":"good","op":"normal_cdf","args":{"x":0}}"#;
const GOOD_ANSWER: &str = r#"{"id":"good","ok":{"p":0.5}}"#;

// Verifies: ORA-009.
#[test]
fn a_number_is_read_as_the_nearest_f64() {
    // 1 + 2⁻⁵³ lies half-way between two f64 and goes to the even one; with one digit more, far behind, it goes up.
    // For one sample, b is the template in a list of one, and σ the noise by itself, to the bit.
    let half_way = "1.00000000000000011102230246251565404236316680908203125";
    let above = format!("{half_way}00000000000000000000000001");
    for (number, expected) in [(half_way, 1.0), (&above, 1.0 + f64::EPSILON)] {
        let line = format!(
            r#"{{"id":1,"op":"matched_filter","args":{{"template_x":[{number}],"template_y":[0],"noise_sd_x":{number},"noise_sd_y":1}}}}"#
        );
        let answer: Value = serde_json::from_str(&answers(line)[0]).unwrap();
        for key in ["b_x", "sigma_x"] {
            let found = answer["ok"][key].as_f64().map(f64::to_bits);
            assert_eq!(found, Some(f64::to_bits(expected)), "{key}: {number}");
        }
    }
    for number in ["1e309", "-1e309", "123456789e400"] {
        let line = format!(r#"{{"id":1,"op":"normal_cdf","args":{{"x":{number}}}}}"#);
        assert_ne!(code_of(&answers(line)[0]), "ok", "{number}");
    }
}

// Verifies: ORA-009.
#[test]
fn a_number_of_an_answer_is_the_shortest_that_reads_back() {
    let mut digits = 0;
    for k in 1..200 {
        let answer = &answers(line(1, "normal_cdf", json!({"x": -0.03 * f64::from(k)})))[0];
        let number = answer.split(r#""p":"#).nth(1).unwrap();
        let number = number.trim_end_matches('}');
        let value: f64 = number.parse().unwrap();
        // Significant digits, with and without a point or an exponent.
        let significant = |text: &str| {
            let mantissa = text.split('e').next().unwrap();
            let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
            digits.trim_start_matches('0').trim_end_matches('0').len()
        };
        let written = significant(number);
        // One digit fewer does not read back.
        let shorter: f64 = format!("{value:.*e}", written - 2).parse().unwrap();
        assert_ne!(shorter.to_bits(), value.to_bits(), "{number}");
        digits += usize::from(written > 14);
    }
    assert!(digits > 100, "{digits}");
    // γ = 10³⁰⁸ · 10 is no f64.
    let template =
        json!({"template_x": [1e308], "template_y": [0], "noise_sd_x": 0.1, "noise_sd_y": 1});
    assert_eq!(refused("matched_filter", template).0, "overflow");
}

// Verifies: ORA-001, ORA-002.
#[test]
fn every_line_has_its_answer_whatever_it_is() {
    let deep = "[".repeat(1_000_000);
    let nested = format!(
        r#"{{"id":2,"op":"normal_cdf","args":{{"x":{deep}{}}}}}"#,
        "]".repeat(1_000_000)
    );
    let objects = r#"{"a":"#.repeat(500_000);
    assert_cases("refused/oracle.txt", "lines", |line| {
        let [answer, good] = &answers([line, GOOD].join("\n"))[..] else {
            panic!("two answers")
        };
        assert_eq!(good, GOOD_ANSWER);
        code_of(answer)
    });
    let garbage: [(Vec<u8>, &str); 9] = [
        (b"".into(), "bad_json"),
        (b"   ".into(), "bad_json"),
        (b"\r".into(), "bad_json"),
        (b"\xff\xfe\x00".into(), "bad_json"),
        (b"{\"id\":1,\"op\":\"\xc3\"}".into(), "bad_json"),
        (b"\0".into(), "bad_json"),
        (deep.into(), "bad_json"),
        (nested.into(), "bad_argument"),
        (objects.into(), "bad_json"),
    ];
    assert_codes(oracle(), &garbage);
}

// Verifies: ORA-002.
#[test]
fn no_input_is_no_answer() {
    assert!(answers("").is_empty());
    for blank in ["\n", " "] {
        let codes: Vec<_> = answers(blank).iter().map(|line| code_of(line)).collect();
        assert_eq!(codes, ["bad_json"]);
    }
}

// Verifies: ORA-004.
#[test]
fn the_id_comes_back_as_it_was_written() {
    let numbers = "0 -0 1.0 1e2 1E+2 12345678901234567890123456789012345678901234567890 1e999 \
                   0.1000000000000000055511151231257827";
    let texts = r#""" "1" "a\u00e9\n\"\\\/é" "\ud800""#;
    for id in numbers.split(' ').chain(texts.split(' ')) {
        let line = format!(" {{ \"op\" : \"normal_cdf\",\"args\":{{\"x\":0}} , \"id\" : {id} }}\t");
        let answer = format!("{{\"id\":{id},\"ok\":{{\"p\":0.5}}}}");
        assert_eq!(answers(line), [answer]);
        for rest in [
            r#""op":"none""#,
            r#""op":5"#,
            r#""op":"a","op":"b""#,
            r#""more":1"#,
        ] {
            let line = format!("{{{rest},\"id\":{id}}}");
            let refusal = format!("{{\"id\":{id},\"error\":");
            assert!(answers(line)[0].starts_with(&refusal), "{rest}");
        }
    }
}

// Verifies: ORA-001.
#[test]
fn an_answer_comes_before_the_next_question() {
    let mut child = oracle();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    let mut answer = String::new();
    let mut expect = |answer_is: &dyn Fn(&str) -> bool| {
        answer.clear();
        output.read_line(&mut answer).unwrap();
        assert!(answer_is(&answer), "{answer}");
    };
    for _ in 0..3 {
        // A piece of the next line is there already, and must not hold up the answer.
        write!(input, "{GOOD}\n{{\"id\":").unwrap();
        expect(&|answer| answer.trim_end() == GOOD_ANSWER);
        input.write_all(b"1}\n").unwrap();
        expect(&|answer| code_of(answer) == "bad_request");
    }
    drop(input);
    assert!(child.wait().unwrap().success());
}

// Verifies: ORA-002.
#[test]
fn a_reader_who_has_gone_ends_it_quietly() {
    let mut child = oracle();
    drop(child.stdout.take());
    let mut input = child.stdin.take().unwrap();
    let line = format!("{GOOD}\n");
    // Until the oracle is gone, and so the pipe is closed.
    while input.write_all(line.as_bytes()).is_ok() {}
    let output = child.wait_with_output().unwrap();
    let holds = output.status.success() && output.stderr.is_empty();
    assert!(holds, "{output:?}");
}

// Verifies: ORA-001.
#[test]
fn a_million_lines_in_a_row() {
    const LINES: usize = 1_000_000;
    let mut input = Vec::with_capacity(LINES * 60);
    for index in 0..LINES {
        let args = r#""op":"normal_cdf","args":{"x":0}"#;
        writeln!(input, r#"{{"id":{index},{args}}}"#).unwrap();
    }
    let lines = answers(input);
    assert_eq!(lines.len(), LINES);
    for (index, line) in lines.iter().enumerate() {
        assert_eq!(*line, format!("{{\"id\":{index},\"ok\":{{\"p\":0.5}}}}"));
    }
}

// Verifies: ORA-007, ORA-011.
#[cfg(unix)]
#[test]
fn memory_is_bounded_for_lines_of_any_length() {
    const LONGEST: usize = 16 << 20;
    let padded = |length: usize| {
        let mut line = GOOD.as_bytes().to_vec();
        line.resize(length, b' ');
        line
    };
    let filled = |open: &str, entry: &str, close: &str| {
        let count = (LONGEST - open.len() - close.len()) / entry.len();
        format!("{open}{}{close}", entry.repeat(count)).into_bytes()
    };
    let rates = r#"{"id":1,"op":"roc","args":{"gamma":1,"false_alarm":[0"#;
    let rows = r#"{"id":1,"op":"interpolate","args":{"depths_m":[],"laterals_m":[],"table_n":[[]"#;
    let names = r#"{"id":1,"op":"capabilities","args":{"a":0"#;
    let cases: [(Vec<u8>, &str); 8] = [
        (padded(LONGEST), "ok"),
        (padded(LONGEST + 1), "bad_json"),
        (vec![b'['; 300 << 20], "bad_json"),
        (filled("", "[", ""), "bad_json"),
        (filled(rates, ",1", "]}}"), "out_of_range"),
        (filled(rows, ",[]", "]}}"), "out_of_range"),
        (filled(r#"{"id":1,"op":""#, "\u{80}", "\"}"), "unknown_op"),
        (filled(names, ",\"b\":0", "}}"), "bad_argument"),
    ];
    let program = crate::program::PROGRAM;
    let limited = format!("ulimit -v 400000 && exec {program} oracle");
    assert_codes(start(Command::new("sh").args(["-c", &limited])), &cases);
}

// Verifies: ORA-011.
#[test]
fn work_beyond_the_limits_is_refused_before_it_begins() {
    let ones = |count: usize| vec![1; count];
    let scan = |samples: usize, length: usize| {
        json!({"residual_x": ones(samples), "residual_y": ones(samples), "template_x": ones(length),
               "template_y": ones(length), "noise_sd_x": 1, "noise_sd_y": 1})
    };
    let coloured = json!({"residual": ones(1002), "template": ones(1002), "covariance": []});
    let beside = |number: usize| {
        json!({"residual": [1, 2, 0], "template": [0, 1, 0], "nuisances": vec![[1, 1, 1]; number], "level": "known",
               "bias": 0, "eta": 0})
    };
    let bank = |number: usize| {
        json!({"residual": [1, 2, 0], "templates": [[0, 1, 0]], "nuisances": vec![[1, 1, 1]; number], "level": "known",
               "prior": [1], "prior_h1": 0.5})
    };
    let rows = |nuisances: usize, templates: usize| {
        json!({"residual": [1], "templates": vec![[1]; templates], "nuisances": vec![[1]; nuisances], "max_false_alarm": 0.01,
               "max_miss": 0.01})
    };
    let robust = |modes: usize, classes: usize, signals: usize| {
        json!({"record": ones(modes), "noise": ones(modes), "weights": ones(classes), "signals": vec![ones(modes); signals],
               "covariances": vec![vec![0; modes]; modes * classes], "sizes": ones(signals),
               "prior": vec![1.0 / signals as f64; signals], "shape": vec![vec![0; modes]; modes]})
    };
    ok("robust_evidence", robust(200, 1, 1));
    ok("robust_evidence", robust(1, 100, 1000));
    ok("theta_nuisances", beside(100));
    ok("bank_posterior", bank(100));
    ok("sequential_evidence", rows(100, 1000));
    // 1000 products at each of the shifts of the whole template: 10,000 shifts are allowed.
    ok("scan", scan(10_999, 1000));
    for (op, args, words) in [
        ("scan", scan(20_000, 10_000), "10000000"),
        ("scan", scan(11_000, 1000), "10000000"),
        ("theta_colored", coloured, "at most 1000"),
        ("theta_nuisances", beside(101), "at most 100"),
        ("bank_posterior", bank(101), "at most 100"),
        ("sequential_evidence", rows(101, 1), "at most 100"),
        ("sequential_evidence", rows(1, 1001), "at most 1000"),
        ("robust_evidence", robust(201, 1, 1), "at most 200"),
        ("robust_evidence", robust(1, 101, 1), "at most 100"),
        ("robust_evidence", robust(1, 1, 1001), "at most 1000"),
    ] {
        let (code, message) = refused(op, args);
        assert_eq!(code, "out_of_range");
        assert!(message.contains(words), "{message}");
    }
    for method in ["wilson", "clopper_pearson"] {
        let ask = |trials: u64| json!({"successes": 5, "trials": trials, "confidence": 0.9, "method": method});
        let (code, _) = refused("proportion_interval", ask(1_000_000_001));
        assert_eq!(code, "out_of_range");
        ok("proportion_interval", ask(1_000_000_000));
    }
}

// Verifies: ORA-012.
#[test]
fn answers_do_not_depend_on_what_was_asked_before() {
    let pose = |id: u32, phantom: &str, depth: f64| {
        let args = json!({"phantom": phantom, "depth_m": depth, "lateral_m": 1e-3});
        line(id, "probe_force", args)
    };
    let mut requests = [
        pose(1, "none", 4e-3),
        pose(2, "6.6", 4e-3),
        pose(3, "none", 1e-3),
        pose(4, "6.6", 2e-3),
        GOOD.into(),
    ];
    let forward = answers(requests.join("\n"));
    requests.reverse();
    let mut backward = answers(requests.join("\n"));
    backward.reverse();
    assert_eq!(forward, backward);
    let mut lines = forward.iter();
    assert!(lines.all(|line| line.contains("\"ok\"")), "{forward:?}");
}
