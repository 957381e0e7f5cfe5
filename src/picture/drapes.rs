//! Ribbons, cut to the displayed triangles, over the line symbols that show them from afar.
//!
//! Symbols of one sort, from below: all casings, then the fills of class after class, so that lines that meet are one. They
//! lie over the ribbons that the true ones of their sort lie over. The symbol of a bridge that would lie beside it on the
//! picture lies on its deck instead.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

use crate::add_mesh;
use crate::detail::Viewer;
use crate::lake_tint::large_lakes;
use crate::line_scale::LineScale;
use crate::markings::faded;
use crate::symbols::{DrapedSymbol, RibbonShow, Symbols, symbols};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, FeatureId, MaterialId};
use sandtable_draw::material::{AlphaMode, Material, NormalSource};
use sandtable_draw::pixels::Pixels;
use sandtable_ribbon::drape::Draper;
use sandtable_ribbon::partition;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_ribbon::texture::area::area_texture;
use sandtable_ribbon::texture::{RibbonSurface, markings, texture};
use sandtable_scene::feature_meshes::Ribbon;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::symbols::LineSymbol;
use sandtable_terrain::triangle_surface::TriangleSurface;

/// The layers that symbols of rivers and of roads are the uppermost of: banks, and lakes.
pub(super) const BELOW_RIVERS: u8 = 1;
pub(super) const BELOW_ROADS: u8 = 3;

/// The share of its surface's light that a casing has.
const CASING_LIGHT: f32 = 0.45;

/// The fills of paved roads, by the least width of their class, in pixels, as maps print them: the higher the class, the
/// fuller the color. In the gray of asphalt a city's streets would leave no ground to see, and no class could be told.
const PAVED_FILLS: [(f64, Srgba); 4] = [
    (5.0, Srgba::opaque(238, 176, 108)),
    (3.5, Srgba::opaque(246, 212, 132)),
    (2.5, Srgba::opaque(248, 236, 190)),
    (0.0, Srgba::opaque(244, 241, 233)),
];

/// The symbols on decks, which are solids.
#[must_use]
pub(super) struct RaisedSymbols(Vec<RaisedMesh>);

/// A part of a symbol on a deck.
struct RaisedMesh {
    mesh: DrawMesh,
    look: RibbonLook,
    feature: FeatureId,
}

impl RaisedSymbols {
    fn new(symbols: Vec<DrapedSymbol<'_>>) -> Self {
        let parts = |DrapedSymbol { symbol, casing, fill, .. }: DrapedSymbol<'_>| {
            let (feature, surface) = (symbol.feature, symbol.surface);
            let fill_look = RibbonLook::RaisedFill(surface, fill_color(symbol));
            [
                RaisedMesh { mesh: casing, look: RibbonLook::RaisedCasing(surface), feature },
                RaisedMesh { mesh: fill, look: fill_look, feature },
            ]
        };
        Self(symbols.into_iter().flat_map(parts).collect())
    }

    /// Adds them.
    pub fn add_to(self, list: &mut DrawList) {
        let mut ribbons = Ribbons { list, materials: BTreeMap::new() };
        for RaisedMesh { mesh, look, feature } in self.0 {
            ribbons.add(mesh, look, DepthLayer::Solid, feature);
        }
    }
}

