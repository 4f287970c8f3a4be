//! Expected values: the same mixtures at 380 digits (`vectors/generator/quadratic.py`), and closed forms.

use proptest::prelude::*;

use super::*;
use crate::stats::tails::chi_square_tail;
use palpate_asserts::{assert_near, numbers};

/// DET-134: how far a tail may be off, for the sum of the degrees of freedom and λ or δ².
fn allowed(tail: f64, sum: f64) -> f64 {
    1e-12 * (1.0 + libm::sqrt(sum) / 100.0) * tail.max(1e-300)
}

#[track_caller]
fn assert_tails(found: Tails, expected: [f64; 2], sum: f64) {
    for (found, expected) in [found.lower, found.upper].into_iter().zip(expected) {
        assert_near(found, expected, allowed(expected, sum));
    }
}

// Verifies: DET-130, DET-134.
#[test]
fn chi_square_tails() {
    // x, degrees, noncentrality, lower and upper tail.
    let table = "
3 2 0 0.776869839851570171 0.223130160148429829
0.02 0.1 0 0.815559805741284926 0.184440194258715074
1.7 0.3 0.2 0.9078646156671911 0.0921353843328089002
1.2 40 0 8.48976835244800405e-24 1.0
1e-4 60 0 3.51090469814609819e-162 1.0
150 1000 0 8.76069116943232768e-230 1.0
1500 40 0 1.0 6.78166673230225064e-289
1900000 2000000 0 0 1.0
2002000 2000000 0 0.841344786368340292 0.158655213631659708
60 40 20 0.526326468094889361 0.473673531905110639
500 10 100 1.0 7.82248535955737251e-34
8 200 90 5.49776213911241732e-119 1.0
4000 300 700 1.0 7.75476035413663688e-243
5 3 1e-20 0.828202855703266865 0.171797144296733135
11000 0.5 1e4 0.999999478443367761 5.21556632238669938e-7
960000 50 1e6 2.72782169774255603e-91 1.0
1.4 1 1.5 0.475416169958686691 0.524583830041313309
99640000 0.1 1e8 7.27176457487116092e-73 1.0
100040000 0.1 1e8 0.977241500071572046 0.0227584999284279539
100360000 0.1 1e8 1.0 1.30314592148935502e-72
101638204 2e6 1e8 7.28688070268713843e-73 1.0
102040200 2e6 1e8 0.977243173358567126 0.0227568266414328745
102361796 2e6 1e8 1.0 1.2993577924550853e-72";
    for [x, degrees, lambda, lower, upper] in numbers(table) {
        let found = chi_square(x, degrees, lambda).unwrap();
        assert_tails(found, [lower, upper], degrees + lambda);
    }
}

// Verifies: DET-130, DET-134.
#[test]
fn f_tails() {
    // x, numerator, denominator, noncentrality, lower and upper tail.
    let table = "
3 2 7 0 0.885437783660931915 0.114562216339068085
0.3 0.1 0.1 0 0.47197211417209847 0.52802788582790153
400 4 800 0 1.0 3.79395698537649382e-189
1e-8 60 5 0 3.1191756493558177e-206 1.0
1.002 2e6 2e6 0 0.921142868730751864 0.0788571312692481358
9 2e6 3 0 0.953642162264611813 0.0463578377353881868
3 2 7 5 0.462747186103337138 0.537252813896662862
25 0.5 0.2 3 0.32963401068350311 0.67036598931649689
90 30 2000 300 1.0 5.1262455326237891e-159
0.05 120 400 60 2.2217853055786342e-64 1.0
1e120 3 5 2 1.0 2.33035487772709462e-299
1 1 2e6 3 0.228921692303857104 0.771078307696142896
2e4 9 2 1e4 0.945912756268596436 0.0540872437314035636
3e8 0.1 0.1 1e8 0.0679548516761974593 0.932045148323802541
5e12 0.1 0.1 1e8 0.422353782314185923 0.577646217685814077
981644000 0.1 2e6 1e8 1.82485109469969215e-74 1.0
1001020000 0.1 2e6 1e8 0.841153747396426558 0.158846252603573442
1018360000 0.1 2e6 1e8 1.0 4.21681825490083228e-71
15.3 2e6 0.1 1e8 0.0679548516900079806 0.932045148309992019
50.0643 2e6 2e6 1e8 1.77928790108753928e-74 1.0
51.052 2e6 2e6 1e8 0.841196831572535544 0.158803168427464456
51.9357 2e6 2e6 1e8 1.0 4.41013057278009759e-71";
    for [x, numerator, denominator, lambda, lower, upper] in numbers(table) {
        let found = f_ratio(x, numerator, denominator, lambda).unwrap();
        assert_tails(found, [lower, upper], numerator + denominator + lambda);
    }
}

