//! Four passes at 1, 2, 3 and 4 mm in one record, there and back, over a surface that is domed or dished: the bar of `spec/robust.md`.

use palpate::stats::binomial::clopper_pearson;

use super::*;

/// Commanded depths of the passes, m.
const PASSES: [f64; 4] = [1e-3, 2e-3, 3e-3, 4e-3];

/// The poses of the record: forth and back, a pass for each depth.
fn path() -> [Vec<f64>; 2] {
    let forth = positions();
    let back = forth.iter().rev().copied();
    let of = |pass: usize| -> Vec<f64> {
        match pass % 2 {
            0 => forth.clone(),
            _ => back.clone().collect(),
        }
    };
    let over = (0..PASSES.len()).flat_map(of).collect();
    let depths = PASSES.iter().flat_map(|depth| vec![*depth; SAMPLES]);
    [over, depths.collect()]
}

/// Record `trial`: the surface is domed by 0.1 to 0.4 mm (dished in a third), a sensor has an offset up to 0.1 N and a drift up to 0.05 N
/// over the whole record, and noise. The depths are those of the stage, which does not know of the dome.
fn domed(table: &ForceTable, sd: f64, stream: u64, trial: u64) -> Record {
    let generator = Generator::new(20_261_126, stream);
    let u = generator.words([9, trial, 2, 0]).map(uniform);
    let height = (0.1e-3 + 0.3e-3 * u[0]) * if u[1] < 1.0 / 3.0 { -1.0 } else { 1.0 };
    let [over, depths] = path();
    let count = over.len();
    let mut noise = vec![0.0; 2 * count + 4];
    generator.normals(trial, 0, &mut noise);
    let [offsets, drifts] = [0, 2].map(|of| {
        let of = &noise[2 * count + of..][..2];
        [of[0], of[1]].map(|of| of.clamp(-1.0, 1.0))
    });
    let mut channels = [Vec::new(), Vec::new()];
    for (at, (x, depth)) in over.iter().zip(&depths).enumerate() {
        let v = x / 8e-3;
        let forces = table
            .path(&[depth + height * (0.5 - v * v)], &[*x])
            .unwrap();
        let (slope, lateral, normal) = (
            -2.0 * height * v / 8e-3,
            forces.lateral[0],
            forces.normal[0],
        );
        let turned = [lateral - slope * normal, normal + slope * lateral];
        let time = 2.0 * at as f64 / (count - 1) as f64 - 1.0;
        for (c, channel) in channels.iter_mut().enumerate() {
            let sensor = 0.1 * offsets[c] + 0.05 * drifts[c] * time;
            channel.push(turned[c] + sensor + sd * noise[c * count + at]);
        }
    }
    let [lateral, normal] = &channels;
    Record::along("path", &over, &depths, Force::new(lateral, normal)).unwrap()
}

/// The detector of a disc 4.6 mm deep by two maps on a coarser mesh than the gels', for records along the path.
struct Judge {
    bank: Bank,
    passes: Vec<Record>,
    changes: GelChanges,
}

impl Judge {
    fn new() -> Judge {
        let phantom = phantom(4.6e-3, |_| ());
        let mut plan = BankPlan::new(phantom, DEPTH, &laterals(0.5e-3)).unwrap();
        plan.probe_depths = PASSES.to_vec();
        let bank = plan.bank().unwrap();
        let [over, depths] = path();
        let zeros = vec![0.0; over.len()];
        let record = Record::along("path", &over, &depths, Force::new(&zeros, &zeros)).unwrap();
        let passes = record.passes();
        let all: Vec<&Record> = passes.iter().collect();
        let depths = GelChanges::depths_along(bank.reference(), &all);
        let changes = GelChanges::new(bank.reference(), &depths, &GelUncertainty::default());
        let changes = changes.unwrap().unwrap();
        Judge {
            bank,
            passes,
            changes,
        }
    }

