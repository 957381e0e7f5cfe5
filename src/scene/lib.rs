//! From a scene file to a draw list.
//!
//! `build` turns a document and its assets into a [`SceneGround`](build::SceneGround) or a [`SceneModel`], one pass a file: the
//! ground (`ground`), ribbons (`areas`, `water`, `roads`), solids (`buildings`, `fences`, `bridges`), models (`models`,
//! `scatter`; `footprint` and `placement` set them on the ground), labels and cameras (`views`). The passes add to `builder`.
//! `picture` turns a scene and a camera into a draw list.

mod all_samples;
pub mod areas;
pub mod assets;
pub mod attributes;
pub mod bridges;
pub mod build;
pub mod builder;
pub mod building_colors;
pub mod buildings;
mod cause_code;
pub mod crossed_shapes;
pub mod earthworks;
mod elevation;
mod exact_ground;
pub mod facade;
pub mod feature_labels;
pub mod feature_origin;
pub mod fences;
pub mod finer_elevation;
pub mod flights;
mod font;
pub mod footprint;
pub mod framing;
pub mod graphics;
pub mod ground;
pub mod ground_map;
pub mod ground_window;
pub mod imagery;
pub mod label_course;
pub mod land_cover;
pub mod military;
pub mod misplacement;
pub mod model_file;
pub mod models;
pub mod near;
pub mod overridden_crs;
pub mod paper_sheet;
pub mod placement;
pub mod planned_pictures;
pub mod plinth;
pub mod ramps;
mod reduced_elevation;
mod relief_strength;
pub mod report;
pub mod roads;
pub mod scatter;
pub mod scene_file;
pub mod scene_findings;
pub mod seen_ground;
pub mod sight_layers;
pub mod source_reach;
pub mod sources;
mod spot_heights;
pub mod style;
pub mod sunlight;
pub mod symbols;
pub mod table_shadow;
pub mod texture_shading;
pub mod undergrowth;
pub mod vertical_scale;
pub mod views;
pub mod water;
pub mod wood;
pub mod world_frame;

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, Vec2, Vec3};

use crate::earthworks::water_beside;
use crate::feature_origin::FeatureOrigin;
use crate::finer_elevation::FinerElevation;
use crate::graphics::SceneGraphic;
use crate::ground_map::{GroundMapCache, GroundMapKey};
use crate::label_course::LabelCourse;
use crate::land_cover::CoverLines;
use crate::military::SceneSymbol;
use crate::paper_sheet::PaperSheet;
use crate::ramps::TintedGround;
use crate::report::SceneReport;
use crate::roads::profiles::{BridgeProfile, RoadProfile};
use crate::sight_layers::SightLayers;
use crate::source_reach::SourceOverlap;
use crate::style::RampSource;
use crate::sunlight::Sunlight;
use crate::symbols::LineSymbol;
use crate::vertical_scale::VerticalScale;
use sandtable_base::message::suggest::quoted;
use sandtable_description::document::FurnitureTable;
use sandtable_description::finding::Finding;
use sandtable_description::words::{Anchor, Clamp, Footing, GridName, LabelKind, StylePreset, TableTop};
use sandtable_draw::color::Srgba;
use sandtable_draw::font::FontFile;
use sandtable_draw::ground::{ColorRamp, Contours, GroundMap};
use sandtable_draw::ground_cover::GroundCover;
use sandtable_draw::ground_imagery::GroundImagery;
use sandtable_draw::list::{DrawMesh, FeatureId};
use sandtable_earthworks::brush::Change;
use sandtable_earthworks::held_posts::HeldPosts;
use sandtable_geom::crs::Crs;
use sandtable_geom::declination::CalendarDay;
use sandtable_geom::rect::Rect;
use sandtable_model::Model;
use sandtable_model::detail::ModelDetail;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::water_cover::WaterCover;

