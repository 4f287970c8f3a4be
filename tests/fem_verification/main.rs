//! Code verification of the finite elements (`spec/verification.md`).