// Verifies: DET-130, DET-134.
#[test]
fn student_tails() {
    // x, degrees, noncentrality, lower and upper tail.
    let table = "
2 9 0 0.961723588114649479 0.0382764118853505206
2.2 600000 0 0.986096362578844641 0.0139036374211553586
-40 50 0 6.20621189218635279e-40 1.0
3 0.1 1 0.333416290410821585 0.666583709589178415
2 9 3 0.169336104742734448 0.830663895257265552
-2 9 3 2.73543798513829532e-6 0.999997264562014862
2 9 -30 1.0 2.48639191697349532e-207
0.001 1000 -36 1.0 4.03465143277117552e-284
0 4 2.5 0.00620966532577613517 0.993790334674223865
0 4 -7.5 0.999999999999968091 3.19089167291089623e-14
5 2e6 -3 0.999999999999999378 6.22225534112130085e-16
300 5 200 0.817605373674720448 0.182394626325279552
-95 2000 -130 1.0 6.40143051591655938e-80
1e60 5 2 1.0 4.22269288721004505e-298
1e152 0.1 -3 0.999999999999999999 6.33547742575614064e-19
1e-9 4 1 0.158655254158906049 0.841344745841093951
990 1e5 1000 0.0000195019284987180562 0.999980498071501282
3100 30 3000 0.565363339466790688 0.434636660533209312
3000 0.1 1e4 0.025589137044120174 0.974410862955879826
5e7 0.1 1e4 0.622676685478958752 0.377323314521041248
2.5 0.1 -1e4 1.0 0.0
9908.22 2e6 1e4 8.53424435935840742e-74 1.0
10005.1 2e6 1e4 0.841213284495529438 0.158786715504470562
-10005.1 2e6 -1e4 0.158786715504470562 0.841213284495529438
10091.8 2e6 1e4 1.0 9.96020618563693638e-72
2.5 2e6 -1e4 1.0 0.0";
    for [x, degrees, delta, lower, upper] in numbers(table) {
        let found = student(x, degrees, delta).unwrap();
        assert_tails(found, [lower, upper], degrees + delta * delta);
    }
}

// Verifies: DET-130. The older function goes through another series, with less accuracy.
#[test]
fn without_noncentrality_the_chi_square_law_is_central() {
    for degrees in [0.3, 1.0, 4.0, 9.5, 20.0] {
        for x in [0.2, 1.0, 3.5, 8.0, 40.0] {
            let found = chi_square(x, degrees, 0.0).unwrap().upper;
            let expected = chi_square_tail(x, degrees).unwrap();
            assert_near(found / expected, 1.0, 1e-12);
        }
    }
}

// Verifies: DET-134. At the ends of the ranges a tail is 0 or 1, or a power.
#[test]
fn ends_of_the_ranges() {
    let (none, all) = ([0.0, 1.0], [1.0, 0.0]);
    for degrees in [0.1, 2e6] {
        for lambda in [0.0, 5e-324, 1e-200, 1.0, 1e8] {
            let sum = degrees + lambda;
            let tails = |x| chi_square(x, degrees, lambda).unwrap();
            assert_eq!([tails(0.0).lower, tails(0.0).upper], none);
            assert_tails(tails(1e152), all, sum);
            for denominator in [0.1, 2e6] {
                let tails = |x| f_ratio(x, degrees, denominator, lambda).unwrap();
                assert_eq!([tails(0.0).lower, tails(0.0).upper], none);
                for x in [1e-300, 1e152] {
                    let Tails { lower, upper } = tails(x);
                    assert!(lower >= 0.0 && upper >= 0.0 && lower + upper == 1.0);
                }
            }
        }
        for delta in [0.0, 1e-300, -1e-300, 1.0, -1.0, 1e4, -1e4] {
            for x in [0.0, -0.0, 1e-300, -1e-300, 1e152, -1e152] {
                let Tails { lower, upper } = student(x, degrees, delta).unwrap();
                assert!(lower >= 0.0 && upper >= 0.0 && lower + upper == 1.0);
            }
            let at_zero = [normal::lower_tail(-delta), normal::lower_tail(delta)];
            assert_tails(student(0.0, degrees, delta).unwrap(), at_zero, degrees);
        }
    }
}