/// Adds all ribbons and symbols on the ground, lower layers first; returns the symbols that solids carry.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
    viewer: Viewer<'_>,
) -> RaisedSymbols {
    let line_scale = || match viewer {
        Viewer::Anyone => None,
        Viewer::Camera(camera) => Some((camera, LineScale::new(camera))),
        Viewer::Around(camera) => Some((camera, LineScale::around(camera))),
    };
    let Symbols { draped, shows } = match line_scale() {
        None => Symbols::default(),
        Some((camera, scale)) => symbols(scene, camera, scale, displayed),
    };
    let scale = line_scale().map(|(_, scale)| scale);
    let sources = sources(scene);
    let lakes = scale.as_ref().map(|scale| large_lakes(scene, scale)).unwrap_or_default();
    let draped_ribbon = |draper: &mut Draper, ribbon: &Ribbon| {
        let mut draped = DrapedRibbon::default();
        if shows.get(&ribbon.feature) != Some(&RibbonShow::Replaced) {
            let source = sources.get(&ribbon.feature).filter(|_| scale.is_some());
            let tapered = source.and_then(|symbol| tapered(ribbon, symbol));
            draped.ribbon = draper.drape(tapered.as_ref().unwrap_or(&ribbon.plan), displayed);
            let scale = scale.as_ref().filter(|_| ribbon.surface != ribbon.surface.unmarked());
            draped.markings = scale.map(|scale| faded(&draped.ribbon, scale));
            let lake = lakes.get(&ribbon.feature).filter(|_| ribbon.surface == RibbonSurface::Lake);
            draped.tint = lake.map(|lake| {
                let tint = lake.tint();
                tint.lay_over(&mut draped.ribbon);
                tint.pixels
            });
        }
        draped
    };
    let meshes: Vec<_> = scene.ribbons.par_iter().map_init(Draper::default, draped_ribbon).collect();
    let (mut shores, mut rivers, mut roads) = (Vec::new(), Vec::new(), Vec::new());
    let (raised, draped): (Vec<_>, Vec<_>) = draped.into_iter().partition(|draped| draped.is_raised);
    for draped in draped {
        match draped.symbol.surface {
            RibbonSurface::ShoreLine => shores.push(draped),
            RibbonSurface::River => rivers.push(draped),
            _ => roads.push(draped),
        }
    }
    let mut ribbons = Ribbons { list, materials: BTreeMap::new() };
    let mut order: Vec<_> =
        scene.ribbons.iter().zip(meshes).filter(|(_, draped)| !draped.ribbon.triangles.is_empty()).collect();
    order.sort_by_key(|(ribbon, _)| ribbon.layer);
    let mut order = order.into_iter().peekable();
    let mut add_up_to = |ribbons: &mut Ribbons<'_>, layer: u8| {
        while let Some((ribbon, draped)) = order.next_if(|(ribbon, _)| ribbon.layer <= layer) {
            let layer = DepthLayer::Draped(ribbon.layer);
            if let Some(pixels) = draped.tint {
                let material = lake_material(ribbons.list, pixels);
                let material = ribbons.list.add_material(material);
                add_mesh(ribbons.list, draped.ribbon, material, layer, ribbon.feature);
                continue;
            }
            let surface = if draped.markings.is_some() { ribbon.surface.unmarked() } else { ribbon.surface };
            ribbons.add(draped.ribbon, RibbonLook::Textured(surface, ribbon.tint.0), layer, ribbon.feature);
            let markings = draped.markings.unwrap_or_default();
            ribbons.add(markings, RibbonLook::Markings(ribbon.surface), layer, ribbon.feature);
        }
    };
    // Mouths of rivers lie over shores.
    for (layer, symbols) in [(BELOW_RIVERS, shores), (BELOW_RIVERS, rivers), (BELOW_ROADS, roads)] {
        add_up_to(&mut ribbons, layer);
        ribbons.add_symbols(symbols, DepthLayer::Draped(layer));
    }
    add_up_to(&mut ribbons, u8::MAX);
    RaisedSymbols::new(raised)
}

/// The rivers that have a source, by feature.
pub(super) fn sources(scene: &SceneModel) -> BTreeMap<FeatureId, &LineSymbol> {
    let with_source = scene.symbols.iter().filter(|symbol| symbol.has_source());
    with_source.map(|symbol| (symbol.feature, symbol)).collect()
}

/// A ribbon on the displayed ground.
#[derive(Default)]
struct DrapedRibbon {
    ribbon: DrawMesh,
    /// What is painted on it, where that is a surface of its own.
    markings: Option<DrawMesh>,
    /// The texture that spans it, where that is its own.
    tint: Option<Pixels>,
}

/// A river's ribbon or banks without what its source is drawn narrower; `None` where that is nothing of it.
pub(super) fn tapered(ribbon: &Ribbon, symbol: &LineSymbol) -> Option<PlanMesh> {
    let more_m = match ribbon.surface {
        RibbonSurface::River | RibbonSurface::Rapids | RibbonSurface::Falls | RibbonSurface::Bar => 0.0,
        RibbonSurface::Bank => symbol.bank_m,
        _ => return None,
    };
    let mut shown = PlanMesh::default();
    stroke(&StrokePath::alone(&symbol.shown_alignment(more_m)), &StrokeOptions::default(), &mut shown);
    Some(partition::within(&ribbon.plan, &shown))
}

/// The color of the fill of a symbol; `None` where it is that of its surface.
pub(super) fn fill_color(symbol: &LineSymbol) -> Option<[u8; 4]> {
    let is_paved = symbol.surface.unmarked() == RibbonSurface::AsphaltPlain;
    let class = PAVED_FILLS.iter().find(|(least_px, _)| symbol.least_px >= *least_px);
    class.filter(|_| is_paved).map(|(_, Srgba(color))| *color)
}

/// What a material is made for.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum RibbonLook {
    /// A surface in a tint.
    Textured(RibbonSurface, [u8; 4]),
    /// The markings of a surface.
    Markings(RibbonSurface),
    /// The inside of a symbol.
    Fill(RibbonSurface, Option<[u8; 4]>),
    /// The outline of a symbol.
    Casing(RibbonSurface),
    /// The inside of a symbol on a deck.
    RaisedFill(RibbonSurface, Option<[u8; 4]>),
    /// The outline of a symbol on a deck.
    RaisedCasing(RibbonSurface),
}

