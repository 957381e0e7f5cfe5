//! The text of an error with its causes.

use std::error::Error;
use std::iter::successors;

/// The message of `error`, followed by those of its causes, separated by colons.
///
/// A cause that the text already quotes is left out.
pub fn error_text(error: &(dyn Error + 'static)) -> String {
    let causes = successors(error.source(), |&error| error.source());
    causes.map(ToString::to_string).fold(error.to_string(), |text, cause| {
        if text.contains(&cause) { text } else { format!("{text}: {cause}") }
    })
}
