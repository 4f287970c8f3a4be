//! The scenarios of the test on the HID stack (`tests/hid-stack`): the guest runs those in its lists `ALL` and prints
//! a line for each.

use crate::sources::Repository;

/// Name and call of each entry of the lists.
#[derive(Debug, Default)]
pub struct Scenarios(Vec<(String, String)>);

impl Scenarios {
    pub fn find(repository: &Repository) -> Scenarios {
        let sources = repository.sources.iter();
        let ours = sources.filter(|source| source.path.starts_with("tests/hid-stack/src/"));
        let mut entries = Vec::new();
        for source in ours {
            let Some((_, list)) = source.text.split_once("const ALL: ") else {
                continue;
            };
            let list = list.split_once("];").map_or(list, |(list, _)| list);
            for entry in list.split("(\n").flat_map(|entry| entry.split("(\"")) {
                let entry = entry.trim_start().trim_start_matches('"');
                if let Some((name, call)) = entry.split_once("\",") {
                    entries.push((name.into(), call.into()));
                }
            }
        }
        Scenarios(entries)
    }

    /// The names of the entries that call this function.
    pub fn lines_of(&self, function: &str) -> Vec<String> {
        let calls = |call: &str| {
            let words = call.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            words.into_iter().any(|word| word == function)
        };
        let entries = self.0.iter().filter(|(_, call)| calls(call));
        entries.map(|(name, _)| name.clone()).collect()
    }
}
