//! A small scene with everything a draw list can hold, made from nothing but numbers.
//!
//! ```text
//!            north
//!   ┌──────────┬──┬───────┐   hills colored by height
//!   │  masked  │r │       │   a blended lake band under an opaque road, both draped
//!   │══lake════│o │═══════│   a textured box, a masked fence and a blended pane, standing
//!   │  box     │a │ pane  │
//!   └──────────┴──┴───────┘
//!            camera
//! ```

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::{ColorRamp, Contours, GroundMap, GroundPost};
use sandtable_draw::lighting::{Haze, Lighting, ReliefShading};
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, MaterialId};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource};
use sandtable_draw::pixels::Pixels;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_view::camera::Camera;

/// Posts a side of the ground.
const POSTS: u32 = 65;
/// Meters between posts.
const CELL_M: f32 = 10.0;

/// The lake's band, south to north.
pub const LAKE_Y: (f32, f32) = (300.0, 345.0);
/// The road's band, west to east.
pub const ROAD_X: (f32, f32) = (333.0, 347.0);
/// The middle of the box's base, its sides and its height.
pub const BOX: (Vec2, f32, f32) = (Vec2::new(180.0, 200.0), 60.0, 50.0);
/// The middle of the fence's foot.
pub const FENCE: Vec2 = Vec2::new(200.0, 480.0);
/// The middle of the pane's foot.
pub const PANE: Vec2 = Vec2::new(460.0, 220.0);
/// Width of fence and pane.
pub const BOARD_WIDTH_M: f32 = 100.0;
/// Height of fence and pane.
pub const BOARD_HEIGHT_M: f32 = 60.0;

pub const LAKE: FeatureId = FeatureId(10);
pub const ROAD: FeatureId = FeatureId(11);
pub const HOUSE: FeatureId = FeatureId(12);
pub const MASKED: FeatureId = FeatureId(13);
pub const BLENDED: FeatureId = FeatureId(14);

pub const ROAD_COLOR: Srgba = Srgba::opaque(120, 110, 100);
pub const LAKE_COLOR: Srgba = Srgba([40, 90, 160, 153]);
pub const PANE_COLOR: Srgba = Srgba([200, 40, 40, 102]);
pub const FENCE_COLOR: Srgba = Srgba::opaque(90, 60, 30);

/// Height of the hills in meters.
pub fn height_at(at: Vec2) -> f32 {
    let wave = |t: f32, length: f32| libm::sinf(t * std::f32::consts::TAU / length);
    40.0 + 18.0 * wave(at.x, 410.0) + 14.0 * wave(at.y + 60.0, 330.0) + 4.0 * wave(at.x + at.y, 120.0)
}

fn slope_at(at: Vec2) -> Vec2 {
    let rise = |step: Vec2| (height_at(at + step) - height_at(at - step)) / 2.0;
    Vec2::new(rise(Vec2::X), rise(Vec2::Y))
}

/// A camera south of the hills looking north and down.
pub fn camera(width: u32, height: u32) -> Camera {
    let (eye, target) = (Vec3::new(330.0, -260.0, 300.0), Vec3::new(320.0, 300.0, 30.0));
    Camera::new(eye, target, 0.85, (width, height), (1.0, 5000.0)).expect("a sound camera")
}

/// The whole scene.
pub fn scene() -> DrawList {
    let mut list = DrawList { ground: Some(ground_map().into()), lighting: lighting(), ..Default::default() };
    let ground = ground_mesh();
    let lake = clipped(&clipped(&ground, 1, LAKE_Y.0, 1.0), 1, LAKE_Y.1, -1.0);
    let road = clipped(&clipped(&ground, 0, ROAD_X.0, 1.0), 0, ROAD_X.1, -1.0);
    let draped = |name: &str, base_color, alpha| Material {
        name: name.into(),
        base_color,
        alpha,
        normals: NormalSource::Ground,
        ..Default::default()
    };
    let bare = Material { albedo: Albedo::GroundMap, ..draped("ground", Srgba::WHITE, AlphaMode::Opaque) };
    add(&mut list, ground, bare, DepthLayer::Ground, FeatureId::GROUND);
    add(&mut list, lake, draped("lake", LAKE_COLOR, AlphaMode::Blend), DepthLayer::Draped(0), LAKE);
    add(&mut list, road, draped("road", ROAD_COLOR, AlphaMode::Opaque), DepthLayer::Draped(1), ROAD);
    add_solids(&mut list);
    list.check().expect("a sound list");
    list
}

