//! A tactical graphic in its place, as pictures draw it.

use glam::DVec2;

use sandtable_description::words::{GraphicSide, GraphicStatus};
use sandtable_draw::list::FeatureId;
use sandtable_symbology::graphic::drawing::GraphicInput;
use sandtable_symbology::graphic::fields::GraphicFields;
use sandtable_symbology::graphic::kind::GraphicKind;

/// A tactical graphic in its place.
#[derive(Clone, Debug)]
pub struct SceneGraphic {
    /// What it is.
    pub kind: &'static GraphicKind,
    /// Its points, world X and Y; of an area without repeating the first.
    pub points: Vec<DVec2>,
    /// The stated width in meters.
    pub width_m: Option<f64>,
    /// Its texts and numbers.
    pub fields: GraphicFields,
    /// The side that it belongs to.
    pub side: GraphicSide,
    /// Whether it is there.
    pub status: GraphicStatus,
    /// The lowest and the highest elevation of airspace, meters.
    pub elevations_m: Option<[f64; 2]>,
    /// The feature it is.
    pub feature: FeatureId,
}

impl SceneGraphic {
    /// What it is drawn from, with texts `em_m` high in meters and the direction that is up on the picture.
    pub fn input(&self, em_m: f64, up: DVec2) -> GraphicInput<'_> {
        GraphicInput { points: &self.points, em_m, up, width_m: self.width_m, fields: &self.fields }
    }
}