/// A digital terrain model: the ground, the features on it, labels and views.
pub struct SceneModel {
    /// The picture's title.
    pub title: Option<String>,
    /// A second line under it.
    pub subtitle: Option<String>,
    /// The phase that it shows; `None` where it has none.
    pub phase: Option<String>,
    /// The map coordinates' system.
    pub crs: Crs,
    /// The system that the scene file or its elevation states in meters: that of inline points unless `points_crs` names
    /// another. It is `crs` but where its lengths are not true.
    pub stated_crs: Crs,
    /// The elevations of the ground, true to scale.
    pub lattice: Arc<Lattice>,
    /// What has more samples than the lattice has posts.
    pub finer: Option<FinerElevation>,
    /// The lowest and the highest of them, meters.
    pub height_range_m: (f32, f32),
    /// How they are drawn.
    pub scale: VerticalScale,
    /// The box of the drawn ground in world space: its least and its greatest corner.
    pub bounds: (Vec3, Vec3),
    /// The greatest error of the drawn ground in pixels.
    pub tolerance_px: f32,
    /// Whether the edges of its triangles show.
    pub wireframe: bool,
    layout: PatchLayout,
    ground: OnceLock<MeasuredGround>,
    /// The posts under water, which earthworks leave as they are.
    pub held: Arc<HeldPosts>,
    /// The posts that its earthworks changed, with their heights before.
    dug: Vec<Change>,
    /// Answers height queries in map coordinates.
    pub heights: HeightService,
    ramp: RampSource,
    pub latitude_deg: Option<f64>,
    land_cover: bool,
    /// Whether it is there to carry symbols and graphics.
    is_base_map: bool,
    /// The picture draped over the ground.
    pub imagery: Option<Arc<GroundImagery>>,
    /// Lines of equal height on the ground.
    pub contours: Option<Contours>,
    /// Where the light comes from.
    pub sunlight: Sunlight,
    /// How strongly its texture shows, 0..=1.
    pub texture: f32,
    /// The distance in meters from the near edge of the scene at which 63 % of what is seen is haze, 0 for clear air;
    /// `None` fits haze to each view.
    pub haze_m: Option<f32>,
    /// What the block stands on where it is seen as a whole.
    pub table: TableTop,
    maps: GroundMapCache,
    infers_water: bool,
    pub water: OnceLock<WaterCover>,
    has_voids: OnceLock<bool>,
    /// Areas, rivers, lakes and roads, in drawing order.
    pub ribbons: Vec<Ribbon>,
    /// Roads and rivers, as lines for pictures in which their ribbons are too narrow.
    pub symbols: Vec<LineSymbol>,
    /// Tactical graphics, in drawing order.
    pub graphics: Vec<SceneGraphic>,
    /// Viewsheds, lines of sight and ranges.
    pub sight: SightLayers,
    /// Solids with fixed heights: buildings, bridges.
    pub solids: Vec<Solid>,
    /// Solids that each picture sets on its displayed ground: walls, fences, lines, footings.
    pub uprights: Vec<FeatureSolid>,
    /// Model files, each loaded once.
    pub models: Vec<Model>,
    /// Simpler forms of each model, made when a picture first needs them.
    pub details: Vec<OnceLock<ModelDetail>>,
    /// Models in their places.
    pub placements: Vec<Placement>,
    /// Names and heights.
    pub labels: Vec<SceneLabel>,
    /// Military symbols.
    pub military: Vec<SceneSymbol>,
    /// Views; at least one.
    pub cameras: Vec<SceneView>,
    /// The font for characters that the embedded fonts lack.
    pub font: Option<FontFile>,
    /// Legend, scale bar and the like.
    pub furniture: FurnitureTable,
    /// The look in one word that its pictures have.
    pub preset: Option<StylePreset>,
    /// The coordinate grid on the ground.
    pub grid: GridName,
    /// The day of its information.
    pub sheet_day: Option<CalendarDay>,
    /// Every feature, in the order of ids from 2 up.
    pub features: Vec<SceneFeature>,
    /// What building it found: features off the model, missing textures, earth moved.
    pub findings: Vec<Finding>,
    /// How much of each source lies off the ground.
    pub overlaps: Vec<SourceOverlap>,
    /// Measures of single features.
    pub report: SceneReport,
    /// The longitudinal profiles of the roads that the ground follows.
    pub profiles: Vec<RoadProfile>,
    /// The longitudinal profiles of bridges.
    pub bridge_profiles: Vec<BridgeProfile>,
    /// The files it was made of, besides the scene file itself.
    pub files: Vec<std::path::PathBuf>,
}

/// The kind of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeatureKind {
    /// A lake.
    Lake,
    /// A river or stream.
    River,
    /// A road.
    Road,
    /// A bridge.
    Bridge,
    /// A tunnel.
    Tunnel,
    /// A ground cover.
    Area,
    /// A building.
    Building,
    /// A fence, wall, power line or another line.
    Fence,
    /// A model.
    Model,
    /// Models scattered over areas: one feature per table.
    Scattered,
    /// A tactical graphic.
    Graphic,
    /// A viewshed, lines of sight or a range.
    Sight,
}

