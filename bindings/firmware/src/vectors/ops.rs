//! The ops of the table: the functions of `palpate` that answer them.

use palpate_core::detect::{self, Costs};
use palpate_core::force::Force;
use palpate_core::hid::{Capabilities, Control, ForceReport, PositionReport};
use palpate_core::servo::{Axis, Table};
use palpate_core::stats::{noncentral, normal};

use super::{Answer, Failure, MOST, Room, Words, double, refused, single};

/// Knots with the reciprocals of their widths.
fn axis<'a>(
    words: Words,
    knots: &'a mut Room<f32>,
    widths: &'a mut Room<f32>,
) -> Result<Axis<'a>, Failure> {
    let knots = knots.filled(words, single)?;
    for (width, pair) in widths.0.iter_mut().zip(knots.windows(2)) {
        *width = Axis::reciprocal_width(pair[0], pair[1]);
    }
    refused(Axis::new(knots, &widths.0[..knots.len().saturating_sub(1)]))
}

fn servo_axis(lists: &mut Words, answer: &mut Answer) -> Result<(), Failure> {
    let (mut knots, mut widths) = (Room::of(0.0), Room::of(0.0));
    let axis = axis(lists.list()?, &mut knots, &mut widths)?;
    let cell = axis.locate(single(&mut lists.list()?)?);
    answer.push(cell.index as u32);
    answer.push(cell.fraction.to_bits());
    Ok(())
}

/// Both components of the table are alike, and so both must be right.
fn servo_interpolate(lists: &mut Words, answer: &mut Answer) -> Result<(), Failure> {
    let (mut depths, mut heights) = (Room::of(0.0), Room::of(0.0));
    let depths = axis(lists.list()?, &mut depths, &mut heights)?;
    let (mut laterals, mut widths) = (Room::of(0.0), Room::of(0.0));
    let laterals = axis(lists.list()?, &mut laterals, &mut widths)?;
    let mut forces = Room::of(Force::ZERO);
    let both = |words: &mut Words| single(words).map(|force| Force::new(force, force));
    let forces = forces.filled(lists.list()?, both)?;
    let table = refused(Table::new(depths, laterals, forces))?;
    let depth = single(&mut lists.list()?)?;
    let force = table.force(depth, single(&mut lists.list()?)?);
    answer.push(force.normal.to_bits());
    if force.lateral.to_bits() != force.normal.to_bits() {
        answer.push(force.lateral.to_bits());
    }
    Ok(())
}

/// Asks all four decoders: bytes are of one report at most.
fn report_decode(lists: &mut Words, answer: &mut Answer) -> Result<(), Failure> {
    let mut bytes = Room::of(0);
    let byte = |words: &mut Words| words.next().map(|word| word as u8);
    let bytes = bytes.filled(lists.list()?, byte)?;
    let signed = |value: i16| i32::from(value) as u32;
    if let Ok(r) = PositionReport::decode(bytes) {
        let fields = [
            signed(r.lateral),
            signed(r.normal),
            r.buttons.into(),
            r.status.into(),
        ];
        let numbers = [r.sequence, r.force_sequence].map(u32::from);
        [1].iter()
            .chain(&fields)
            .chain(&numbers)
            .for_each(|&word| answer.push(word));
    }
    if let Ok(r) = ForceReport::decode(bytes) {
        let fields = [
            2,
            signed(r.lateral),
            signed(r.normal),
            r.sequence.into(),
            r.flags.into(),
        ];
        fields.into_iter().for_each(|word| answer.push(word));
    }
    if let Ok(r) = Capabilities::decode(bytes) {
        let first = [
            3,
            r.version,
            r.position_unit_nm,
            r.force_unit_un,
            r.largest_force_mn,
        ];
        let last = [
            r.period_us,
            r.watchdog_ms,
            r.damping_mn_s_per_m,
            r.friction_mn,
        ];
        first
            .iter()
            .chain(&last)
            .for_each(|&word| answer.push(word.into()));
    }
    if let Ok(control) = Control::decode(bytes) {
        answer.push(4);
        answer.push(control as u32);
    }
    refused((answer.length > 0).then_some(()).ok_or(()))
}

