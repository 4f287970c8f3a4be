//! What the build was made with, and what it runs on (`spec/supply-chain.md`).

/// The SHA-256 of the lock file of this build, in hexadecimal.
///
/// ```
/// let sum = palpate_verify::build::lock_sha256();
/// assert!(sum.len() == 64 && sum.chars().all(|digit| digit.is_ascii_hexdigit()));
/// ```
pub fn lock_sha256() -> String {
    palpate_conform::sha256(super::supply::LOCK)
}

/// The model of the processor that this runs on, as Linux names it; `None` where it does not.
///
/// ```
/// let model = palpate_verify::build::processor();
/// assert!(model.is_none_or(|model| !model.is_empty()));
/// ```
pub fn processor() -> Option<String> {
    model(&std::fs::read_to_string("/proc/cpuinfo").ok()?)
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
    fn the_hash_is_that_of_the_file_which_holds_the_checksums() {
        let output = std::process::Command::new("sha256sum")
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.lock"))
            .output()
            .expect("sha256sum is part of every Linux");
        let told = String::from_utf8(output.stdout).expect("hexadecimal");
        assert_eq!(told.split_whitespace().next(), Some(&*lock_sha256()));
    }
}