/// The noun of each kind for one feature and for several, in the order of summaries.
const FEATURE_NOUNS: [(FeatureKind, &str, &str); 12] = [
    (FeatureKind::Lake, "lake", "lakes"),
    (FeatureKind::River, "river", "rivers"),
    (FeatureKind::Road, "road", "roads"),
    (FeatureKind::Bridge, "bridge", "bridges"),
    (FeatureKind::Tunnel, "tunnel", "tunnels"),
    (FeatureKind::Area, "area", "areas"),
    (FeatureKind::Building, "building", "buildings"),
    (FeatureKind::Fence, "line", "lines"),
    (FeatureKind::Model, "model", "models"),
    (FeatureKind::Scattered, "scatter of models", "scatters of models"),
    (FeatureKind::Graphic, "tactical graphic", "tactical graphics"),
    (FeatureKind::Sight, "layer of sight", "layers of sight"),
];

impl FeatureKind {
    /// Its noun for a count of one, or of several.
    pub fn noun(self, count: usize) -> &'static str {
        let (_, one, several) = FEATURE_NOUNS[self as usize];
        if count == 1 { one } else { several }
    }
}

/// One feature of the scene: one road line, one lake polygon, one model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFeature {
    /// What it is.
    pub kind: FeatureKind,
    /// Its name; may be empty.
    pub name: String,
    /// Where it comes from.
    pub origin: FeatureOrigin,
}

impl SceneFeature {
    /// What a message calls it: its kind with its name, or with its number in its file.
    pub fn described(&self) -> String {
        let kind = self.kind.noun(1);
        match (self.name.as_str(), self.origin.number) {
            ("", Some(number)) => format!("{kind} {number} of its file"),
            ("", None) => builder::described(kind, ""),
            (name, _) => format!("{kind} '{}'", quoted(name)),
        }
    }
}

/// A feature that lies on the ground.
pub struct Ribbon {
    /// Its triangles in plan.
    pub plan: PlanMesh,
    /// Its surface.
    pub surface: RibbonSurface,
    /// A factor of the surface's color and alpha.
    pub tint: Srgba,
    /// Its drawing order: a higher number covers a lower.
    pub layer: u8,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// A solid with fixed heights.
pub struct Solid {
    /// Its triangles in world space, at displayed heights.
    pub mesh: DrawMesh,
    /// The look of its triangles.
    pub coat: Coat,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// A solid that each picture sets on its displayed ground.
pub struct FeatureSolid {
    /// The solid.
    pub upright: DrapedSolid,
    /// The feature it belongs to.
    pub feature: FeatureId,
}

/// The look of a solid's triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coat {
    /// The colors of their vertices.
    Painted,
    /// Walls with windows where they have texture coordinates, times the colors of their vertices.
    Facade,
    /// A surface's texture, times the colors of their vertices.
    Surface(RibbonSurface),
}

/// A model in its place.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Which of the scene's models.
    pub model: usize,
    /// World X and Y of its origin.
    pub at: Vec2,
    /// What its height is measured from.
    pub clamp: Clamp,
    /// Meters above the ground, or displayed elevation, as `clamp` says; 0 where it stands on the ground.
    pub height: f64,
    /// The heading of its front, radians clockwise from north.
    pub heading_rad: f32,
    /// Meters per unit of the model.
    pub scale: f32,
    /// How it meets the ground.
    pub standing: GroundFit,
    /// The feature it is.
    pub feature: FeatureId,
}

/// How a model meets the ground it stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroundFit {
    /// The ground under it that decides its height.
    pub anchor: Anchor,
    /// The most that it leans with the ground, in radians.
    pub tilt_rad: f32,
    /// How deep it stands in the ground, in meters.
    pub sink_m: f32,
    /// What fills the gap.
    pub footing: Footing,
}

impl Placement {
    /// Whether its pose depends on the ground under its whole footprint, not only under its origin.
    pub fn needs_footprint(&self) -> bool {
        self.standing.anchor != Anchor::Origin || self.standing.tilt_rad > 0.0
    }
}

