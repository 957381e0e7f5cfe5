//! The page of limits: the text of `src/base/LIMITS.md`.

use std::fmt::Write;

use crate::limits::GROUPS;

/// The page.
#[cfg_attr(not(test), allow(dead_code, reason = "a test holds the file to it"))]
pub(super) fn page() -> String {
    let mut page = String::from(
        "# Limits on input and work\n\nInput that exceeds a limit is refused, or left out with a note, before the program spends \
         memory or time on it; the message states the number and the name of the limit. Every command takes \
         `--limit NAME=VALUE`, once for each limit to change for the run: raise it for trusted data, lower it for other data. \
         A value is a whole number, which may end in k, M or G for thousands, millions or billions. Fixed limits cannot be \
         changed, because they protect the stack or are part of a format.\n",
    );
    for (title, limits) in GROUPS {
        let _ =
            write!(page, "\n## {title}\n\n| limit | at most | | where more is needed |\n|---|--:|---|---|\n");
        for limit in *limits {
            let (name, most) = (limit.name(), grouped(limit.default_value()));
            let fixed = if limit.is_fixed() { ", fixed" } else { "" };
            let _ = writeln!(
                page,
                "| `{name}` | {most} {}{fixed} | {} | {} |",
                limit.unit, limit.what, limit.remedy
            );
        }
    }
    page
}

/// A whole number with commas between its thousands.
fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::all;
    use std::collections::BTreeSet;

    #[test]
    fn the_page_holds_every_limit() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/LIMITS.md");
        if std::env::var_os("SANDTABLE_BLESS").is_some() {
            std::fs::write(file, page()).expect("writable");
        }
        let found = std::fs::read_to_string(file).expect("the page is there");
        assert!(found == page(), "src/base/LIMITS.md is old; run the test again with SANDTABLE_BLESS=1");
    }

    #[test]
    fn limits_have_names_of_their_own_and_say_what_to_do() {
        let names: BTreeSet<String> = all().map(|limit| limit.name()).collect();
        assert!(names.len() == all().count() && names.len() > 40);
        assert!(all().all(|limit| limit.default_value() >= 8 && !limit.remedy.is_empty()));
        assert_eq!(grouped(268_468_225), "268,468,225");
    }
}
