//! Chooses the form in which a model is drawn by the size at which it is seen.
//!
//! ```text
//! size               form
//! ≤ 32 px across     impostor: a picture on a quad
//! larger             the coarsest level whose error is at most half a pixel
//! large              the model itself
//! ```

use std::sync::OnceLock;

use glam::Vec3;

use crate::Model;
use crate::impostor::{Impostor, ImpostorDirection};
use crate::simplify::{DetailLevel, levels};

/// The greatest error of a level's surface in the picture, in pixels.
const TOLERANCE_PX: f32 = 0.5;

/// The largest size at which an impostor is drawn, in pixels. Where one impostor replaces the next, views 17° apart differ
/// by five pixels at the model's rim; at twice the size they would visibly jump.
const IMPOSTOR_PX: f32 = 32.0;

/// The greatest error of the level from which an impostor is made, relative to the model's size: a quarter of its pixels.
const IMPOSTOR_ERROR: f32 = 1.0 / 256.0;

/// The simpler forms of a model.
#[derive(Clone, Debug)]
pub struct ModelDetail {
    /// Coarser meshes, finest first.
    pub levels: Vec<DetailLevel>,
    /// Pictures from all sides, made where a picture first shows the model small: they take a hundred times as long as
    /// the levels. `None` where they would not pay.
    pub impostor: OnceLock<Option<Impostor>>,
}

/// The apparent size of a placed model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApparentSize {
    /// Pixels per unit of the model at its nearest point.
    pub px_per_unit: f32,
    /// The diameter of the model's bounding sphere in pixels.
    pub across_px: f32,
    /// The direction from the model's center to the eye, in the model's space; of any length but 0.
    pub toward_eye: Vec3,
}

/// One form of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DetailForm {
    /// The model itself.
    Full,
    /// One of [`ModelDetail::levels`].
    Level(u8),
    /// A view of [`ModelDetail::impostor`].
    Impostor(ImpostorDirection),
}

impl ApparentSize {
    /// Whether it is small enough for a picture on a quad.
    pub fn is_small(&self) -> bool {
        self.across_px <= IMPOSTOR_PX
    }
}

impl ModelDetail {
    /// The coarser meshes of `model`; takes some microseconds a triangle.
    pub fn new(model: &Model) -> Self {
        Self { levels: levels(model), impostor: OnceLock::new() }
    }

    /// Makes the pictures of `model`, whose detail this is, where they are not yet made.
    pub fn make_impostor(&self, model: &Model) {
        if self.impostor.get().is_some() {
            return;
        }
        let size = model.bounds().map_or(0.0, |bounds| bounds.size().length());
        let simple = self.levels.iter().rfind(|level| level.error <= size * IMPOSTOR_ERROR);
        let parts = simple.map_or(&model.parts, |level| &level.parts);
        // Another picture may have set the same value first.
        let _ = self.impostor.set(Impostor::new(model, parts));
    }

    /// The pictures, where they were made and pay.
    pub fn impostor(&self) -> Option<&Impostor> {
        self.impostor.get()?.as_ref()
    }

    /// The simplest form within the tolerance; a picture on a quad only where `may_be_pictured`.
    pub fn form(&self, size: &ApparentSize, may_be_pictured: bool) -> DetailForm {
        if may_be_pictured && size.is_small() && self.impostor().is_some() {
            return DetailForm::Impostor(ImpostorDirection::nearest(size.toward_eye));
        }
        let fits = |level: &DetailLevel| level.error * size.px_per_unit <= TOLERANCE_PX;
        self.levels.iter().rposition(fits).map_or(DetailForm::Full, |level| DetailForm::Level(level as u8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detail() -> ModelDetail {
        let level = |error| DetailLevel { parts: Vec::new(), error };
        ModelDetail { levels: vec![level(0.01), level(0.1)], impostor: OnceLock::new() }
    }

    fn seen(px_per_unit: f32) -> ApparentSize {
        ApparentSize { px_per_unit, across_px: px_per_unit * 10.0, toward_eye: Vec3::X }
    }

    #[test]
    fn the_coarsest_level_within_half_a_pixel_is_taken() {
        assert_eq!(detail().form(&seen(100.0), true), DetailForm::Full);
        assert_eq!(detail().form(&seen(40.0), true), DetailForm::Level(0));
        assert_eq!(detail().form(&seen(4.0), true), DetailForm::Level(1));
    }
}