/// A name on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLabel {
    /// What it says.
    pub text: String,
    /// The bytes of the scene file that state it; `0..0` for a spot height.
    pub stated: Range<usize>,
    /// The position on the ground, world space, displayed height.
    pub ground: Vec3,
    /// Where the leader line starts, at or above the ground.
    pub anchor: Vec3,
    /// What it follows on the ground.
    pub course: LabelCourse,
    /// The kind of thing that it names.
    pub kind: LabelKind,
    /// The lower, the more important; never NaN.
    pub rank: f64,
}

/// A view of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneView {
    /// Its name on the command line.
    pub name: String,
    /// From where it looks, and whereto.
    pub aim: ViewAim,
    /// Vertical field of view in radians; without effect on parallel rays.
    pub fov_y_rad: f32,
    /// The paper that it fills, where it is meant for print.
    pub paper: Option<PaperSheet>,
}

impl SceneView {
    /// Pixels per inch of its print; `None` where it has no print in mind.
    pub fn dpi(&self) -> Option<f64> {
        match self.aim {
            ViewAim::Parallel(ParallelView { dpi, .. }) => Some(dpi),
            _ => self.paper.map(|paper| paper.dpi),
        }
    }
}

impl SceneView {
    /// The part of the ground that it is fitted to, world X and Y; `None` where that is all, and where it has an eye.
    pub fn shown(&self) -> Option<Rect> {
        match self.aim {
            ViewAim::At { .. } => None,
            ViewAim::Fitted(FittedView { shown, .. }) | ViewAim::Parallel(ParallelView { shown, .. }) => {
                shown
            }
        }
    }

    /// This view with all of its places moved.
    pub fn moved(&self, by: DVec2) -> Self {
        let rect = |rect: Rect| Rect { min: rect.min + by, max: rect.max + by };
        let point = |at: Vec3| at + by.as_vec2().extend(0.0);
        let aim = match self.aim {
            ViewAim::At { eye, target } => ViewAim::At { eye: point(eye), target: point(target) },
            ViewAim::Fitted(view) => ViewAim::Fitted(FittedView { shown: view.shown.map(rect), ..view }),
            ViewAim::Parallel(view) => ViewAim::Parallel(ParallelView {
                shown: view.shown.map(rect),
                middle: view.middle.map(|middle| middle + by),
                ..view
            }),
        };
        Self { aim, ..self.clone() }
    }
}

/// From where a view looks, and whereto.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewAim {
    /// From a place to a place, world space.
    At {
        /// The eye.
        eye: Vec3,
        /// The point in the picture's middle.
        target: Vec3,
    },
    /// From as near as what it shows fits into the picture.
    Fitted(FittedView),
    /// By parallel rays, with one scale.
    Parallel(ParallelView),
}

/// A view whose eye depends on the picture's shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedView {
    /// Where it looks, clockwise from north, radians; `None` for north, or for the east or the west where ground that is
    /// long from south to north fills the picture better so.
    pub azimuth_rad: Option<f32>,
    /// How far it looks down from the horizon, radians; `None` for what fills the picture best.
    pub pitch_rad: Option<f32>,
    /// The ground that it shows, world X and Y; `None` for all of it.
    pub shown: Option<Rect>,
}

/// A view by parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelView {
    /// Where it looks, clockwise from north, radians.
    pub azimuth_rad: f32,
    /// How far it looks down from the horizon, radians; a right angle at most.
    pub pitch_rad: f32,
    /// How many times as many pixels a meter spans up the picture as across it.
    pub stretch: f32,
    /// `n` of its scale 1:n; `None` for the largest at which what it shows fits into the picture.
    pub scale: Option<f64>,
    /// Pixels per inch of the print on which that scale is true.
    pub dpi: f64,
    /// The ground that it shows, world X and Y; `None` for all of it.
    pub shown: Option<Rect>,
    /// The ground in the middle of the picture, world X and Y; `None` for the middle of what it shows.
    pub middle: Option<DVec2>,
}

impl SceneModel {
    /// The ground as it is drawn, made on first use; what is measured of it is measured when it is first asked for.
    pub fn ground(&self) -> &MeasuredGround {
        self.ground.get_or_init(|| MeasuredGround::with_layout(self.scale.drawn(&self.lattice), self.layout))
    }

    /// What the ground looks like, its light computed unless the last picture had the same; `making` is called before.
    pub fn map(&self, key: GroundMapKey, making: impl FnOnce()) -> Arc<GroundMap> {
        self.maps.get(self, key, making)
    }

