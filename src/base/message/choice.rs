//! Choices that users write as words: in scene files, on the command line and in HTTP requests alike.

use std::fmt::Debug;

/// A type whose values are written as words.
pub trait Choice: Copy + Debug + PartialEq + 'static {
    /// Every value that may be written, in the order in which messages list them.
    const CHOICES: &'static [ChoiceWord<Self>];

    /// The word for this value; empty where there is none.
    fn word(self) -> &'static str {
        Self::CHOICES.iter().find(|choice| choice.value == self).map_or("", |choice| choice.word)
    }

    /// The value that a word names.
    fn from_word(word: &str) -> Option<Self> {
        Self::CHOICES.iter().find(|choice| choice.word == word).map(|choice| choice.value)
    }
}

/// A value, its word and its meaning.
pub struct ChoiceWord<T> {
    /// The value.
    pub value: T,
    /// The word.
    pub word: &'static str,
    /// A phrase for a list of choices.
    pub meaning: &'static str,
}

/// A value with its word and meaning.
pub const fn word<T: Copy>(value: T, word: &'static str, meaning: &'static str) -> ChoiceWord<T> {
    ChoiceWord { value, word, meaning }
}
