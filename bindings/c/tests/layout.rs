//! The C compiler asserts the layout that Rust has.

use std::path::Path;

/// For 64 bits, where the offsets of all fields are known.
// Verifies: CLB-007.
#[test]
fn the_c_compiler_is_given_the_offsets_of_rust() {
    let mut text = String::from(
        "/* Written by tests/layout.rs from the offsets that Rust computes, for 64 bits. */\n\
         #include \"palpate.h\"\n\n#include <stddef.h>\n\n",
    );
    for (name, size, fields) in palpate_c::LAYOUT {
        text += &format!("_Static_assert(sizeof(Palpate{name}) == {size}, \"{name}\");\n");
        for (field, offset) in *fields {
            text += &format!(
                "_Static_assert(offsetof(Palpate{name}, {field}) == {offset}, \"{name}.{field}\");\n"
            );
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/layout.c");
    if std::env::var_os("PALPATE_WRITE_LAYOUT").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).unwrap() == text,
        "tests/layout.c is not current: PALPATE_WRITE_LAYOUT=1 cargo test -p palpate-c writes it"
    );
}
