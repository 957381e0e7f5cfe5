//! Parses expressions by recursive descent, with one function for each line of the grammar.

use std::iter;
use std::ops::Range;

use crate::expression::ExpressionError;
use crate::expression::syntax::{Binary, ExpressionNode, FUNCTIONS, OPERATORS, RESERVED};
use crate::expression::token::{ExpressionToken, SpannedToken, tokens, wrong};
use crate::scalar::Scalar;
use sandtable_base::limits::EXPRESSION_DEPTH;
use sandtable_base::message::suggest::{nearest, quoted, remedy};

/// A node and its depth.
type Deep = (ExpressionNode, usize);
type Parsed = Result<Deep, ExpressionError>;

/// The deepest nesting of brackets; each level takes a dozen stack frames.
const MAX_BRACKETS: usize = 32;

/// Parses `text`. The result must be one of `words`, unless `words` is empty.
///
/// # Errors
/// The text is not an expression, or a literal result is not one of the words.
pub(super) fn parse(text: &str, words: &[&str]) -> Result<ExpressionNode, ExpressionError> {
    let mut parser = ExpressionParser { text, tokens: tokens(text)?, next: 0, brackets: 0, words };
    let (root, _) = parser.expression()?;
    if parser.next < parser.tokens.len() {
        let help = "join two parts with an operator such as `and`, `*` or `??`";
        return Err(parser.unexpected("the end or an operator", help));
    }
    let stray = root.results().into_iter().find(|text| !words.contains(text));
    match stray.filter(|_| !words.is_empty()) {
        Some(stray) => {
            let message = format!("this cannot be \"{}\"", quoted(stray));
            Err(parser.wrong(parser.place_of(stray), message, remedy(stray, words, "it may be")))
        }
        None => Ok(root),
    }
}

struct ExpressionParser<'t> {
    text: &'t str,
    tokens: Vec<SpannedToken>,
    next: usize,
    brackets: usize,
    /// The results that are allowed; empty for any.
    words: &'t [&'t str],
}

/// Rows of [`OPERATORS`].
const OR: usize = 0;
const AND: usize = 1;
const COMPARISON: usize = 2;
const FALLBACK: usize = 3;
const SUM: usize = 4;
const PRODUCT: usize = 5;

