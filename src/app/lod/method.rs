//! Which methods there are.
//!
//! A method is what emits triangles, the criterion that tells when an error shows, and what refines. Not all go
//! together: a [`LodMethod`] holds only what does, and `choice` tells a user why the rest does not.

use std::fmt::{self, Display};

use clap::ValueEnum;

/// What makes triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// The leaves of the triangle bintree
    Bintree,
    /// The restricted quadtree's fans: the same triangles
    Quadtree,
    /// Triangle strips of the bintree's leaves
    Strips,
    /// GeoMipMap: a level for each patch, the borders stitched; nothing is refined
    Geomipmap,
    /// Every post: the reference; nothing is refined
    Full,
}

/// When an error shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CriterionKind {
    /// The largest length an error could span on the picture; kept at every post of the picture
    Screen,
    /// Variance and the land's width over distance
    Variance,
    /// Roughness below a midpoint over distance: at equal pixels what variance is
    Roughness,
    /// The length of an error on the picture, foreshortened by the viewing direction
    Anisotropic,
    /// Relief times half a block's side over distance
    Block,
    /// Nested error spheres about midpoint errors
    Spheres,
    /// Nested error spheres, smaller where the ground is smooth
    Constrained,
    /// Nested error spheres about exact errors; kept at every post, wherever the camera looks
    Bounding,
}

/// What sets the bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Refine {
    /// Anew for every frame, by splits alone
    Rebuild,
    /// Forced splits and forced merges of the last frame's mesh
    Coherent,
    /// A queue of splits and one of merges; may keep a budget of triangles
    Queues,
    /// Each vertex looked at again when the eye has come far enough; goes with spheres
    Deferred,
}

/// How bits of vertices are written as index lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndexEmitter {
    /// Triangles, in the order of the bintree's walk.
    Bintree,
    /// Triangles, in the order of the quadtree's nodes.
    Quadtree,
    /// Strips of triangles.
    Strips,
}

/// What sets bits of vertices by asking any criterion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refiner {
    /// From the roots, for every frame.
    Rebuild,
    /// From the last frame, without queues.
    Coherent,
    /// From the last frame, with two queues.
    Queues,
}

/// Which own radii the nested spheres have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SphereRule {
    /// Of midpoint errors.
    Plain,
    /// Of midpoint errors and local roughness.
    Constrained,
    /// Of exact errors, so that the tolerance is kept.
    Bounding,
}

/// One way of showing the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LodMethod {
    /// Every post.
    Full,
    /// A level for each patch.
    Geomipmap,
    /// Bits of vertices, set where a criterion wants them, and index lists written of them.
    Refining {
        /// How lists are written.
        lists: IndexEmitter,
        /// When an error shows.
        rule: CriterionKind,
        /// What refines.
        refiner: Refiner,
    },
    /// Nested spheres examined when due; the index lists of triangles are kept as they change.
    Deferred {
        /// Which spheres.
        spheres: SphereRule,
    },
}

impl CriterionKind {
    /// Which spheres it is about, if it is about spheres.
    pub fn spheres(self) -> Option<SphereRule> {
        match self {
            Self::Spheres => Some(SphereRule::Plain),
            Self::Constrained => Some(SphereRule::Constrained),
            Self::Bounding => Some(SphereRule::Bounding),
            Self::Screen | Self::Variance | Self::Roughness | Self::Anisotropic | Self::Block => None,
        }
    }
}

impl LodMethod {
    /// What it is on the command line; what does not refine has neither criterion nor refiner.
    pub fn parts(&self) -> (Emit, Option<CriterionKind>, Option<Refine>) {
        match *self {
            Self::Full => (Emit::Full, None, None),
            Self::Geomipmap => (Emit::Geomipmap, None, None),
            Self::Refining { lists, rule, refiner } => (emit(lists), Some(rule), Some(refine(refiner))),
            Self::Deferred { spheres } => (Emit::Bintree, Some(rule(spheres)), Some(Refine::Deferred)),
        }
    }
}

fn emit(lists: IndexEmitter) -> Emit {
    match lists {
        IndexEmitter::Bintree => Emit::Bintree,
        IndexEmitter::Quadtree => Emit::Quadtree,
        IndexEmitter::Strips => Emit::Strips,
    }
}

fn refine(refiner: Refiner) -> Refine {
    match refiner {
        Refiner::Rebuild => Refine::Rebuild,
        Refiner::Coherent => Refine::Coherent,
        Refiner::Queues => Refine::Queues,
    }
}

fn rule(spheres: SphereRule) -> CriterionKind {
    match spheres {
        SphereRule::Plain => CriterionKind::Spheres,
        SphereRule::Constrained => CriterionKind::Constrained,
        SphereRule::Bounding => CriterionKind::Bounding,
    }
}

impl Display for LodMethod {
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

/// Every method that has a meaning, in the order in which they are compared.
pub fn all() -> Vec<LodMethod> {
    const LISTS: [IndexEmitter; 3] = [IndexEmitter::Bintree, IndexEmitter::Quadtree, IndexEmitter::Strips];
    const REFINERS: [Refiner; 3] = [Refiner::Rebuild, Refiner::Coherent, Refiner::Queues];
    let mut all = vec![LodMethod::Full, LodMethod::Geomipmap];
    for lists in LISTS {
        for &rule in CriterionKind::value_variants() {
            all.extend(REFINERS.map(|refiner| LodMethod::Refining { lists, rule, refiner }));
            let spheres = rule.spheres().filter(|_| lists == IndexEmitter::Bintree);
            all.extend(spheres.map(|spheres| LodMethod::Deferred { spheres }));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_method_is_listed_twice_and_each_has_a_name_of_its_own() {
        let all = all();
        for (at, method) in all.iter().enumerate() {
            assert!(!all[..at].contains(method), "{method}");
            assert!(all[..at].iter().all(|other| other.to_string() != method.to_string()), "{method}");
        }
    }

    #[test]
    fn spheres_are_called_by_the_criterion_they_are_of() {
        for &of in CriterionKind::value_variants() {
            assert!(of.spheres().is_none_or(|spheres| rule(spheres) == of), "{of:?}");
        }
    }
}
