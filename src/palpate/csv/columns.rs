//! Which column of a file holds which quantity: by the names that this project writes, by those that laboratories use, or as the user says.

use std::collections::BTreeMap;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, de::Error};

use super::split;
use crate::decimal::parse_scaled;
use crate::refusal::{Refusal, shortened};

/// What a column can be called, and for each name the power of ten from its unit to SI. Of several groups of names the first that
/// the header has counts.
///
/// Implements: CON-002.
pub type Column = &'static [&'static [(&'static str, i32)]];

/// Other names of a quantity, in small letters and with `_` between their parts, without a unit.
///
/// Implements: MAP-045.
const SYNONYMS: &[(&str, &[&str])] = &[
    (
        "normal_force",
        &[
            "force_normal",
            "fz",
            "fn",
            "force_z",
            "z_force",
            "wrench_force_z",
            "force",
            "load",
            "f",
        ],
    ),
    (
        "lateral_force",
        &[
            "force_lateral",
            "fx",
            "ft",
            "force_x",
            "x_force",
            "wrench_force_x",
            "shear_force",
        ],
    ),
    ("position", POSITIONS),
    ("lateral", POSITIONS),
    (
        "depth",
        &["indentation", "indentation_depth", "displacement"],
    ),
    ("time", &["t", "timestamp", "elapsed_time"]),
];
const POSITIONS: &[&str] = &[
    "pos",
    "x",
    "x_position",
    "position_x",
    "lateral_position",
    "pose_position_x",
];

/// How a file is laid out, where its header does not tell.
///
/// ```
/// use palpate::csv::Layout;
/// use palpate::trace::Trace;
///
/// let text = "Well,E5\nZ (mm),Fx (N),Raw_Force(N)\n0,0,-1.5\n1,0,-1.75\n";
/// let layout = "position=Z (mm), normal=-Raw_Force(N)".parse::<Layout>()?;
/// let trace = Trace::from_csv_as(text, "E5.csv", &layout)?;
/// assert_eq!(trace.record(None)?.forces().normal, [1.5, 1.75]);
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    columns: Vec<Stated>,
    /// Lines that are left out at the start of the file.
    pub skipped: usize,
    /// The decimal mark, if it is known from other lines.
    pub(crate) mark: Option<char>,
    /// Whether the table was made of an object, whose keys are the header.
    pub(crate) is_of_objects: bool,
}

/// A column as the user states it: `position=Z_Position(mm)`, `normal=-AI1*500[mN]`.
#[derive(Debug, Clone, PartialEq)]
struct Stated {
    /// As in [`key`].
    quantity: String,
    /// All that is stated but the sign: a name, if the header has it.
    whole: String,
    /// The name in the header, or the number from 1.
    name: String,
    sign: f64,
    factor: f64,
    unit: Option<String>,
}

/// What a column holds in the words of `--columns`, by the beginning of its name.
fn key(quantity: &str) -> &str {
    match quantity {
        "lateral" => "position",
        "normal_force" => "normal",
        "lateral_force" => "lateral",
        other => other,
    }
}

impl FromStr for Layout {
    type Err = Refusal;

    /// Reads a list such as `position=Z(mm), normal=-Load[mN]`: a quantity (position, time, depth, normal, lateral), a name of the
    /// header or a number from 1, before it a sign, behind it `*` and a factor and a unit in square brackets.
    ///
    /// Implements: MAP-046.
    fn from_str(text: &str) -> Result<Layout, Refusal> {
        let columns = split(text, ',').map(Stated::parse);
        let columns: Vec<Stated> = columns.collect::<Result<_, _>>()?;
        for (at, stated) in columns.iter().enumerate() {
            let quantity = &stated.quantity;
            let is_twice = columns[..at].iter().any(|of| of.quantity == *quantity);
            let found = format!("{quantity} is twice in the columns");
            Refusal::state(found, "give it once").when(is_twice)?;
        }
        Ok(Layout {
            columns,
            ..Layout::default()
        })
    }
}

/// From a table with an entry for each quantity: `normal = "-Load[mN]"`.
///
/// Implements: CLI-174.
impl<'de> Deserialize<'de> for Layout {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Layout, D::Error> {
        let table = BTreeMap::<String, String>::deserialize(deserializer)?;
        let columns = table.iter().map(|(key, name)| format!("{key}={name}"));
        let columns: Result<_, Refusal> = columns.map(|column| Stated::parse(&column)).collect();
        Ok(Layout {
            columns: columns.map_err(D::Error::custom)?,
            ..Layout::default()
        })
    }
}

impl Layout {
    /// Whether a column is stated.
    pub(super) fn states(&self, column: Column) -> bool {
        let mut keys = column.iter().map(|names| key(quantity(names)));
        keys.any(|key| self.columns.iter().any(|stated| stated.quantity == key))
    }

    /// Checks that a table of `columns` has what is stated.
    ///
    /// Implements: MAP-046.
    pub(super) fn check(&self, columns: &[Column]) -> Result<(), Refusal> {
        let quantities = columns.iter().copied().flatten();
        let keys: Vec<&str> = quantities.map(|names| key(quantity(names))).collect();
        let mut stated = self.columns.iter().map(|stated| &*stated.quantity);
        match stated.find(|stated| !keys.contains(stated)) {
            None => Ok(()),
            Some(other) => Err(Refusal::state(
                format!("the columns have {other}, which such a table does not have"),
                format!("give {}", keys.join(", ")),
            )),
        }
    }
}

impl Stated {
    fn parse(text: &str) -> Result<Stated, Refusal> {
        let wrong = || {
            let text = format!("{:?} in the columns", shortened(text));
            Refusal::state(
                text,
                "write each as in position=Z_Position(mm) or normal=-Load*0.5[mN]",
            )
        };
        let (quantity, name) = text.split_once('=').ok_or_else(wrong)?;
        let unquoted = |name: &str| name.trim().trim_matches('"').trim().to_owned();
        let (quantity, name) = (quantity.trim(), &*unquoted(name));
        let (whole, sign) = match name.strip_prefix('-') {
            Some(name) => (name, -1.0),
            None => (name, 1.0),
        };
        let (name, unit) = match whole
            .strip_suffix(']')
            .and_then(|name| name.rsplit_once('['))
        {
            Some((name, unit)) => (name.trim(), Some(unit.trim().to_owned())),
            None => (whole, None),
        };
        let factor = name.rsplit_once('*').and_then(|(name, factor)| {
            let factor = parse_scaled(factor.trim(), 0)?;
            Some((name.trim(), factor)).filter(|_| factor != 0.0)
        });
        let (name, factor) = factor.unwrap_or((name, 1.0));
        let name = unquoted(name);
        let is_known = SYNONYMS.iter().any(|(of, _)| key(of) == quantity);
        if name.is_empty() || !is_known {
            return Err(wrong());
        }
        Ok(Stated {
            quantity: quantity.into(),
            whole: unquoted(whole),
            name,
            sign,
            factor,
            unit,
        })
    }
}

/// A column that was found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    /// Its place in the header, from 0.
    pub place: usize,
    /// The name that this project writes for it, with its unit.
    pub name: &'static str,
    /// The power of ten from its unit to SI.
    pub power: i32,
    /// What its numbers are multiplied by.
    pub factor: f64,
    /// How it was found.
    pub by: By,
    /// Who says its unit.
    pub unit: UnitBy,
}

