//! Phantom files: TOML, in mm and kPa (`spec/phantom.md`). A file's tables become the JSON of a phantom, which serde reads;
//! what serde refuses there is told in the keys of the file.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Map, Value, json};
use serde_path_to_error::Segment;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Phantom;
use super::limits::{UNITS, in_unit_of, power_to_si};
use crate::decimal::parse_scaled;
use crate::input::line_of;
use crate::refusal::{Refusal, shortened};

/// Keys that a file has among those of a layer or an inclusion, and JSON in an object of their own.
const MATERIAL: &str = "youngs_modulus_kpa poisson_ratio";
const SHAPE: &str = "diameter_mm width_mm height_mm angle_deg points_mm";
const NESTED: [(&str, &str); 2] = [("material", MATERIAL), ("shape", SHAPE)];

impl Phantom {
    /// Reads the phantom file at `path`.
    ///
    /// # Errors
    /// As [`Phantom::from_toml`]; also if the file cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<Phantom, Refusal> {
        crate::input::parse(path, Phantom::from_toml)
    }

    /// The phantom in `text`, the content of `file`, which is named in errors alone.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let text = r#"
    /// name = "soft, without inclusion"
    /// well = { width_mm = 34, walls = "sliding" }
    /// layer = [{ thickness_mm = 15, youngs_modulus_kpa = 2.5, poisson_ratio = 0.49 }]
    /// probe = { radius_mm = 6.5, length_mm = 30 }
    /// "#;
    /// let phantom = Phantom::from_toml(text, "soft.toml")?;
    /// assert_eq!((phantom.well.width, phantom.layers[0].material.youngs_modulus), (0.034, 2500.0));
    /// let error = Phantom::from_toml(&text.replace("6.5", "17.0"), "wide.toml").unwrap_err();
    /// assert!(error.to_string().starts_with("wide.toml:5: probe.radius_mm = 17.0, expected "));
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// The text is not TOML, has an unknown key, lacks one, has a value of another type, or makes a phantom that
    /// [`Phantom::validate`] refuses; with the file, and the line where there is one.
    ///
    /// Implements: PHA-020, PHA-021, PHA-026, PHA-037.
    pub fn from_toml(text: &str, file: &str) -> Result<Phantom, Refusal> {
        let document = DeTable::parse(text).map_err(|error| {
            let at = error.span().map_or(text.len(), |span| span.start);
            let before = text.get(..at).unwrap_or(text);
            let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
            let message = format!("column {column}: not TOML: {}", error.message());
            let line = line_of(text, at);
            Refusal::state(message, "").at(line).in_file(file)
        })?;
        let (spans, names) = Default::default();
        let mut source = File { text, spans, names };
        let mut json = source.object("", document.get_ref());
        source.restructure(&mut json);
        let phantom = serde_path_to_error::deserialize(Value::Object(json));
        let phantom = phantom.map_err(|error| source.not_a_phantom(&error));
        let valid = phantom.and_then(|phantom: Phantom| match phantom.validate() {
            Ok(()) => Ok(phantom),
            Err(refusal) => Err(source.placed(refusal)),
        });
        valid.map_err(|refusal| refusal.in_file(file))
    }

    /// This phantom as the text of a phantom file.
    ///
    /// # Errors
    /// As [`Phantom::validate`], so that what is written can be read.
    ///
    /// Implements: PHA-021, PHA-027.
    pub fn to_toml(&self) -> Result<String, Refusal> {
        self.validate()?;
        let si = toml::to_string(self).expect("tables of texts and finite numbers are TOML");
        let mut text = String::new();
        for line in si.lines() {
            text += &match line.split_once(" = ") {
                Some((key, value)) => line_in_file(&other_name(key), value),
                // The tables of JSON that a file does not have.
                None if line.is_empty() || line.contains('.') => continue,
                None => format!("\n{line}\n"),
            }
        }
        Ok(text)
    }
}

/// A line with the SI numbers in `value`, or its text.
fn line_in_file(key: &str, value: &str) -> String {
    let item = |item: &str| {
        let digits = item.trim_matches(['[', ']']);
        let number = digits.parse().ok().filter(|_| power_to_si(key) != 0);
        let replaced = |number| item.replace(digits, &in_unit_of(key, number));
        number.map_or(item.into(), replaced)
    };
    let items: Vec<_> = value.split(", ").map(item).collect();
    format!("{key} = {}\n", items.join(", "))
}

/// A key of a file in JSON, and the other way round: in a file, a key of JSON thus becomes none of JSON.
fn other_name(key: &str) -> String {
    let both_ways = |(file, si, _)| [(file, si), (si, file)];
    let mut ends = UNITS.into_iter().flat_map(both_ways);
    let other = ends.find_map(|(end, other)| Some(key.strip_suffix(end)?.to_string() + other));
    other.unwrap_or(key.into())
}

/// A file that is being read.
struct File<'a> {
    text: &'a str,
    /// Where each value stands.
    spans: BTreeMap<String, std::ops::Range<usize>>,
    /// What this edition's keys are called in this file, where it is otherwise.
    names: Vec<(String, &'static str)>,
}