    /// The water that the elevations themselves show, found on first use; none where the scene file forbids it.
    pub fn water(&self) -> &WaterCover {
        self.water.get_or_init(|| {
            if self.infers_water { water_beside(&self.dug, &self.lattice) } else { WaterCover::default() }
        })
    }

    /// The colors of the ground by height. Where there is a sea they begin at 0 m: its bed has colors of its own,
    /// [`bathymetry`](sandtable_draw::bathymetry::bathymetry).
    pub fn ramp(&self) -> ColorRamp {
        let (low, high) = self.height_range_m;
        let low = if self.has_sea() && high > 0.0 { low.max(0.0) } else { low };
        self.ramp.over(&TintedGround { range_m: (low, high), latitude_deg: self.latitude_deg })
    }

    /// Where the covers of natural ground change; `None` where the picture shows none.
    pub fn cover(&self) -> Option<GroundCover> {
        let lines = CoverLines::at(self.latitude_deg);
        self.land_cover.then(|| GroundCover {
            tree_m: lines.tree_m as f32,
            snow_m: lines.snow_m as f32,
            true_rise: self.scale.0.recip(),
            shady_north: if self.latitude_deg.is_some_and(|degrees| degrees < 0.0) { -1.0 } else { 1.0 },
        })
    }

    /// Whether part of the ground is drawn as sea.
    pub fn has_sea(&self) -> bool {
        self.water().sea_posts > 0
    }

    /// Whether enough of the model's rectangle is without data to be hatched: more than the ragged border that is left
    /// where a raster was warped.
    pub fn has_voids(&self) -> bool {
        /// Posts without data, as a share of all.
        const RAGGED: f64 = 0.002;
        *self.has_voids.get_or_init(|| {
            let missing = self.lattice.heights().iter().filter(|height| height.is_nan()).count();
            missing as f64 > RAGGED * self.lattice.heights().len() as f64
        })
    }

    /// The sentences of its findings, for the user.
    pub fn notes(&self) -> Vec<&str> {
        self.findings.iter().map(|finding| finding.message.as_str()).collect()
    }

    /// What a picture shows that no file states, for the user.
    pub fn inferred_notes(&self) -> Vec<String> {
        let WaterCover { sea_posts, lakes, .. } = self.water();
        let area = |posts: usize| format!("{:.2} km²", posts as f64 * self.lattice.cell_m2() / 1e6);
        let sea = (*sea_posts > 0).then(|| {
            format!(
                "{} are drawn as sea: ground at or below 0 m that is connected to the border",
                area(*sea_posts)
            )
        });
        let lakes = (!lakes.is_empty()).then(|| {
            let area = area(lakes.iter().sum());
            format!("{} level basins are drawn as lakes, {area} in all", lakes.len())
        });
        let off = |note| format!("{note} (inferred; `infer_water = false` in [terrain] switches it off)");
        sea.into_iter().chain(lakes).map(off).collect()
    }

    /// Whether [`SceneModel::map`] has been made.
    pub fn is_lit(&self) -> bool {
        !self.maps.is_empty()
    }

    /// The view called `name`, or the first where no name is given.
    pub fn view(&self, name: Option<&str>) -> Option<&SceneView> {
        match name {
            Some(name) => self.cameras.iter().find(|view| view.name == name),
            None => self.cameras.first(),
        }
    }

    /// What a feature is called: its kind and its name; empty for nothing.
    pub fn feature_name(&self, feature: FeatureId) -> String {
        match feature {
            FeatureId::GROUND => return "ground".into(),
            FeatureId::PLINTH => return "plinth".into(),
            _ => {}
        }
        let feature = feature.index().and_then(|index| self.features.get(index));
        feature.map_or_else(String::new, |SceneFeature { kind, name, .. }| match name.as_str() {
            "" => kind.noun(1).to_owned(),
            name => format!("{} {name}", kind.noun(1)),
        })
    }

    /// The number of features of each kind that is present, in the order of [`FeatureKind`].
    pub fn census(&self) -> Vec<(FeatureKind, usize)> {
        let count = |kind| self.features.iter().filter(|feature| feature.kind == kind).count();
        FEATURE_NOUNS
            .map(|(kind, ..)| (kind, count(kind)))
            .into_iter()
            .filter(|&(_, count)| count > 0)
            .collect()
    }
}
