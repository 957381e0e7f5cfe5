//! The words of a proj string, such as `+proj=utm +zone=32`.

/// A proj string.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProjString<'a>(pub &'a str);

impl<'a> ProjString<'a> {
    /// The value of the first word `+key=value`.
    pub fn value(self, key: &str) -> Option<&'a str> {
        self.words().find_map(|word| word.strip_prefix('+')?.strip_prefix(key)?.strip_prefix('='))
    }

    /// The value of `key`, where it is a number.
    pub fn number(self, key: &str) -> Option<f64> {
        self.value(key)?.parse().ok()
    }

    /// Whether the flag `+key` is set.
    pub fn has_flag(self, key: &str) -> bool {
        self.words().any(|word| word.strip_prefix('+') == Some(key))
    }

    /// The words of these keys alone.
    pub fn only(self, keys: &[&str]) -> String {
        self.join(|key| keys.contains(&key))
    }

    /// The words without those of these keys.
    pub fn without(self, keys: &[&str]) -> String {
        self.join(|key| !keys.contains(&key))
    }

    fn words(self) -> impl Iterator<Item = &'a str> {
        self.0.split_whitespace()
    }

    fn join(self, is_kept: impl Fn(&str) -> bool) -> String {
        let key = |word: &'a str| word.trim_start_matches('+').split('=').next().unwrap_or_default();
        self.words().filter(|word| is_kept(key(word))).collect::<Vec<_>>().join(" ")
    }
}
