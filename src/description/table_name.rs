//! The name of a table of the scene file, as messages write it.

/// The name of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TableName {
    dotted: String,
    repeated: bool,
}

impl TableName {
    /// The name of the table at `key` of this one.
    pub fn inner(&self, key: &str, repeated: bool) -> Self {
        let dot = if self.dotted.is_empty() { "" } else { "." };
        Self { dotted: format!("{}{dot}{key}", self.dotted), repeated }
    }

    /// `style.light` or `road`; empty for the whole scene.
    pub fn dotted(&self) -> &str {
        &self.dotted
    }

    /// Whether it is the whole scene.
    pub fn is_root(&self) -> bool {
        self.dotted.is_empty()
    }

    /// `[style.light]`, `[[road]]` or `the scene file`.
    pub fn title(&self) -> String {
        match (self.dotted.as_str(), self.repeated) {
            ("", _) => "the scene file".into(),
            (dotted, true) => format!("[[{dotted}]]"),
            (dotted, false) => format!("[{dotted}]"),
        }
    }
}
