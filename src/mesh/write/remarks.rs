//! What a file says about itself where its format has no field for it.

/// Remarks about the content of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remarks {
    pub(in crate::write) lines: Vec<String>,
    pub(in crate::write) short: String,
}

impl Remarks {
    /// Full sentences, and a short form for the 80 bytes of an STL header. Control characters become `?`, so that no
    /// line can end a comment.
    pub fn new(lines: &[String], short: &str) -> Self {
        let printable = |line: &str| line.replace(char::is_control, "?");
        Self { lines: lines.iter().map(|line| printable(line)).collect(), short: printable(short) }
    }
}

#[cfg(test)]
mod tests {
    use crate::write::samples;

    #[test]
    fn remarks_are_single_lines() {
        assert_eq!(samples::remarks().lines, ["a?v 9 9 9", "zwölf"]);
    }
}
