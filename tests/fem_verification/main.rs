//! Code verification of the finite elements (`spec/verification.md`): each test compares with a closed form, or with
//! a law that the exact solution obeys. Run with `--nocapture` to see the figures.

mod cylinder;
mod energy;
mod full_contact;
mod hertz;
mod inclusion;
mod layer;
mod manufactured;
mod patch;
mod problem;
mod skyline;
