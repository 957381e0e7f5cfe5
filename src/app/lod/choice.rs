//! Which methods are asked for, and why some cannot be had.

use std::fmt::{self, Display};

use crate::app::failure::CliError;
use crate::app::lod::method::{
    CriterionKind, Emit, IndexEmitter, LodMethod, Refine, Refiner, SphereRule, all, name,
};

/// What is compared where nothing is asked for: each criterion and each refiner once, those of spheres side by side.
pub const SELECTION: &[LodMethod] = &[
    LodMethod::Full,
    LodMethod::Geomipmap,
    refining(IndexEmitter::Bintree, CriterionKind::Screen, Refiner::Rebuild),
    refining(IndexEmitter::Bintree, CriterionKind::Variance, Refiner::Coherent),
    refining(IndexEmitter::Bintree, CriterionKind::Roughness, Refiner::Rebuild),
    refining(IndexEmitter::Bintree, CriterionKind::Anisotropic, Refiner::Coherent),
    refining(IndexEmitter::Bintree, CriterionKind::Block, Refiner::Coherent),
    refining(IndexEmitter::Bintree, CriterionKind::Spheres, Refiner::Rebuild),
    refining(IndexEmitter::Quadtree, CriterionKind::Spheres, Refiner::Rebuild),
    refining(IndexEmitter::Strips, CriterionKind::Spheres, Refiner::Rebuild),
    refining(IndexEmitter::Bintree, CriterionKind::Spheres, Refiner::Coherent),
    refining(IndexEmitter::Bintree, CriterionKind::Spheres, Refiner::Queues),
    LodMethod::Deferred { spheres: SphereRule::Plain },
    LodMethod::Deferred { spheres: SphereRule::Constrained },
    LodMethod::Deferred { spheres: SphereRule::Bounding },
];

const fn refining(lists: IndexEmitter, rule: CriterionKind, refiner: Refiner) -> LodMethod {
    LodMethod::Refining { lists, rule, refiner }
}

/// What was asked for; what is not said may be anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// What makes triangles.
    pub emit: Option<Emit>,
    /// When an error shows.
    pub rule: Option<CriterionKind>,
    /// What refines.
    pub refine: Option<Refine>,
    /// So many triangles at most, which only queues keep.
    pub budget: Option<u32>,
}

impl Wanted {
    /// The methods that are wanted, in the order in which they are compared.
    ///
    /// Where nothing is asked for it is a selection. Otherwise all that go with what is asked for, their lists those
    /// of the bintree unless others are asked for: all show the same triangles.
    ///
    /// # Errors
    /// What is asked for does not go together; the message tells what does.
    pub fn methods(self) -> Result<Vec<LodMethod>, CliError> {
        if self == Self::default() {
            return Ok(SELECTION.to_vec());
        }
        if let Some(why) = self.flaw() {
            return Err(CliError::Usage(format!("{self} cannot be had: {why}")));
        }
        let emit = self.emit.unwrap_or(Emit::Bintree);
        Ok(all().into_iter().filter(|method| self.holds(method) && method.parts().0 == emit).collect())
    }

    fn holds(&self, method: &LodMethod) -> bool {
        let (emit, rule, refine) = method.parts();
        self.emit.is_none_or(|wanted| wanted == emit)
            && (self.rule.is_none() || self.rule == rule)
            && (self.refine.is_none() || self.refine == refine)
            && (self.budget.is_none() || refine == Some(Refine::Queues))
    }

    /// Why no method is what is wanted.
    fn flaw(&self) -> Option<&'static str> {
        let is_static = matches!(self.emit, Some(Emit::Geomipmap | Emit::Full));
        if is_static && (self.rule.is_some() || self.refine.is_some() || self.budget.is_some()) {
            return Some(
                "geomipmap and full refine nothing and have no criterion, no refiner and no budget; \
                 --emit bintree, quadtree and strips have",
            );
        }
        if self.budget.is_some() && self.refine.is_some_and(|refine| refine != Refine::Queues) {
            return Some("only --refine queues keeps a budget; the others go by --tolerance-px");
        }
        if self.refine != Some(Refine::Deferred) {
            return None;
        }
        if self.rule.is_some_and(|rule| rule.spheres().is_none()) {
            return Some(
                "deferred waits for the eye to enter or leave a sphere, and the criterion has none; it goes with \
                 --criterion spheres, constrained and bounding, and the criterion with --refine rebuild, coherent \
                 and queues",
            );
        }
        matches!(self.emit, Some(Emit::Quadtree | Emit::Strips)).then_some(
            "deferred keeps the bintree's index lists as they change; it goes with --emit bintree, and the others \
             with --refine rebuild, coherent and queues",
        )
    }
}

impl Display for Wanted {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            self.emit.as_ref().map(|emit| format!("--emit {}", name(emit))),
            self.rule.as_ref().map(|rule| format!("--criterion {}", name(rule))),
            self.refine.as_ref().map(|refine| format!("--refine {}", name(refine))),
            self.budget.map(|triangles| format!("--budget {triangles}")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        out.write_str(&parts.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    /// All values and none.
    fn or_none<T: ValueEnum + Copy>() -> Vec<Option<T>> {
        T::value_variants().iter().map(|&value| Some(value)).chain([None]).collect()
    }

    #[test]
    fn whatever_is_asked_for_is_had_or_refused_with_a_reason_that_holds() {
        for emit in or_none() {
            for rule in or_none() {
                for refine in or_none() {
                    for budget in [None, Some(500)] {
                        let wanted = Wanted { emit, rule, refine, budget };
                        let exist = all().iter().any(|method| wanted.holds(method));
                        assert_eq!(wanted.flaw().is_none(), exist, "{wanted:?}");
                        let found = wanted.methods();
                        assert_eq!(found.is_ok(), exist, "{wanted}");
                        assert!(found.is_err() || found.is_ok_and(|found| !found.is_empty()), "{wanted}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_said_restricts_and_lists_are_the_bintree_s_unless_others_are_asked_for() {
        let spheres = Wanted { rule: Some(CriterionKind::Spheres), ..Wanted::default() };
        let names = |wanted: Wanted| -> Vec<String> {
            wanted.methods().expect("some").iter().map(LodMethod::to_string).collect()
        };
        let refiners = ["rebuild", "coherent", "queues", "deferred"];
        assert_eq!(names(spheres), refiners.map(|refine| format!("bintree/spheres/{refine}")));
        let strips = Wanted { emit: Some(Emit::Strips), refine: Some(Refine::Queues), ..spheres };
        assert_eq!(names(strips), ["strips/spheres/queues"]);
        assert_eq!(names(Wanted { emit: Some(Emit::Full), ..Wanted::default() }), ["full"]);
    }

    #[test]
    fn the_selection_has_every_value_once_at_least_and_only_what_there_is() {
        assert!(SELECTION.iter().all(|method| all().contains(method)));
        let parts: Vec<_> = SELECTION.iter().map(LodMethod::parts).collect();
        for &emit in Emit::value_variants() {
            assert!(parts.iter().any(|part| part.0 == emit), "{emit:?}");
        }
        for &rule in CriterionKind::value_variants() {
            assert!(parts.iter().any(|part| part.1 == Some(rule)), "{rule:?}");
        }
        for &refine in Refine::value_variants() {
            assert!(parts.iter().any(|part| part.2 == Some(refine)), "{refine:?}");
        }
    }
}