// Verifies: DET-136.
#[test]
fn points_of_the_chi_square_law() {
    for [degrees, p, lower_point, upper_point] in numbers(
        "
1 0.05 0.00393214000001952317 3.84145882069412587
2 1e-9 2.00000000100000013e-9 41.4465316738928222
40 1e-12 4.66008315518523343 138.148089409788992
0.5 0.3 0.0109826049485509663 0.374696456740394357
1000 1e-20 640.374297734500723 1472.45690210755731
7.3 1e-100 1.66281571826677335e-27 486.921877840553714
200000 0.001 198051.263781001837 201960.135583918452",
    ) {
        for (tail, expected) in [(Tail::Lower(p), lower_point), (Tail::Upper(p), upper_point)] {
            let found = chi_square_point(tail, degrees).unwrap();
            assert_near(found / expected, 1.0, 1e-12);
        }
    }
    // Below every normal number.
    let least = chi_square_point(Tail::Lower(1e-300), 0.1).unwrap();
    assert!(least > 0.0 && least < f64::MIN_POSITIVE);
}

// Verifies: DET-136.
#[test]
fn points_of_students_law() {
    for [degrees, upper, expected] in numbers(
        "
9 0.025 2.26215716279820551
1 0.25 1.0
3 1e-12 10331.1082442924862
36 1e-100 3335.36551939010607
0.5 1e-30 1.02849115631633984e+59
200000 0.001 3.09027305730519879
4 0.9 -1.5332062740589441
12 0.4999 0.000255933628849423207",
    ) {
        let found = student_point(upper, degrees).unwrap();
        // Next to ½ a tail is known to 2⁻⁵⁴.
        assert_near(found, expected, 1e-12 * expected.abs() + 1e-15);
    }
    assert!(student_point(0.5, 3.0).unwrap().abs() < 1e-15);
    let beyond = student_point(1e-300, 0.1);
    assert_eq!(beyond, Err(NumericError::Overflow { what: "the point" }));
}

// Verifies: DET-005.
#[test]
fn what_has_no_answer_is_refused() {
    let nan = f64::NAN;
    let refused = |name: &str, found: Result<Tails, NumericError>| {
        let named = |error| matches!(error, NumericError::OutOfRange { what, .. } if what == name);
        assert!(found.is_err_and(named), "{name}: {found:?}");
    };
    for x in [-1.0, -5e-324, 1.1e152, f64::INFINITY, nan] {
        refused("x", chi_square(x, 3.0, 1.0));
        refused("x", f_ratio(x, 3.0, 3.0, 1.0));
    }
    for x in [-1.1e152, 1.1e152, f64::NEG_INFINITY, nan] {
        refused("x", student(x, 3.0, 1.0));
    }
    for degrees in [0.0, 0.09, -3.0, 2000001.0, f64::INFINITY, nan] {
        refused("degrees", chi_square(1.0, degrees, 1.0));
        refused("numerator", f_ratio(1.0, degrees, 3.0, 1.0));
        refused("denominator", f_ratio(1.0, 3.0, degrees, 1.0));
        refused("degrees", student(1.0, degrees, 1.0));
        assert!(chi_square_point(Tail::Lower(0.5), degrees).is_err());
        assert!(student_point(0.5, degrees).is_err());
    }
    for lambda in [-5e-324, 1.001e8, f64::INFINITY, nan] {
        refused("noncentrality", chi_square(1.0, 3.0, lambda));
        refused("noncentrality", f_ratio(1.0, 3.0, 3.0, lambda));
    }
    for delta in [-10000.1, 10000.1, f64::INFINITY, nan] {
        refused("noncentrality", student(1.0, 3.0, delta));
    }
    for p in [0.0, 1.0, -0.1, nan] {
        for found in [
            chi_square_point(Tail::Lower(p), 3.0),
            chi_square_point(Tail::Upper(p), 3.0),
            student_point(p, 3.0),
        ] {
            assert!(matches!(found, Err(NumericError::OutOfRange { .. })), "{p}");
        }
    }
}