impl File<'_> {
    /// The value at `path` as JSON.
    fn value(&mut self, path: &str, value: &Spanned<DeValue>) -> Value {
        self.spans.insert(path.into(), value.span());
        match value.get_ref() {
            DeValue::String(text) => text.as_ref().into(),
            DeValue::Table(table) => self.object(path, table).into(),
            DeValue::Array(values) => {
                let item = |(at, item)| self.value(&format!("{path}[{at}]"), item);
                values.iter().enumerate().map(item).collect()
            }
            _ => {
                let text = self.text.get(value.span()).unwrap_or("").replace('_', "");
                let number = parse_scaled(&text, power_to_si(path));
                // All else becomes a boolean, which no key takes.
                number.map_or(Value::Bool(false), Value::from)
            }
        }
    }

    fn object(&mut self, path: &str, table: &DeTable) -> Map<String, Value> {
        let mut object = Map::new();
        for (key, value) in table {
            let path = format!("{path}.{}", key.get_ref());
            let value = self.value(path.trim_start_matches('.'), value);
            object.insert(other_name(key.get_ref()), value);
        }
        let nested = match path.split('[').next() {
            Some("layer" | "skin") => &NESTED[..1],
            Some("inclusion") => &NESTED,
            _ => return object,
        };
        for (outer, keys) in nested {
            // The outer key too: in a file there is none of that name.
            let keys = keys.split(' ').chain([*outer]);
            let entry = |key| object.remove_entry(&other_name(key));
            let mut inner: Map<_, _> = keys.filter_map(entry).collect();
            if *outer == "shape" {
                let keys: Vec<_> = inner.keys().map(|key| &**key).collect();
                let shape = match keys[..] {
                    ["diameter_m"] => "disc",
                    ["height_m", "width_m"] | ["angle_deg", "height_m", "width_m"] => "ellipse",
                    ["points_m"] => "polygon",
                    [] => "no key",
                    // As for none, serde will say that there is no such shape.
                    _ => &keys.join("`, `"),
                };
                inner = Map::from_iter([(shape.into(), inner.clone().into())]);
            }
            object.insert(outer.to_string(), inner.into());
        }
        if nested.len() == 1 {
            object.entry("name").or_insert(path.into());
        }
        object
    }

    /// Gives what a person or the first edition may write otherwise the form that JSON has.
    fn restructure(&mut self, file: &mut Map<String, Value>) {
        if let Some(table) = file.get_mut("inclusion").filter(|value| value.is_object()) {
            *table = json!([table.take()]);
            self.names.push(("inclusion[0]".into(), "inclusion"));
        }
        let mut well = file.remove("well").unwrap_or_else(|| json!({}));
        // Beside keys of this edition, `gel` stays, as an unknown key.
        if well.is_object()
            && well["width_m"].is_null()
            && !file.contains_key("layer")
            && let Some(gel) = file.get_mut("gel").and_then(Value::as_object_mut)
        {
            // What is null here is missing.
            well["width_m"] = json!(gel.remove("width_m"));
            let gel =
                json!({"name": "gel", "thickness_m": gel.remove("height_m"), "material": gel});
            file.remove("gel");
            let skin = file.remove("skin");
            let layer = format!("layer[{}]", usize::from(skin.is_some()));
            self.names.extend([
                ("well.width_mm".into(), "gel.width_mm"),
                (format!("{layer}.thickness_mm"), "gel.height_mm"),
                (layer, "gel"),
                ("layer[0]".into(), "skin"),
            ]);
            file.insert("layer".into(), skin.into_iter().chain([gel]).collect());
        }
        file.insert("well".into(), well);
    }

    /// The refusal of what serde refused in JSON.
    fn not_a_phantom(&self, error: &serde_path_to_error::Error<serde_json::Error>) -> Refusal {
        let mut key = String::new();
        for segment in error.path() {
            match segment {
                Segment::Seq { index } => key += &format!("[{index}]"),
                Segment::Map { key: name } => key += &format!(".{}", other_name(name)),
                Segment::Enum { .. } | Segment::Unknown => {}
            }
        }
        let message = error.inner().to_string();
        let words: Vec<_> = message.split('`').map(other_name).collect();
        let message = words.join("`");
        let (found, expected) = message.split_once(", expected ").unwrap_or((&message, ""));
        let mut expected = expected.replace("f64", "a finite decimal number");
        for (outer, keys) in NESTED {
            let keys = format!("`{}`", keys.replace(' ', "`, `"));
            expected = expected.replace(&format!("`{outer}`"), &keys);
        }
        let is_missing = words[0] == "missing field ";
        if is_missing {
            key = key + "." + &words[1];
        }
        let key = self.in_file(&key);
        let key = key.replace(".material.", ".").replace(".shape.", ".");
        let key = key.trim_start_matches('.');
        let span = self.spans.get(key).cloned();
        let written = span.and_then(|span| self.text.get(span));
        // Without a value it is a shape of unknown keys.
        let written = written.unwrap_or(found.trim_start_matches("unknown variant "));
        let refusal = Refusal::value(key, shortened(written), expected);
        let line = self.line_of(key);
        let refusal = if is_missing || found == "invalid type: null" {
            Refusal::state(format!("{key} is missing"), "")
        } else if words[0] == "unknown field " {
            Refusal::state(format!("{key} is unknown"), refusal.expected)
        } else {
            refusal
        };
        Refusal { line, ..refusal }
    }

    /// A refusal of a phantom, in the keys and with the line of this file.
    fn placed(&self, refusal: Refusal) -> Refusal {
        let key = self.in_file(&refusal.key);
        Refusal {
            line: self.line_of(&key),
            found: self.in_file(&refusal.found),
            expected: self.in_file(&refusal.expected),
            key,
            ..refusal
        }
    }

    /// The line of the value at `key`, or of the innermost one around it that is there.
    fn line_of(&self, key: &str) -> Option<usize> {
        let mut outer = std::iter::successors(Some(key), |key| key.get(..key.rfind(['.', '['])?));
        let span = outer.find_map(|key| self.spans.get(key))?;
        Some(line_of(self.text, span.start))
    }

    /// A text that names keys of this edition, in those of this file.
    fn in_file(&self, text: &str) -> String {
        let names = self.names.iter();
        names.fold(text.into(), |text, (key, name)| text.replace(key, name))
    }
}
