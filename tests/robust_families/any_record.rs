//! Records of anything at all: whatever is answered has finite numbers that fit each other.

use std::sync::Mutex;
use std::thread;

use palpate::force_map::Hypotheses;
use palpate::robust::Part;
use palpate::trace::Question;

use super::*;

/// Positions and questions that are tried, and the records of each.
const SWEEPS: u64 = 500;
const RECORDS: u64 = 2_000;
/// With a bank, which takes several times as long, one record in so many; and by the exact model.
const SHARE: u64 = 10;

/// Numbers between 0 and 1, one after the other.
struct Draws {
    generator: Generator,
    record: u64,
    next: u64,
}

impl Draws {
    fn new(sweep: u64, record: u64) -> Draws {
        Draws {
            generator: Generator::new(47, sweep),
            record,
            next: 0,
        }
    }

    fn unit(&mut self) -> f64 {
        self.next += 1;
        uniform(self.generator.words([self.next, self.record, 3, 0])[0])
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A size between two powers of ten, of either sign.
    fn power(&mut self, low: f64, high: f64) -> f64 {
        let size = 10_f64.powf(self.between(low, high));
        if self.unit() < 0.5 { -size } else { size }
    }

    fn deviate(&mut self) -> f64 {
        self.next += 1;
        self.generator.normal(self.record, self.next)
    }
}

/// What may happen to a channel; each does with a probability of its own.
const HAPPENS: [fn(&mut Vec<f64>, &mut Draws); 12] = [
    |f, u| {
        let gain = u.between(0.7, 1.4);
        f.iter_mut().for_each(|v| *v *= gain);
    },
    |f, u| {
        let gain = u.power(-6.0, 6.0);
        f.iter_mut().for_each(|v| *v *= gain);
    },
    |f, u| {
        let offset = u.power(-3.0, 2.0);
        f.iter_mut().for_each(|v| *v += offset);
    },
    |f, u| {
        let (slope, n) = (u.power(-3.0, 1.0), f.len() as f64);
        (0..)
            .zip(f)
            .for_each(|(k, v)| *v += slope * f64::from(k) / n);
    },
    |f, u| {
        let (size, at, width) = (
            u.power(-3.0, 1.0),
            u.between(-0.2, 1.2),
            u.between(0.01, 0.5),
        );
        let n = f.len() as f64;
        let bump = |k: i32| (-0.5 * ((f64::from(k) / n - at) / width).powi(2)).exp();
        (0..).zip(f).for_each(|(k, v)| *v += size * bump(k));
    },
    |f, u| {
        let (size, period, phase) = (u.power(-3.0, 0.0), u.between(2.0, 200.0), u.unit());
        let wave = |k: i32| (6.3 * (f64::from(k) / period + phase)).sin();
        (0..).zip(f).for_each(|(k, v)| *v += size * wave(k));
    },
    |f, u| {
        let (size, mut sum) = (u.power(-4.0, 0.0), 0.0);
        for v in f {
            sum += size * u.deviate();
            *v += sum;
        }
    },
    |f, u| {
        for _ in 0..1 + (8.0 * u.unit()) as usize {
            let at = (u.unit() * f.len() as f64) as usize;
            f[at] += u.power(0.0, 300.0);
        }
    },
    |f, u| {
        let most = u.between(-1.0, 3.0);
        f.iter_mut().for_each(|v| *v = v.min(most));
    },
    |f, u| {
        let step = u.power(-6.0, 1.0);
        f.iter_mut().for_each(|v| *v = (*v / step).round() * step);
    },
    |f, u| {
        let [from, to] = [u.unit(), u.unit()].map(|share| (share * f.len() as f64) as usize);
        let value = [0.0, f[0], -0.0][(u.unit() * 3.0) as usize];
        f[from.min(to)..from.max(to)].fill(value);
    },
    |f, u| match (3.0 * u.unit()) as usize {
        0 => f.reverse(),
        1 => f.fill(0.0),
        _ => f.iter_mut().for_each(|v| *v = -*v),
    },
];

fn any_record(tables: [&ForceTable; 2], over: &[f64], u: &mut Draws) -> [Vec<f64>; 2] {
    let table = tables[usize::from(u.unit() < 0.5)];
    let forces = table.sweep(DEPTH, over).unwrap();
    let mut channels = [forces.lateral, forces.normal];
    let sd = u.power(-6.0, 1.0);
    for channel in &mut channels {
        channel.iter_mut().for_each(|v| *v += sd * u.deviate());
        for happens in HAPPENS {
            if u.unit() < 0.15 {
                happens(channel, u);
            }
        }
        // What a file may hold.
        channel
            .iter_mut()
            .for_each(|v| *v = v.clamp(f64::MIN, f64::MAX));
    }
    channels
}

fn any_question(u: &mut Draws) -> RobustQuestion<'static> {
    const KNOWN: [&[Part]; 4] = [
        &[],
        &[Part::Gel, Part::Support],
        &[Part::Surface],
        &Part::KNOWN,
    ];
    let sd = [u.power(-6.0, 2.0), u.power(-6.0, 2.0)].map(f64::abs);
    RobustQuestion {
        known: KNOWN[(4.0 * u.unit()) as usize],
        is_zeroed: u.unit() < 0.3,
        noise_sd: (u.unit() < 0.3).then(|| Force::new(sd[0], sd[1])),
        is_white: u.unit() < 0.3,
        prior_h1: u.between(1e-6, 1.0),
        sure: u.between(0.51, 0.999_999),
        correlation_length: u.between(1.0, 100.0),
    }
}

