//! The robust model, which is the default, end to end.

use super::{MAPS, NOISE, maps, place, sweep, write_trace};
use crate::program::text;
use palpate::file::from_toml;
use palpate::force::Force;
use palpate::force_map::ForceMap;
use palpate::robust::GelUncertainty;
use palpate::stats::random::Generator;
use palpate_asserts::assert_has;
use serde_json::{Value, json};

/// The answer in JSON and the code of the end.
fn answer(arguments: &str) -> (Value, Option<i32>) {
    let output = place().run(&format!("detect {arguments} --format json"));
    let said = text(&output.stderr).to_string();
    let answer = serde_json::from_slice(&output.stdout);
    (answer.expect(&said), output.status.code())
}

// Verifies: ROB-003.
#[test]
fn a_good_sweep_does_not_vouch_for_a_sensor_in_air() {
    let [reference, _] = maps(place());
    let sound = sweep(reference.table());
    let air: Vec<_> = sound.iter().map(|[x, ..]| [*x, 0.0, 0.0]).collect();
    write_trace(place(), "aloft.csv", &air, 11);
    for more in [
        "",
        "--reference-sweep without.csv",
        "without.csv --together",
    ] {
        let asked = format!("aloft.csv {more} {MAPS} --depth-mm 3 --known gel,support");
        let (found, code) = answer(&asked);
        let causes = &found["causes"];
        assert_eq!((causes, code), (&json!(["no_contact"]), Some(3)), "{more}");
    }
}

// Verifies: ROB-012.
#[test]
fn slow_noise_of_a_blank_sweep_counts_more_and_is_told_as_it_is() {
    // Each force for four samples: the standard deviation is that of the forces, and the correlation length about 4.
    let generator = Generator::new(20_261_128, 1);
    let rows = (0..1200).map(|i| {
        let force = |(sd, channel)| sd * generator.normal(channel, i / 4);
        let Force { lateral, normal } = NOISE.zip(Force::new(0, 1)).map(force);
        format!("{i},{lateral},{normal}\n")
    });
    let head = "time_ms,lateral_force_n,normal_force_n\n".to_string();
    place().write("slow.csv", head + &rows.collect::<String>());
    let found = |noise: &str| answer(&format!("with.csv {MAPS} --depth-mm 3 {noise}")).0;
    let slow = found("--noise slow.csv");
    let white = found("--noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12");
    let keys = Force::new("noise_sd_lateral_n", "noise_sd_normal_n");
    for (key, sd) in keys.zip(NOISE).into_array() {
        // Of 300 forces it is known to 1/√600.
        let ratio = slow[key].as_f64().unwrap() / sd;
        assert!((ratio - 1.0).abs() < 5.0 / 600_f64.sqrt(), "{slow}");
    }
    let theta = |found: &Value| found["theta"].as_f64().unwrap();
    assert!(theta(&slow) < 0.8 * theta(&white), "{slow} {white}");
}

// Verifies: ROB-001, ROB-009.
#[test]
fn a_lateral_force_that_is_none_or_of_the_other_sign_gives_no_answer() {
    let [_, map] = maps(place());
    let write = |factor: f64, of_normal: f64, stream| {
        let generator = Generator::new(20_261_128, stream);
        let rows = (0..).zip(sweep(map.table()));
        let rows = rows.map(|(i, [x, lateral, normal])| {
            let noise = [0, 1].map(|channel| 0.01 * generator.normal(channel, i));
            let lateral = factor * (lateral + noise[0]);
            format!("{x},{lateral:e},{:e}\n", of_normal * (normal + noise[1]))
        });
        let head = "position_mm,lateral_force_n,normal_force_n\n";
        place().write("lateral.csv", format!("{head}{}", rows.collect::<String>()));
    };
    // Without the classes in which the probe rubs unevenly or the sensor sways, 33 samples are enough.
    let asked = || {
        answer(&format!(
            "lateral.csv {MAPS} --depth-mm 3 --known friction,walk"
        ))
    };
    for stream in 2..6 {
        for (factor, decision, causes, code) in [
            (1.0, "inclusion", json!([]), 0),
            (-1.0, "cannot_be_judged", json!(["channels"]), 3),
            (0.0, "cannot_be_judged", json!(["saturated"]), 3),
        ] {
            write(factor, 1.0, stream);
            let (found, ended) = asked();
            let expected = (&json!(decision), &causes, Some(code));
            assert_eq!(
                (&found["decision"], &found["causes"], ended),
                expected,
                "{found}"
            );
        }
    }
    // Only one force in another unit: that is what is wrong, not the other one.
    write(1.0, 1e3, 2);
    assert_eq!(asked().0["causes"], json!(["force_unit"]));
}

