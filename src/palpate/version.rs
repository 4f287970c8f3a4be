//! What this build is: from which sources, by which compiler and how it was made (`spec/supply-chain.md`).

/// The identity of a build.
///
/// ```
/// use palpate::version::Build;
///
/// let build = Build::THIS;
/// assert_eq!(build.version, env!("CARGO_PKG_VERSION"));
/// let changed = Build { commit: "0123abcd with changes", ..build };
/// assert_eq!(changed.known_commit(), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
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
    /// Instructions of the processor that the compiler took for granted, separated by commas.
    pub processor_features: &'static str,
}

/// The version, and which build this is, for `--version`.
pub const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit ",
    env!("PALPATE_BUILD_COMMIT"),
    "\n",
    env!("PALPATE_BUILD_COMPILER"),
    " for ",
    env!("PALPATE_BUILD_TARGET")
);

impl Build {
    /// This build.
    pub const THIS: Build = Build {
        version: env!("CARGO_PKG_VERSION"),
        commit: env!("PALPATE_BUILD_COMMIT"),
        compiler: env!("PALPATE_BUILD_COMPILER"),
        target: env!("PALPATE_BUILD_TARGET"),
        profile: env!("PALPATE_BUILD_PROFILE"),
        optimisation: env!("PALPATE_BUILD_OPTIMISATION"),
        debug_assertions: cfg!(debug_assertions),
        flags: env!("PALPATE_BUILD_FLAGS"),
        processor_features: env!("PALPATE_BUILD_PROCESSOR"),
    };

    /// The commit that has exactly the sources of this build, in hexadecimal. `None` for a development build, for
    /// sources that differ from their commit, and where no commit was known.
    pub fn known_commit(&self) -> Option<&'static str> {
        let hexadecimal = self.commit.chars().all(|c| c.is_ascii_hexdigit());
        (hexadecimal && !self.commit.is_empty()).then_some(self.commit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn this_build_is_told() {
        let build = Build::THIS;
        assert!(build.compiler.starts_with("rustc 1."), "{build:?}");
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
}
