//! Texts with a capital letter first, as names in legends and titles have it.

/// A text with its first letter as a capital.
pub fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_letter_alone_is_changed() {
        let texts = ["watch tower", "Émile", "élan vital", "7 firs", ""];
        assert_eq!(texts.map(capitalized), ["Watch tower", "Émile", "Élan vital", "7 firs", ""]);
    }
}
