//! The reports of the haptic device.

use serde::{Deserialize, Serialize};

use super::{Refused, Whole, arguments_of, with_arguments};
use crate::hid::{Capabilities, Control, ForceReport, InvalidReport, PositionReport};

/// The number of a report, which chooses its other fields.
#[derive(Debug, Deserialize)]
struct Number {
    report: Whole<1, 4>,
}

/// The bytes of a report from its fields in a text, each a whole number of its type.
macro_rules! encoded {
    ($text:ident => $report:ident, $($field:ident: $type:ident),*) => {
        with_arguments!($text, [report] {
            $($field: Whole<{ $type::MIN as i64 }, { $type::MAX as i64 }>),*
        } => $report { $($field: $field.0 as $type),* }.encode().to_vec())
    };
}

/// The number of a report and its fields.
#[derive(Debug, Serialize)]
pub struct Decoded {
    report: u8,
    #[serde(flatten)]
    fields: Fields,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Fields {
    Position(PositionReport),
    Force(ForceReport),
    Capabilities(Capabilities),
    Control { control: u8 },
}

/// The fields of a report.
///
/// Implements: ORA-009, VEC-010.
pub fn decode(text: &str) -> Result<Decoded, Refused> {
    let bytes = bytes(text)
        .ok_or_else(|| Refused::argument("bytes must be pairs of hexadecimal digits"))?;
    let Some(&report) = bytes.first() else {
        return Err(Refused::argument("bytes is empty, but must be a report"));
    };
    let fields = match report {
        PositionReport::NUMBER => PositionReport::decode(&bytes).map(Fields::Position),
        ForceReport::NUMBER => ForceReport::decode(&bytes).map(Fields::Force),
        Capabilities::NUMBER => Capabilities::decode(&bytes).map(Fields::Capabilities),
        Control::NUMBER => Control::decode(&bytes).map(|control| Fields::Control {
            control: control as u8,
        }),
        _ => {
            let wrong = format_args!("bytes: report number {report} is not from 1 to 4");
            return Err(Refused::range(wrong));
        }
    };
    let invalid = |error: InvalidReport| Refused::range(format_args!("bytes: {error}"));
    let fields = fields.map_err(invalid)?;
    Ok(Decoded { report, fields })
}

/// The bytes of a report.
///
/// Implements: ORA-009, VEC-010.
pub fn encode(text: &str) -> Result<String, Refused> {
    let Number {
        report: Whole(number),
    } = arguments_of(text)?;
    let bytes = match number as u8 {
        PositionReport::NUMBER => encoded!(text => PositionReport,
            lateral: i16, normal: i16, buttons: u8, status: u8, sequence: u16, force_sequence: u16),
        ForceReport::NUMBER => encoded!(text => ForceReport,
            lateral: i16, normal: i16, sequence: u16, flags: u8),
        Capabilities::NUMBER => encoded!(text => Capabilities,
            version: u16, position_unit_nm: u16, force_unit_un: u16, largest_force_mn: u16,
            period_us: u16, watchdog_ms: u16, damping_mn_s_per_m: u16, friction_mn: u16),
        _ => with_arguments!(text, [report] { control: Whole<0, 2> } =>
            vec![Control::NUMBER, control.0 as u8]),
    };
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Bytes from pairs of hexadecimal digits.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (pairs, rest) = text.as_bytes().as_chunks::<2>();
    let byte = |&[high, low]: &[u8; 2]| Some((digit(high)? * 16 + digit(low)?) as u8);
    let bytes = pairs.iter().map(byte).collect();
    rest.is_empty().then_some(bytes)?
}
