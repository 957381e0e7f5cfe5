//! A lake under a mountain, made by formula: level water in the south, a slope from its shore to a crest in the north.
//!
//! ```text
//!      eye                      ╱▔▔▔  high: green
//!       •                     ╱
//!  ~~~~~~~~~~~~~~~~~~~~~~~~~╱       low: red
//!  y −2000                  0   60
//! ```

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::{ColorRamp, GroundMap, GroundPost};
use sandtable_draw::lighting::{Haze, Lighting, ReliefShading};
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId};
use sandtable_draw::material::{Albedo, Material, NormalSource};
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_view::camera::Camera;

const HALF_M: f32 = 2000.0;
const CELL_M: f32 = 20.0;
const SIDE: u32 = (2.0 * HALF_M / CELL_M) as u32 + 1;
/// The level of the lake in meters.
pub const LEVEL_M: f32 = 10.0;
/// The height of the crest over the lake in meters.
pub const CREST_M: f32 = 60.0;
/// How far the crest lies behind the shore in meters.
pub const SLOPE_M: f32 = 60.0;

/// The height of the ground over the lake with its crest at `crest`.
fn height(at: Vec2, crest_m: f32) -> f32 {
    crest_m * (at.y / SLOPE_M).clamp(0.0, 1.0)
}

/// The lake under a crest that rises and falls along the shore by `uneven` of its height.
pub fn mountain_lake(uneven: f32) -> DrawList {
    let crest_m = |x: f32| CREST_M * (1.0 + uneven * libm::sinf(x / 90.0));
    let post = |index: u32| {
        let at = Vec2::new((index % SIDE) as f32, (index / SIDE) as f32) * CELL_M - HALF_M;
        let rise = |step: Vec2| {
            let at_step = |at: Vec2| height(at, crest_m(at.x));
            (at_step(at + step) - at_step(at - step)) / (2.0 * CELL_M)
        };
        GroundPost {
            height_m: LEVEL_M + height(at, crest_m(at.x)),
            slope_east: rise(Vec2::X * CELL_M),
            slope_north: rise(Vec2::Y * CELL_M),
            sun_visibility: 1.0,
            sky_visibility: 1.0,
            water: (0.5 - 0.5 * at.y / CELL_M).clamp(0.0, 0.9),
        }
    };
    let posts: Vec<GroundPost> = (0..SIDE * SIDE).map(post).collect();
    let (red, green) = (Srgba::opaque(150, 40, 30), Srgba::opaque(30, 120, 40));
    let stops = vec![(LEVEL_M, red), (LEVEL_M + 22.0, red), (LEVEL_M + 28.0, green)];
    let mut mesh = DrawMesh::default();
    for (index, post) in (0..).zip(&posts) {
        let at = Vec2::new((index % SIDE) as f32, (index / SIDE) as f32) * CELL_M - HALF_M;
        mesh.vertex(DrawVertex {
            position: at.extend(post.height_m).into(),
            normal: [0.0, 0.0, 1.0],
            uv: [0.0; 2],
            color: Srgba::WHITE,
        });
    }
    let id = |column: u32, row: u32| VertexId::new((row * SIDE + column) as usize);
    for (x, y) in (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y))) {
        mesh.triangle([id(x, y), id(x + 1, y), id(x + 1, y + 1)]);
        mesh.triangle([id(x, y), id(x + 1, y + 1), id(x, y + 1)]);
    }
    let map = GroundMap {
        origin: Vec2::splat(-HALF_M),
        cell: Vec2::splat(CELL_M),
        columns: SIDE,
        rows: SIDE,
        posts,
        ramp: ColorRamp::new(stops).expect("rising stops"),
        shade_gain: ReliefShading::GAIN,
        detail: ReliefShading::DETAIL,
        ..GroundMap::level()
    };
    let haze = Haze { near_m: 300.0, distance_m: 6000.0, ..Lighting::default().haze };
    let mut list = DrawList {
        ground: Some(Arc::new(map)),
        // From overhead: the slope faces away from a sun in the north-west.
        lighting: Lighting { haze, to_sun: Vec3::Z, ..Lighting::default() },
        ..DrawList::default()
    };
    let triangles = 0..mesh.triangles.len() as u32;
    let material =
        Material { normals: NormalSource::Ground, albedo: Albedo::GroundMap, ..Material::default() };
    let item = DrawItem {
        mesh: list.add_mesh(mesh),
        triangles,
        material: list.add_material(material),
        world_from_mesh: Mat4::IDENTITY,
        layer: DepthLayer::Ground,
        feature: FeatureId::GROUND,
    };
    list.items.push(item);
    list
}

/// A camera 20 m over the lake, 600 m from the shore, that looks at it.
pub fn low_over_water(size: (u32, u32)) -> Camera {
    let eye = Vec3::new(0.0, -600.0, LEVEL_M + 20.0);
    Camera::new(eye, eye + Vec3::Y, 0.8, size, (0.5, 10_000.0)).expect("a sound camera")
}
