//! A tactical graphic in its place, as pictures draw it.

use glam::DVec2;

use sandtable_description::words::{GraphicSide, GraphicStatus};
use sandtable_draw::color::Srgba;
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
    /// How an overlay's file draws it; `None` for what the standard draws.
    pub style: Option<GraphicStyle>,
    /// The feature it is.
    pub feature: FeatureId,
}

/// The look that an overlay's file gives a line, an area or a point.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphicStyle {
    /// The color of its line; `None` where it has none.
    pub stroke: Option<Srgba>,
    /// The width of its line in pixels of a picture 1080 pixels high.
    pub width_px: f64,
    /// Whether its line is dashed.
    pub is_dashed: bool,
    /// The color of its inside; `None` where the ground shows.
    pub fill: Option<Srgba>,
    /// The rings within an area that are not of it, world X and Y.
    pub holes: Vec<Vec<DVec2>>,
    /// The name of its overlay in the legend.
    pub overlay: String,
}

impl SceneGraphic {
    /// What it is drawn from, with texts `em_m` high in meters and the direction that is up on the picture.
    pub fn input(&self, em_m: f64, up: DVec2) -> GraphicInput<'_> {
        GraphicInput { points: &self.points, em_m, up, width_m: self.width_m, fields: &self.fields }
    }
}