// Verifies: ROB-085.
#[test]
fn a_sweep_that_is_too_long_or_at_the_surface_is_refused() {
    let row = |k: u32| format!("{},0,1.{k}\n", f64::from(k) * 1.6e-3 - 8.0);
    let rows: String = (0..=10_000).map(row).collect();
    place().write(
        "long.csv",
        format!("position_mm,lateral_force_n,normal_force_n\n{rows}"),
    );
    assert_eq!(
        place().refused(&format!("detect long.csv {MAPS} --depth-mm 3")),
        "long.csv: 10001 samples; give at most 10000, such as means of neighbours"
    );
    for (file, force) in [("surface-none.csv", 1.0), ("surface-disc.csv", 1.5)] {
        let row = |k: i32| format!("0,{k},{},0\n", force + 0.01 * f64::from(k * k));
        let rows: String = (-8..=8).map(row).collect();
        place().write(
            file,
            format!("depth_mm,lateral_mm,normal_force_n,lateral_force_n\n{rows}"),
        );
    }
    assert_eq!(
        place().refused(
            "detect with.csv --reference surface-none.csv --inclusion surface-disc.csv --depth-mm 0"
        ),
        "with.csv: the sweep touches the surface alone; give a depth inside the gel, or maps with rows at several depths"
    );
}

// Verifies: CLI-140, CLI-143, CLI-043, ROB-003, ROB-004, ROB-030, ROB-040, ROB-043, ROB-050.
#[test]
fn the_robust_model_is_the_default_and_has_three_answers() {
    let map = ForceMap::read(&place().at("inclusion.json")).unwrap();
    let row = map.table().row(0.003).unwrap();
    let laterals = map.table().laterals();
    let sweep = |scale: f64, along: f64| -> Vec<[f64; 3]> {
        let sample = |at: usize| {
            [
                1e3 * along * laterals[at],
                scale * row.lateral[at],
                scale * row.normal[at],
            ]
        };
        (0..laterals.len()).map(sample).collect()
    };
    for (file, scale, along) in [
        ("strong.csv", 20.0, 1.0),
        ("metres.csv", 1.0, 1e-3),
        ("turned.csv", -1.0, 1.0),
    ] {
        write_trace(place(), file, &sweep(scale, along), 9);
    }
    let sharp =
        "--depth-mm 3 --known gel,support,surface,stage,tilt,friction,relaxation,walk,smooth";
    let (found, code) = answer(&format!("with.csv {MAPS} {sharp}"));
    assert_eq!(
        (&found["decision"], code),
        (&json!("inclusion"), Some(0)),
        "{found}"
    );
    assert_eq!(
        (&found["model"], &found["schema_version"]),
        (&json!("robust"), &json!(4))
    );
    // Beside what is known, two classes are left.
    assert!(found["posterior_h1"].as_f64().unwrap() > 0.95);
    assert!(
        ["the maps hold", "the forces are off smoothly by 0.5 %"]
            .contains(&found["class_with"]["class"].as_str().unwrap())
    );
    let (found, code) = answer(&format!("without.csv {MAPS} {sharp}"));
    assert_eq!(
        (&found["decision"], code),
        (&json!("no_inclusion"), Some(0)),
        "{found}"
    );
    // Where nothing is known, 33 samples in noise of 0.1 N are too few.
    let (found, code) = answer(&format!("without.csv {MAPS} --depth-mm 3 --sure 0.999"));
    assert_eq!(
        (&found["causes"], code),
        (&json!(["too_weak"]), Some(3)),
        "{found}"
    );
    assert!(found["posterior_h1"].is_f64());
    for (file, cause) in [
        ("strong.csv", "level"),
        ("metres.csv", "narrow"),
        ("turned.csv", "sign"),
    ] {
        let (found, code) = answer(&format!("{file} {MAPS} --depth-mm 3"));
        assert_eq!(
            (&found["causes"], code),
            (&json!([cause]), Some(3)),
            "{found}"
        );
        assert_eq!(found["posterior_h1"], Value::Null);
        // Before it is compared, it has no level and no noise.
        if cause == "narrow" {
            let of = ["level", "noise_sd_lateral_n", "noise_sd_normal_n"].map(|key| &found[key]);
            assert_eq!(of, [&Value::Null; 3], "{found}");
        }
    }
    // Two sweeps of one place say more than one.
    let theta = |traces: &str, depths: &str| {
        let (found, _) = answer(&format!(
            "{traces} {MAPS} --depth-mm {depths} --known gel,support"
        ));
        found["theta"].as_f64().unwrap()
    };
    let both = theta("with.csv disturbed.csv --together", "3");
    assert!(both > theta("with.csv", "3"), "{both}");
    assert_eq!(both, theta("with.csv disturbed.csv --together", "3,3"));
}

