//! Chooses the form in which a model is drawn by the size at which it is seen.
//!
//! ```text
//! size               form
//! ≤ 32 px across     impostor: a picture on a quad
//! larger             the coarsest level whose error is at most half a pixel
//! large              the model itself
//! ```

use glam::Vec3;

use crate::model::Model;
use crate::model::impostor::{Impostor, ImpostorDirection};
use crate::model::simplify::{DetailLevel, levels};

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
    /// Pictures from all sides; `None` where they would not pay.
    pub impostor: Option<Impostor>,
}

/// How a placed model is seen.
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

impl ModelDetail {
    /// The simpler forms of `model`; takes some microseconds a triangle.
    pub fn new(model: &Model) -> Self {
        let levels = levels(model);
        let size = model.bounds().map_or(0.0, |bounds| bounds.size().length());
        let simple = levels.iter().rfind(|level| level.error <= size * IMPOSTOR_ERROR);
        let parts = simple.map_or(&model.parts, |level| &level.parts);
        Self { impostor: Impostor::new(model, parts), levels }
    }

    /// The simplest form within the tolerance.
    pub fn form(&self, size: &ApparentSize) -> DetailForm {
        if self.impostor.is_some() && size.across_px <= IMPOSTOR_PX {
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
        ModelDetail { levels: vec![level(0.01), level(0.1)], impostor: None }
    }

    fn seen(px_per_unit: f32) -> ApparentSize {
        ApparentSize { px_per_unit, across_px: px_per_unit * 10.0, toward_eye: Vec3::X }
    }

    #[test]
    fn the_coarsest_level_within_half_a_pixel_is_taken() {
        assert_eq!(detail().form(&seen(100.0)), DetailForm::Full);
        assert_eq!(detail().form(&seen(40.0)), DetailForm::Level(0));
        assert_eq!(detail().form(&seen(4.0)), DetailForm::Level(1));
    }
}
