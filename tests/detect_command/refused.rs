//! Arguments and files that are refused.

use super::*;

/// Arguments, and words of the refusal.
const REFUSED: &str = "
--noise-sd-n 0.1 => --depth-mm
--depth-mm 3 --noise-sd-lateral-n 1 => --noise-sd-normal-n
--depth-mm 3 --noise-sd-n 0.1 --noise-sd-lateral-n 1 --noise-sd-normal-n 1 => cannot be used with
--depth-mm 3 --noise-sd-n 0 => must be a force above 0 in N
--depth-mm 3 --noise-sd-n -1 => must be a force above 0 in N
--depth-mm 3 --noise-sd-n nan => must be a force above 0 in N
--depth-mm inf --noise-sd-n 1 => must be a position in mm
--depth-mm -1 --noise-sd-n 1 => depth -0.001 m is outside the map
--depth-mm 3.5 --noise-sd-n 1 => expected 0.002 to 0.003 m
--depth-mm 3 --noise-sd-n 0.1 --prior-h1 1 => strictly between 0 and 1
--depth-mm 3 --noise-sd-n 0.1 --max-miss 0.1 => --criterion map takes neither --max-miss nor --max-false-alarm
--depth-mm 3 --noise-sd-n 0.1 --criterion neyman-pearson-miss => --criterion neyman-pearson-miss needs --max-miss and takes no --max-false-alarm
--depth-mm 3 --noise-sd-n 0.1 --criterion neyman-pearson => neyman-pearson-miss
--depth-mm 3 --noise-sd-n 0.1 --velocity-mm-s 1 => --start-mm
--depth-mm 3 --noise-sd-n 0.1 --velocity-mm-s 1 --start-mm 0 => expected neither velocity nor start
--depth-mm 3 --noise-sd-n 0.1 --tirm => --trim
--depth-mm 3 --noise-sd-n 0.1 --bank bank.json => cannot be used with
--depth-mm 3 --noise-sd-n 0.1 --figure place.svg => cannot be used with '--figure
--depth-mm 3 --noise-sd-n 0.1 --simulations 1000 => cannot be used with '--simulations
--depth-mm 3 --noise-sd-n 0.1 --prior prior.csv => cannot be used with '--prior
--depth-mm 3 --known ofset => \"ofset\" is none of offset, drift, gain, depth, variance, all and none
--depth-mm 3 --known variance => --known variance needs --noise-sd-n, or --noise FILE
--depth-mm 3 --known all => --known variance needs --noise-sd-n, or --noise FILE
--depth-mm 3 --noise pink => pink: cannot be read
--depth-mm 3 --noise with.csv => with.csv: 33 samples, expected at least 100
--depth-mm 3 --depth-tolerance-mm -1 => must be a length of at least 0 in mm
";

// Verifies: CLI-041, CLI-042, CLI-003, CLI-048, CLI-140.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    place().refuses(REFUSED, |words| format!("detect with.csv {MAPS} {words}"));
}

/// Files and other arguments, and words of the refusal.
const REFUSED_FILES: &str = "
word.csv MAPS => word.csv:3: lateral_force_n = \"zero\"
nan.csv MAPS => nan.csv:2: normal_force_n = \"NaN\"
unsorted.csv MAPS => unsorted.csv:4: position 0.5 mm after 1.0 mm
far.csv MAPS => far.csv:3: position 9.0 mm is outside the maps, expected -8.0 to 8.0 mm (or use --trim)
away.csv --trim MAPS => away.csv: all of 2 samples are outside the maps, expected -8.0 to 8.0 mm
twice.csv MAPS => twice.csv:1: columns position_m and position_mm in the header
empty.csv MAPS => empty.csv:1: no samples
latin1.csv MAPS => latin1.csv: cannot be read
missing.csv MAPS => missing.csv: cannot be read
with.csv --reference missing.json --inclusion inclusion.json => palpate solve
with.csv --reference inclusion.json --inclusion none.json => none.json: the maps are swapped
with.csv --reference none.json --inclusion none.json => none.json: the map has no inclusion
with.csv --reference inclusion.json --inclusion inclusion.json => the reference map already contains an inclusion
with.csv --reference other-gel.json --inclusion inclusion.json => phantom.layer[0].material.youngs_modulus_pa is
with.csv --reference coarse.json --inclusion inclusion.json => mesh_size_m is
with.csv --reference with.csv --inclusion inclusion.json => with.csv:2: no column depth_mm or depth_m in the header
with.csv --bank missing.json => missing.json: cannot be read
with.csv --bank bank.json --simulations 9 => --max-false-alarm
with.csv --bank bank.json --simulations 9 --max-false-alarm 0.1 => --criterion map takes neither
";

// Verifies: TRC-004, TRC-008, TRC-024, TRC-025, CLI-047, CLI-140, MAP-033.
#[test]
fn bad_files_are_refused_with_file_and_line() {
    let head = "position_mm,lateral_force_n,normal_force_n\n";
    for (name, rows) in [
        ("word.csv", "0,0,1\n1,zero,1\n"),
        ("nan.csv", "0,0,NaN\n"),
        ("unsorted.csv", "0,0,1\n1,0,1\n0.5,0,1\n2,0,1\n"),
        ("far.csv", "0,0,1\n9,0,1\n"),
        ("away.csv", "9,0,1\n9.5,0,1\n"),
        ("empty.csv", ""),
    ] {
        place().write(name, format!("{head}{rows}"));
    }
    place().write("latin1.csv", b"position_mm\xff");
    place().write("twice.csv", format!("position_m,{head}0,0,0,1\n"));
    let mut other: Value = serde_json::from_str(&place().read("none.json")).unwrap();
    let mesh_size = other["certificate"]["mesh_size_m"].clone();
    other["certificate"]["mesh_size_m"] = 0.003.into();
    place().write("coarse.json", other.to_string());
    other["certificate"]["mesh_size_m"] = mesh_size;
    other["phantom"]["layer"][0]["material"]["youngs_modulus_pa"] = 7.5e4.into();
    place().write("other-gel.json", other.to_string());
    place().refuses(REFUSED_FILES, |words| {
        format!("detect {} {USUAL}", words.replace("MAPS", MAPS))
    });
}
