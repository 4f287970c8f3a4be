//! The reports of the haptic device.

use serde_json::{Map, Value, from_value, to_value};

use super::{Answer, Arguments, Refused};
use crate::hid::{Capabilities, Control, ForceReport, PositionReport};

/// The number of a report, and the fields of all reports.
///
/// Implements: ORA-009.
pub const FIELDS: &str = "report lateral normal buttons status sequence force_sequence flags version \
    position_unit_nm force_unit_un largest_force_mn period_us watchdog_ms damping_mn_s_per_m friction_mn control";

/// The fields of the report with a number.
fn fields(number: i64) -> Result<&'static str, Refused> {
    Ok(match number {
        1 => "lateral normal buttons status sequence force_sequence",
        2 => "lateral normal sequence flags",
        3 => {
            "version position_unit_nm force_unit_un largest_force_mn period_us watchdog_ms \
             damping_mn_s_per_m friction_mn"
        }
        4 => "control",
        _ => {
            let wrong = format_args!("report number {number} is unknown, expected 1 to 4");
            return Err(Refused::range(wrong));
        }
    })
}

/// The least and the largest value of a field.
fn range(field: &str) -> (i64, i64) {
    match field {
        "lateral" | "normal" => (i16::MIN.into(), i16::MAX.into()),
        "buttons" | "status" | "flags" => (0, u8::MAX.into()),
        "control" => (0, 2),
        _ => (0, u16::MAX.into()),
    }
}

/// The fields of a report.
///
/// Implements: ORA-009, VEC-010.
pub fn decode(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let bytes = bytes(&arguments.text("bytes")?)
        .ok_or_else(|| Refused::argument("bytes is expected to be pairs of hexadecimal digits"))?;
    let Some(&number) = bytes.first() else {
        return Err(Refused::argument("bytes is empty, expected a report"));
    };
    let fields = fields(number.into())?;
    let report = match number {
        PositionReport::NUMBER => PositionReport::decode(&bytes).map(to_value),
        ForceReport::NUMBER => ForceReport::decode(&bytes).map(to_value),
        Capabilities::NUMBER => Capabilities::decode(&bytes).map(to_value),
        _ => Control::decode(&bytes).map(|control| {
            let value = control.encode()[1];
            Ok(Map::from_iter([("control".into(), value.into())]).into())
        }),
    };
    let report = report.map_err(|error| Refused::range(format_args!("bytes: {error}")))?;
    let mut report = report.map_err(Refused::range)?;
    let answer = Answer::of([("report", number)]);
    Ok(fields.split(' ').fold(answer, |answer, field| {
        answer.with(field, report[field].take())
    }))
}

/// The bytes of a report.
///
/// Implements: ORA-009, VEC-010.
pub fn encode(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let number = arguments.whole("report", 0, 255)?;
    let mut report = Map::new();
    for field in fields(number)?.split(' ') {
        let (least, most) = range(field);
        let value = arguments.whole(field, least, most)?;
        report.insert(field.into(), value.into());
    }
    let control = report.get("control").and_then(Value::as_u64);
    let report = Value::Object(report);
    let bytes = match number as u8 {
        PositionReport::NUMBER => from_value(report).map(|r: PositionReport| r.encode().to_vec()),
        ForceReport::NUMBER => from_value(report).map(|r: ForceReport| r.encode().to_vec()),
        Capabilities::NUMBER => from_value(report).map(|r: Capabilities| r.encode().to_vec()),
        _ => Ok(vec![Control::NUMBER, control.unwrap_or_default() as u8]),
    };
    let bytes = bytes.map_err(Refused::range)?.into_iter();
    let text: String = bytes.map(|byte| format!("{byte:02x}")).collect();
    Ok(Answer::of([("bytes", text)]))
}

/// Bytes from pairs of hexadecimal digits.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (pairs, rest) = text.as_bytes().as_chunks::<2>();
    let byte = |&[high, low]: &[u8; 2]| Some((digit(high)? * 16 + digit(low)?) as u8);
    let bytes = pairs.iter().map(byte).collect();
    rest.is_empty().then_some(bytes)?
}