/// Between 0 and 1, but for the roundings of a sum of a few thousand shares.
fn is_share(number: f64) -> bool {
    (-1e-12..=1.0 + 1e-12).contains(&number)
}

fn check(answer: &RobustAnswer, question: &RobustQuestion<'_>) {
    assert!(answer.theta.is_finite() && is_share(answer.posterior));
    let mut numbers = answer.thetas.iter().chain(&answer.levels);
    assert!(numbers.all(|number| number.is_finite()));
    let sds = answer.noise_sd.iter().flat_map(|sd| sd.into_array());
    let sds: Vec<f64> = sds.flatten().collect();
    assert!(sds.iter().all(|sd| sd.is_finite() && *sd >= 0.0), "{sds:?}");
    let classes = answer.classes.iter().flat_map(|(_, shares)| *shares);
    assert!(classes.into_iter().all(is_share));
    if let Some(rates) = answer.rates {
        assert!(is_share(rates.false_alarm) && is_share(rates.miss));
    }
    match answer.decision {
        Some(Decision::Inclusion) => assert!(answer.posterior >= question.sure),
        Some(Decision::NoInclusion) => assert!(answer.posterior <= 1.0 - question.sure),
        None => {}
    }
    assert_eq!(answer.decision.is_none(), !answer.causes.is_empty());
    if let Some(explained) = &answer.explanation {
        let [without, with] = &explained.expected;
        let forces = explained.records.iter().chain(without).chain(with);
        let mut forces = forces.flat_map(|force| force.lateral.iter().chain(&force.normal));
        assert!(explained.amplitude.is_finite() && forces.all(|force| force.is_finite()));
    }
}

fn check_place(place: &RobustPlace) {
    for interval in place.intervals.iter().flatten() {
        let at = interval.estimate;
        assert!(at.is_finite());
        assert!(
            interval.lower.is_none_or(|lower| lower <= at),
            "{interval:?}"
        );
        assert!(
            interval.upper.is_none_or(|upper| at <= upper),
            "{interval:?}"
        );
    }
    assert!(place.marginals.iter().flatten().copied().all(is_share) && is_share(place.several));
    assert!(place.none_down_to.is_none_or(f64::is_finite));
}

