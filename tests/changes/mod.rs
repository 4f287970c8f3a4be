//! Files that are changed in one place, and what is said of them.

/// `text` after `change`, a line `old -> new` with `\n` for the end of a line: the first `old` is now `new`.
pub fn changed(text: &str, change: &str) -> String {
    let (old, new) = change.split_once(" ->").expect(change);
    let [old, new] = [old, new.trim_start()].map(|part| part.replace("\\n", "\n"));
    assert!(text.contains(&old), "{old:?}");
    text.replacen(&old, &new, 1)
}

/// Each line of `changes`, and under it the one line that `say` says of `text` after this change.
pub fn said(text: &str, changes: &str, say: impl Fn(&str) -> String) -> String {
    let under = |change: &str| {
        let message = say(&changed(text, change));
        assert_eq!(message.lines().count(), 1, "{message}");
        format!("{change}\n    {message}\n")
    };
    changes.trim().lines().map(str::trim).map(under).collect()
}
