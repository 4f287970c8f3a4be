//! The reports of the haptic device.

use super::super::{Answer, Arguments, Refusal};
use crate::hid::{Capabilities, Control, ForceReport, InvalidReport, PositionReport};

/// The fields of a report.
///
/// Implements: ORA-023, ORA-025, VEC-010.
pub fn decode(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let text = arguments.text("bytes")?;
    let bytes = bytes(&text).ok_or_else(|| {
        Refusal::argument("bytes", "is expected to be pairs of hexadecimal digits")
    })?;
    let Some(&number) = bytes.first() else {
        return Err(Refusal::argument("bytes", "is empty, expected a report"));
    };
    let answer = Answer::default().with("report", number);
    let refused = |error: InvalidReport| Refusal::range("bytes:", error);
    Ok(match number {
        PositionReport::NUMBER => {
            let report = PositionReport::decode(&bytes).map_err(refused)?;
            answer
                .with("lateral", report.lateral)
                .with("normal", report.normal)
                .with("buttons", report.buttons)
                .with("status", report.status)
                .with("sequence", report.sequence)
                .with("force_sequence", report.force_sequence)
        }
        ForceReport::NUMBER => {
            let report = ForceReport::decode(&bytes).map_err(refused)?;
            answer
                .with("lateral", report.lateral)
                .with("normal", report.normal)
                .with("sequence", report.sequence)
                .with("flags", report.flags)
        }
        Capabilities::NUMBER => {
            let report = Capabilities::decode(&bytes).map_err(refused)?;
            answer
                .with("version", report.version)
                .with("position_unit_nm", report.position_unit_nm)
                .with("force_unit_un", report.force_unit_un)
                .with("largest_force_mn", report.largest_force_mn)
                .with("period_us", report.period_us)
                .with("watchdog_ms", report.watchdog_ms)
                .with("damping_mn_s_per_m", report.damping_mn_s_per_m)
                .with("friction_mn", report.friction_mn)
        }
        Control::NUMBER => {
            let control = Control::decode(&bytes).map_err(refused)?;
            answer.with("control", control.encode()[1])
        }
        _ => return Err(unknown(number.into())),
    })
}

/// The bytes of a report.
///
/// Implements: ORA-023, ORA-025, VEC-010.
pub fn encode(arguments: &mut Arguments) -> Result<Answer, Refusal> {
    let number = arguments.whole("report", 0, 255)?;
    let mut fields = Fields(arguments);
    let bytes = if number == i64::from(PositionReport::NUMBER) {
        let report = PositionReport {
            lateral: fields.i16("lateral")?,
            normal: fields.i16("normal")?,
            buttons: fields.u8("buttons")?,
            status: fields.u8("status")?,
            sequence: fields.u16("sequence")?,
            force_sequence: fields.u16("force_sequence")?,
        };
        report.encode().to_vec()
    } else if number == i64::from(ForceReport::NUMBER) {
        let report = ForceReport {
            lateral: fields.i16("lateral")?,
            normal: fields.i16("normal")?,
            sequence: fields.u16("sequence")?,
            flags: fields.u8("flags")?,
        };
        report.encode().to_vec()
    } else if number == i64::from(Capabilities::NUMBER) {
        let report = Capabilities {
            version: fields.u16("version")?,
            position_unit_nm: fields.u16("position_unit_nm")?,
            force_unit_un: fields.u16("force_unit_un")?,
            largest_force_mn: fields.u16("largest_force_mn")?,
            period_us: fields.u16("period_us")?,
            watchdog_ms: fields.u16("watchdog_ms")?,
            damping_mn_s_per_m: fields.u16("damping_mn_s_per_m")?,
            friction_mn: fields.u16("friction_mn")?,
        };
        report.encode().to_vec()
    } else if number == i64::from(Control::NUMBER) {
        fields.control()?.encode().to_vec()
    } else {
        return Err(unknown(number));
    };
    let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(Answer::default().with("bytes", text))
}

/// Reads whole numbers into the types of a report.
struct Fields<'a, 'b>(&'a mut Arguments<'b>);

impl Fields<'_, '_> {
    fn i16(&mut self, name: &'static str) -> Result<i16, Refusal> {
        let value = self.0.whole(name, i16::MIN.into(), i16::MAX.into())?;
        Ok(value as i16) // in range, as in the next two
    }

    fn u16(&mut self, name: &'static str) -> Result<u16, Refusal> {
        Ok(self.0.whole(name, 0, u16::MAX.into())? as u16)
    }

    fn u8(&mut self, name: &'static str) -> Result<u8, Refusal> {
        Ok(self.0.whole(name, 0, u8::MAX.into())? as u8)
    }

    fn control(&mut self) -> Result<Control, Refusal> {
        let value = self.u8("control")?;
        Control::decode(&[Control::NUMBER, value])
            .map_err(|_| Refusal::range("control", format_args!("is {value}, expected 0 to 2")))
    }
}

fn unknown(number: i64) -> Refusal {
    Refusal::range(
        "report",
        format_args!("number {number} is unknown, expected 1 to 4"),
    )
}

/// Bytes from pairs of hexadecimal digits.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (pairs, rest) = text.as_bytes().as_chunks::<2>();
    if !rest.is_empty() {
        return None;
    }
    let byte = |&[high, low]: &[u8; 2]| Some((digit(high)? * 16 + digit(low)?) as u8);
    pairs.iter().map(byte).collect()
}