fn check_exact(hypotheses: Hypotheses<'_>, record: &Record, question: &RobustQuestion<'_>) {
    let asked = Question {
        is_zeroed: question.is_zeroed,
        prior_h1: question.prior_h1,
        ..exact_question(question.noise_sd)
    };
    // It may be refused, in words.
    if let Ok(found) = asked.judge(hypotheses, record) {
        let rates = [found.rates.false_alarm, found.rates.miss, found.posterior];
        assert!(rates.into_iter().all(is_share), "{rates:?}");
        assert!(found.test.t.is_finite() && found.test.gamma.is_finite());
        assert_eq!(found.decision.is_none(), !found.causes.is_empty());
    }
}

// Verifies: CON-007, ROB-040, ROB-041.
#[test]
#[ignore = "a million records"]
fn whatever_a_record_holds_the_answer_is_one() {
    let bank = bank();
    let own = gel(|_| (), &[3.2e-3, 3.6e-3, 4e-3, 4.4e-3, 4.8e-3]);
    let changes = GelChanges::new(bank.reference(), &[DEPTH], &GelUncertainty::default()).unwrap();
    let counts = Mutex::new([0_u64; 4]);
    let try_sweep = |sweep: u64| {
        let u = &mut Draws::new(sweep, u64::MAX);
        let question = any_question(u);
        let (count, half) = (20 + (180.0 * u.unit()) as usize, u.between(2e-3, 8e-3));
        let step = 2.0 * half / (count - 1) as f64;
        let over: Vec<f64> = (0..count).map(|k| step * k as f64 - half).collect();
        let zeros = vec![0.0; count];
        let empty = Record::new("any", &over, Force::new(&zeros, &zeros)).unwrap();
        let at = RobustSweep::new(&empty, DEPTH, changes.as_ref());
        let maps = Hypotheses::of_tables(&own[0], &own[1]).unwrap();
        let of_maps = question.detector(maps, &[at]).unwrap();
        let of_bank = question.bank_detector(&bank, None, &[at]).unwrap();
        let mut found = [0; 4];
        for number in 0..RECORDS {
            let channels = any_record([&own[0], &own[1]], &over, &mut Draws::new(sweep, number));
            let forces = Force::new(&channels[0][..], &channels[1][..]);
            let is_more = number % SHARE == 0;
            let detector = if is_more { &of_bank.0 } else { &of_maps };
            match detector.judge(&[forces]) {
                // In words.
                Err(_) => found[3] += 1,
                Ok(answer) => {
                    check(&answer, &question);
                    if is_more && !answer.thetas.is_empty() {
                        check_place(&of_bank.1.place(&answer));
                    }
                    found[match answer.decision {
                        Some(Decision::Inclusion) => 0,
                        Some(Decision::NoInclusion) => 1,
                        None => 2,
                    }] += 1;
                }
            }
            if is_more {
                check_exact(maps, &Record::new("any", &over, forces).unwrap(), &question);
            }
        }
        let mut counts = counts.lock().unwrap();
        counts
            .iter_mut()
            .zip(found)
            .for_each(|(sum, more)| *sum += more);
    };
    let workers = thread::available_parallelism().map_or(1, usize::from) as u64;
    thread::scope(|scope| {
        for worker in 0..workers {
            scope.spawn(move || {
                (worker..SWEEPS)
                    .step_by(workers as usize)
                    .for_each(try_sweep)
            });
        }
    });
    let [inclusion, none, unjudged, refused] = *counts.lock().unwrap();
    println!(
        "{inclusion} with an inclusion, {none} without, {unjudged} cannot be judged, {refused} refused"
    );
    // Each of the answers comes by.
    let all = SWEEPS * RECORDS;
    assert_eq!(inclusion + none + unjudged + refused, all);
    assert!(inclusion.min(none) >= all / 100 && unjudged >= all / 10);
}