/// Who says the unit of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UnitBy {
    /// Nobody: it is the usual one, if there is one.
    Nobody,
    /// Its name.
    Name,
    /// The user, whose word counts.
    User,
    /// Its name and a row of units, which say different ones.
    Two,
}

/// How a column is found: by the first that finds one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum By {
    /// By the name that this project writes, or as the user states it.
    Name,
    /// By another name with a unit.
    Synonym,
    /// The same without a unit.
    Unitless,
}

impl Found {
    /// The same in the unit that a row of units gives, if it is one.
    pub fn in_unit(self, column: Column, unit: &str) -> Option<Found> {
        let unit = unit.trim_matches(['(', ')', '[', ']']);
        let of_quantity = |names: &&&[Named]| names.contains(&(self.name, self.power));
        let names = column.iter().find(of_quantity)?;
        let (name, power) = in_unit(names, unit)?;
        let by = match self.by {
            By::Unitless => By::Synonym,
            by => by,
        };
        Some(match self.unit {
            UnitBy::User => self,
            UnitBy::Name if power != self.power => Found {
                unit: UnitBy::Two,
                ..self
            },
            _ => Found {
                name,
                power,
                by,
                ..self
            },
        })
    }
}

/// One of the names of a quantity, which ends in its unit, with its power of ten.
type Named = (&'static str, i32);

/// The quantity of names.
fn quantity(names: &[Named]) -> &'static str {
    let apart = names[0].0.rsplit_once('_');
    apart.map_or("", |(quantity, _)| quantity)
}

