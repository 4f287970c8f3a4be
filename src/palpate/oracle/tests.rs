use std::cell::RefCell;
use std::io::{self, Read, Write};

use super::answer::{Code, answer, json};
use super::{Oracle, serve};

/// Gives its bytes out in pieces of a size, and checks before each that all whole lines so far were
/// answered.
struct Pieces<'a> {
    input: &'a [u8],
    size: usize,
    given: usize,
    output: &'a RefCell<Vec<u8>>,
}

fn lines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte == b'\n').count()
}

impl Read for Pieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let (asked, given) = (lines(&self.input[..self.given]), self.given);
        assert_eq!(lines(&self.output.borrow()), asked, "after {given} bytes");
        let rest = &self.input[self.given..];
        let count = self.size.min(rest.len()).min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.given += count;
        Ok(count)
    }
}

struct Shared<'a>(&'a RefCell<Vec<u8>>);

impl Write for Shared<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

// Verifies: ORA-001.
#[test]
fn lines_are_found_however_the_input_is_cut() {
    let mut input = String::new();
    let mut expected = String::new();
    for index in 0..300 {
        input += &format!("{{\"id\":{index},\"op\":\"normal_cdf\",\"args\":{{\"x\":0}}}}\n");
        expected += &format!("{{\"id\":{index},\"ok\":{{\"p\":0.5}}}}\n");
    }
    let whole = input.trim_end(); // a last line without an end
    for size in [1, 2, 7, 63, 64, 65, 4096, 65535, 65536, 65537, 1 << 20] {
        let output = RefCell::new(Vec::new());
        let pieces = Pieces {
            input: whole.as_bytes(),
            size,
            given: 0,
            output: &output,
        };
        serve(pieces, Shared(&output)).unwrap();
        let is_right = output.borrow().as_slice() == expected.as_bytes();
        assert!(is_right, "pieces of {size}");
    }
}

// Verifies: ORA-008, ORA-009.
// The keys of an answer are the names of its types.
#[allow(non_camel_case_types)]
#[test]
fn no_answer_holds_a_number_that_is_not_finite_however_deep_it_lies() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let outcomes = [
            json(answer! { first: 1.0, bad: bad }),
            json(answer! { first: 1.0, bad: [1.0, bad] }),
            json(answer! { first: 1.0, bad: [vec![0.0], vec![1.0, bad]], last: 1.0 }),
            json(answer! { first: 1.0, bad: [[[bad]]] }),
            json(answer! { first: [1.0], inner: answer! { bad: [Some(bad)] } }),
        ];
        for outcome in outcomes {
            let refused = outcome.unwrap_err();
            assert_eq!(refused.code, Code::Overflow);
            assert_eq!(refused.message, "bad would not be a finite number");
        }
    }
    assert!(json(answer! { a: [[f64::MAX, -0.0]], b: f64::MIN_POSITIVE }).is_ok());
}

// Verifies: ORA-001. A walk through what a line may be: cut, doubled, with bytes changed.
#[test]
fn damaged_lines_have_one_answer_each() {
    let line = br#"{"id":"a\u00e9","op":"theta_colored","args":{"residual":[1,-2e-3],"template":[1,1],"covariance":[[1,0.5],[0.5,2]]}}"#;
    let mut oracle = Oracle::default();
    let mut check = |line: &[u8]| {
        let mut out = Vec::new();
        oracle.answer(line, &mut out);
        assert_eq!(lines(&out), 1);
        assert_eq!(out.last(), Some(&b'\n'));
        let answer: serde_json::Value = serde_json::from_slice(&out).unwrap();
        assert!(answer.get("ok").is_some() != answer.get("error").is_some());
    };
    for place in 0..line.len() {
        check(&line[..place]);
        check(&line[place..]);
        for byte in 0..=255_u8 {
            if byte == b'\n' {
                continue;
            }
            let mut changed = line.to_vec();
            changed[place] = byte;
            check(&changed);
        }
        let mut inserted = line.to_vec();
        inserted.splice(place..place, line[place / 2..].iter().copied());
        check(&inserted);
    }
}

// Verifies: ORA-011.
#[test]
fn each_template_is_judged_whatever_the_others_have_come_to() {
    // θ grows by 2 or 1.5 or falls by 2.5 a row, and ends at ±ln 100 = ±4.605.
    let templates = [
        "[2,2,2,2,2,2,2,2,2,2,2,2]",
        "[1,1,1,1,1,1,1,1,1,1,1,1]",
        "[-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1]",
    ];
    let ended = |order: [usize; 3]| {
        let templates = order.map(|template| templates[template]).join(",");
        let residual = "[2,2,2,2,2,2,2,2,2,2,2,2]";
        let request = format!(
            "{{\"id\":1,\"op\":\"sequential_evidence\",\"args\":{{\"residual\":{residual},\"templates\":[{templates}],\
             \"nuisances\":[],\"max_false_alarm\":0.01,\"max_miss\":0.01}}}}"
        );
        let mut out = Vec::new();
        Oracle::default().answer(request.as_bytes(), &mut out);
        let answer: serde_json::Value = serde_json::from_slice(&out).unwrap();
        let at = |key: &str, place: usize| answer["ok"][key][place].as_u64().expect("a row");
        let places = [0, 1, 2].map(|template| order.iter().position(|of| *of == template).unwrap());
        places.map(|place| [at("inclusion_at", place), at("no_inclusion_at", place)])
    };
    for order in [
        [0, 1, 2],
        [1, 0, 2],
        [2, 1, 0],
        [2, 0, 1],
        [0, 2, 1],
        [1, 2, 0],
    ] {
        assert_eq!(ended(order), [[3, 0], [4, 0], [0, 2]], "{order:?}");
    }
}