/// A draw list with the materials of ribbons so far.
struct Ribbons<'a> {
    list: &'a mut DrawList,
    materials: BTreeMap<RibbonLook, MaterialId>,
}

impl Ribbons<'_> {
    fn add_symbols(&mut self, mut symbols: Vec<DrapedSymbol<'_>>, layer: DepthLayer) {
        symbols.sort_by(|a, b| a.symbol.least_px.total_cmp(&b.symbol.least_px));
        for draped in &mut symbols {
            let casing = std::mem::take(&mut draped.casing);
            self.add(casing, RibbonLook::Casing(draped.symbol.surface), layer, draped.symbol.feature);
        }
        for DrapedSymbol { symbol, fill, .. } in symbols {
            let look = RibbonLook::Fill(symbol.surface, fill_color(symbol));
            self.add(fill, look, layer, symbol.feature);
        }
    }

    fn add(&mut self, mesh: DrawMesh, look: RibbonLook, layer: DepthLayer, feature: FeatureId) {
        if !mesh.triangles.is_empty() {
            let material = self.material(look);
            add_mesh(self.list, mesh, material, layer, feature);
        }
    }

    fn material(&mut self, look: RibbonLook) -> MaterialId {
        let list = &mut *self.list;
        *self.materials.entry(look).or_insert_with(|| add_material(list, look))
    }
}

/// Adds the material of a look.
pub(super) fn add_material(list: &mut DrawList, look: RibbonLook) -> MaterialId {
    let material = match look {
        RibbonLook::Textured(surface, tint) => draped_material(list, surface, Srgba(tint)),
        RibbonLook::Markings(surface) => marking_material(list, surface),
        RibbonLook::Fill(surface, color) => fill_material(list, surface, color.map(Srgba)),
        RibbonLook::Casing(surface) => flat_material("casing", surface, CASING_LIGHT),
        RibbonLook::RaisedFill(surface, color) => raised(fill_material(list, surface, color.map(Srgba))),
        RibbonLook::RaisedCasing(surface) => raised(flat_material("casing", surface, CASING_LIGHT)),
    };
    list.add_material(material)
}

/// A symbol's material on a deck: it lies level, and as a sign casts no shadow, which what is blended does not.
fn raised(material: Material) -> Material {
    Material { normals: NormalSource::Vertex, alpha: AlphaMode::Blend, two_sided: true, ..material }
}

fn draped_material(list: &mut DrawList, surface: RibbonSurface, tint: Srgba) -> Material {
    let texture = list.add_texture(texture(surface));
    Material {
        area: area_texture(surface),
        name: format!("{surface:?}").to_lowercase(),
        base_color: tint,
        texture: Some(texture),
        alpha: if surface.lets_through() { AlphaMode::Blend } else { AlphaMode::Opaque },
        normals: NormalSource::Ground,
        is_water: surface.is_water(),
        is_natural: surface.is_natural(),
        ..Material::default()
    }
}

pub(super) fn lake_material(list: &mut DrawList, pixels: Pixels) -> Material {
    Material {
        name: "lake".to_owned(),
        texture: Some(list.add_texture(pixels)),
        normals: NormalSource::Ground,
        is_water: true,
        ..Material::default()
    }
}

fn marking_material(list: &mut DrawList, surface: RibbonSurface) -> Material {
    Material {
        name: format!("markings of {surface:?}").to_lowercase(),
        texture: markings(surface).map(|pixels| list.add_texture(pixels)),
        alpha: AlphaMode::Blend,
        normals: NormalSource::Ground,
        ..Material::default()
    }
}

/// The fill of a symbol: its surface's mean color, which along U becomes `color` where it has one.
fn fill_material(list: &mut DrawList, surface: RibbonSurface, color: Option<Srgba>) -> Material {
    /// Texels along U: the steps between them are not seen.
    const STEPS: u32 = 64;
    let material = flat_material("line", surface, 1.0);
    let Some(color) = color else { return material };
    let (from, to) = (material.base_color.linear(), color.linear());
    let blend = Pixels::from_fn(STEPS, 1, |x, _| {
        // The outermost texels run into each other.
        let part = (x.clamp(1, STEPS - 2) - 1) as f32 / (STEPS - 3) as f32;
        Srgba::from_linear(from.lerp(to, part))
    });
    Material { base_color: Srgba::WHITE, texture: Some(list.add_texture(blend)), ..material }
}

/// The mean color of a surface without markings, with this share of its light.
fn flat_material(part: &str, surface: RibbonSurface, light: f32) -> Material {
    let texture = texture(surface.unmarked());
    let sum: Vec3 = texture.data().iter().map(|texel| texel.linear()).sum();
    Material {
        name: format!("{part} of {surface:?}").to_lowercase(),
        base_color: Srgba::from_linear(sum * light / texture.data().len() as f32),
        normals: NormalSource::Ground,
        is_water: surface.is_water() && light == 1.0,
        ..Material::default()
    }
}