// Verifies: ROB-041, ROB-042, CLI-140.
#[test]
fn a_bank_tells_where_and_down_to_which_depth_there_is_none() {
    let known = "--known gel,support,surface,stage,tilt,friction,relaxation,walk,smooth";
    let (found, _) = answer(&format!(
        "moved.csv --bank bank.json --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12 {known}"
    ));
    assert_eq!(found["decision"], "inclusion", "{found}");
    let ends = &found["position"]["interval"];
    let holds = |end: &Value, is_within: fn(f64) -> bool| {
        end.is_null() || end.as_f64().is_some_and(is_within)
    };
    assert!(
        holds(&ends[0], |x| x < 1.5e-3) && holds(&ends[1], |x| x > 1.5e-3),
        "{found}"
    );
    assert_eq!(found["no_inclusion_down_to_m"], Value::Null);
    let (found, _) = answer(&format!(
        "without.csv --bank bank.json --noise-sd-lateral-n 0.05 --noise-sd-normal-n 0.12 {known}"
    ));
    assert_eq!(found["decision"], "no_inclusion", "{found}");
    assert_eq!(found["no_inclusion_down_to_m"], 3.6e-3);
    let other = place().run("detect moved.csv --bank bank.json --depth-mm 2");
    assert_eq!(other.status.code(), Some(2));
    assert_has(
        text(&other.stderr),
        "the bank is for a depth of 3.0 mm, not 2.0 mm; give 3.0, or another bank",
    );
}

// Verifies: CLI-163, ROB-044.
#[test]
fn a_figure_shows_the_record_beside_what_explains_it() {
    let [_, inclusion] = maps(place());
    let mut spiked = sweep(inclusion.table());
    spiked[16][2] += 50.0;
    write_trace(place(), "spiked.csv", &spiked, 10);
    let turned = sweep(inclusion.table());
    let turned: Vec<_> = turned.iter().map(|[x, l, n]| [*x, -l, -n]).collect();
    write_trace(place(), "negative.csv", &turned, 10);
    let figure = |arguments: &str| {
        let (found, _) = answer(&format!("{arguments} --figure explained.svg"));
        (found, place().read("explained.svg"))
    };
    let holds = |figure: &str, words: &str| {
        for words in words.split('|') {
            assert_has(figure, &format!(">\n{words}\n<"));
        }
    };
    let (found, both) = figure(&format!(
        "with.csv spiked.csv {MAPS} --depth-mm 3 --together"
    ));
    assert_eq!(found["glitches"], json!([0, 1]), "{found}");
    holds(
        &both,
        "Normal force, sweep 1 (N)|Lateral force, sweep 2 (N)|record|left out as a glitch|without an inclusion\
         |with an inclusion|What is left without an inclusion (N)|What is left with an inclusion (N)|Position x (mm)",
    );
    // 33 samples in 2 sweeps and 2 channels, as they are and over either hypothesis; 4 keys to the record and one to the glitch.
    assert_eq!(both.matches("<circle").count(), 33 * 4 * 3 + 5);
    let class = found["class_without"]["class"].as_str().unwrap();
    assert_has(&both, &format!("Likeliest without an inclusion: {class} ("));
    let (found, bank) = figure("moved.csv --bank bank.json --known gel,support,surface,stage");
    assert_eq!(found["decision"], "inclusion", "{found}");
    assert_has(&bank, "An inclusion. Probability of an inclusion: ");
    holds(
        &bank,
        "Probability, if there is one|Position x of the inclusion (mm)|Depth of the inclusion (mm)",
    );
    // What is not compared is shown alone.
    let (_, alone) = figure(&format!("negative.csv {MAPS} --depth-mm 3"));
    assert_has(
        &alone,
        "It cannot be judged: the forces have the opposite sign",
    );
    assert_eq!(alone.matches("<circle").count(), 33 * 2 + 2);
}

// Verifies: CLI-140, ROB-032, BNK-012.
#[test]
fn a_prior_excludes_what_it_gives_no_weight() {
    // The inclusion is at 1.5 mm.
    let left = "position_mm,depth_mm,diameter_mm,youngs_modulus_kpa,weight\n-3,2.6,6.4,1200,1\n-3,3.6,6.4,1200,1\n";
    place().write("left.csv", left);
    let asked = "moved.csv --bank bank.json --known gel,support,surface,stage";
    let estimate = |more: &str| {
        let (found, _) = answer(&format!("{asked} {more}"));
        found["position"]["estimate"].as_f64().expect("a position")
    };
    assert!((estimate("") - 1.5e-3).abs() < 1e-3);
    assert!((estimate("--prior left.csv") + 3e-3).abs() < 1e-12);
}

