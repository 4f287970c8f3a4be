//! The C compiler asserts the layout that Rust has.

use std::process::Command;

/// For 64 bits, where the offsets of all fields are known.
// Verifies: CLB-007.
#[test]
fn the_c_compiler_is_given_the_offsets_of_rust() {
    let mut text = String::from("#include \"palpate.h\"\n#include <stddef.h>\n");
    for (name, size, fields) in palpate_c::LAYOUT {
        text += &format!("_Static_assert(sizeof(Palpate{name}) == {size}, \"{name}\");\n");
        for (field, offset) in *fields {
            text += &format!(
                "_Static_assert(offsetof(Palpate{name}, {field}) == {offset}, \"{name}.{field}\");\n"
            );
        }
    }
    let file = concat!(env!("CARGO_TARGET_TMPDIR"), "/layout.c");
    std::fs::write(file, text).unwrap();
    let mut compiler = Command::new("cc");
    compiler.args(["-std=c11", "-fsyntax-only", "-Iinclude", file]);
    compiler.current_dir(env!("CARGO_MANIFEST_DIR"));
    assert!(compiler.status().unwrap().success());
}
