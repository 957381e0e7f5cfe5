//! The tokens of an expression.

use std::ops::Range;

use crate::expression::ExpressionError;
use sandtable_base::limits::EXPRESSION_BYTES;
use sandtable_base::message::suggest::quoted;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum ExpressionToken {
    /// A number; never negative, NaN or infinite.
    Number(f64),
    /// A text in single quotes.
    Text(String),
    /// A name without quotes: a property, a function or one of the language's own words.
    Name(String),
    /// A property's name in backticks or double quotes.
    Property(String),
    /// An operator, a bracket or a comma.
    Mark(&'static str),
}

/// The marks, each before the marks that are its prefixes.
const MARKS: [&str; 16] =
    ["??", "!=", "<=", ">=", "==", "<>", "=", "<", ">", "+", "-", "*", "/", "(", ")", ","];

/// A token and the bytes it takes.
pub(super) type SpannedToken = (ExpressionToken, Range<usize>);

/// An error about the bytes `at` of `text`.
pub(super) fn wrong(
    text: &str,
    at: Range<usize>,
    message: impl Into<String>,
    help: impl Into<String>,
) -> ExpressionError {
    let start = text.floor_char_boundary(at.start);
    let column = text[..start].chars().count() + 1;
    ExpressionError {
        message: message.into(),
        help: help.into(),
        at: start..at.end.max(start),
        column: Some(column),
    }
}

/// The tokens of `text`, in order.
///
/// # Errors
/// The text is too long, a quotation is not closed, or a character begins no token.
pub(super) fn tokens(text: &str) -> Result<Vec<SpannedToken>, ExpressionError> {
    if text.len() > EXPRESSION_BYTES.count() {
        let message =
            format!("this expression has {} bytes, more than the {EXPRESSION_BYTES} allowed", text.len());
        let help =
            format!("make several tables of it, each with a `where` of its own, or {EXPRESSION_BYTES:#}");
        return Err(wrong(text, 0..0, message, help));
    }
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let start = at;
        let token = match first {
            _ if first.is_whitespace() => {
                at += first.len_utf8();
                continue;
            }
            '\'' | '`' | '"' => quotation(text, &mut at, first)?,
            _ if first.is_ascii_digit() || first == '.' => number(text, &mut at)?,
            _ if starts_name(first) => ExpressionToken::Name(taken(text, &mut at, continues_name).to_owned()),
            _ => mark(text, &mut at)?,
        };
        tokens.push((token, start..at));
    }
    Ok(tokens)
}

/// Whether a bare name may start with it.
pub(super) fn starts_name(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_'
}

/// Whether a bare name may contain it after its first letter.
pub(super) fn continues_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == ':'
}

/// The longest run of characters from `at` on for which `keep` holds; moves `at` behind it.
fn taken<'t>(text: &'t str, at: &mut usize, keep: impl Fn(char) -> bool) -> &'t str {
    let rest = &text[*at..];
    let end = rest.find(|letter| !keep(letter)).unwrap_or(rest.len());
    *at += end;
    &rest[..end]
}

fn quotation(text: &str, at: &mut usize, quote: char) -> Result<ExpressionToken, ExpressionError> {
    let start = *at;
    let mut content = String::new();
    *at += 1;
    loop {
        let Some(length) = text[*at..].find(quote) else {
            let help = format!("close it with {quote}; one that stands in it is doubled");
            return Err(wrong(text, start..text.len(), format!("this {quote} is not closed"), help));
        };
        content.push_str(&text[*at..*at + length]);
        *at += length + 1;
        if !text[*at..].starts_with(quote) {
            break;
        }
        content.push(quote);
        *at += 1;
    }
    match quote {
        '\'' => Ok(ExpressionToken::Text(content)),
        _ if content.is_empty() => {
            Err(wrong(text, start..*at, "this names no property", "write its name between the quotes"))
        }
        _ => Ok(ExpressionToken::Property(content)),
    }
}

/// Digits with a point and an exponent, as in `12`, `.5` and `1.5e3`.
fn number(text: &str, at: &mut usize) -> Result<ExpressionToken, ExpressionError> {
    let start = *at;
    taken(text, at, |letter| letter.is_ascii_digit() || letter == '.');
    let rest = &text.as_bytes()[*at..];
    let sign = usize::from(matches!(rest.get(1), Some(b'+' | b'-')));
    if matches!(rest.first(), Some(b'e' | b'E')) && rest.get(1 + sign).is_some_and(u8::is_ascii_digit) {
        *at += 1 + sign;
        taken(text, at, |letter| letter.is_ascii_digit());
    }
    let found = &text[start..*at];
    match found.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(ExpressionToken::Number(number)),
        _ => {
            let message = format!("\"{}\" is not a number", quoted(found));
            Err(wrong(text, start..*at, message, "write it as 12, 1.5 or 1e3"))
        }
    }
}

fn mark(text: &str, at: &mut usize) -> Result<ExpressionToken, ExpressionError> {
    let rest = &text[*at..];
    let found = MARKS.into_iter().find(|mark| rest.starts_with(mark));
    let length = found.map_or_else(|| rest.chars().next().map_or(0, char::len_utf8), str::len);
    let place = *at..*at + length;
    let help = match (found, rest.chars().next()) {
        (Some("=="), _) => "write = to compare",
        (Some("<>"), _) => "write != for unlike",
        (Some(mark), _) => {
            *at += mark.len();
            return Ok(ExpressionToken::Mark(mark));
        }
        (None, Some('!')) => "write `not` for the contrary",
        (None, Some('&')) => "write `and` where both must hold",
        (None, Some('|')) => "write `or` where one must hold",
        _ => "quote a text as 'text', and a property's unusual name as `name`",
    };
    let message = format!("\"{}\" means nothing here", quoted(&rest[..length]));
    Err(wrong(text, place, message, help))
}