fn report_encode(lists: &mut Words, answer: &mut Answer) -> Result<(), Failure> {
    let mut fields = lists.list()?;
    let number = fields.next()?;
    let mut field = || fields.next().map(|word| word as u16);
    let mut push = |bytes: &[u8]| bytes.iter().for_each(|&byte| answer.push(byte.into()));
    match number {
        1 => push(
            &PositionReport {
                lateral: field()? as i16,
                normal: field()? as i16,
                buttons: field()? as u8,
                status: field()? as u8,
                sequence: field()?,
                force_sequence: field()?,
            }
            .encode(),
        ),
        2 => push(
            &ForceReport {
                lateral: field()? as i16,
                normal: field()? as i16,
                sequence: field()?,
                flags: field()? as u8,
            }
            .encode(),
        ),
        3 => push(
            &Capabilities {
                version: field()?,
                position_unit_nm: field()?,
                force_unit_un: field()?,
                largest_force_mn: field()?,
                period_us: field()?,
                watchdog_ms: field()?,
                damping_mn_s_per_m: field()?,
                friction_mn: field()?,
            }
            .encode(),
        ),
        4 => {
            let controls = [Control::Stop, Control::Enable, Control::ClearFault];
            push(
                &controls
                    .get(usize::from(field()?))
                    .ok_or(Failure::Table)?
                    .encode(),
            );
        }
        _ => return Err(Failure::Table),
    }
    Ok(())
}

/// The detector's functions of a few numbers.
fn numbers(op: u32, lists: &mut Words, answer: &mut Answer) -> Result<(), Failure> {
    let mut list = lists.list()?;
    let mut n = || double(&mut list);
    let value = match op {
        4 => refused(normal::cdf(n()?))?,
        5 => refused(normal::quantile(n()?))?,
        6 => {
            let rates = refused(detect::error_rates(n()?, n()?))?;
            answer.doubles(&[rates.false_alarm, rates.miss]);
            return Ok(());
        }
        7 => refused(detect::required_gamma(n()?, n()?))?,
        8 => refused(detect::two_afc(n()?))?,
        9 => refused(detect::gamma_from_two_afc(n()?))?,
        10..=12 => {
            let tails = match op {
                10 => noncentral::chi_square(n()?, n()?, n()?),
                11 => noncentral::f_ratio(n()?, n()?, n()?, n()?),
                _ => noncentral::student(n()?, n()?, n()?),
            };
            let tails = refused(tails)?;
            answer.doubles(&[tails.lower, tails.upper]);
            return Ok(());
        }
        14 => refused(detect::map_threshold(n()?))?,
        15 => {
            let prior = n()?;
            let [c00, c01, c10, c11] = [n()?, n()?, n()?, n()?];
            refused(detect::bayes_threshold(prior, Costs { c00, c01, c10, c11 }))?
        }
        16 => refused(detect::neyman_pearson_miss_threshold(n()?, n()?))?,
        17 => refused(detect::neyman_pearson_false_alarm_threshold(n()?, n()?))?,
        _ => return Err(Failure::Table),
    };
    answer.doubles(&[value]);
    Ok(())
}

/// θ, y(0) and γ of a record.
fn theta(lists: &mut Words, answer: &mut Answer) -> Result<(), Failure> {
    let mut rooms = [const { Room([0.0; MOST]) }; 6];
    let [a, b, c, d, e, f] = &mut rooms;
    let observed = Force::new(
        a.filled(lists.list()?, double)?,
        b.filled(lists.list()?, double)?,
    );
    let f0 = Force::new(
        c.filled(lists.list()?, double)?,
        d.filled(lists.list()?, double)?,
    );
    let f1 = Force::new(
        e.filled(lists.list()?, double)?,
        f.filled(lists.list()?, double)?,
    );
    let noise_sd = Force::new(double(&mut lists.list()?)?, double(&mut lists.list()?)?);
    let found = refused(detect::theta_of_record(observed, f0, f1, noise_sd))?;
    answer.doubles(&[found.theta, found.y.lateral, found.y.normal, found.gamma]);
    Ok(())
}

/// The answer to one case, which must use up its lists.
pub fn ask(op: u32, lists: &mut Words) -> Result<Answer, Failure> {
    let mut answer = Answer::default();
    match op {
        0 => servo_axis(lists, &mut answer)?,
        1 => servo_interpolate(lists, &mut answer)?,
        2 => report_decode(lists, &mut answer)?,
        3 => report_encode(lists, &mut answer)?,
        13 => theta(lists, &mut answer)?,
        _ => numbers(op, lists, &mut answer)?,
    }
    if lists.length() > 0 {
        Err(Failure::Table)
    } else {
        Ok(answer)
    }
}
