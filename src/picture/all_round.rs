//! The draw list of a scene for all points of view, for programs that load it once.
//!
//! What lies on the ground has its true width. Over it lie line symbols of roads and rivers for several distances, each as
//! wide as the farthest of its band needs; whoever draws them cuts them to the width of the place, by how far across the
//! line each place is.

use std::collections::BTreeMap;
use std::f32::consts::FRAC_PI_2;

use glam::{Mat4, Vec3};
use rayon::prelude::*;

use crate::detail::{ListedForm, Viewer};
use crate::drapes::{
    BELOW_RIVERS, BELOW_ROADS, RibbonLook, add_material, fill_color, lake_material, sources, tapered,
};
use crate::lake_tint::longest_lakes;
use crate::line_scale::LineScale;
use crate::placed_text::PlacedText;
use crate::symbols::{DrapedSymbol, PlannedSymbol, SymbolUv, planned_with};
use crate::{airspace, ground, models, overlay, solids, table, uprights, voids};
use sandtable_draw::lighting::Lighting;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, FeatureId, MaterialId};
use sandtable_geom::rect::Rect;
use sandtable_ribbon::drape::Draper;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::feature_meshes::Ribbon;
use sandtable_scene::framing::parallel_view::parallel_camera;
use sandtable_scene::ground_map_cache::GroundMapKey;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::ParallelView;
use sandtable_scene::symbols::LineSymbol;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::{Camera, CameraError};

/// The picture of the whole scene that the widest symbols are for.
const OVERVIEW_SIZE: (u32, u32) = (1920, 1080);

/// How many times as fine as the overview's the pixels of each band are. Three bands reach from the whole to where most
/// roads show their true width; between two, symbols are cut to a third of their width at most.
const BANDS: [u32; 3] = [1, 3, 8];

/// How many times as wide as in the overview the widest symbols are: perspective shows the far end of a scene smaller.
const WIDEST: f64 = 1.3;

/// How many times as wide symbols are made as their band needs, of which the rest is cut off: lines that are seen across
/// at a low angle need it. The page's script has the same constant.
const SPREAD: f64 = 2.0;

/// U of a fill in the color of its class.
const CLASS_U: f32 = 0.98;

/// The draw list of a scene for all points of view.
pub struct AllRoundScene {
    /// The draw list.
    pub list: DrawList,
    /// When each of its items is shown.
    pub shown: Vec<ItemShown>,
    /// Meters in a pixel, of a picture 1080 lines high, for which the symbols of each band are wide enough; falling.
    pub bands_m: Vec<f64>,
    /// The forms of models.
    pub forms: Vec<ListedForm>,
    /// The texts of tactical graphics.
    pub graphic_texts: Vec<PlacedText>,
}

/// The condition under which an item is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ItemShown {
    /// Always.
    Always,
    /// Where pixels are finer than those of its band and not than those of the next. V says how far across the line a place
    /// is: 0 and 1 at the edges.
    Band(u8),
    /// Where the scene is seen as a block on a table.
    Table,
    /// Where a model is seen at the size for which this form is fine enough, and no simpler one is.
    Form(u32),
}

