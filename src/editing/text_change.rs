//! The difference of two texts as one replaced stretch: what undo needs, small for a small edit of a large file.

/// A stretch of a text that was replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextChange {
    /// The byte at which it starts.
    at: usize,
    removed: String,
    inserted: String,
}

impl TextChange {
    /// The change from `before` to `after`.
    pub fn between(before: &str, after: &str) -> Self {
        let same = before.bytes().zip(after.bytes()).take_while(|(a, b)| a == b).count();
        let at = before.floor_char_boundary(same).min(after.floor_char_boundary(same));
        let rests = (&before[at..], &after[at..]);
        let same = rests.0.bytes().rev().zip(rests.1.bytes().rev()).take_while(|(a, b)| a == b).count();
        let end = |text: &str| text.ceil_char_boundary(text.len() - same);
        // A boundary of one is one of the other, unless a character differs in its first bytes alone.
        let left = (rests.0.len() - end(rests.0)).min(rests.1.len() - end(rests.1));
        let cut = |text: &str| text[..text.len() - left].to_owned();
        Self { at, removed: cut(rests.0), inserted: cut(rests.1) }
    }

    /// The text after the change.
    ///
    /// # Panics
    /// Where `text` is not the one before it.
    pub fn apply(&self, text: &mut String) {
        replace(text, self.at, &self.removed, &self.inserted);
    }

    /// The text before the change.
    ///
    /// # Panics
    /// Where `text` is not the one after it.
    pub fn revert(&self, text: &mut String) {
        replace(text, self.at, &self.inserted, &self.removed);
    }
}

fn replace(text: &mut String, at: usize, old: &str, new: &str) {
    let range = at..at + old.len();
    assert_eq!(text.get(range.clone()), Some(old), "a change fits the text that it was made of");
    text.replace_range(range, new);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_change_leads_from_one_text_to_the_other_and_back(
            before in "[aäß€😀\n]{0,12}",
            after in "[aäß€😀\n]{0,12}",
        ) {
            let change = TextChange::between(&before, &after);
            let mut text = before.clone();
            change.apply(&mut text);
            prop_assert_eq!(&text, &after);
            change.revert(&mut text);
            prop_assert_eq!(&text, &before);
        }
    }

    #[test]
    fn a_change_holds_what_differs_alone() {
        let change = TextChange::between("width = 12 # m\nname = 1\n", "width = 132 # m\nname = 1\n");
        assert_eq!((change.at, change.removed.as_str(), change.inserted.as_str()), (9, "", "3"));
    }
}
