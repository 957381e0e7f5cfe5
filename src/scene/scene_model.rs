//! The built scene: the ground, the features on it, labels and views, with data that pictures compute on first use.

use std::sync::{Arc, OnceLock};

use glam::Vec3;

use crate::analyses::SceneAnalysis;
use crate::climate::Climate;
use crate::earthworks::water_beside;
use crate::feature::{FEATURE_NOUNS, FeatureKind, SceneFeature};
use crate::feature_meshes::{FeatureSolid, Ribbon, Solid};
use crate::fences::Barrier;
use crate::finer_elevation::FinerElevation;
use crate::ground_map_cache::GroundMapCache;
use crate::military::SceneSymbol;
use crate::placed_model::Placement;
use crate::ramps::TintedGround;
use crate::report::SceneReport;
use crate::roads::profiles::{BridgeProfile, RoadProfile};
use crate::scene_graphic::SceneGraphic;
use crate::scene_label::SceneLabel;
use crate::scene_view::SceneView;
use crate::sight_layers::SightLayers;
use crate::source_reach::SourceOverlap;
use crate::style::{RampSource, RockDrawing};
use crate::sunlight::Sunlight;
use crate::symbols::LineSymbol;
use crate::vertical_scale::VerticalScale;
use crate::water::culvert::Culvert;
use sandtable_analysis::movement::vehicle::Vehicle;
use sandtable_description::document::FurnitureTable;
use sandtable_description::finding::Finding;
use sandtable_description::words::{GridName, StylePreset, TableTop};
use sandtable_draw::font::FontFile;
use sandtable_draw::ground::{ColorRamp, Contours};
use sandtable_draw::ground_cover::GroundCover;
use sandtable_draw::ground_imagery::GroundImagery;
use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;
use sandtable_earthworks::brush::Change;
use sandtable_earthworks::held_posts::HeldPosts;
use sandtable_geom::crs::Crs;
use sandtable_geom::declination::CalendarDay;
use sandtable_model::Model;
use sandtable_model::detail::ModelDetail;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::water_cover::{WaterCover, WaterRules};

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
    pub(crate) layout: PatchLayout,
    pub(crate) ground: OnceLock<MeasuredGround>,
    /// The posts under water, which earthworks leave as they are.
    pub held: Arc<HeldPosts>,
    /// The posts that its earthworks changed, with their heights before.
    pub dug: Vec<Change>,
    /// Answers height queries in map coordinates.
    pub heights: HeightService,
    pub(crate) ramp: RampSource,
    /// The climate of the middle of its ground.
    pub climate: Climate,
    pub(crate) land_cover: bool,
    /// Whether its shade is light: it carries symbols and graphics, or its preset wants it so.
    pub(crate) is_lightly_shaded: bool,
    /// The picture draped over the ground.
    pub imagery: Option<Arc<GroundImagery>>,
    /// Lines of equal height on the ground.
    pub contours: Option<Contours>,
    /// Rock drawing, on views from above.
    pub rock: Option<RockDrawing>,
    /// Where the light comes from.
    pub sunlight: Sunlight,
    /// How strongly its texture shows, 0..=1.
    pub texture: f32,
    /// The distance in meters from the near edge of the scene at which 63 % of what is seen is haze, 0 for clear air;
    /// `None` fits haze to each view.
    pub haze_m: Option<f32>,
    /// What the block stands on where it is seen as a whole.
    pub table: TableTop,
    pub(crate) maps: GroundMapCache,
    /// What is water besides the features of the scene file.
    pub water_rules: WaterRules,
    /// The water that the elevations themselves show, once it is found; see [`SceneModel::water`].
    pub water: OnceLock<WaterCover>,
    pub(crate) has_voids: OnceLock<bool>,
    /// Areas, rivers, lakes and roads, in drawing order.
    pub ribbons: Vec<Ribbon>,
    /// Roads and rivers, as lines for pictures in which their ribbons are too narrow.
    pub symbols: Vec<LineSymbol>,
    /// Tactical graphics, in drawing order.
    pub graphics: Vec<SceneGraphic>,
    /// Viewsheds, lines of sight and ranges.
    pub sight: SightLayers,
    /// Walls, belts of obstacles and trenches, as lines.
    pub barriers: Vec<Barrier>,
    /// Reaches of rivers that run in culverts, as the data have them.
    pub culverts: Vec<Culvert>,
    /// The vehicles that it describes.
    pub vehicles: Vec<Vehicle>,
    /// What the ground allows.
    pub analyses: Vec<SceneAnalysis>,
    /// Solids with fixed heights: buildings, bridges.
    pub solids: Vec<Solid>,
    /// Pictures on them, by the numbers that their coats name.
    pub pictures: Vec<Pixels>,
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

