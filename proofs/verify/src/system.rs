//! The machine and the moment of a run.

use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

/// Where and when a run was made, and by whom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct System {
    /// When it began, UTC, as in `2026-11-23T18:00:00Z`.
    pub began: String,
    /// Who ran it, as `--operator` says.
    pub operator: Option<String>,
    /// Operating system and kernel.
    pub operating_system: String,
    /// The C library.
    pub c_library: String,
    /// The processor.
    pub processor: String,
}

impl System {
    /// This machine, now. What cannot be found out is `not known`.
    pub fn here(operator: Option<String>) -> System {
        let known = |text: Option<String>| text.unwrap_or_else(|| "not known".into());
        let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
        let kernel = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
        System {
            began: utc(SystemTime::now()),
            operator,
            operating_system: known(
                name(&release).map(|name| format!("{name}, Linux {}", kernel.trim())),
            ),
            c_library: known(c_library()),
            processor: known(processor()),
        }
    }
}

/// `PRETTY_NAME` of an os-release file.
fn name(release: &str) -> Option<String> {
    let line = release
        .lines()
        .find_map(|line| line.strip_prefix("PRETTY_NAME="))?;
    Some(line.trim_matches('"').into())
}

fn c_library() -> Option<String> {
    let output = Command::new("getconf")
        .arg("GNU_LIBC_VERSION")
        .output()
        .ok()?;
    let said = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !said.trim().is_empty()).then(|| said.trim().into())
}

/// The model of the processor, as Linux names it.
fn processor() -> Option<String> {
    model(&std::fs::read_to_string("/proc/cpuinfo").ok()?)
}

/// The first model in the text of `/proc/cpuinfo`.
fn model(text: &str) -> Option<String> {
    let fields = text.lines().filter_map(|line| line.split_once(':'));
    let mut models = fields.filter(|(name, _)| name.trim() == "model name");
    let model = models.next()?.1.trim();
    (!model.is_empty()).then(|| model.to_string())
}

/// A time in UTC, by the Gregorian calendar: days are counted from 1 March, so that leap days end a year.
fn utc(time: SystemTime) -> String {
    let seconds = time
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 {
        (era * 400 + year, month + 3)
    } else {
        (era * 400 + year + 1, month - 9)
    };
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    // Expected: `date -u -d @N +%FT%TZ`.
    #[test]
    fn times_are_told_as_the_calendar_has_them() {
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), expected);
        }
    }

    #[test]
    fn the_processor_is_the_first_model_that_the_system_names() {
        let text = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Intel(R) Xeon(R): 2.5 GHz\n\nmodel name\t: other\n";
        assert_eq!(model(text).as_deref(), Some("Intel(R) Xeon(R): 2.5 GHz"));
        assert_eq!(model("processor\t: 0\nmodel name\t: \n"), None);
        assert_eq!(model(""), None);
    }

    #[test]
    fn a_system_is_named_as_it_names_itself() {
        let release = "NAME=\"Debian GNU/Linux\"\nPRETTY_NAME=\"Debian GNU/Linux 13 (trixie)\"\n";
        assert_eq!(
            name(release).as_deref(),
            Some("Debian GNU/Linux 13 (trixie)")
        );
        assert_eq!(name("ID=x\n"), None);
        let here = System::here(Some("A. Reviewer".into()));
        assert_eq!(
            (here.began.len(), here.operator.as_deref()),
            (20, Some("A. Reviewer"))
        );
    }
}