impl ExpressionParser<'_> {
    fn expression(&mut self) -> Parsed {
        self.chain(OR, |parser| parser.chain(AND, Self::negation))
    }

    fn negation(&mut self) -> Parsed {
        let count = self.take_all("not");
        let part = self.comparison()?;
        self.prefixed(count, part, ExpressionNode::Not)
    }

    fn comparison(&mut self) -> Parsed {
        let left = self.fallback()?;
        let is_negated = self.written(0) == "not" && self.written(1) == "in";
        self.next += usize::from(is_negated);
        if self.take("in") {
            let (list, deep) = self.list()?;
            let deep = self.deepened(left.1.max(deep))?;
            let within = (ExpressionNode::In(Box::new(left.0), list), deep);
            return self.prefixed(usize::from(is_negated), within, ExpressionNode::Not);
        }
        let Some(binary) = self.take_operator(COMPARISON) else { return Ok(left) };
        let right = self.fallback()?;
        let whole = self.join(binary, left, right)?;
        let place = self.place();
        match self.take_operator(COMPARISON) {
            Some(_) => Err(self.wrong(place, "comparisons cannot be chained", "write a < b and b < c")),
            None => Ok(whole),
        }
    }

    fn fallback(&mut self) -> Parsed {
        self.chain(FALLBACK, |parser| parser.chain(SUM, |parser| parser.chain(PRODUCT, Self::factor)))
    }

    fn factor(&mut self) -> Parsed {
        let count = self.take_all("-");
        let part = self.primary()?;
        self.prefixed(count, part, ExpressionNode::Negative)
    }

    fn primary(&mut self) -> Parsed {
        let place = self.place();
        let node = match self.tokens.get(self.next).map(|(token, _)| token.clone()) {
            Some(ExpressionToken::Number(number)) => ExpressionNode::Literal(Scalar::Number(number)),
            Some(ExpressionToken::Text(text)) => ExpressionNode::Literal(Scalar::Text(text)),
            Some(ExpressionToken::Property(name)) => ExpressionNode::Property(name),
            Some(ExpressionToken::Name(name)) if name == "true" || name == "false" => {
                ExpressionNode::Literal(Scalar::Bool(name == "true"))
            }
            Some(ExpressionToken::Name(name)) if !RESERVED.contains(&name.as_str()) => {
                self.next += 1;
                return if self.written(0) == "(" { self.call(&name, place) } else { self.bare(name, place) };
            }
            Some(ExpressionToken::Mark("(")) => {
                self.open()?;
                let inner = self.expression()?;
                self.close()?;
                return Ok(inner);
            }
            _ => {
                let help = "write a property as its name, a text as 'text'";
                return Err(self.unexpected("a number, a text or a property", help));
            }
        };
        self.next += 1;
        Ok((node, 1))
    }

    /// A name without quotes and brackets: a property, unless it is a text that misses its quotes.
    fn bare(&self, name: String, place: Range<usize>) -> Parsed {
        if self.words.contains(&name.as_str()) {
            let help =
                format!("write '{name}' for the word, `{name}` in backticks for a property of that name");
            return Err(self.wrong(place, format!("the word {name} must be in quotes"), help));
        }
        Ok((ExpressionNode::Property(name), 1))
    }

    fn call(&mut self, name: &str, place: Range<usize>) -> Parsed {
        if name == "property" {
            return self.named_property();
        }
        let Some((_, function, fewest, most, example)) = FUNCTIONS.iter().find(|known| known.0 == name)
        else {
            let names = FUNCTIONS.map(|known| known.0);
            let all = names.into_iter().chain(["property"]).collect::<Vec<_>>();
            let help = match nearest(name, names) {
                Some(near) => format!("did you mean `{near}`?"),
                None => remedy("", &all, "the functions are").replace(" or ", " and "),
            };
            return Err(self.wrong(place, format!("there is no function `{}`", quoted(name)), help));
        };
        let (list, deep) = self.list()?;
        if !(*fewest..=*most).contains(&list.len()) {
            let (count, s) = (list.len(), if list.len() == 1 { "" } else { "s" });
            let message = format!("`{name}` cannot have {count} argument{s}");
            return Err(self.wrong(place, message, format!("write {example}")));
        }
        self.deepened(deep).map(|deep| (ExpressionNode::Call(*function, list), deep))
    }

    /// `property('name')`, after its name.
    fn named_property(&mut self) -> Parsed {
        self.open()?;
        let name = match self.tokens.get(self.next) {
            Some((ExpressionToken::Text(name), _)) if !name.is_empty() => name.clone(),
            _ => return Err(self.unexpected("a property's name in quotes", "write property('its name')")),
        };
        self.next += 1;
        self.close()?;
        Ok((ExpressionNode::Property(name), 1))
    }

    /// One or more expressions in brackets, and how deep the deepest is.
    fn list(&mut self) -> Result<(Vec<ExpressionNode>, usize), ExpressionError> {
        self.open()?;
        let (first, mut deepest) = self.expression()?;
        let mut list = vec![first];
        while self.take(",") {
            let (next, deep) = self.expression()?;
            deepest = deepest.max(deep);
            list.push(next);
        }
        self.close()?;
        Ok((list, deepest))
    }

    /// `part { operator part }` with the operators of a row, the left ones taken together first.
    fn chain(&mut self, row: usize, part: fn(&mut Self) -> Parsed) -> Parsed {
        let mut left = part(self)?;
        while let Some(binary) = self.take_operator(row) {
            let right = part(self)?;
            left = self.join(binary, left, right)?;
        }
        Ok(left)
    }

    fn join(&self, binary: Binary, left: Deep, right: Deep) -> Parsed {
        let deep = self.deepened(left.1.max(right.1))?;
        Ok((ExpressionNode::Binary(binary, Box::new(left.0), Box::new(right.0)), deep))
    }

    fn prefixed(
        &self,
        count: usize,
        part: Deep,
        prefix: fn(Box<ExpressionNode>) -> ExpressionNode,
    ) -> Parsed {
        (0..count).try_fold(part, |(node, deep), _| Ok((prefix(Box::new(node)), self.deepened(deep)?)))
    }

    fn deepened(&self, deep: usize) -> Result<usize, ExpressionError> {
        if deep < EXPRESSION_DEPTH.count() { Ok(deep + 1) } else { Err(self.too_deep()) }
    }

    fn too_deep(&self) -> ExpressionError {
        let help = format!(
            "split it over several tables, or write a long `or` as x in (a, b, ...); {EXPRESSION_DEPTH:#}"
        );
        self.wrong(self.place(), "this expression is nested too deeply", help)
    }

    fn open(&mut self) -> Result<(), ExpressionError> {
        self.expect("(", "write its arguments in brackets")?;
        self.brackets += 1;
        if self.brackets > MAX_BRACKETS { Err(self.too_deep()) } else { Ok(()) }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        self.brackets -= 1;
        self.expect(")", "close every bracket that is open")
    }

    fn expect(&mut self, mark: &'static str, help: &str) -> Result<(), ExpressionError> {
        if self.take(mark) { Ok(()) } else { Err(self.unexpected(&format!("`{mark}`"), help)) }
    }

    /// The mark or bare name `ahead` tokens after the next one; empty for another token.
    fn written(&self, ahead: usize) -> &str {
        match self.tokens.get(self.next + ahead) {
            Some((ExpressionToken::Mark(mark), _)) => mark,
            Some((ExpressionToken::Name(name), _)) => name,
            _ => "",
        }
    }

    fn take(&mut self, written: &str) -> bool {
        let is_next = self.written(0) == written;
        self.next += usize::from(is_next);
        is_next
    }

    fn take_all(&mut self, written: &str) -> usize {
        iter::from_fn(|| self.take(written).then_some(())).count()
    }

    fn take_operator(&mut self, row: usize) -> Option<Binary> {
        let (_, binary) = OPERATORS[row].iter().find(|(written, _)| *written == self.written(0))?;
        self.next += 1;
        Some(*binary)
    }

    /// The bytes of the next token; past the last one the end of the text.
    fn place(&self) -> Range<usize> {
        let end = self.text.len()..self.text.len();
        self.tokens.get(self.next).map_or(end, |(_, place)| place.clone())
    }

    /// The bytes of the last text literal `content`.
    fn place_of(&self, content: &str) -> Range<usize> {
        let is = |placed: &&SpannedToken| matches!(&placed.0, ExpressionToken::Text(text) if text == content);
        self.tokens.iter().rfind(is).map_or(0..0, |(_, place)| place.clone())
    }

    fn unexpected(&self, wanted: &str, help: impl Into<String>) -> ExpressionError {
        let place = self.place();
        let found = match &self.text[place.clone()] {
            "" => "the end".to_owned(),
            found => format!("`{}`", quoted(found)),
        };
        self.wrong(place, format!("expected {wanted}, but found {found}"), help)
    }

    fn wrong(
        &self,
        at: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> ExpressionError {
        wrong(self.text, at, message, help)
    }
}
