//! The oracle in a process of your own, without a pipe: `cargo run -p palpate --example oracle`.

use std::error::Error;

use palpate::oracle::Oracle;

/// A question that it answers, one with a mistyped argument, and a line that is no JSON.
const QUESTIONS: [&str; 3] = [
    r#"{"id":1,"op":"error_rates","args":{"gamma":3.3,"eta":0}}"#,
    r#"{"id":2,"op":"error_rates","args":{"gama":3.3,"eta":0}}"#,
    "error_rates",
];

fn main() -> Result<(), Box<dyn Error>> {
    // It keeps the finite-element models that it has solved.
    let mut oracle = Oracle::default();
    for question in QUESTIONS {
        let mut answer = Vec::new();
        oracle.answer(question.as_bytes(), &mut answer);
        print!("{question}\n  {}", String::from_utf8(answer)?);
    }
    Ok(())
}
