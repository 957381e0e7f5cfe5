//! The level-of-detail methods.
//!
//! A method is an emitter of triangles, a criterion that decides when an error shows, and a refiner. Not all
//! combinations make sense; a [`LodMethod`] is one that does.

use std::fmt::{self, Display};

use sandtable_base::message::choice::{Choice, ChoiceWord, word};

/// The emitters of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emit {
    /// Index lists of refined vertices.
    Lists(IndexEmitter),
    /// A level for each patch; nothing is refined.
    Geomipmap,
    /// Every post; nothing is refined.
    Full,
}

/// The form in which refined vertices are written as index lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndexEmitter {
    /// Triangles in the order of the bintree.
    Bintree,
    /// Triangles in the order of the quadtree's nodes.
    Quadtree,
    /// Strips of triangles.
    Strips,
}

/// The criterion by which an error shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CriterionKind {
    /// By the largest length an error can span on the picture.
    Screen,
    /// By variance.
    Variance,
    /// By roughness below a midpoint.
    Roughness,
    /// By the length of an error on the picture, foreshortened.
    Anisotropic,
    /// By the relief of a block.
    Block,
    /// By nested error spheres.
    Spheres(SphereRule),
}

/// The errors that nested spheres enclose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SphereRule {
    /// Midpoint errors.
    Plain,
    /// Midpoint errors and local roughness.
    Constrained,
    /// Exact errors, so that the tolerance is kept.
    Bounding,
}

/// The refiner of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refine {
    /// A refiner that evaluates any criterion.
    With(Refiner),
    /// Nested spheres, examined when due.
    Deferred,
}

/// The refiners that take any criterion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refiner {
    /// From the roots, for every frame.
    Rebuild,
    /// From the last frame, without queues.
    Coherent,
    /// From the last frame, with two queues.
    Queues,
}

/// A method of showing the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LodMethod {
    /// Every post.
    Full,
    /// A level for each patch.
    Geomipmap,
    /// Vertices refined by a criterion, written as index lists.
    Refining {
        /// How lists are written.
        lists: IndexEmitter,
        /// When an error shows.
        criterion: CriterionKind,
        /// The refiner of a method.
        refiner: Refiner,
    },
    /// Nested spheres examined when due; the index lists of triangles are updated in place.
    Deferred {
        /// Which spheres.
        spheres: SphereRule,
    },
}

impl Choice for Emit {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Lists(IndexEmitter::Bintree), "bintree", "The leaves of the triangle bintree"),
        word(
            Self::Lists(IndexEmitter::Quadtree),
            "quadtree",
            "The fans of the restricted quadtree: the same triangles",
        ),
        word(Self::Lists(IndexEmitter::Strips), "strips", "Triangle strips of the bintree's leaves"),
        word(
            Self::Geomipmap,
            "geomipmap",
            "GeoMipMap: a level for each patch, the borders stitched; nothing is refined",
        ),
        word(Self::Full, "full", "Every post: the reference; nothing is refined"),
    ];
}

impl Choice for CriterionKind {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(
            Self::Screen,
            "screen",
            "The largest length an error can span on the picture; kept at every post of the picture",
        ),
        word(Self::Variance, "variance", "Variance and the land's width over distance"),
        word(
            Self::Roughness,
            "roughness",
            "Roughness below a midpoint over distance: at equal pixels the same as variance",
        ),
        word(
            Self::Anisotropic,
            "anisotropic",
            "The length of an error on the picture, foreshortened by the viewing direction",
        ),
        word(Self::Block, "block", "Relief times half a block's side over distance"),
        word(Self::Spheres(SphereRule::Plain), "spheres", "Nested error spheres of midpoint errors"),
        word(
            Self::Spheres(SphereRule::Constrained),
            "constrained",
            "Nested error spheres, smaller where the ground is smooth",
        ),
        word(
            Self::Spheres(SphereRule::Bounding),
            "bounding",
            "Nested error spheres of exact errors; kept at every post, wherever the camera looks",
        ),
    ];
}

impl Choice for Refine {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::With(Refiner::Rebuild), "rebuild", "From the roots for every frame, by splits alone"),
        word(
            Self::With(Refiner::Coherent),
            "coherent",
            "Forced splits and forced merges of the last frame's mesh",
        ),
        word(
            Self::With(Refiner::Queues),
            "queues",
            "A queue of splits and one of merges; can keep a budget of triangles",
        ),
        word(
            Self::Deferred,
            "deferred",
            "Each vertex examined again when the eye has come far enough; goes with spheres",
        ),
    ];
}

impl LodMethod {
    /// Its emitter of triangles.
    pub fn emit(self) -> Emit {
        match self {
            Self::Full => Emit::Full,
            Self::Geomipmap => Emit::Geomipmap,
            Self::Refining { lists, .. } => Emit::Lists(lists),
            Self::Deferred { .. } => Emit::Lists(IndexEmitter::Bintree),
        }
    }

    /// Its criterion; `None` where nothing is refined.
    pub fn criterion(self) -> Option<CriterionKind> {
        match self {
            Self::Full | Self::Geomipmap => None,
            Self::Refining { criterion, .. } => Some(criterion),
            Self::Deferred { spheres } => Some(CriterionKind::Spheres(spheres)),
        }
    }

    /// Its refiner; `None` if it refines nothing.
    pub fn refine(self) -> Option<Refine> {
        match self {
            Self::Full | Self::Geomipmap => None,
            Self::Refining { refiner, .. } => Some(Refine::With(refiner)),
            Self::Deferred { .. } => Some(Refine::Deferred),
        }
    }

    /// Every method, in the order in which they are compared.
    pub fn all() -> Vec<Self> {
        const LISTS: [IndexEmitter; 3] =
            [IndexEmitter::Bintree, IndexEmitter::Quadtree, IndexEmitter::Strips];
        const REFINERS: [Refiner; 3] = [Refiner::Rebuild, Refiner::Coherent, Refiner::Queues];
        let mut all = vec![Self::Full, Self::Geomipmap];
        for lists in LISTS {
            for criterion in CriterionKind::CHOICES.iter().map(|choice| choice.value) {
                all.extend(REFINERS.map(|refiner| Self::Refining { lists, criterion, refiner }));
                if let (IndexEmitter::Bintree, CriterionKind::Spheres(spheres)) = (lists, criterion) {
                    all.push(Self::Deferred { spheres });
                }
            }
        }
        all
    }
}

impl Display for LodMethod {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.emit().word())?;
        let words = [self.criterion().map(Choice::word), self.refine().map(Choice::word)];
        words.into_iter().flatten().try_for_each(|word| write!(out, "/{word}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_method_is_listed_twice_and_no_two_have_the_same_name() {
        let all = LodMethod::all();
        for (at, method) in all.iter().enumerate() {
            assert!(!all[..at].contains(method), "{method}");
            assert!(all[..at].iter().all(|other| other.to_string() != method.to_string()), "{method}");
        }
    }
}
