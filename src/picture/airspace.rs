//! Airspace with stated elevations: upright ribbons along both sides of a corridor, or round an area, seen through.

use glam::{DVec2, Vec3};

use crate::add_mesh;
use crate::graphic_colors::graphic_color;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList};
use sandtable_draw::material::{AlphaMode, Material};
use sandtable_scene::scene_graphic::SceneGraphic;
use sandtable_scene::scene_model::SceneModel;
use sandtable_structure::faces::Faces;
use sandtable_symbology::graphic::kind::GraphicShape;

/// The share of light that a ribbon stops, and that its upper and lower border stop.
const RIBBON_ALPHA: u8 = 62;
const BORDER_ALPHA: u8 = 220;

/// The height of a border, as a share of the ribbon's.
const BORDER: f32 = 0.05;

/// Adds the ribbons of all airspace.
pub(super) fn add(list: &mut DrawList, scene: &SceneModel) {
    let mut material = None;
    for graphic in &scene.graphics {
        let Some(range_m) = graphic.elevations_m else { continue };
        let color = graphic_color(graphic.side, graphic.kind.tint);
        let [low, high] = range_m.map(|elevation_m| scene.scale.world_z(elevation_m as f32));
        let mut faces = Faces::default();
        for line in sides(graphic) {
            ribbon(&line, [low, high], color, &mut faces);
        }
        let mesh = faces.into_mesh();
        if mesh.triangles.is_empty() {
            continue;
        }
        let material = *material.get_or_insert_with(|| {
            list.add_material(Material {
                name: "airspace".into(),
                alpha: AlphaMode::Blend,
                two_sided: true,
                receives_shadows: false,
                ..Material::default()
            })
        });
        add_mesh(list, mesh, material, DepthLayer::Solid, graphic.feature);
    }
}

/// The lines on which ribbons stand: the sides of a corridor leg by leg, or the outline of an area.
fn sides(graphic: &SceneGraphic) -> Vec<Vec<DVec2>> {
    let points = &graphic.points;
    match graphic.kind.shape {
        GraphicShape::Corridor => {
            let width_m = graphic.width_m.or(graphic.fields.distances_m.first().copied()).unwrap_or(0.0);
            let leg_sides = |leg: &[DVec2]| {
                let aside = (leg[1] - leg[0]).normalize_or_zero().perp() * width_m / 2.0;
                [vec![leg[0] + aside, leg[1] + aside], vec![leg[0] - aside, leg[1] - aside]]
            };
            points.windows(2).flat_map(leg_sides).collect()
        }
        GraphicShape::Area => vec![points.iter().chain(points.first()).copied().collect()],
        _ => Vec::new(),
    }
}

/// A ribbon from one height to another with a border above and below.
fn ribbon(line: &[DVec2], [low, high]: [f32; 2], color: Srgba, faces: &mut Faces) {
    let border = (high - low) * BORDER;
    let bands = [
        ([low, low + border], BORDER_ALPHA),
        ([low + border, high - border], RIBBON_ALPHA),
        ([high - border, high], BORDER_ALPHA),
    ];
    for ([from, to], alpha) in bands {
        let Srgba([red, green, blue, _]) = color;
        for leg in line.windows(2) {
            let corner = |at: DVec2, z: f32| -> Vec3 { at.as_vec2().extend(z) };
            let corners =
                [corner(leg[0], from), corner(leg[1], from), corner(leg[1], to), corner(leg[0], to)];
            faces.polygon(&corners, Srgba([red, green, blue, alpha]));
        }
    }
}
