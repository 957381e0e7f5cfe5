//! Which methods there are, and which of them are asked for.
//!
//! A method is what emits triangles, the criterion that tells when an error shows, and what refines. Not all go
//! together, so the ones that do are listed: adding a method is adding a line.

use std::fmt::{self, Display};

use clap::ValueEnum;

use crate::app::failure::Failure;

/// What makes triangles of the bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// The leaves of the triangle bintree
    Bintree,
}

/// When an error shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Rule {
    /// The largest length an error could span on the picture; the tolerance is kept at every post
    Screen,
    /// Nested error spheres: the error seen from where the vertex is, in any direction
    Spheres,
}

/// What sets the bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Refine {
    /// Anew for every frame, by splits alone
    Rebuild,
}

/// One way of showing the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Bits of vertices, set by a refiner where a criterion wants them, and triangles made of them.
    Refining {
        /// What makes triangles.
        emit: Emit,
        /// When an error shows.
        rule: Rule,
        /// What refines.
        refine: Refine,
    },
}

/// All methods, in the order in which they are compared.
pub const ALL: &[Method] = &[
    Method::Refining { emit: Emit::Bintree, rule: Rule::Screen, refine: Refine::Rebuild },
    Method::Refining { emit: Emit::Bintree, rule: Rule::Spheres, refine: Refine::Rebuild },
];

impl Method {
    /// What it is on the command line; what does not refine has no refiner and may have no criterion.
    pub fn parts(&self) -> (Emit, Option<Rule>, Option<Refine>) {
        match *self {
            Self::Refining { emit, rule, refine } => (emit, Some(rule), Some(refine)),
        }
    }
}

impl Display for Method {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (emit, rule, refine) = self.parts();
        let parts = [Some(name(&emit)), rule.as_ref().map(name), refine.as_ref().map(name)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        out.write_str(&parts.join("/"))
    }
}

/// How a value is written on the command line.
pub fn name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// What was asked for; what is not said may be anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// What makes triangles.
    pub emit: Option<Emit>,
    /// When an error shows.
    pub rule: Option<Rule>,
    /// What refines.
    pub refine: Option<Refine>,
}

impl Wanted {
    fn holds(&self, method: &Method) -> bool {
        let (emit, rule, refine) = method.parts();
        self.emit.is_none_or(|wanted| wanted == emit)
            && (self.rule.is_none() || self.rule == rule)
            && (self.refine.is_none() || self.refine == refine)
    }
}

impl Display for Wanted {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            self.emit.as_ref().map(|emit| format!("--emit {}", name(emit))),
            self.rule.as_ref().map(|rule| format!("--criterion {}", name(rule))),
            self.refine.as_ref().map(|refine| format!("--refine {}", name(refine))),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        out.write_str(&parts.join(" "))
    }
}

/// The methods of `all` that are what is wanted, in order.
///
/// # Errors
/// There is none; the message tells what goes together.
pub fn chosen(all: &[Method], wanted: Wanted) -> Result<Vec<Method>, Failure> {
    let found: Vec<Method> = all.iter().filter(|method| wanted.holds(method)).copied().collect();
    if found.is_empty() {
        let names: Vec<String> = all.iter().map(Method::to_string).collect();
        let names = names.join(", ");
        let message =
            format!("{wanted} have no meaning together; as emit/criterion/refine there are {names}");
        return Err(Failure::Usage(message));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_restricts_and_what_is_not_said_may_be_anything() {
        assert_eq!(chosen(ALL, Wanted::default()).expect("some"), ALL);
        let spheres = Wanted { rule: Some(Rule::Spheres), ..Wanted::default() };
        let found = chosen(ALL, spheres).expect("some");
        assert!(!found.is_empty() && found.iter().all(|method| method.parts().1 == Some(Rule::Spheres)));
    }

    #[test]
    fn what_has_no_meaning_together_is_refused_with_what_has() {
        let wanted = Wanted { rule: Some(Rule::Screen), refine: Some(Refine::Rebuild), ..Wanted::default() };
        let Err(Failure::Usage(message)) = chosen(&ALL[1..], wanted) else { panic!("accepted") };
        assert!(message.contains("--criterion screen --refine rebuild"), "{message}");
        assert!(message.contains("bintree/spheres/rebuild"), "{message}");
    }

    #[test]
    fn no_method_is_listed_twice() {
        for (at, method) in ALL.iter().enumerate() {
            assert!(!ALL[..at].contains(method), "{method}");
        }
    }
}
