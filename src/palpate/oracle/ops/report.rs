//! The reports of the haptic device.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{Refused, Whole, arguments, arguments_of, named};
use crate::hid::{Capabilities, Control, ForceReport, InvalidReport, PositionReport};

/// The number of a report, which names its other fields.
#[derive(Debug, Deserialize)]
struct Number {
    report: Whole<1, 4>,
}

/// The arguments of a report: any whole number of the type of each field.
macro_rules! report {
    ($report:ident from $arguments:ident { $($field:ident: $type:ident),+ $(,)? }) => {
        arguments! {
            #[allow(dead_code)]
            $arguments {
                report: IgnoredAny,
                $($field: Whole<{ $type::MIN as i64 }, { $type::MAX as i64 }>),+
            }
        }

        impl From<$arguments> for $report {
            fn from(arguments: $arguments) -> $report {
                $report { $($field: arguments.$field.0 as $type),+ }
            }
        }
    };
}

report! {
    PositionReport from PositionFields {
        lateral: i16, normal: i16, buttons: u8, status: u8, sequence: u16, force_sequence: u16,
    }
}
report! {
    ForceReport from ForceFields { lateral: i16, normal: i16, sequence: u16, flags: u8 }
}
report! {
    Capabilities from CapabilitiesFields {
        version: u16, position_unit_nm: u16, force_unit_un: u16, largest_force_mn: u16,
        period_us: u16, watchdog_ms: u16, damping_mn_s_per_m: u16, friction_mn: u16,
    }
}
arguments! { #[allow(dead_code)] ControlFields { report: IgnoredAny, control: Whole<0, 2> } }
arguments! { Encoded { bytes: String } }

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
pub fn decode(arguments: Encoded) -> Result<Decoded, Refused> {
    let bytes = bytes(&arguments.bytes)
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
pub fn encode(arguments: &RawValue) -> Result<BTreeMap<&'static str, String>, Refused> {
    let text = arguments.get();
    let Number { report } = arguments_of(text)?;
    let bytes = match report.0 as u8 {
        PositionReport::NUMBER => PositionReport::from(arguments_of::<PositionFields>(text)?)
            .encode()
            .to_vec(),
        ForceReport::NUMBER => ForceReport::from(arguments_of::<ForceFields>(text)?)
            .encode()
            .to_vec(),
        Capabilities::NUMBER => Capabilities::from(arguments_of::<CapabilitiesFields>(text)?)
            .encode()
            .to_vec(),
        number => {
            let ControlFields { control, .. } = arguments_of(text)?;
            vec![number, control.0 as u8]
        }
    };
    let text = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(named("bytes", text))
}

/// Bytes from pairs of hexadecimal digits.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (pairs, rest) = text.as_bytes().as_chunks::<2>();
    let byte = |&[high, low]: &[u8; 2]| Some((digit(high)? * 16 + digit(low)?) as u8);
    let bytes = pairs.iter().map(byte).collect();
    rest.is_empty().then_some(bytes)?
}
