//! Which form of a model to draw, by how large it is seen.
//!
//! ```text
//! seen as            form
//! ≤ 32 px across     impostor: a picture on a quad
//! larger             the coarsest level whose error is seen as at most half a pixel
//! large              the model itself
//! ```

use glam::Vec3;

use crate::model::Model;
use crate::model::impostor::{Impostor, ImpostorDirection};
use crate::model::simplify::{DetailLevel, levels};

/// How far a level's surface may be off on the picture, in pixels.
const TOLERANCE_PX: f32 = 0.5;

/// The largest a model may be seen as an impostor, in pixels. Where one gives way to the other the eye is near enough
/// for views 17° apart to differ by five pixels at the model's rim; twice as large they would jump.
const IMPOSTOR_PX: f32 = 32.0;

/// An impostor is made of a level whose error is at most this part of the model's size: a quarter of its pixels.
const IMPOSTOR_SHARE: f32 = 1.0 / 256.0;

/// The simpler forms of a model.
#[derive(Clone, Debug)]
pub struct ModelDetail {
    /// Simpler meshes, finest first.
    pub levels: Vec<DetailLevel>,
    /// Pictures from all sides, where they pay.
    pub impostor: Option<Impostor>,
}

/// How a placed model is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApparentSize {
    /// Pixels across a unit of the model at the model's nearest point.
    pub px_per_unit: f32,
    /// Pixels across the ball around the model.
    pub across_px: f32,
    /// Where the eye is seen from the model's middle, in the model's space; any length but 0.
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
    /// The simpler forms of `model`. Takes some microseconds a triangle; the same model gives the same forms.
    pub fn of(model: &Model) -> Self {
        let levels = levels(model);
        let size = model.bounds().map_or(0.0, |(min, max)| (max - min).length());
        let simple = levels.iter().rfind(|level| level.error <= size * IMPOSTOR_SHARE);
        let parts = simple.map_or(&model.parts, |level| &level.parts);
        Self { impostor: Impostor::of(model, parts), levels }
    }

    /// The simplest form that looks right.
    pub fn form(&self, seen: &ApparentSize) -> DetailForm {
        if self.impostor.is_some() && seen.across_px <= IMPOSTOR_PX {
            return DetailForm::Impostor(ImpostorDirection::nearest(seen.toward_eye));
        }
        let fits = |level: &DetailLevel| level.error * seen.px_per_unit <= TOLERANCE_PX;
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
