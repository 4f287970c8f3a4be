//! The maths library with each result moved to the next double (ACC-031): up, down, or up and down as the arguments have it, by
//! `LAST_PLACE`. What rounds correctly everywhere, such as the square root, stays, and so does an exact 0.

use std::sync::OnceLock;

pub use right::*;

/// `up`, `down`, or the number of a pattern; nothing moves without it.
const VARIABLE: &str = "LAST_PLACE";

#[derive(Clone, Copy)]
enum Way {
    Nowhere,
    Up,
    Down,
    Either(u64),
}

fn way() -> Way {
    static WAY: OnceLock<Way> = OnceLock::new();
    *WAY.get_or_init(|| match std::env::var(VARIABLE).as_deref() {
        Err(_) => Way::Nowhere,
        Ok("up") => Way::Up,
        Ok("down") => Way::Down,
        Ok(number) => Way::Either(number.parse().expect(VARIABLE)),
    })
}

fn moved(result: f64, arguments: &[f64]) -> f64 {
    if result == 0.0 || !result.is_finite() {
        return result;
    }
    let is_up = match way() {
        Way::Nowhere => return result,
        Way::Up => true,
        Way::Down => false,
        // FNV-1a of the arguments and the result: a function of them, as a maths library is.
        Way::Either(seed) => {
            let numbers = arguments.iter().chain([&result]);
            let mix =
                |hash: u64, number: &f64| (hash ^ number.to_bits()).wrapping_mul(0x100_0000_01B3);
            numbers.fold(0xCBF2_9CE4_8422_2325 ^ seed, mix).count_ones() % 2 == 0
        }
    };
    if is_up {
        result.next_up()
    } else {
        result.next_down()
    }
}

macro_rules! moved {
    ($($name:ident($($argument:ident),+));+ $(;)?) => {
        $(pub fn $name($($argument: f64),+) -> f64 {
            moved(right::$name($($argument),+), &[$($argument),+])
        })+
    };
}

moved! {
    acos(x); acosh(x); asin(x); asinh(x); atan(x); atan2(y, x); atanh(x); cbrt(x); cos(x); cosh(x);
    erf(x); erfc(x); exp(x); exp2(x); exp10(x); expm1(x); hypot(x, y); lgamma(x); log(x); log10(x); log1p(x); log2(x);
    pow(x, y); sin(x); sinh(x); tan(x); tanh(x); tgamma(x);
}

pub fn sincos(x: f64) -> (f64, f64) {
    (sin(x), cos(x))
}
