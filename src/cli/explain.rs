//! `sandtable explain`: what a code of `sandtable check` means.

use clap::Args;

use crate::error::CliError;
use crate::output::{aligned, print_lines};
use sandtable_base::message::suggest::{nearest, quoted};
use sandtable_description::finding_code::FindingCode;

/// The characters of a line of text.
const WIDTH: usize = 100;

#[derive(Debug, Args)]
pub struct ExplainArguments {
    /// The code, such as river-uphill [default: a list of all]
    pub code: Option<String>,
}

pub fn run(arguments: &ExplainArguments) -> Result<(), CliError> {
    let Some(word) = &arguments.code else { return print_lines(&list()) };
    let code = FindingCode::from_word(word).ok_or_else(|| {
        let meant = nearest(word, FindingCode::all().map(FindingCode::word));
        let meant = meant.map(|meant| format!("; did you mean '{meant}'?")).unwrap_or_default();
        let all = "`sandtable explain` lists all";
        CliError::usage(format!("there is no code '{}'{meant} ({all})", quoted(word)))
    })?;
    print_lines(&[vec![code.head(), String::new()], wrapped(code.text())].concat())
}

/// Every code with its severity and the first sentence of its text.
fn list() -> Vec<String> {
    let first = |text: &'static str| text.split_inclusive(". ").next().unwrap_or(text).trim_end();
    let row = |code: FindingCode| {
        [code.word(), code.severity().word(), first(code.text())].map(str::to_owned).to_vec()
    };
    let lines = aligned(&FindingCode::all().map(row).collect::<Vec<_>>(), |_| true);
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

/// `text` in lines of at most [`WIDTH`] characters.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if line > 0 && line + 1 + word.chars().count() > WIDTH {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            let space = if line.is_empty() { "" } else { " " };
            *line += &format!("{space}{word}");
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_cut_between_words() {
        let text = "word ".repeat(50);
        let lines = wrapped(text.trim_end());
        assert!(lines.iter().all(|line| line.len() <= WIDTH && !line.starts_with(' ')));
        assert_eq!(lines.join(" "), text.trim_end());
    }
}
