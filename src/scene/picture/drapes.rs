//! Ribbons, cut to the displayed triangles, over the line symbols that show them from afar.
//!
//! Symbols of one sort, from below: all casings, then the fills of class after class, so that lines that meet are one. They
//! lie over the ribbons that the true ones of their sort lie over.

use std::collections::BTreeMap;

use glam::Vec3;
use rayon::prelude::*;

use crate::draw::color::Srgba;
use crate::draw::list::{DepthLayer, DrawList, DrawMesh, FeatureId, MaterialId};
use crate::draw::material::{AlphaMode, Material, NormalSource};
use crate::ribbon::drape::drape;
use crate::ribbon::texture::{RibbonSurface, texture};
use crate::scene::picture::add_mesh;
use crate::scene::picture::detail::Viewer;
use crate::scene::picture::symbols::{DrapedSymbol, RibbonShow, Symbols, symbols};
use crate::scene::{Ribbon, SceneModel};
use crate::terrain::triangle_surface::TriangleSurface;

/// The layers that symbols of rivers and of roads are the uppermost of: banks, and lakes.
const BELOW_RIVERS: u8 = 1;
const BELOW_ROADS: u8 = 3;

/// The share of its surface's light that a casing has.
const CASING_LIGHT: f32 = 0.45;

/// That the fill of a paved road has: where roads are a city's pattern, fills as dark as asphalt would leave no ground
/// to see.
const PAVED_LIGHT: f32 = 1.8;

/// Adds all ribbons and symbols, lower layers first.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
    viewer: Viewer<'_>,
) {
    let Symbols { draped, shows } = match viewer {
        Viewer::Anyone => Symbols::default(),
        Viewer::Camera(camera) => symbols(scene, camera, displayed),
    };
    let show = |ribbon: &Ribbon| shows.get(&ribbon.feature).copied().unwrap_or(RibbonShow::Full);
    let meshes: Vec<DrawMesh> = scene
        .ribbons
        .par_iter()
        .map(|ribbon| {
            let mut mesh = DrawMesh::default();
            if show(ribbon) != RibbonShow::Replaced {
                drape(&ribbon.plan, displayed, &mut mesh);
            }
            mesh
        })
        .collect();
    let (mut shores, mut rivers, mut roads) = (Vec::new(), Vec::new(), Vec::new());
    for draped in draped {
        match draped.symbol.surface {
            RibbonSurface::ShoreLine => shores.push(draped),
            RibbonSurface::River => rivers.push(draped),
            _ => roads.push(draped),
        }
    }
    let mut ribbons = Ribbons { list, materials: BTreeMap::new() };
    let mut order: Vec<_> =
        scene.ribbons.iter().zip(meshes).filter(|(_, mesh)| !mesh.triangles.is_empty()).collect();
    order.sort_by_key(|(ribbon, _)| ribbon.layer);
    let mut order = order.into_iter().peekable();
    let mut add_up_to = |ribbons: &mut Ribbons<'_>, layer: u8| {
        while let Some((ribbon, mesh)) = order.next_if(|(ribbon, _)| ribbon.layer <= layer) {
            let surface =
                if show(ribbon) == RibbonShow::Plain { ribbon.surface.unmarked() } else { ribbon.surface };
            let material = ribbons.material(RibbonLook::Textured(surface, ribbon.tint.0));
            add_mesh(ribbons.list, mesh, material, DepthLayer::Draped(ribbon.layer), ribbon.feature);
        }
    };
    // Mouths of rivers lie over shores.
    for (layer, symbols) in [(BELOW_RIVERS, shores), (BELOW_RIVERS, rivers), (BELOW_ROADS, roads)] {
        add_up_to(&mut ribbons, layer);
        ribbons.add_symbols(symbols, DepthLayer::Draped(layer));
    }
    add_up_to(&mut ribbons, u8::MAX);
}

/// The share of a surface's light that the fill of its symbol has.
fn fill_light(surface: RibbonSurface) -> f32 {
    if surface.unmarked() == RibbonSurface::AsphaltPlain { PAVED_LIGHT } else { 1.0 }
}

/// What a material is made for.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum RibbonLook {
    Textured(RibbonSurface, [u8; 4]),
    Fill(RibbonSurface),
    Casing(RibbonSurface),
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
            self.add(fill, RibbonLook::Fill(symbol.surface), layer, symbol.feature);
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
        *self.materials.entry(look).or_insert_with(|| {
            let material = match look {
                RibbonLook::Textured(surface, tint) => draped_material(list, surface, Srgba(tint)),
                RibbonLook::Fill(surface) => flat_material("line", surface, fill_light(surface)),
                RibbonLook::Casing(surface) => flat_material("casing", surface, CASING_LIGHT),
            };
            list.add_material(material)
        })
    }
}

fn draped_material(list: &mut DrawList, surface: RibbonSurface, tint: Srgba) -> Material {
    let texture = list.add_texture(texture(surface));
    Material {
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
