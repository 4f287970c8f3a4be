//! Arguments and files that are refused.

use super::*;

// Verifies: CLI-041, CLI-042, CLI-003, CLI-048, CLI-140, ROB-008, CLI-239.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    place().refuses("detect", |words| {
        format!("detect --model exact with.csv {MAPS} {words}")
    });
    place().write("wrong.toml", "height_percent = -1");
    place().write("unknown.toml", "height_mm = 1");
    let with = place().read("with.csv");
    place().write("copy.csv", &with);
    let (before, _) = with.trim_end().rsplit_once(',').unwrap();
    place().write("huge.csv", format!("{before},1e300\n"));
    place().refuses("detect robust", |words| {
        format!("detect {} --depth-mm 3", words.replace("MAPS", MAPS))
    });
}

// Verifies: TRC-004, TRC-008, TRC-024, TRC-025, CLI-047, CLI-140, MAP-033.
#[test]
fn bad_files_are_refused_with_file_and_line() {
    let head = "position_mm,lateral_force_n,normal_force_n\n";
    for (name, rows) in [
        ("word.csv", "0,0,1\n1,zero,1\n"),
        ("infinite.csv", "0,0,inf\n"),
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
    place().refuses("detect files", |words| {
        format!(
            "detect --model exact {} {USUAL}",
            words.replace("MAPS", MAPS)
        )
    });
}