/// The unit at the end of a name.
fn unit((name, _): &Named) -> &'static str {
    name.rsplit('_').next().unwrap_or("")
}

/// The name in a unit, whose case does not count, but that a meganewton is no millinewton.
fn in_unit(names: &[Named], of: &str) -> Option<Named> {
    let same = |name: &&Named| unit(name).eq_ignore_ascii_case(of) && of != "MN";
    names.iter().find(same).copied()
}

/// What stands between the parts of a name, beside blanks. Other marks are a part of it: `Load (%)` is no force in N.
const BETWEEN: &[char] = &[
    '_', '-', '.', '/', '\\', ':', ',', ';', '(', ')', '[', ']', '{', '}', '"', '\'',
];

/// The parts of a field of the header with `_` between them, in small letters, and the name in the unit behind them, if there is one.
fn taken_apart(field: &str, names: &[Named]) -> (String, Option<Named>) {
    let parts = field.split(|c: char| c.is_whitespace() || BETWEEN.contains(&c));
    let mut parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    let last = parts.last().filter(|_| parts.len() > 1);
    let named = last.and_then(|last| in_unit(names, last));
    parts.truncate(parts.len() - usize::from(named.is_some()));
    (parts.join("_").to_lowercase(), named)
}

/// Where in a header a column is.
///
/// Implements: MAP-030, MAP-033, MAP-045, MAP-046.
pub(super) fn find(header: &[&str], column: Column, layout: &Layout) -> Result<Found, String> {
    for names in column {
        let mut stated = layout.columns.iter();
        if let Some(stated) = stated.find(|stated| stated.quantity == key(quantity(names))) {
            return stated.find(header, names);
        }
    }
    for names in column {
        for by in [By::Name, By::Synonym, By::Unitless] {
            let found = (0..).zip(header).filter_map(|(place, field)| {
                let (name, power) = read(field, names, by)?;
                let is_named = by == By::Name || taken_apart(field, names).1.is_some();
                Some(Found {
                    place,
                    name,
                    power,
                    factor: 1.0,
                    by,
                    unit: if is_named {
                        UnitBy::Name
                    } else {
                        UnitBy::Nobody
                    },
                })
            });
            match found.collect::<Vec<_>>()[..] {
                [] => {}
                [only] => return Ok(only),
                [first, second, ..] => {
                    let (first, second) = (first.place + 1, second.place + 1);
                    let quantity = quantity(names).replace('_', " ");
                    return Err(format!("columns {first} and {second} for the {quantity}"));
                }
            }
        }
    }
    let names = column.iter().copied().flatten().map(|(name, _)| *name);
    let names: Vec<_> = names.collect();
    Err(format!("no column {}", names.join(" or ")))
}