impl SceneModel {
    /// Whether lines, tints or texts lie over the ground: tactical graphics, layers of sight, analyses.
    pub fn has_overlay(&self) -> bool {
        !(self.graphics.is_empty() && self.sight.is_empty() && self.analyses.is_empty())
    }

    /// The ground as it is drawn, made on first use; its measures are computed at first use, too.
    pub fn ground(&self) -> &MeasuredGround {
        self.ground.get_or_init(|| MeasuredGround::with_layout(self.scale.drawn(&self.lattice), self.layout))
    }

    /// The water that the elevations themselves show, found on first use by [`Self::water_rules`].
    pub fn water(&self) -> &WaterCover {
        self.water.get_or_init(|| water_beside(&self.dug, &self.lattice, &self.water_rules))
    }

    /// The elevation in meters below which all colors are those of a sea's bed,
    /// [`bathymetry`](sandtable_draw::bathymetry::bathymetry); `None` without a sea, and where land lies lower.
    pub fn shore_m(&self) -> Option<f32> {
        let stated_m = self.water_rules.sea_level_m;
        let shore_m = stated_m.or_else(|| (self.water().low_posts == 0).then_some(0.0));
        shore_m.filter(|_| self.has_sea())
    }

    /// The colors of the ground by height; they begin at [`Self::shore_m`].
    pub fn ramp(&self) -> ColorRamp {
        let (low, high) = self.height_range_m;
        let low = self.shore_m().filter(|&shore_m| high > shore_m).map_or(low, |shore_m| low.max(shore_m));
        let has_sea = self.climate.is_known() && self.has_sea();
        self.ramp.over(&TintedGround { range_m: (low, high), climate: self.climate, has_sea })
    }

    /// The elevations where the covers of natural ground change; `None` where the picture shows none.
    pub fn cover(&self) -> Option<GroundCover> {
        self.land_cover.then(|| GroundCover {
            has_forms: self.imagery.is_none(),
            ..self.climate.cover(self.scale.0.recip() * coarse_rise(self.lattice.cell().max_element()))
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
            self.lattice.missing_posts() as f64 > RAGGED * self.lattice.heights().len() as f64
        })
    }

    /// The sentences of its findings, for the user.
    pub fn notes(&self) -> Vec<&str> {
        self.findings.iter().map(|finding| finding.message.as_str()).collect()
    }

    /// Notes for the user about what a picture shows and no file states.
    pub fn inferred_notes(&self) -> Vec<String> {
        let WaterCover { sea_posts, lakes, open_low_posts, .. } = self.water();
        let area = |posts: usize| format!("{:.2} km²", posts as f64 * self.lattice.cell_m2() / 1e6);
        let stated_m = self.water_rules.sea_level_m;
        let sea = (*sea_posts > 0 && stated_m.is_none()).then(|| {
            format!(
                "{} are drawn as sea: level ground at 0 m that is connected to the border",
                area(*sea_posts)
            )
        });
        let dry = stated_m.filter(|_| *sea_posts == 0).map(|level_m| {
            format!(
                "`sea_level = {level_m}` has no effect: no ground at or below it is connected to the border"
            )
        });
        let low = (*open_low_posts > 0).then(|| {
            format!(
                "{} below 0 m that reach the border are not drawn as sea (`sea_level = 0` in [terrain] draws them so)",
                area(*open_low_posts)
            )
        });
        let lakes = (!lakes.is_empty()).then(|| {
            let area = area(lakes.iter().sum());
            format!("{} level basins are drawn as lakes, {area} in all", lakes.len())
        });
        let cover = self.land_cover.then(|| {
            "woods, fields, meadow, scree, rock and snow are inferred from climate, elevation and slope; plots of fields and forms \
             below the size of the model's cells are symbols (`land_cover = false` in [style] switches them off)"
                .to_owned()
        });
        let off = |note| format!("{note} (inferred; `infer_water = false` in [terrain] switches it off)");
        sea.into_iter().chain(lakes).map(off).chain(dry).chain(low).chain(cover).collect()
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

    /// The name of a feature: its kind and its own name; empty for nothing.
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

/// By how much slopes over cells of this size are steeper in truth: the mean over a cell hides cliffs.
fn coarse_rise(cell_m: f64) -> f32 {
    // The cell whose slopes are taken as they are, the factor for each doubling of it, and the greatest.
    const FINE_M: f64 = 10.0;
    const STEEPER: f64 = 1.12;
    const MOST: f64 = 1.5;
    libm::pow(STEEPER, libm::log2((cell_m / FINE_M).max(1.0))).min(MOST) as f32
}
