//! Text to tree, by recursive descent: one function for each line of the grammar.

use std::ops::Range;

use crate::description::expression::syntax::{Binary, ExpressionNode, FUNCTIONS, RESERVED};
use crate::description::expression::token::{ExpressionToken, SpannedToken, tokens, wrong};
use crate::description::expression::{ExpressionError, MAX_DEPTH};
use crate::description::scalar::Scalar;
use crate::message::suggest::{nearest, quoted, remedy};

/// A node and how many nodes lie one below another in it.
type Deep = (ExpressionNode, usize);
type Parsed = Result<Deep, ExpressionError>;

/// How deep brackets may be nested: each costs the stack a dozen calls.
const MAX_BRACKETS: usize = 32;

/// The text while it is read.
pub(super) struct ExpressionParser<'t> {
    text: &'t str,
    tokens: Vec<SpannedToken>,
    next: usize,
    brackets: usize,
    /// What the result must be one of; none for any.
    words: &'t [&'t str],
}

impl<'t> ExpressionParser<'t> {
    /// A parser of `text`, which gives one of `words`, or anything where they are none.
    ///
    /// # Errors
    /// The text is not made of the language's tokens.
    pub fn new(text: &'t str, words: &'t [&'t str]) -> Result<Self, ExpressionError> {
        Ok(Self { text, tokens: tokens(text)?, next: 0, brackets: 0, words })
    }

    /// The whole text.
    ///
    /// # Errors
    /// It is no expression, or one that cannot give one of the words.
    pub fn whole(mut self) -> Result<ExpressionNode, ExpressionError> {
        let (root, _) = self.expression()?;
        if self.next < self.tokens.len() {
            let help = "join two parts with an operator such as `and`, `*` or `??`";
            return Err(self.unexpected("the end or an operator", help));
        }
        let stray = root.results().into_iter().find(|text| !self.words.contains(text));
        match stray.filter(|_| !self.words.is_empty()) {
            Some(stray) => {
                let message = format!("this cannot be \"{}\"", quoted(stray));
                Err(self.wrong(self.place_of(stray), message, remedy(stray, self.words, "it may be")))
            }
            None => Ok(root),
        }
    }

    fn expression(&mut self) -> Parsed {
        self.chain(&[Binary::Or], Self::conjunction)
    }

    fn conjunction(&mut self) -> Parsed {
        self.chain(&[Binary::And], Self::negation)
    }

    fn negation(&mut self) -> Parsed {
        let mut count = 0;
        while self.take_name("not") {
            count += 1;
        }
        let mut parsed = self.comparison()?;
        for _ in 0..count {
            parsed = self.over(parsed, |of| ExpressionNode::Not(Box::new(of)))?;
        }
        Ok(parsed)
    }

    fn comparison(&mut self) -> Parsed {
        const COMPARISONS: [Binary; 6] = [
            Binary::Equal,
            Binary::Unequal,
            Binary::LessOrEqual,
            Binary::Less,
            Binary::GreaterOrEqual,
            Binary::Greater,
        ];
        let left = self.fallback()?;
        let negated = self.peek_name("not", 0) && self.peek_name("in", 1);
        self.next += usize::from(negated);
        if self.take_name("in") {
            let (list, deep) = self.list()?;
            let (of, deep) = (left.0, left.1.max(deep));
            let within = self.over((of, deep), |of| ExpressionNode::In(Box::new(of), list))?;
            return if negated {
                self.over(within, |of| ExpressionNode::Not(Box::new(of)))
            } else {
                Ok(within)
            };
        }
        let Some(binary) = self.take_operator(&COMPARISONS) else { return Ok(left) };
        let right = self.fallback()?;
        let whole = self.join(binary, left, right)?;
        if self.peek_operator(&COMPARISONS).is_some() {
            let message = "comparisons cannot be chained";
            return Err(self.wrong(self.place(), message, "write a < b and b < c"));
        }
        Ok(whole)
    }

    fn fallback(&mut self) -> Parsed {
        self.chain(&[Binary::Fallback], Self::sum)
    }

    fn sum(&mut self) -> Parsed {
        self.chain(&[Binary::Plus, Binary::Minus], Self::product)
    }

    fn product(&mut self) -> Parsed {
        self.chain(&[Binary::Times, Binary::Over], Self::factor)
    }

    fn factor(&mut self) -> Parsed {
        let mut count = 0;
        while self.take_mark("-") {
            count += 1;
        }
        let mut parsed = self.primary()?;
        for _ in 0..count {
            parsed = self.over(parsed, |of| ExpressionNode::Negative(Box::new(of)))?;
        }
        Ok(parsed)
    }

    fn primary(&mut self) -> Parsed {
        let place = self.place();
        let leaf = |node| Ok((node, 1));
        match self.tokens.get(self.next).map(|(token, _)| token.clone()) {
            Some(ExpressionToken::Number(number)) => {
                self.after(leaf(ExpressionNode::Literal(Scalar::Number(number))))
            }
            Some(ExpressionToken::Text(text)) => {
                self.after(leaf(ExpressionNode::Literal(Scalar::Text(text))))
            }
            Some(ExpressionToken::Property(name)) => self.after(leaf(ExpressionNode::Property(name))),
            Some(ExpressionToken::Name(name)) if name == "true" || name == "false" => {
                self.after(leaf(ExpressionNode::Literal(Scalar::Bool(name == "true"))))
            }
            Some(ExpressionToken::Name(name)) if !RESERVED.contains(&name.as_str()) => {
                self.next += 1;
                if self.peek_mark("(") { self.call(&name, place) } else { self.bare(name, place) }
            }
            Some(ExpressionToken::Mark("(")) => {
                self.open()?;
                let inner = self.expression()?;
                self.close()?;
                Ok(inner)
            }
            _ => Err(self.unexpected(
                "a number, a text or a property",
                "write a property as its name, a text as 'text'",
            )),
        }
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
        while self.take_mark(",") {
            let (next, deep) = self.expression()?;
            deepest = deepest.max(deep);
            list.push(next);
        }
        self.close()?;
        Ok((list, deepest))
    }

    /// `part { operator part }`, the left ones taken together first.
    fn chain(&mut self, operators: &[Binary], part: fn(&mut Self) -> Parsed) -> Parsed {
        let mut left = part(self)?;
        while let Some(binary) = self.take_operator(operators) {
            let right = part(self)?;
            left = self.join(binary, left, right)?;
        }
        Ok(left)
    }

    fn join(&self, binary: Binary, left: Deep, right: Deep) -> Parsed {
        let deep = self.deepened(left.1.max(right.1))?;
        Ok((ExpressionNode::Binary(binary, Box::new(left.0), Box::new(right.0)), deep))
    }

    fn over(&self, (node, deep): Deep, wrap: impl FnOnce(ExpressionNode) -> ExpressionNode) -> Parsed {
        Ok((wrap(node), self.deepened(deep)?))
    }

    fn deepened(&self, deep: usize) -> Result<usize, ExpressionError> {
        if deep < MAX_DEPTH { Ok(deep + 1) } else { Err(self.too_deep()) }
    }

    fn too_deep(&self) -> ExpressionError {
        let help = "split it over several tables, or write a long `or` as x in (a, b, ...)";
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
        if self.take_mark(mark) { Ok(()) } else { Err(self.unexpected(&format!("`{mark}`"), help)) }
    }

    fn after(&mut self, parsed: Parsed) -> Parsed {
        self.next += 1;
        parsed
    }

    fn peek_mark(&self, mark: &str) -> bool {
        matches!(self.tokens.get(self.next), Some((ExpressionToken::Mark(found), _)) if *found == mark)
    }

    fn take_mark(&mut self, mark: &str) -> bool {
        let found = self.peek_mark(mark);
        self.next += usize::from(found);
        found
    }

    fn peek_name(&self, name: &str, ahead: usize) -> bool {
        matches!(self.tokens.get(self.next + ahead), Some((ExpressionToken::Name(found), _)) if found == name)
    }

    fn take_name(&mut self, name: &str) -> bool {
        let found = self.peek_name(name, 0);
        self.next += usize::from(found);
        found
    }

    fn peek_operator(&self, operators: &[Binary]) -> Option<Binary> {
        let written = match &self.tokens.get(self.next)?.0 {
            ExpressionToken::Mark(mark) => mark,
            ExpressionToken::Name(name) => name.as_str(),
            _ => return None,
        };
        operators.iter().copied().find(|operator| operator.written() == written)
    }

    fn take_operator(&mut self, operators: &[Binary]) -> Option<Binary> {
        let found = self.peek_operator(operators);
        self.next += usize::from(found.is_some());
        found
    }

    /// The bytes of the next token; past the last one the end of the text.
    fn place(&self) -> Range<usize> {
        let end = self.text.len()..self.text.len();
        self.tokens.get(self.next).map_or(end, |(_, place)| place.clone())
    }

    /// Where the last text that says `content` stands.
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
