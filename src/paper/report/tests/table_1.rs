//! Table 1, typed a second time.

/// One experiment in the second transcription of Table 1.
pub struct Experiment {
    /// What Table 1 calls it.
    pub name: &'static str,
    /// Right answers in [`TRIALS`], one row a subject, one column an inclusion.
    pub correct: [[u32; 4]; 10],
}

/// Table 1, typed a second time. Nothing is computed from it: it shows a slip of the pen in the table that is used.
#[rustfmt::skip]
pub const EXPERIMENTS: [Experiment; 3] = [
    Experiment {
        name: "direct contact",
        correct: [
            [30, 28, 27, 27], [30, 30, 28, 23], [30, 29, 20, 21], [28, 25, 18, 16], [27, 26, 23, 19],
            [30, 30, 27, 17], [23, 19, 18, 13], [30, 30, 30, 19], [30, 30, 29, 23], [30, 28, 27, 22],
        ],
    },
    Experiment {
        name: "FEM data",
        correct: [
            [30, 30, 30, 21], [30, 30, 29, 25], [30, 29, 28, 16], [28, 29, 24, 20], [29, 25, 20, 17],
            [29, 29, 27, 15], [27, 23, 18, 15], [30, 30, 27, 20], [29, 24, 21, 16], [30, 28, 29, 24],
        ],
    },
    Experiment {
        name: "measured data",
        correct: [
            [30, 22, 24, 18], [30, 28, 28, 21], [28, 27, 19, 15], [25, 19, 19, 21], [29, 24, 23, 18],
            [26, 21, 23, 17], [17, 15, 19, 18], [29, 26, 26, 13], [26, 21, 22, 15], [28, 25, 26, 18],
        ],
    },
];