/// Numbers of any size between 10^low and 10^high.
fn sizes(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(libm::exp10)
}

/// δ² of any size, or none.
fn squares() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), sizes(-6.0, 5.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    // Verifies: DET-134. Slack for monotony: twice DET-134.
    #[test]
    fn tails_add_up_and_are_monotone(
        degrees in sizes(-1.0, 4.0),
        denominator in sizes(-1.0, 4.0),
        lambda in squares(),
        more in 1.0..2.0,
        place in sizes(-3.0, 1.0),
    ) {
        let x = place * (degrees + lambda);
        let ratio = place * (1.0 + lambda / degrees);
        let sum = degrees + denominator + 2.0 * lambda;
        for (here, beyond, moved) in [
            (
                chi_square(x, degrees, lambda),
                chi_square(more * x, degrees, lambda),
                chi_square(x, degrees, more * lambda),
            ),
            (
                f_ratio(ratio, degrees, denominator, lambda),
                f_ratio(more * ratio, degrees, denominator, lambda),
                f_ratio(ratio, degrees, denominator, more * lambda),
            ),
            (
                student(place - 1.0, denominator, libm::sqrt(lambda)),
                student(more * place - 1.0, denominator, libm::sqrt(lambda)),
                student(place - 1.0, denominator, libm::sqrt(more * lambda)),
            ),
        ] {
            let (here, beyond, moved) = (here.unwrap(), beyond.unwrap(), moved.unwrap());
            prop_assert!((here.lower + here.upper - 1.0).abs() <= f64::EPSILON);
            let above = |large: f64, small: f64| large >= small - 2.0 * allowed(large, sum);
            prop_assert!(above(beyond.lower, here.lower) && above(here.upper, beyond.upper));
            prop_assert!(above(here.lower, moved.lower) && above(moved.upper, here.upper));
        }
    }

    // Verifies: DET-130. T² is F with 1 numerator degree; the signs of δ and t are one route through mixtures and one
    // through an integral.
    #[test]
    fn the_square_of_t_is_f(
        t in sizes(-2.0, 2.5),
        degrees in sizes(-1.0, 5.0),
        delta in 0.0..30.0,
    ) {
        let two_sided = f_ratio(t * t, 1.0, degrees, delta * delta).unwrap();
        let (same, other) = (
            student(t, degrees, delta).unwrap(),
            student(t, degrees, -delta).unwrap(),
        );
        let sum = degrees + delta * delta;
        let upper = same.upper + other.upper;
        // t² and δ² are rounded, which moves the logarithm of a tail by no more than 2⁻⁵² times itself and the degrees' root.
        let slack = 8.0 * allowed(upper, sum);
        prop_assert!((upper - two_sided.upper).abs() <= slack, "{upper:e} {two_sided:?}");
        let lower = same.lower - other.upper;
        prop_assert!((lower - two_sided.lower).abs() <= allowed(1.0, sum), "{lower:e}");
    }

    // Verifies: DET-130. With one degree X is (Z + δ)².
    #[test]
    fn one_degree_is_a_normal_deviate(root in 0.0..20.0_f64, delta in 0.0..20.0_f64) {
        let found = chi_square(root * root, 1.0, delta * delta).unwrap();
        let upper = normal::lower_tail(delta - root) + normal::lower_tail(-root - delta);
        let slack = 8.0 * allowed(upper, 1.0 + delta * delta);
        prop_assert!((found.upper - upper).abs() <= slack, "{found:?} {upper:e}");
    }
}