fn add_solids(list: &mut DrawList) {
    let bricks = list.add_texture(Pixels::from_fn(64, 64, |x, y| match (x / 8 + y / 8) % 2 {
        0 => Srgba::opaque(190, 120, 90),
        _ => Srgba::opaque(210, 200, 180),
    }));
    let holes = list.add_texture(Pixels::from_fn(32, 32, |x, _| match x / 8 % 2 {
        0 => Srgba::WHITE,
        _ => Srgba([255, 255, 255, 0]),
    }));
    let house = Material { texture: Some(bricks), ..Default::default() };
    let fence = Material {
        base_color: FENCE_COLOR,
        texture: Some(holes),
        alpha: AlphaMode::Mask(0.5),
        two_sided: true,
        ..Default::default()
    };
    let pane =
        Material { base_color: PANE_COLOR, alpha: AlphaMode::Blend, two_sided: true, ..Default::default() };
    let turned = Mat4::from_rotation_z(0.4);
    add_at(list, box_mesh(), house, BOX.0, turned, HOUSE);
    add_at(list, board(), fence, FENCE, Mat4::IDENTITY, MASKED);
    add_at(list, board(), pane, PANE, Mat4::IDENTITY, BLENDED);
}

fn add(list: &mut DrawList, mesh: DrawMesh, material: Material, layer: DepthLayer, feature: FeatureId) {
    let triangles = 0..mesh.triangles.len() as u32;
    let (mesh, material) = (list.add_mesh(mesh), list.add_material(material));
    list.items.push(DrawItem { mesh, triangles, material, world_from_mesh: Mat4::IDENTITY, layer, feature });
}

fn add_at(list: &mut DrawList, mesh: DrawMesh, material: Material, at: Vec2, turn: Mat4, feature: FeatureId) {
    add(list, mesh, material, DepthLayer::Solid, feature);
    let item = list.items.last_mut().expect("just added");
    item.world_from_mesh = Mat4::from_translation(at.extend(height_at(at) - 5.0)) * turn;
}

/// The material of the item with `feature`, to be changed.
pub fn material_of(list: &mut DrawList, feature: FeatureId) -> &mut Material {
    let MaterialId(index) =
        list.items.iter().find(|item| item.feature == feature).expect("in the scene").material;
    &mut list.materials[index as usize]
}

fn lighting() -> Lighting {
    let haze = Haze { color: Vec3::new(0.66, 0.76, 0.86), near_m: 0.0, distance_m: 4000.0 };
    Lighting { haze, ..Default::default() }
}

fn ground_map() -> GroundMap {
    let at = |index: u32| Vec2::new((index % POSTS) as f32, (index / POSTS) as f32) * CELL_M;
    let post = |index: u32| {
        let slope = slope_at(at(index));
        GroundPost {
            height_m: height_at(at(index)),
            slope_east: slope.x,
            slope_north: slope.y,
            sun_visibility: if at(index).x > 500.0 { 0.25 } else { 1.0 },
            sky_visibility: 0.9,
            water: 0.0,
        }
    };
    let stops = [
        (5.0, Srgba::opaque(60, 110, 60)),
        (35.0, Srgba::opaque(150, 160, 90)),
        (75.0, Srgba::opaque(230, 220, 200)),
    ];
    GroundMap {
        origin: Vec2::ZERO,
        cell: Vec2::splat(CELL_M),
        z_per_m: 1.0,
        columns: POSTS,
        rows: POSTS,
        posts: (0..POSTS * POSTS).map(post).collect(),
        ramp: ColorRamp::new(stops.into()).expect("rising stops"),
        contours: None,
        imagery: None,
        cover: None,
        halvings: 0,
        is_curved: false,
        form_level: 0,
        z_factor: 1.0,
        shade_gain: ReliefShading::GAIN,
        detail: ReliefShading::DETAIL,
        has_grain: false,
    }
}