/// Whether a field of a header is a name of a column that may be missing. A depth has its own name alone: what laboratories call a
/// displacement or an indentation may be another.
///
/// Implements: TRC-080.
pub(super) fn names(field: &str, column: Column) -> bool {
    let is_name = |names: &&[Named], by| {
        (by == By::Name || quantity(names) != "depth") && read(field, names, by).is_some()
    };
    let ways = [By::Name, By::Synonym, By::Unitless];
    ways.iter()
        .any(|by| column.iter().any(|names| is_name(names, *by)))
}

/// The name of a field of the header. A force without a unit is in N and a time in s; a length must have one.
fn read(field: &str, names: &[Named], by: By) -> Option<Named> {
    if by == By::Name {
        return names
            .iter()
            .find(|(name, _)| name.eq_ignore_ascii_case(field) && !field.ends_with("_MN"))
            .copied();
    }
    let (name, named) = taken_apart(field, names);
    let quantity = quantity(names);
    let synonyms = SYNONYMS.iter().find(|(of, _)| *of == quantity);
    let is_synonym = synonyms.is_some_and(|(_, synonyms)| synonyms.contains(&&*name));
    let is_named = !quantity.is_empty() && name == quantity || is_synonym;
    let named = named.or(Some(names[0]).filter(|first| ["n", "s"].contains(&unit(first))));
    let named = match by {
        By::Unitless => Some(names[0]).filter(|_| named.is_none()),
        _ => named,
    };
    named.filter(|_| is_named)
}

