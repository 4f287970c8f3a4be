//! Answers are right, acceptable or wrong, and the verdict says so.

use std::fs;

use serde_json::{Value, json};

use crate::program::*;

// Verifies: ORA-047, ORA-048.
#[test]
fn wrong_answers_name_their_bug() {
    let answer = r#"echo '{"id":"choice-002","ok":{"p_correct":0.15865525393145707,"more":1}}';;"#;
    let found = run("wrong", &shell(&format!("*choice-002*) {answer}")), "20");
    found.expect(&[("choice-002", "expected 0.8413447460685429 within 2 ulp")]);
    let complement =
        json!({"flag": "complement", "bug": "the rate of wrong answers", "notes": "p for 1 - p"});
    assert_eq!(
        found.verdict["diagnosis"],
        json!([{"group": "choice", "class": "mathematics", "wrong": 1, "explanations": [
            {"bugs": [complement], "explains": 1, "against": 0, "first_case": "choice-002"}]}])
    );
    // A wrong answer that is no known bug's names none.
    let answer = r#"echo '{"id":"choice-002","ok":{"p_correct":0.5}}';;"#;
    let found = run("odd", &shell(&format!("*choice-002*) {answer}")), "20");
    found.expect(&[("choice-002", "p_correct is 0.5")]);
    assert_eq!(found.verdict["diagnosis"][0]["explanations"], json!([]));
    // What is not refused names the flags of the case.
    let answer = r#"echo '{"id":"choice-003","ok":{"p_correct":0.2}}';;"#;
    let found = run("accepts", &shell(&format!("*choice-003*) {answer}")), "20");
    found.expect(&[("choice-003", "must be refused")]);
    assert_eq!(first_bug(&found.verdict), "negative");
}