/// The ground map of the scene, to be changed.
pub fn ground_of(list: &mut DrawList) -> &mut GroundMap {
    Arc::make_mut(list.ground.as_mut().expect("the scene has a ground map"))
}

/// The whole scene with contour lines every five meters.
pub fn scene_with_contours() -> DrawList {
    let mut list = scene();
    ground_of(&mut list).contours = Some(contours());
    list
}

/// The same with lines that show the light.
pub fn scene_with_illuminated_contours() -> DrawList {
    let mut list = scene();
    ground_of(&mut list).contours = Some(Contours { lit: Some(Srgba::WHITE), ..contours() });
    list
}

fn contours() -> Contours {
    Contours { interval_m: 5.0, major_every: 4, color: Srgba([70, 40, 20, 200]), width_px: 1.0, lit: None }
}

fn ground_mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    for row in 0..POSTS {
        for column in 0..POSTS {
            let at = Vec2::new(column as f32, row as f32) * CELL_M;
            mesh.vertex(corner(at.extend(height_at(at)), Vec3::Z, Vec2::ZERO));
        }
    }
    for row in 0..POSTS - 1 {
        for column in 0..POSTS - 1 {
            let id = |east: u32, north: u32| VertexId((row + north) * POSTS + column + east);
            mesh.triangle([id(0, 0), id(1, 0), id(1, 1)]);
            mesh.triangle([id(0, 0), id(1, 1), id(0, 1)]);
        }
    }
    mesh
}

fn corner(position: Vec3, normal: Vec3, uv: Vec2) -> DrawVertex {
    DrawVertex {
        position: position.to_array(),
        normal: normal.to_array(),
        uv: uv.to_array(),
        color: Srgba::WHITE,
    }
}

/// What of `mesh` lies where `side · (coordinate − at) ≥ 0`, cut exactly along its triangles.
fn clipped(mesh: &DrawMesh, axis: usize, at: f32, side: f32) -> DrawMesh {
    let mut cut = DrawMesh::default();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|id| mesh.vertices[id.index()]);
        let inside = |corner: &DrawVertex| side * (corner.position[axis] - at);
        let mut ring: Vec<VertexId> = Vec::new();
        for index in 0..3 {
            let (from, to) = (corners[index], corners[(index + 1) % 3]);
            let (a, b) = (inside(&from), inside(&to));
            if a >= 0.0 {
                ring.push(cut.vertex(from));
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                let (from_at, to_at) = (Vec3::from_array(from.position), Vec3::from_array(to.position));
                let between = from_at.lerp(to_at, a / (a - b));
                ring.push(cut.vertex(DrawVertex { position: between.to_array(), ..from }));
            }
        }
        for index in 2..ring.len() {
            cut.triangle([ring[0], ring[index - 1], ring[index]]);
        }
    }
    cut
}

/// A box on its base's middle, textured on each side.
fn box_mesh() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let (_, side, height) = BOX;
    let half = side * 0.5;
    let middle = Vec3::Z * height * 0.5;
    for (normal, right, up, depth) in [
        (Vec3::NEG_Y, Vec3::X * half, middle, half),
        (Vec3::X, Vec3::Y * half, middle, half),
        (Vec3::Y, Vec3::NEG_X * half, middle, half),
        (Vec3::NEG_X, Vec3::NEG_Y * half, middle, half),
        (Vec3::Z, Vec3::X * half, Vec3::Y * half, height * 0.5),
    ] {
        quad(&mut mesh, middle + normal * depth, right, up, normal);
    }
    mesh
}

/// An upright board that faces south.
fn board() -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let (right, up) = (Vec3::X * BOARD_WIDTH_M * 0.5, Vec3::Z * BOARD_HEIGHT_M * 0.5);
    quad(&mut mesh, up, right, up, Vec3::NEG_Y);
    mesh
}

fn quad(mesh: &mut DrawMesh, middle: Vec3, right: Vec3, up: Vec3, normal: Vec3) {
    let mut at = |x: f32, y: f32| {
        let uv = Vec2::new(x * 0.5 + 0.5, 0.5 - y * 0.5);
        mesh.vertex(corner(middle + right * x + up * y, normal, uv))
    };
    let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    mesh.triangle([a, b, c]);
    mesh.triangle([a, c, d]);
}
