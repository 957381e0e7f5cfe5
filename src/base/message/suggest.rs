//! Names in messages: the valid name that a wrong one is nearest to, lists of names, quoted text.

use std::fmt::Write;

/// Longer words are not compared: nobody mistypes them, and the comparison is quadratic.
const MAX_COMPARED: usize = 64;

/// The name among `valid` that `word` is nearest to, or `None` where none is near.
///
/// A name is near where it is the same but for case, `-` and `_`; where one edit (insertion, deletion, replacement or swap
/// of neighbors) for every three characters leads to it; or where one of the two contains the other and both have at least
/// four characters. The first of equals wins.
pub fn nearest<'a>(word: &str, valid: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = folded(word);
    let length = word.chars().count();
    if length == 0 || length > MAX_COMPARED {
        return None;
    }
    let mut best: Option<(usize, &str)> = None;
    for candidate in valid {
        let folded = folded(candidate);
        let longer = length.max(folded.chars().count());
        if longer > MAX_COMPARED {
            continue;
        }
        let edits = strsim::osa_distance(&word, &folded);
        let contained =
            word.len().min(folded.len()) >= 4 && (word.contains(&folded) || folded.contains(&word));
        let near = edits <= (longer / 3).max(1) && edits < longer;
        if (near || contained) && best.is_none_or(|(least, _)| edits < least) {
            best = Some((edits, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// ``did you mean `x`?`` where a valid name is near, else `otherwise` and all valid names.
pub fn remedy(word: &str, valid: &[&str], otherwise: &str) -> String {
    match nearest(word, valid.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("{otherwise} {}", listed(valid)),
    }
}

/// `` `a`, `b` or `c` ``.
pub fn listed(words: &[&str]) -> String {
    let mut out = String::new();
    for (index, word) in words.iter().enumerate() {
        let join = match index {
            0 => "",
            _ if index + 1 == words.len() => " or ",
            _ => ", ",
        };
        let _ = write!(out, "{join}`{word}`");
    }
    out
}

/// `text` fit for a message: at most 60 characters, control characters escaped.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut out: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push('…');
    }
    out.replace("\\'", "'").replace("\\\"", "\"")
}

fn folded(word: &str) -> String {
    word.chars().filter(|character| !matches!(character, '_' | '-')).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_find_their_word() {
        let valid = ["name", "points", "file", "where", "crs", "width", "surface"];
        for (slip, meant) in [
            ("widht", "width"),
            ("Width", "width"),
            ("point", "points"),
            ("csr", "crs"),
            ("surfaces", "surface"),
        ] {
            assert_eq!(nearest(slip, valid), Some(meant), "{slip}");
        }
        assert_eq!(nearest("exaggeration", ["vertical_exaggeration"]), Some("vertical_exaggeration"));
    }

    #[test]
    fn far_words_find_none() {
        assert_eq!(nearest("elephant", ["name", "width"]), None);
        assert_eq!(nearest("", ["name"]), None);
        assert_eq!(nearest("x", ["y"]), None);
        assert_eq!(nearest(&"w".repeat(10_000), ["width"]), None);
    }

    #[test]
    fn all_words_are_listed_where_none_is_near() {
        assert_eq!(remedy("zzz", &["a", "b", "c"], "it may be"), "it may be `a`, `b` or `c`");
    }
}
