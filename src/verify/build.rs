//! What this build is: from which sources, by which compiler and how it was made (`spec/supply-chain.md`).

/// The identity of a build.
///
/// ```
/// use palpate::verify::build::Build;
///
/// let build = Build::THIS;
/// assert_eq!(build.version, env!("CARGO_PKG_VERSION"));
/// let changed = Build { commit: "0123abcd with changes", ..build };
/// assert_eq!(changed.known_commit(), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "std", derive(serde::Serialize))]
pub struct Build {
    /// The version of the package.
    pub version: &'static str,
    /// The commit of the sources; see [`Build::known_commit`].
    pub commit: &'static str,
    /// What the compiler calls itself, with its own commit and date.
    pub compiler: &'static str,
    /// The platform that it compiled for.
    pub target: &'static str,
    /// `release` or `debug`; a profile of another name shows as the one of these that it inherits from.
    pub profile: &'static str,
    /// The level of optimisation.
    pub optimisation: &'static str,
    /// Whether debug assertions are on.
    pub debug_assertions: bool,
    /// Flags given to the compiler beside those of the profile (`RUSTFLAGS`), without those that rename folders.
    pub flags: &'static str,
    /// The layers of the package that are in it, separated by commas.
    pub features: &'static str,
    /// Instructions of the processor that the compiler took for granted, separated by commas.
    pub processor_features: &'static str,
}

impl Build {
    /// This build.
    ///
    /// Implements: EVD-067, EVD-068.
    pub const THIS: Build = Build {
        version: env!("CARGO_PKG_VERSION"),
        commit: env!("PALPATE_BUILD_COMMIT"),
        compiler: env!("PALPATE_BUILD_COMPILER"),
        target: env!("PALPATE_BUILD_TARGET"),
        profile: env!("PALPATE_BUILD_PROFILE"),
        optimisation: env!("PALPATE_BUILD_OPTIMISATION"),
        debug_assertions: cfg!(debug_assertions),
        flags: env!("PALPATE_BUILD_FLAGS"),
        features: env!("PALPATE_BUILD_FEATURES"),
        processor_features: env!("PALPATE_BUILD_PROCESSOR"),
    };

    /// The commit that has exactly the sources of this build, in hexadecimal. `None` for a development build, for
    /// sources that differ from their commit, and where no commit was known.
    pub fn known_commit(&self) -> Option<&'static str> {
        let hexadecimal = self.commit.chars().all(|c| c.is_ascii_hexdigit());
        (hexadecimal && !self.commit.is_empty()).then_some(self.commit)
    }
}

/// The SHA-256 of the lock file of this build, in hexadecimal.
///
/// ```
/// let sum = palpate::verify::build::lock_sha256();
/// assert!(sum.len() == 64 && sum.chars().all(|digit| digit.is_ascii_hexdigit()));
/// ```
///
/// Implements: EVD-069.
#[cfg(feature = "cli")]
pub fn lock_sha256() -> String {
    use sha2::Digest;
    let digest = sha2::Sha256::digest(super::supply::LOCK);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The model of the processor that this runs on, as Linux names it; `None` where it does not.
///
/// ```
/// let model = palpate::verify::build::processor();
/// assert!(model.is_none_or(|model| !model.is_empty()));
/// ```
///
/// Implements: EVD-069.
#[cfg(feature = "std")]
pub fn processor() -> Option<String> {
    model(&std::fs::read_to_string("/proc/cpuinfo").ok()?)
}

/// The first model in the text of `/proc/cpuinfo`.
#[cfg(feature = "std")]
fn model(text: &str) -> Option<String> {
    let fields = text.lines().filter_map(|line| line.split_once(':'));
    let mut models = fields.filter(|(name, _)| name.trim() == "model name");
    let model = models.next()?.1.trim();
    (!model.is_empty()).then(|| model.to_string())
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    // Verifies: EVD-068.
    #[test]
    fn only_a_bare_commit_is_known() {
        let id = "0123456789abcdef0123456789abcdef01234567";
        let with = |commit| Build {
            commit,
            ..Build::THIS
        };
        assert_eq!(with(id).known_commit(), Some(id));
        for commit in [
            "0123456789abcdef0123456789abcdef01234567 with changes",
            "not recorded: development build",
            "unknown",
            "",
        ] {
            assert_eq!(with(commit).known_commit(), None, "{commit}");
        }
    }

    // Verifies: EVD-067.
    #[test]
    fn this_build_is_told() {
        let build = Build::THIS;
        assert!(build.compiler.starts_with("rustc 1."), "{build:?}");
        assert!(
            build.features.split(',').any(|feature| feature == "verify"),
            "{build:?}"
        );
        assert!(build.target.contains(std::env::consts::ARCH), "{build:?}");
        if cfg!(target_arch = "x86_64") {
            assert!(build.processor_features.contains("sse2"), "{build:?}");
        }
        let profile = if build.profile == "debug" {
            build.commit == "not recorded: development build"
        } else {
            build.profile == "release"
        };
        assert!(profile && !build.optimisation.is_empty(), "{build:?}");
    }

    // Verifies: EVD-069.
    #[test]
    fn the_processor_is_the_first_model_that_the_system_names() {
        let text = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Intel(R) Xeon(R): 2.5 GHz\n\nmodel name\t: other\n";
        assert_eq!(model(text).as_deref(), Some("Intel(R) Xeon(R): 2.5 GHz"));
        assert_eq!(model("processor\t: 0\nmodel name\t: \n"), None);
        assert_eq!(model(""), None);
    }

    // Verifies: EVD-069.
    #[cfg(feature = "cli")]
    #[test]
    fn the_hash_is_that_of_the_file_which_holds_the_checksums() {
        let output = std::process::Command::new("sha256sum")
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.lock"))
            .output()
            .expect("sha256sum is part of every Linux");
        let told = String::from_utf8(output.stdout).expect("hexadecimal");
        assert_eq!(told.split_whitespace().next(), Some(&*lock_sha256()));
    }
}
