//! The paper of Yan, Scott and Fearing (1999) retold: its figures and tables, its subjects, and what uncertain inputs do to its numbers.
//! A client of the library `palpate`: nothing that decides or moves a hand is here. It has 6,500 lines of code. Read it in
//! this order:
//!
//! | module | content | paper |
//! |---|---|---|
//! | [`psychophysics`] | pairs of samples, felt and judged; what the answers say | §4, §5 |
//! | [`study`] | uncertain inputs, propagated to every number | |
//! | [`report`] | figures, tables, the page | §2–§5 |

pub mod psychophysics;
pub mod report;
mod settings;
pub mod study;

#[cfg(test)]
mod tests;