// Verifies: ORA-058.
#[test]
fn an_error_without_a_code_is_no_refusal() {
    for (error, class) in [
        ("null", json!("protocol")),
        ("false", json!("protocol")),
        ("[]", json!("protocol")),
        (r#""no""#, Value::Null),
        ("{}", Value::Null),
        (r#"{"code":null}"#, Value::Null),
    ] {
        let answer = format!("*choice-003*) echo '{{\"id\":\"choice-003\",\"error\":{error}}}';;");
        let word = "expected an object with a code";
        let found = run("no-refusal", &shell(&answer), "20");
        found.expect(&[("choice-003", word)]);
        assert_eq!(found.verdict["findings"][0]["class"], class, "{error}");
    }
    let answer = r#"*choice-003*) echo '{"id":"choice-003","error":{"code":"own"}}';;"#;
    run("refusal-of-its-own", &shell(answer), "20").expect(&[]);
}

// Verifies: ORA-046, ORA-067.
#[test]
fn a_profile_widens_the_tolerance_by_the_condition() {
    let mut file = vectors();
    // Φ(1) and a condition of 2: 2⁻⁵³·2 = 2.2e-16 beside 2 ulp, 2⁻²⁴·2 = 1.2e-7.
    file["cases"][1]["condition"] = json!({"p_correct": 2.0});
    let folder = write("profile", &file);
    let profile =
        json!({"name": "coarse", "unit_roundoff": 0.001, "smallest": 1e-3, "largest": 1e3});
    fs::write(folder.join("coarse.json"), profile.to_string()).unwrap();
    fs::rename(folder.join("choice.json"), folder.join("choice")).unwrap();
    fs::create_dir(folder.join("v")).unwrap();
    fs::rename(folder.join("choice"), folder.join("v/choice.json")).unwrap();
    let found = |profile: &str, answer: &str, more: &str| {
        let answer = format!(
            "*choice-002*) echo '{{\"id\":\"choice-002\",\"ok\":{{\"p_correct\":{answer}}}}}';;"
        );
        let options = format!("--vectors v --profile {profile} {more}");
        conform_at(&folder, &options, &["sh", "-c", &shell(&answer)])
            .status
            .code()
    };
    for [profile, answer, code] in rows(
        "exact | 0.8413447460685433 | 1\n f64 | 0.8413447460685433 | 0\n f64 | 0.8413447460685436 | 1
         f32 | 0.8413448 | 0\n f32 | 0.8413449 | 1\n coarse.json | 0.8433 | 0\n coarse.json | 0.8434 | 1",
    ) {
        assert_eq!(found(profile, answer, ""), Some(code.parse().unwrap()), "{profile} {answer}");
    }
    for (text, word) in [
        ("{", "EOF"),
        (
            "{\"name\":\"a\",\"unit_roundoff\":1,\"smallest\":0.1,\"largest\":9}",
            "unit_roundoff = 1",
        ),
        (
            "{\"name\":\"a\",\"unit_roundoff\":0.1,\"smallest\":2,\"largest\":9}",
            "smallest = 2",
        ),
    ] {
        fs::write(folder.join("coarse.json"), text).unwrap();
        let output = conform_at(&folder, "--vectors v --profile coarse.json", &["true"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            error(&output).contains(word) && error(&output).contains("coarse.json"),
            "{}",
            error(&output)
        );
    }
    let output = conform_at(&folder, "--vectors v --profile f16", &["true"]);
    assert!(
        error(&output).contains("expected exact, f64, f32 or a file"),
        "{}",
        error(&output)
    );
}

// Verifies: ORA-067.
#[test]
fn known_mistakes_are_accepted_with_their_reason_and_told_when_they_are_mended() {
    let folder = write("accept", &vectors());
    let answer = r#"*choice-002*) echo '{"id":"choice-002","ok":{"p_correct":0.5}}';;"#;
    let accept = |list: &str| {
        fs::write(folder.join("known"), list).unwrap();
        let options = "--vectors . --accept known --format json";
        conform_at(&folder, options, &["sh", "-c", &shell(answer)])
    };
    let output =
        accept("# of version 1\n\nchoice-002   a table of five digits\nchoice-001 once wrong\n");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let verdict = json_of(&output);
    assert_eq!(verdict["findings"][0]["accepted"], "a table of five digits");
    assert_eq!(verdict["groups"][0]["accepted"], 1);
    assert_eq!(verdict["mended"], json!(["choice-001"]));
    for (list, word) in [
        ("choice-002", "known:1: choice-002 has no reason"),
        ("\nchoice-9 a", "known:2: no case \"choice-9\""),
        (
            "choice-002 a\nchoice-002 b",
            "known:2: choice-002 stands here twice",
        ),
    ] {
        let output = accept(list);
        assert_eq!(output.status.code(), Some(2));
        assert!(error(&output).contains(word), "{}", error(&output));
    }
}

// Verifies: ORA-040.
#[test]
fn cases_are_chosen_left_out_and_shown() {
    let folder = write("choice", &vectors());
    let oracle = [&palpate()[..], "oracle"];
    let counts = |options: &str| {
        let options = format!("--vectors . --format json {options}");
        let verdict = json_of(&conform_at(&folder, &options, &oracle));
        let of = &verdict["groups"][0];
        [&of["cases"], &of["right"], &of["skipped"]].map(|count| count.as_u64().unwrap())
    };
    assert_eq!(counts(""), [4, 4, 0]);
    assert_eq!(counts("--case choice-002 --case choice-004"), [2, 2, 0]);
    assert_eq!(counts("--skip choice-002"), [4, 3, 1]);
    let output = conform_at(&folder, "--vectors . --skip choice", &oracle);
    assert_eq!(output.status.code(), Some(1), "nothing is checked");
    let output = plain(&folder, "--vectors . --case choice-002 --show");
    let expected = "choice-002: root 2\n{\"args\":{\"gamma\":1.4142135623730951},\"id\":\"choice-002\",\"op\":\"two_afc\"}\n\
                    p_correct = 0.8413447460685429 within 2 ulp\n";
    assert_eq!(stdout(&output), expected);
    for words in [
        "--case choice-009 --show",
        "--skip choice-009 -- true",
        "--show -- true",
    ] {
        let output = plain(&folder, &format!("--vectors . {words}"));
        assert_eq!(output.status.code(), Some(2), "{words} {output:?}");
        error(&output);
    }
}

// Verifies: ORA-043, ORA-058.
#[test]
fn loose_answers_are_told() {
    let folder = write("loose", &vectors());
    let banner = r#"*choice-002*) echo 'Octave 7'; echo '{"id":"choice-002","ok":{"p_correct":0.8413447460685429}}';;"#;
    let output = conform_at(
        &folder,
        "--vectors . --lenient",
        &["sh", "-c", &shell(banner)],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let told = "note: passed over, since it is no answer: Octave 7";
    assert!(stdout(&output).contains(told), "{}", stdout(&output));
    let script = format!("echo hello; {}", shell(""));
    for (lenient, code) in [("--lenient", 0), ("", 1)] {
        let options = format!("--vectors . {lenient}");
        let output = conform_at(&folder, &options, &["sh", "-c", &script]);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
    }
    let no_id = r#"*choice-002*) echo '{"ok":{"p_correct":0.8413447460685429}}';;"#;
    for (require, code) in [("right", 1), ("acceptable", 0)] {
        let options = format!("--vectors . --require {require}");
        let output = conform_at(&folder, &options, &["sh", "-c", &shell(no_id)]);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
    }
}

// Verifies: ORA-048, ORA-050.
#[test]
fn the_page_says_what_was_judged_and_stands_alone() {
    let folder = write("page", &vectors());
    fs::write(folder.join("known"), "choice-003 <b>later</b>\n").unwrap();
    fs::write(
        folder.join("program"),
        shell("*choice-003*) echo '{\"id\":\"choice-003\",\"ok\":{}}';;"),
    )
    .unwrap();
    let page = |options: &str| {
        conform_at(
            &folder,
            &format!("--vectors . --accept known {options}"),
            &["sh", "program"],
        )
    };
    let (html, verdict) = (page("--format html"), json_of(&page("--format json")));
    let text = stdout(&html);
    assert_eq!(html.status.code(), Some(0));
    // Numbers are set to the right, words and cells of nothing are not.
    let mut wanted = vec![
        "<td>choice-003</td>",
        "<td class=\"n\">1</td>",
        "&lt;b&gt;later&lt;/b&gt;",
        "passed",
        "Signature",
    ];
    wanted.push(verdict["suite_sha256"].as_str().unwrap());
    let files = verdict["program"]["files"].as_array().unwrap();
    assert_eq!(files.len(), 2, "the shell, and the file that it reads");
    wanted.extend(files.iter().map(|file| file["sha256"].as_str().unwrap()));
    for word in wanted {
        assert!(text.contains(word), "{word} is not in {text}");
    }
    assert!(!text.contains("<b>") && !text.contains("src=") && !text.contains("href="));
}

// Verifies: ORA-050.
#[test]
fn the_verdict_for_ci_holds_every_case_and_is_the_same_each_time() {
    let folder = write("junit", &vectors());
    let answer = r#"echo '{"id":"choice-003","ok":{"p_correct":"<&>"}}';;"#;
    let script = shell(&format!("*choice-003*) {answer}"));
    let run = || {
        conform_at(
            &folder,
            "--vectors . --format junit",
            &["sh", "-c", &script],
        )
    };
    let output = run();
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites "));
    let suite = r#"<testsuite name="choice" tests="4" failures="1" errors="0" skipped="0">"#;
    assert!(text.contains(suite), "{text}");
    assert_eq!(text.matches("<testcase ").count(), 4);
    assert_eq!(text.matches("<failure ").count(), 1);
    assert!(text.contains("name=\"choice-003: below 0 &lt;&amp;&gt;\"><failure type=\"range\" message=\"answered {&quot;p_correct&quot;:&quot;&lt;&amp;&gt;&quot;}"), "{text}");
    assert_eq!(stdout(&run()), text);
}
