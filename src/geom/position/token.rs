//! The parts of a text that states a position.

/// A part of a text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(NumberToken),
    /// Letters, upper case.
    Word(String),
    /// The mark of degrees, minutes or seconds: 0, 1 or 2.
    Mark(u8),
    /// A comma, a semicolon or a slash.
    Separator,
}

/// A number and how it is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NumberToken {
    /// Its absolute value; finite.
    pub value: f64,
    pub is_signed: bool,
    pub is_negative: bool,
    /// The digits before the decimal point.
    pub whole_digits: usize,
    pub has_decimals: bool,
}

/// How commas between digits are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DigitCommas {
    Separate,
    /// They are decimal points.
    Decimal,
}

/// The characters of a text with one form of each mark.
pub(super) fn plain(text: &str) -> String {
    let one = |character: char| match character {
        'º' | '˚' | '∘' => '°',
        '′' | '’' | '‘' | '´' | '`' | 'ʹ' => '\'',
        '″' | '”' | '“' | 'ʺ' => '"',
        '−' | '–' | '‐' | '‑' => '-',
        character if character.is_whitespace() => ' ',
        character => character.to_ascii_uppercase(),
    };
    let text: String = text.trim().chars().map(one).collect();
    text.replace("''", "\"").replace("\"\"", "\"")
}

/// The parts of a plain text; `None` where a character is in no position.
pub(super) fn tokens(text: &str, commas: DigitCommas) -> Option<Vec<Token>> {
    let characters: Vec<char> = text.chars().collect();
    let (mut tokens, mut at) = (Vec::new(), 0);
    while let Some(&character) = characters.get(at) {
        let before = at.checked_sub(1).and_then(|before| characters.get(before)).copied();
        match character {
            ' ' | ':' | '=' => at += 1,
            // A hyphen after a digit, as in 36-16-37N, stands between parts.
            '-' if before.is_some_and(|before| before.is_ascii_digit()) => at += 1,
            '+' | '-' | '0'..='9' | '.' => {
                let (number, end) = number(&characters, at, commas)?;
                tokens.push(Token::Number(number));
                at = end;
            }
            'A'..='Z' => {
                let letters = characters[at..].iter().take_while(|letter| letter.is_ascii_uppercase());
                let word: String = letters.collect();
                at += word.len();
                tokens.push(Token::Word(word));
            }
            '°' | '\'' | '"' => {
                tokens.push(Token::Mark(match character {
                    '°' => 0,
                    '\'' => 1,
                    _ => 2,
                }));
                at += 1;
            }
            ',' | ';' | '/' => {
                tokens.push(Token::Separator);
                at += 1;
            }
            _ => return None,
        }
    }
    Some(tokens)
}

/// The number that begins at a character, and where it ends.
fn number(characters: &[char], start: usize, commas: DigitCommas) -> Option<(NumberToken, usize)> {
    let is_signed = matches!(characters[start], '+' | '-');
    let digits = |from: usize| characters[from..].iter().take_while(|digit| digit.is_ascii_digit()).count();
    let from = start + usize::from(is_signed);
    let whole_digits = digits(from);
    let mut end = from + whole_digits;
    let mut decimals = 0;
    let is_point = |&point: &char| point == '.' || (point == ',' && commas == DigitCommas::Decimal);
    if characters.get(end).is_some_and(is_point) {
        decimals = digits(end + 1);
        if characters[end] == '.' || (whole_digits > 0 && decimals > 0) {
            end += 1 + decimals;
        }
    }
    let written: String = characters[from..end].iter().map(|&c| if c == ',' { '.' } else { c }).collect();
    let value: f64 = written.parse().ok()?;
    let number = NumberToken {
        value,
        is_signed,
        is_negative: characters[start] == '-',
        whole_digits,
        has_decimals: decimals > 0,
    };
    value.is_finite().then_some((number, end))
}

impl NumberToken {
    /// Whether it is digits alone, two at most, as the number of a zone is.
    pub(super) fn is_plain(&self) -> bool {
        !self.is_signed && !self.has_decimals && (1..=2).contains(&self.whole_digits)
    }
}