/// The draw list of a scene for all points of view, its terrain shown as `displayed` and lit from `to_sun`, a unit vector, with
/// all models in all their forms. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// The scene cannot be seen from above.
pub fn all_round(
    scene: &SceneModel,
    displayed: &DisplayedTerrain,
    to_sun: Vec3,
    progress: &dyn Fn(&'static str),
) -> Result<AllRoundScene, CameraError> {
    let overview = overview(scene, 1)?;
    let map = scene.map(GroundMapKey { level: 0, to_sun }, || progress("lighting terrain"));
    let lighting = Lighting { to_sun, ..Lighting::default() };
    let mut list = DrawList { ground: Some(map), lighting, ..DrawList::default() };
    let walls = ground::add(&mut list, scene, displayed);
    progress("draping features");
    let mut shown = vec![ItemShown::Always; list.items.len()];
    let bands_m = add_laid(&mut list, &mut shown, scene, displayed)?;
    let tints = overlay::add_ground_tints(&mut list, scene, displayed);
    shown.splice(tints.start..tints.start, tints.map(|_| ItemShown::Always));
    let graphic_texts = overlay::add(&mut list, scene, Viewer::Camera(&overview), displayed, progress);
    progress("setting models");
    ground::add_plinth(&mut list, scene, walls);
    shown.resize(list.items.len(), ItemShown::Always);
    table::add(&mut list, scene);
    shown.resize(list.items.len(), ItemShown::Table);
    solids::add(&mut list, scene);
    voids::add(&mut list, scene);
    uprights::add(&mut list, scene, displayed);
    let forms = models::add_forms(&mut list, scene, displayed);
    airspace::add(&mut list, scene);
    shown.resize(list.items.len(), ItemShown::Always);
    for (index, form) in forms.iter().enumerate() {
        shown[form.items.clone()].fill(ItemShown::Form(index as u32));
    }
    Ok(AllRoundScene { list, shown, bands_m, forms, graphic_texts })
}

/// The whole scene from straight above, with pixels that are `fineness` times as fine as those of the overview.
fn overview(scene: &SceneModel, fineness: u32) -> Result<Camera, CameraError> {
    let view = ParallelView {
        azimuth_rad: 0.0,
        pitch_rad: FRAC_PI_2,
        stretch: 1.0,
        scale: None,
        dpi: 96.0,
        shown: None,
        middle: None,
    };
    parallel_camera(scene, &view, (OVERVIEW_SIZE.0 * fineness, OVERVIEW_SIZE.1 * fineness))
}

/// Something on the ground.
struct LaidItem {
    layer: u8,
    mesh: DrawMesh,
    material: MaterialId,
    feature: FeatureId,
    shown: ItemShown,
}

/// Adds ribbons and symbols, lower layers first; returns the bands of the symbols.
fn add_laid(
    list: &mut DrawList,
    shown: &mut Vec<ItemShown>,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
) -> Result<Vec<f64>, CameraError> {
    let mut looks = BTreeMap::new();
    let mut laid = ribbons(list, &mut looks, scene, displayed);
    let mut bands_m = Vec::new();
    let bands = if scene.symbols.is_empty() { &[][..] } else { &BANDS[..] };
    for (band, &fineness) in bands.iter().enumerate() {
        let camera = overview(scene, fineness)?;
        let scale = LineScale::all_round(&camera, WIDEST * SPREAD);
        bands_m.push(WIDEST / f64::from(camera.pixels_per_meter(1.0)));
        let shown = ItemShown::Band(band as u8);
        laid.extend(symbols(list, &mut looks, scene, displayed, &camera, scale, shown));
    }
    // Symbols lie over the ribbons of their layer.
    laid.sort_by_key(|item| item.layer);
    for LaidItem { layer, mesh, material, feature, shown: when } in laid {
        let triangles = 0..mesh.triangles.len() as u32;
        let (mesh, layer) = (list.add_mesh(mesh), DepthLayer::Draped(layer));
        let world_from_mesh = Mat4::IDENTITY;
        list.items.push(DrawItem { mesh, triangles, material, world_from_mesh, layer, feature });
        shown.push(when);
    }
    Ok(bands_m)
}

/// The materials of looks so far.
type Looks = BTreeMap<RibbonLook, MaterialId>;

fn ribbons(
    list: &mut DrawList,
    looks: &mut Looks,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
) -> Vec<LaidItem> {
    let sources = sources(scene);
    let lakes = longest_lakes(scene, |bounds: &Rect| Some(bounds.size().max_element()));
    let draped = |draper: &mut Draper, ribbon: &Ribbon| {
        let taper = sources.get(&ribbon.feature).and_then(|symbol| tapered(ribbon, symbol));
        let mut mesh = draper.drape(taper.as_ref().unwrap_or(&ribbon.plan), displayed);
        let lake = lakes.get(&ribbon.feature).filter(|_| ribbon.surface == RibbonSurface::Lake);
        let tint = lake.map(|lake| {
            let tint = lake.tint();
            tint.lay_over(&mut mesh);
            tint.pixels
        });
        (mesh, tint)
    };
    let meshes: Vec<_> = scene.ribbons.par_iter().map_init(Draper::default, draped).collect();
    let item = |(ribbon, (mesh, tint)): (&Ribbon, (DrawMesh, _))| {
        let material = match tint {
            Some(pixels) => {
                let material = lake_material(list, pixels);
                list.add_material(material)
            }
            None => {
                let look = RibbonLook::Textured(ribbon.surface, ribbon.tint.0);
                *looks.entry(look).or_insert_with(|| add_material(list, look))
            }
        };
        LaidItem { layer: ribbon.layer, mesh, material, feature: ribbon.feature, shown: ItemShown::Always }
    };
    let shown = scene.ribbons.iter().zip(meshes).filter(|(_, (mesh, _))| !mesh.triangles.is_empty());
    shown.map(item).collect()
}

/// The symbols of a band: all casings of a sort, then the fills of class after class.
fn symbols<'a>(
    list: &mut DrawList,
    looks: &mut Looks,
    scene: &'a SceneModel,
    displayed: &dyn TriangleSurface,
    camera: &Camera,
    scale: LineScale<'_>,
    shown: ItemShown,
) -> Vec<LaidItem> {
    let draped = |draper: &mut Draper, planned: PlannedSymbol<'a>| {
        let PlannedSymbol { symbol, casing, fill, deck } = planned;
        // A page shows bridges as they are, and drapes all symbols.
        let [casing, fill] = if deck.is_some() { Default::default() } else { [casing, fill] };
        let [casing, fill] = [casing, fill].map(|plan| {
            let mut mesh = draper.drape(&plan, displayed);
            mesh.vertices.iter_mut().for_each(|vertex| vertex.uv = [CLASS_U, vertex.uv[0]]);
            mesh
        });
        DrapedSymbol { symbol, casing, fill, is_raised: false }
    };
    let (mut lines, _) = planned_with(scene, camera, scale, SymbolUv::Across, draped);
    // Mouths of rivers lie over shores.
    lines.sort_by(|a, b| {
        let is_shore = |line: &DrapedSymbol<'_>| line.symbol.surface == RibbonSurface::ShoreLine;
        is_shore(b).cmp(&is_shore(a)).then(a.symbol.least_px.total_cmp(&b.symbol.least_px))
    });
    let mut item = |mesh: DrawMesh, look: RibbonLook, symbol: &LineSymbol| {
        let is_water = matches!(symbol.surface, RibbonSurface::River | RibbonSurface::ShoreLine);
        let layer = if is_water { BELOW_RIVERS } else { BELOW_ROADS };
        let material = *looks.entry(look).or_insert_with(|| add_material(list, look));
        LaidItem { layer, mesh, material, feature: symbol.feature, shown }
    };
    let (mut casings, mut fills) = (Vec::new(), Vec::new());
    for DrapedSymbol { symbol, casing, fill, .. } in lines {
        casings.push(item(casing, RibbonLook::Casing(symbol.surface), symbol));
        fills.push(item(fill, RibbonLook::Fill(symbol.surface, fill_color(symbol)), symbol));
    }
    casings.into_iter().chain(fills).filter(|item| !item.mesh.triangles.is_empty()).collect()
}
