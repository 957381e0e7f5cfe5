//! The table under the block: its top, and the block's shadow on it.
//!
//! Paper and plain ground are one sheet with the shadow in its texture; it is full under and around the block and ends
//! gradually in the backdrop. Boards have an edge, and the shadow lies over them as a sheet of its own.

use glam::{DVec2, FloatExt, Vec3};

use crate::add_mesh;
use sandtable_description::words::TableTop;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, DrawVertex, FeatureId};
use sandtable_draw::material::{AlphaMode, Material};
use sandtable_draw::pixels::Pixels;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::MeshSink;
use sandtable_scene::plinth::base_z;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::table_shadow::{TableShadow, table_rect};
use sandtable_scene::wood::wood;

const PAPER: Srgba = Srgba::opaque(250, 248, 243);
const CLAY: Srgba = Srgba::opaque(206, 198, 184);
/// The color of full shade: neutral, a little cool, as the sky lights it.
const SHADE: Srgba = Srgba::opaque(38, 38, 46);

/// How far the table reaches beyond the block, and how far it is full, as shares of the block's longer side.
const REACH: f64 = 0.45;
const FULL: f64 = 0.12;

/// The side of the texture with the shadow in texels: shadows are soft, and coarser ones show steps at the block's foot.
const TEXELS: u32 = 448;

/// Repeats of the wood over the block's longer side.
const WOOD_REPEATS: f64 = 2.2;

/// By how much the shadow lies over the boards, as a share of the block's longer side: less is lost in the rounding of
/// depths.
const SHADOW_ABOVE: f32 = 2e-4;

/// Adds the table that the scene asks for; nothing for [`TableTop::None`].
pub(super) fn add(list: &mut DrawList, scene: &SceneModel) {
    let top = match scene.table {
        TableTop::Paper => Some(PAPER),
        TableTop::Ground => Some(CLAY),
        TableTop::Wood => None,
        TableTop::None => return,
    };
    let side_m = scene.lattice.extent().size().max_element();
    let rect = table_rect(&scene.lattice, REACH * side_m);
    let z = base_z(scene.bounds);
    // A level surface shows its color whatever the sun.
    let light = list.lighting.shade(Vec3::ONE, Vec3::Z).max(Vec3::splat(1e-3));
    if top.is_none() {
        let texture = Some(list.add_texture(wood()));
        let base_color = Srgba::from_linear(light.recip().min(Vec3::ONE));
        let uv_per_m = WOOD_REPEATS / side_m;
        let uv = |at: DVec2| (at * DVec2::new(uv_per_m, -uv_per_m)).as_vec2().to_array();
        add_sheet(
            list,
            &rect,
            z,
            uv,
            Material {
                name: "table".into(),
                base_color,
                texture,
                receives_shadows: false,
                ..Material::default()
            },
        );
    }
    let color = top.map(|color| (color.linear() / light).min(Vec3::ONE));
    let sheet = shadowed(scene, list.lighting.to_sun, &rect, color, FULL * side_m);
    let texture = Some(list.add_texture(sheet));
    // The outermost texels' centers lie on the sheet's edges.
    let inset = 0.5 / f64::from(TEXELS);
    let uv = |at: DVec2| {
        let part = (at - rect.min) / rect.size();
        (inset + DVec2::new(part.x, 1.0 - part.y) * (1.0 - 2.0 * inset)).as_vec2().to_array()
    };
    let above = if top.is_none() { SHADOW_ABOVE * side_m as f32 } else { 0.0 };
    let material = Material {
        name: "table".into(),
        texture,
        alpha: AlphaMode::Blend,
        receives_shadows: false,
        ..Material::default()
    };
    add_sheet(list, &rect, z + above, uv, material);
}

/// The texture of a sheet over `rect` of the color `top` (linear), full up to `full_m` from the block, with the shadow in
/// it; of the shadow alone without a color.
fn shadowed(scene: &SceneModel, to_sun: Vec3, rect: &Rect, top: Option<Vec3>, full_m: f64) -> Pixels {
    let shadow = TableShadow { ground: scene.ground().lattice(), table_z: base_z(scene.bounds), to_sun };
    let shades = shadow.map(rect, TEXELS);
    let block = table_rect(&scene.lattice, full_m);
    let margin = (block.min - rect.min).max_element();
    Pixels::par_from_fn(TEXELS, TEXELS, |x, y| {
        let part = DVec2::new(f64::from(x), f64::from(TEXELS - 1 - y)) / f64::from(TEXELS - 1);
        let at = rect.min + part * rect.size();
        let off = (block.min - at).max(at - block.max).max(DVec2::ZERO).length() / margin;
        let full = ((1.0 - off) as f32).smoothstep(0.0, 1.0);
        let shade = shades[(y * TEXELS + x) as usize] * full;
        let (sheet, under) = (if top.is_some() { full } else { 0.0 }, 1.0 - shade);
        let alpha = 1.0 - (1.0 - sheet) * under;
        let color = SHADE.linear() * shade + top.unwrap_or(Vec3::ZERO) * (sheet * under);
        let Srgba([red, green, blue, _]) = Srgba::from_linear(color / alpha.max(1e-6));
        Srgba([red, green, blue, (alpha * 255.0 + 0.5) as u8])
    })
}

fn add_sheet(list: &mut DrawList, rect: &Rect, z: f32, uv: impl Fn(DVec2) -> [f32; 2], material: Material) {
    let mut mesh = DrawMesh::default();
    let corners =
        [rect.min, DVec2::new(rect.max.x, rect.min.y), rect.max, DVec2::new(rect.min.x, rect.max.y)];
    let [a, b, c, d] = corners.map(|at| {
        mesh.vertex(DrawVertex {
            position: at.as_vec2().extend(z).to_array(),
            normal: [0.0, 0.0, 1.0],
            uv: uv(at),
            color: Srgba::WHITE,
        })
    });
    mesh.triangle([a, b, c]);
    mesh.triangle([a, c, d]);
    let material = list.add_material(material);
    // The table is no part of the scene.
    add_mesh(list, mesh, material, DepthLayer::Solid, FeatureId::NONE);
}