// Verifies: ROB-020, ROB-033, ROB-046, ROB-047, ROB-002, CLI-140, CLI-045.
#[test]
fn what_is_known_of_the_gel_makes_an_answer_surer() {
    place().write("gel.toml", "height_percent = 0\nsupport_percent = 0");
    let known = "--depth-mm 3 --known smooth,surface,stage,tilt,friction,relaxation,walk";
    let found = |more: &str| answer(&format!("with.csv {MAPS} {known} {more}")).0;
    let theta = |found: &Value| found["theta"].as_f64().unwrap();
    let alone = theta(&found(""));
    for (more, key, file) in [
        (
            "--gel-uncertainty gel.toml",
            "gel_uncertainty",
            json!("gel.toml"),
        ),
        (
            "--reference-sweep without.csv",
            "reference_sweeps",
            json!(["without.csv"]),
        ),
    ] {
        let found = found(more);
        let known = theta(&found);
        assert!(known > alone + 1.0, "{more}: {known}, alone {alone}");
        assert_eq!((&found[key], &found["samples"]), (&file, &json!(33)));
    }
    let found = found("--sure 0.9 --zeroed");
    let asked = ["known", "sure", "zeroed", "reference_sweeps"].map(|key| found[key].clone());
    let parts = [
        "smooth",
        "stage",
        "surface",
        "tilt",
        "friction",
        "relaxation",
        "walk",
    ];
    assert_eq!(json!(asked), json!([parts, 0.9, true, []]));
    // What would help a weak record; and one glitch, which is replaced and told.
    let rows = std::fs::read_to_string(place().at("without.csv")).unwrap();
    let mut lines: Vec<_> = rows.lines().map(String::from).collect();
    let middle = lines.len() / 2;
    let cut = lines[middle].rfind(',').unwrap();
    lines[middle].replace_range(cut.., ",9");
    place().write("glitch.csv", lines.join("\n"));
    let output = place().run(&format!(
        "detect glitch.csv {MAPS} --depth-mm 3 --sure 0.999"
    ));
    let (told, said) = (text(&output.stdout), text(&output.stderr));
    assert!(
        said.contains("glitch.csv: samples replaced as glitches: 1"),
        "{said}"
    );
    assert!(told.contains("what would help"), "{told}");
    let (found, _) = answer(&format!("with.csv {MAPS} {known}"));
    // Beside every class θ of an answer that is sure has N(∓γ²/2, γ²): at worst Q(√(2 ln 19)).
    for rate in ["false_alarm", "miss"] {
        let rate = found[rate].as_f64().unwrap();
        assert!((1e-30..=0.00763).contains(&rate), "{found}");
    }
}

// Verifies: ROB-004, ROB-020, CLI-040.
#[test]
fn measured_maps_need_no_phantom_and_are_seen_if_exchanged() {
    for file in ["none", "inclusion"] {
        let map = ForceMap::read(&place().at(&format!("{file}.json"))).unwrap();
        let row = map.table().row(0.003).unwrap();
        let laterals = map.table().laterals();
        let sample = |at: usize| {
            let (x, normal, lateral) = (1e3 * laterals[at], row.normal[at], row.lateral[at]);
            format!("3,{x},{normal},{lateral}\n")
        };
        let rows: String = (0..laterals.len()).map(sample).collect();
        let head = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n";
        place().write(&format!("{file}.csv"), format!("{head}{rows}"));
    }
    let known = "--depth-mm 3 --known smooth,surface,stage,tilt,friction,relaxation,walk";
    let maps = "--reference none.csv --inclusion inclusion.csv";
    let (found, code) = answer(&format!("with.csv {maps} {known}"));
    assert_eq!(
        (&found["decision"], code),
        (&json!("inclusion"), Some(0)),
        "{found}"
    );
    place().write("gel.toml", "height_percent = 0");
    let asked = format!("detect with.csv {maps} {known} --gel-uncertainty gel.toml");
    let refused = "--gel-uncertainty needs maps that state their phantom; leave it out";
    assert_eq!(place().refused(&asked), refused);
    let maps = "--reference inclusion.csv --inclusion none.csv";
    let (found, _) = answer(&format!("with.csv {maps} {known}"));
    assert_eq!(found["causes"][0], "exchanged", "{found}");
}

// Verifies: ROB-020.
#[test]
fn the_uncertainty_on_the_page_is_the_default() {
    let page = std::path::Path::new(crate::ROOT).join("docs/how-to/detect.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (block, _) = page
        .split_once("```toml\n")
        .unwrap()
        .1
        .split_once("```")
        .unwrap();
    assert_eq!(block.lines().count(), 7);
    let found: GelUncertainty = from_toml(block, "page").unwrap();
    assert_eq!(found, GelUncertainty::default());
    // Each line counts.
    for line in block.lines() {
        let (key, _) = line.split_once(" = ").unwrap();
        let found: GelUncertainty = from_toml(&format!("{key} = 0.0"), "line").unwrap();
        assert_ne!(found, GelUncertainty::default(), "{key}");
    }
}
