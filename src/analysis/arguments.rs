//! The arguments of an analysis: values of its kind's parameters, in map coordinates of the land.

use glam::DVec2;

use crate::error::AnalysisError;
use sandtable_catalog::kind::{AnalysisKind, AnalysisReach};
use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};

/// The arguments of an analysis of a kind. What is not stated has the catalog's default.
#[derive(Clone, Debug)]
pub struct AnalysisArguments {
    kind: &'static AnalysisKind,
    stated: Vec<(&'static str, ArgumentValue)>,
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum ArgumentValue {
    /// Of a number.
    Number(f64),
    /// Of numbers.
    Numbers(Vec<f64>),
    /// Of a word, or the name of a vehicle.
    Word(String),
    /// Of points, a line or an area: map coordinates of the land.
    Points(Vec<DVec2>),
}

impl AnalysisArguments {
    /// The defaults of a kind.
    pub fn new(kind: &'static AnalysisKind) -> Self {
        Self { kind, stated: Vec::new() }
    }

    /// These arguments with one more.
    ///
    /// # Panics
    /// Where the kind has no such parameter: the reader of arguments checks names, forms and ranges.
    pub fn with(mut self, name: &str, value: ArgumentValue) -> Self {
        let parameter = self.kind.parameter(name);
        let parameter = parameter.unwrap_or_else(|| panic!("{} has no parameter {name}", self.kind.name));
        self.stated.retain(|&(stated, _)| stated != parameter.name);
        self.stated.push((parameter.name, value));
        self
    }

    /// The kind.
    pub fn kind(&self) -> &'static AnalysisKind {
        self.kind
    }

    /// A number: as stated, or the default.
    ///
    /// # Panics
    /// Where the parameter is not a number with a default or required.
    pub fn number(&self, name: &str) -> f64 {
        self.number_if(name).unwrap_or_else(|| self.lacks(name, "a number"))
    }

    /// A number, where it is stated or has a default.
    pub fn number_if(&self, name: &str) -> Option<f64> {
        match self.get(name) {
            Some(ArgumentValue::Number(number)) => Some(number),
            _ => None,
        }
    }

    /// A number of posts: as stated, or the default.
    ///
    /// # Errors
    /// It is not whole.
    ///
    /// # Panics
    /// As [`AnalysisArguments::number`].
    pub fn posts(&self, name: &'static str) -> Result<usize, AnalysisError> {
        let number = self.number(name);
        match number.fract() == 0.0 {
            true => Ok(number as usize),
            false => {
                let problem = format!("is {number}; it must be a whole number of posts");
                Err(AnalysisError::argument(name, problem))
            }
        }
    }

    /// Numbers: as stated, or the default; empty where there is none.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        match self.get(name) {
            Some(ArgumentValue::Numbers(numbers)) => numbers,
            Some(ArgumentValue::Number(number)) => vec![number],
            _ => Vec::new(),
        }
    }

    /// Numbers of which each is above the one before it.
    ///
    /// # Errors
    /// They are not, or they are more than `most`.
    pub(crate) fn rising_numbers(&self, name: &'static str, most: usize) -> Result<Vec<f64>, AnalysisError> {
        let numbers = self.numbers(name);
        if numbers.len() > most || !numbers.windows(2).all(|pair| pair[0] < pair[1]) {
            return Err(AnalysisError::argument(name, format!("must be up to {most} rising numbers")));
        }
        Ok(numbers)
    }

    /// A word: as stated, or the default; empty where there is none.
    pub fn word(&self, name: &str) -> String {
        match self.get(name) {
            Some(ArgumentValue::Word(word)) => word,
            _ => String::new(),
        }
    }

    /// Points, a line or a ring; empty where none is stated.
    pub fn points(&self, name: &str) -> &[DVec2] {
        match self.stated.iter().find(|&&(stated, _)| stated == name) {
            Some((_, ArgumentValue::Points(points))) => points,
            _ => &[],
        }
    }

    /// From how many posts away the land has an effect on a value, where posts lie `cell` meters apart; `None` where it has one
    /// from everywhere.
    pub fn reach_posts(&self, cell: DVec2) -> Option<u32> {
        let posts = |reach_m: f64| ((reach_m / cell.min_element()).ceil() as u32).saturating_add(1);
        match self.kind.reach {
            AnalysisReach::Posts(posts) => Some(posts),
            AnalysisReach::PostsBy(name) => Some(posts(self.number(name) * cell.max_element())),
            AnalysisReach::MetersBy(name) => Some(posts(self.number(name))),
            AnalysisReach::Between { .. } | AnalysisReach::Around { .. } | AnalysisReach::Whole => None,
        }
    }

    fn get(&self, name: &str) -> Option<ArgumentValue> {
        let stated = self.stated.iter().find(|&&(stated, _)| stated == name);
        stated.map(|(_, value)| value.clone()).or_else(|| default(self.kind.parameter(name)?))
    }

    fn lacks(&self, name: &str, what: &str) -> ! {
        panic!("{} of {} must be {what}", name, self.kind.name)
    }
}

/// The default of a parameter; `None` where it has none.
fn default(parameter: &AnalysisParameter) -> Option<ArgumentValue> {
    let ParameterDefault::Value(text) = parameter.default else { return None };
    Some(match parameter.form {
        ParameterForm::Number { .. } => ArgumentValue::Number(text.parse().ok()?),
        ParameterForm::Numbers { .. } => ArgumentValue::Numbers(
            text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?,
        ),
        ParameterForm::Word(_) | ParameterForm::Vehicle | ParameterForm::Ground => {
            ArgumentValue::Word(text.to_owned())
        }
        ParameterForm::Points { .. } | ParameterForm::Line | ParameterForm::Area | ParameterForm::Extent => {
            return None;
        }
    })
}