    fn detector(&self) -> RobustDetector<'static> {
        let sweep = |record| RobustSweep::new(record, DEPTH, Some(&self.changes));
        let sweeps: Vec<_> = self.passes.iter().map(sweep).collect();
        let signals = BankHypotheses::new(&self.bank, None)
            .signals(&sweeps)
            .unwrap();
        let without = self.bank.reference().table();
        RobustDetector::new(RobustQuestion::default(), without, &sweeps, &signals).unwrap()
    }
}

/// The number of answers inclusion, no inclusion and none, of records over a gel; and of those that are an inclusion, or were one if a
/// posterior of 0.8 were enough.
fn counts(
    detector: &RobustDetector<'_>,
    table: &ForceTable,
    [sd, stream]: [f64; 2],
    records: u64,
) -> (Counts, u64) {
    let (mut counts, mut less_sure) = ([0; 3], 0);
    for trial in 0..records {
        let passes = domed(table, sd, stream as u64, trial).passes();
        let forces: Vec<_> = passes.iter().map(Record::forces).collect();
        let answer = detector.judge(&forces).unwrap();
        let is_weak = answer.causes == [Cause::TooWeak] && answer.posterior >= 0.8;
        less_sure += u64::from(is_weak || answer.decision == Some(Decision::Inclusion));
        counts[match answer.decision {
            Some(Decision::Inclusion) => 0,
            Some(Decision::NoInclusion) => 1,
            None => 2,
        }] += 1;
    }
    (counts, less_sure)
}

/// The gel on a finer mesh, at depths that are closer than those of the maps.
fn gels() -> Gel {
    let depths: Vec<f64> = (3..=24).map(|row| 0.2e-3 * f64::from(row)).collect();
    gel(|_| (), &depths)
}

// Seeds are fixed: it fails or not. With a rate of 5 % of false answers, and 95 % found, it would fail for 4 % of all seeds; with a rate
// of 50 % of either it passes for 1 in 50.
// Verifies: ROB-084.
#[test]
fn a_few_paths_over_domed_gels() {
    let judge = Judge::new();
    let (detector, gels) = (judge.detector(), gels());
    let (without, _) = counts(&detector, &gels[0], [0.1, 1.0], 12);
    let (with, _) = counts(&detector, &gels[1], [0.1, 2.0], 12);
    assert!(without[0] <= 2, "{without:?}");
    assert!(with[0] >= 10, "{with:?}");
}

// Verifies: ROB-084.
#[test]
#[ignore = "minutes"]
fn paths_over_domed_gels_keep_their_rates() {
    let records = 400;
    let judge = Judge::new();
    let (detector, gels) = (judge.detector(), gels());
    // Beside a domed surface γ is 4.0 in noise of 0.1 N: a posterior of 0.95 comes with a probability of Φ((γ²/2 − ln 19)/γ) = 0.90 at most.
    for (number, sd, least) in [(1.0, 0.02, 0.95), (2.0, 0.1, 0.8)] {
        let (without, less_sure_without) =
            counts(&detector, &gels[0], [sd, 10.0 + number], records);
        let (with, less_sure_with) = counts(&detector, &gels[1], [sd, 20.0 + number], records);
        let rates = [without[0], less_sure_without, with[0], less_sure_with];
        println!("noise {sd} N: without {without:?}, with {with:?}");
        for (what, count) in ["false", "false at 0.8", "found", "found at 0.8"]
            .iter()
            .zip(rates)
        {
            println!(
                "{what}: {count}, {:?}",
                clopper_pearson(count, records, 0.95).unwrap()
            );
        }
        for (count, most) in [(without[0], 0.05), (less_sure_without, 0.2)] {
            assert!(clopper_pearson(count, records, 0.95).unwrap().upper <= most);
        }
        assert!(with[0] as f64 >= least * records as f64, "{with:?}");
        assert!(
            less_sure_with as f64 >= 0.95 * records as f64,
            "{less_sure_with}"
        );
    }
}
