//! The last section: how to rerun, and what the page does not say.

use super::Page;

/// How to rerun, and limits.
///
/// Implements: REP-041.
pub fn closing(_page: &Page<'_>) -> String {
    "<h3>How to rerun</h3>\n\
     <p>In the folder of the source, with a Rust toolchain and a C compiler:</p>\n\
     <pre><code>cargo run --release -- run</code></pre>\n\
     <p>It writes this page, <code>summary.json</code> with the same numbers for programs, every map and every figure. \
     The same input gives the same bytes. With <code>--config FILE</code> it runs other phantoms, depths, noise or \
     measured maps; <code>spec/command-line.md</code> has every key, and <code>spec/report.md</code> says what each \
     file must hold.</p>\n\
     <h3>Limits</h3>\n\
     <ul>\n\
     <li>The model is two-dimensional, linear, static and without friction, as the paper's is, with moduli that the \
     paper calls “roughly determined”. Where a map's smallest det(I + ∇u) is low, small strain is at its limit.</li>\n\
     <li>Nothing here was measured on tissue. The error rates are those of the model under its own noise, not of a \
     device or of a person.</li>\n\
     <li>The answers of the subjects are the paper's, ten persons in 1999; no one was tested for this page.</li>\n\
     <li>The paper's measured forces are not available, so nothing here compares the model with a gel.</li>\n\
     <li>It is no medical device and certifies none.</li>\n\
     </ul>\n"
        .into()
}
