//! The machine and the moment of a run.

use std::process::Command;

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
        let processors = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        System {
            began: known(said("date", &["-u", "+%FT%TZ"])),
            operator,
            operating_system: known(
                name(&release).map(|name| format!("{name}, Linux {}", kernel.trim())),
            ),
            c_library: known(said("getconf", &["GNU_LIBC_VERSION"])),
            processor: known(model(&processors)),
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

/// What a program of the system prints, if it is there.
fn said(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let said = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !said.trim().is_empty()).then(|| said.trim().into())
}

/// The first model in the text of `/proc/cpuinfo`.
fn model(text: &str) -> Option<String> {
    let fields = text.lines().filter_map(|line| line.split_once(':'));
    let mut models = fields.filter(|(name, _)| name.trim() == "model name");
    let model = models.next()?.1.trim();
    (!model.is_empty()).then(|| model.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(here.operator.as_deref(), Some("A. Reviewer"));
        // As in 2026-11-23T18:00:00Z.
        let began = (here.began.len(), &here.began[10..11], &here.began[19..]);
        assert_eq!(began, (20, "T", "Z"));
    }
}