impl Stated {
    /// The column that was stated.
    fn find(&self, header: &[&str], names: &[Named]) -> Result<Found, String> {
        let place_of = |name: &str| {
            let mut places = (0..header.len()).filter(|at| header[*at].eq_ignore_ascii_case(name));
            match (places.next(), places.next()) {
                (Some(first), Some(second)) => {
                    let (first, second) = (first + 1, second + 1);
                    let name = shortened(name);
                    Err(format!(
                        "columns {first} and {second} with the name {name:?}"
                    ))
                }
                (place, _) => Ok(place),
            }
        };
        let by_whole = place_of(&self.whole)?;
        let by_name = match by_whole {
            Some(place) => Some(place),
            None => place_of(&self.name)?,
        };
        let number = self
            .name
            .parse()
            .ok()
            .and_then(|number: usize| number.checked_sub(1));
        let place = by_name.or(number).filter(|place| *place < header.len());
        let place = place.ok_or_else(|| format!("no column {:?}", shortened(&self.name)))?;
        let named = match &self.unit {
            None => taken_apart(header[place], names).1,
            Some(unit) => Some(in_unit(names, unit).ok_or_else(|| {
                let units: Vec<_> = names.iter().map(self::unit).collect();
                let units = units.join(" or ");
                format!("column {} in {unit}, which must be in {units},", place + 1)
            })?),
        };
        let (name, power) = named.unwrap_or(names[0]);
        Ok(Found {
            place,
            name,
            power,
            factor: self.sign * by_whole.map_or(self.factor, |_| 1.0),
            by: named.map_or(By::Unitless, |_| By::Name),
            unit: match (&self.unit, named) {
                (Some(_), _) => UnitBy::User,
                (None, Some(_)) => UnitBy::Name,
                (None, None) => UnitBy::Nobody,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::Rows;

    const COLUMNS: [Column; 2] = [
        &[
            &[("position_mm", -3), ("position_m", 0)],
            &[("time_s", 0), ("time_ms", -3)],
        ],
        &[&[("normal_force_n", 0), ("normal_force_mn", -3)]],
    ];
    const TEXT: &str = "pos (mm),t,AI1,Load (N)\n1,0.25,-2,-3\n";

    fn read(text: &str, layout: &str) -> Result<[f64; 2], String> {
        let layout = layout
            .parse()
            .map_err(|refusal: Refusal| refusal.to_string())?;
        let read = Rows::parse_optional(text, COLUMNS, 2, "a trace", &layout, false);
        Ok(read.map_err(|refusal| refusal.to_string())?.0.rows[0].1)
    }

    // Verifies: MAP-046, MAP-045.
    #[test]
    fn columns_are_taken_as_they_are_stated() {
        for (layout, expected) in [
            ("normal=Load (N)", [1e-3, -3.0]),
            ("normal=-Load (N)", [1e-3, 3.0]),
            (" normal = -ai1*0.5[mN] ", [1e-3, 1e-3]),
            ("normal=-3*0.5[mN],position=1", [1e-3, 1e-3]),
            ("time=t[ms], normal=4", [2.5e-4, -3.0]),
            ("position=t[m]", [0.25, -3.0]),
            ("normal=-\"Load (N)\"[mN]", [1e-3, 3e-3]),
            ("normal=\"-Load (N)[mN]\"", [1e-3, 3e-3]),
        ] {
            assert_eq!(read(TEXT, layout), Ok(expected), "{layout}");
        }
        // A name that is a number is a name first.
        let layout = "position=1[mm],normal=2[N]";
        assert_eq!(read("2,1\n3,4\n", layout), Ok([4e-3, 3.0]));
        let layout = layout.parse().unwrap();
        let rows = Rows::parse_optional("2,1\n3,4\n", COLUMNS, 2, "", &layout, false);
        let note = "line 1, which holds numbers, is taken for the header";
        assert!(rows.unwrap().0.notes.contains(&note.to_string()));
        // A name may end in a unit in square brackets, as the user's column may.
        let text = "pos (mm),t,Raw [mN]\n1,0.25,-2\n";
        for (layout, force) in [
            ("normal=Raw [mN]", -2e-3),
            ("normal=-raw [mN]", 2e-3),
            ("normal=-\"Raw [mN]\"", 2e-3),
            ("normal=-Raw [mN]*0.5[N]", 1.0),
        ] {
            let layout = format!("{layout},position=1");
            assert_eq!(read(text, &layout), Ok([1e-3, force]), "{layout}");
        }
        // A row of units does not change a unit that is stated, nor has it to know that of a column with one.
        let text = "pos,t,AI1,Load\nmm,s,V,N\n1,0.25,-2,-3\n";
        for (layout, force) in [
            ("normal=AI1*0.5[mN]", -1e-3),
            ("normal=Load[mN]", -3e-3),
            ("normal=Load", -3.0),
        ] {
            let layout = format!("{layout},position=pos");
            assert_eq!(read(text, &layout), Ok([1e-3, force]), "{layout}");
        }
        // Without a word the position counts, however well the time is named, and of the forces the one with a name.
        for (text, position) in [
            ("time_s,X (mm),Load (N)\n1,2,-3\n", 2e-3),
            ("Time,X,Load\ns,mm,N\n1,2,-3\n", 2e-3),
            ("time_s,Load (N)\n1,-3\n", 1.0),
        ] {
            let rows = Rows::parse(text, COLUMNS, "").unwrap().rows;
            assert_eq!(rows[0].1, [position, -3.0], "{text}");
        }
        // A unit that the name has, or that is the usual one, need not stand again below it.
        for text in [
            "pos_mm,Force\n,mN\n1,-3\n",
            "pos,time_s,Force\nmm,,mN\n1,2,-3\n",
        ] {
            let rows = Rows::parse(text, COLUMNS, "").unwrap().rows;
            assert_eq!(rows[0].1, [1e-3, -3e-3], "{text}");
        }
        assert_eq!(
            Rows::parse(TEXT, COLUMNS, "").unwrap().rows[0].1,
            [1e-3, -3.0]
        );
        let ros = "pose.position.x (m),wrench.force.z\n0.001,-3\n";
        assert_eq!(
            Rows::parse(ros, COLUMNS, "").unwrap().rows[0].1,
            [1e-3, -3.0]
        );
    }

    // Verifies: MAP-046.
    #[test]
    fn columns_that_are_not_there_are_refused() {
        for (layout, expected) in [
            (
                "normal",
                "\"normal\" in the columns; write each as in position=",
            ),
            (
                "force=Load (N)",
                "\"force=Load (N)\" in the columns; write each",
            ),
            ("normal=", "\"normal=\" in the columns; write each"),
            (
                "depth=t[mm]",
                "the columns have depth, which such a table does not have; give position, time, normal",
            ),
            (
                "normal=3[N],normal=4",
                "normal is twice in the columns; give it once",
            ),
            (
                "position=4[mm]",
                "line 1: column 4 for both position_mm and normal_force_n in the header",
            ),
            ("normal=Last", "line 1: no column \"Last\" in the header"),
            ("normal=5[N]", "line 1: no column \"5\" in the header"),
            ("normal=0[N]", "line 1: no column \"0\" in the header"),
            ("normal=AI1", "line 1: column 3 has no unit in the header"),
            (
                "normal=AI1[V]",
                "line 1: column 3 in V, which must be in n or mn, in the header",
            ),
            (
                "normal=AI1[MN]",
                "line 1: column 3 in MN, which must be in n or mn, in the header",
            ),
        ] {
            let found = read(TEXT, layout).unwrap_err();
            assert!(found.starts_with(expected), "{layout}: {found}");
        }
    }

    // Verifies: MAP-045, MAP-046.
    #[test]
    fn what_may_mean_two_things_is_refused() {
        let mega = "no column normal_force_n or normal_force_mn in the header";
        for header in [
            "pos (mm),Load (MN)",
            "pos (mm),normal_force_MN",
            "pos (mm),Load (%)",
            "pos (mm),|F| (N)",
        ] {
            let found = read(&format!("{header}\n1,-3\n"), "position=1").unwrap_err();
            assert!(found.contains(mega), "{header}: {found}");
        }
        assert!(Rows::parse("pos,Load\nmm,MN\n1,-3\n", COLUMNS, "").is_err());
        let text = "pos (mm),Load,T,load\n1,-3,20,5\n";
        let found = read(text, "normal=Load[N]").unwrap_err();
        let twice = "line 1: columns 2 and 4 with the name \"Load\" in the header";
        assert!(found.starts_with(twice), "{found}");
        assert_eq!(read(text, "normal=4[N]"), Ok([1e-3, 5.0]));
        // Spreadsheets write blanks that do not break a line.
        let blanks = "pos\u{a0}(mm),Load\u{a0}(N)\n1,-3\n";
        assert_eq!(read(blanks, "position=1"), Ok([1e-3, -3.0]));
    }

    // Verifies: MAP-047.
    #[test]
    fn a_row_of_units_does_not_contradict_the_names() {
        for (text, column) in [
            ("a line before\n\npos_mm,Force\nm,N\n1,-3\n", 1),
            ("position_mm,normal_force_n\nmm,mN\n1,-3\n", 2),
            ("pos [mm],Load (N)\nmm,mN\n1,-3\n", 2),
        ] {
            let found = Rows::parse(text, COLUMNS, "").err().unwrap().to_string();
            let expected =
                format!("column {column} has two units, one in its name and one below it,");
            assert!(found.contains(&expected), "{text}: {found}");
        }
        let text = "pos_mm,Load (N)\nm,mN\n1,-3\n";
        let stated = "position=pos_mm[mm],normal=Load (N)[N]";
        assert_eq!(read(text, stated), Ok([1e-3, -3.0]));
        let same = Rows::parse("pos_mm,Load (N)\nmm,N\n1,-3\n", COLUMNS, "");
        assert_eq!(same.unwrap().rows[0].1, [1e-3, -3.0]);
    }
}
