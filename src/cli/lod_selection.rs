//! The methods that the arguments of `lod` select, and why some combinations have none.

use std::fmt::{self, Display};

use sandtable_base::message::choice::Choice;
use sandtable_walk::lod::method::{
    CriterionKind, Emit, IndexEmitter, LodMethod, Refine, Refiner, SphereRule,
};

/// The methods that are compared by default: each criterion and each refiner once, those of spheres side by side.
const SELECTION: &[LodMethod] = &[
    LodMethod::Full,
    LodMethod::Geomipmap,
    refining(IndexEmitter::Bintree, CriterionKind::Screen, Refiner::Rebuild),
    refining(IndexEmitter::Bintree, CriterionKind::Variance, Refiner::Coherent),
    refining(IndexEmitter::Bintree, CriterionKind::Roughness, Refiner::Rebuild),
    refining(IndexEmitter::Bintree, CriterionKind::Anisotropic, Refiner::Coherent),
    refining(IndexEmitter::Bintree, CriterionKind::Block, Refiner::Coherent),
    refining(IndexEmitter::Bintree, SPHERES, Refiner::Rebuild),
    refining(IndexEmitter::Quadtree, SPHERES, Refiner::Rebuild),
    refining(IndexEmitter::Strips, SPHERES, Refiner::Rebuild),
    refining(IndexEmitter::Bintree, SPHERES, Refiner::Coherent),
    refining(IndexEmitter::Bintree, SPHERES, Refiner::Queues),
    LodMethod::Deferred { spheres: SphereRule::Plain },
    LodMethod::Deferred { spheres: SphereRule::Constrained },
    LodMethod::Deferred { spheres: SphereRule::Bounding },
];

const SPHERES: CriterionKind = CriterionKind::Spheres(SphereRule::Plain);

const fn refining(lists: IndexEmitter, criterion: CriterionKind, refiner: Refiner) -> LodMethod {
    LodMethod::Refining { lists, criterion, refiner }
}

/// The parts that a method must have; `None` admits any.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodFilter {
    pub emit: Option<Emit>,
    pub criterion: Option<CriterionKind>,
    pub refine: Option<Refine>,
    /// The most triangles, which only queues keep.
    pub budget: Option<u32>,
}

/// A filter that no method passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no method has {filter}: {reason}")]
pub struct NoMethod {
    filter: MethodFilter,
    reason: &'static str,
}

impl MethodFilter {
    /// The methods that pass, in the order in which they are compared: the default selection for an empty filter.
    /// Without `emit` the lists are those of the bintree, since all emitters show the same triangles.
    pub fn methods(self) -> Result<Vec<LodMethod>, NoMethod> {
        if self == Self::default() {
            return Ok(SELECTION.to_vec());
        }
        if let Some(reason) = self.contradiction() {
            return Err(NoMethod { filter: self, reason });
        }
        let emit = self.emit.unwrap_or(Emit::Lists(IndexEmitter::Bintree));
        Ok(LodMethod::all()
            .into_iter()
            .filter(|method| self.admits(*method) && method.emit() == emit)
            .collect())
    }

    fn admits(self, method: LodMethod) -> bool {
        self.emit.is_none_or(|emit| emit == method.emit())
            && (self.criterion.is_none() || self.criterion == method.criterion())
            && (self.refine.is_none() || self.refine == method.refine())
            && (self.budget.is_none() || method.refine() == Some(Refine::With(Refiner::Queues)))
    }

    /// Why no method passes.
    fn contradiction(self) -> Option<&'static str> {
        let is_static = matches!(self.emit, Some(Emit::Geomipmap | Emit::Full));
        if is_static && (self.criterion.is_some() || self.refine.is_some() || self.budget.is_some()) {
            return Some(
                "geomipmap and full refine nothing and have no criterion, no refiner and no budget; \
                 --emit bintree, quadtree and strips have",
            );
        }
        if self.budget.is_some() && self.refine.is_some_and(|refine| refine != Refine::With(Refiner::Queues))
        {
            return Some("only --refine queues keeps a budget; the others use --tolerance-px");
        }
        if self.refine != Some(Refine::Deferred) {
            return None;
        }
        if self.criterion.is_some_and(|criterion| !matches!(criterion, CriterionKind::Spheres(_))) {
            return Some(
                "deferred waits for the eye to enter or leave a sphere, and the criterion has none; it goes with \
                 --criterion spheres, constrained and bounding, and the criterion with --refine rebuild, coherent \
                 and queues",
            );
        }
        matches!(self.emit, Some(Emit::Lists(IndexEmitter::Quadtree | IndexEmitter::Strips))).then_some(
            "deferred updates the bintree's index lists in place; it goes with --emit bintree, and the others with \
             --refine rebuild, coherent and queues",
        )
    }
}

impl Display for MethodFilter {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            self.emit.map(|emit| format!("--emit {}", emit.word())),
            self.criterion.map(|criterion| format!("--criterion {}", criterion.word())),
            self.refine.map(|refine| format!("--refine {}", refine.word())),
            self.budget.map(|triangles| format!("--budget {triangles}")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        out.write_str(&parts.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All values and none.
    fn or_none<T: Choice>() -> Vec<Option<T>> {
        T::CHOICES.iter().map(|choice| Some(choice.value)).chain([None]).collect()
    }

    #[test]
    fn every_filter_admits_methods_or_is_refused_with_a_reason_that_holds() {
        for emit in or_none() {
            for criterion in or_none() {
                for refine in or_none() {
                    for budget in [None, Some(500)] {
                        let filter = MethodFilter { emit, criterion, refine, budget };
                        let exist = LodMethod::all().into_iter().any(|method| filter.admits(method));
                        assert_eq!(filter.contradiction().is_none(), exist, "{filter:?}");
                        let found = filter.methods();
                        assert_eq!(found.is_ok(), exist, "{filter}");
                        assert!(found.is_err() || found.is_ok_and(|found| !found.is_empty()), "{filter}");
                    }
                }
            }
        }
    }

    #[test]
    fn lists_are_those_of_the_bintree_unless_others_are_asked_for() {
        let spheres = MethodFilter { criterion: Some(SPHERES), ..MethodFilter::default() };
        let names = |filter: MethodFilter| -> Vec<String> {
            filter.methods().expect("some").iter().map(LodMethod::to_string).collect()
        };
        let refiners = ["rebuild", "coherent", "queues", "deferred"];
        assert_eq!(names(spheres), refiners.map(|refine| format!("bintree/spheres/{refine}")));
        let strips = MethodFilter {
            emit: Some(Emit::Lists(IndexEmitter::Strips)),
            refine: Some(Refine::With(Refiner::Queues)),
            ..spheres
        };
        assert_eq!(names(strips), ["strips/spheres/queues"]);
        assert_eq!(names(MethodFilter { emit: Some(Emit::Full), ..MethodFilter::default() }), ["full"]);
    }

    #[test]
    fn the_selection_has_every_value_at_least_once_and_only_methods_that_exist() {
        assert!(SELECTION.iter().all(|method| LodMethod::all().contains(method)));
        for emit in Emit::CHOICES.iter().map(|choice| choice.value) {
            assert!(SELECTION.iter().any(|method| method.emit() == emit), "{emit:?}");
        }
        for criterion in CriterionKind::CHOICES.iter().map(|choice| choice.value) {
            assert!(SELECTION.iter().any(|method| method.criterion() == Some(criterion)), "{criterion:?}");
        }
        for refine in Refine::CHOICES.iter().map(|choice| choice.value) {
            assert!(SELECTION.iter().any(|method| method.refine() == Some(refine)), "{refine:?}");
        }
    }
}
