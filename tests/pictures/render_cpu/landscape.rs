//! A small landscape made by formula: hills, a ground map, a road cut to the ground's triangles, boxes.

use glam::{DVec2, Mat4, Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::{ColorRamp, Contours, GroundMap, GroundPost};
use sandtable_draw::lighting::{Haze, Lighting, ReliefShading};
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource};
use sandtable_draw::pixels::Pixels;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// Half the side of the landscape in meters.
pub const HALF_M: f32 = 9_000.0;
/// The road's feature.
pub const ROAD: FeatureId = FeatureId(2);
/// The boxes' feature.
pub const BOX: FeatureId = FeatureId(3);
/// The forest's feature.
pub const FOREST: FeatureId = FeatureId(4);

/// The height of the hills in meters.
pub fn height(x: f32, y: f32) -> f32 {
    let wave = |length: f32, phase: f32| libm::sinf((x * phase + y * (1.0 - phase)) / length);
    let ridges = 1.0 - libm::fabsf(libm::sinf(x / 2100.0 + 0.4 * libm::sinf(y / 1700.0)));
    260.0 * ridges * ridges
        + 150.0 * wave(1300.0, 0.7) * wave(1700.0, -0.6)
        + 35.0 * wave(310.0, 0.3) * wave(270.0, 1.2)
        + 6.0 * wave(90.0, 0.1) * wave(70.0, 0.8)
}

/// A corner with an upward normal.
pub fn vertex(position: Vec3, uv: Vec2) -> DrawVertex {
    DrawVertex { position: position.into(), normal: [0.0, 0.0, 1.0], uv: uv.into(), color: Srgba::WHITE }
}

/// One item with all triangles of `mesh` where it stands.
pub fn item(list: &mut DrawList, mesh: DrawMesh, material: Material, layer: DepthLayer, feature: FeatureId) {
    let triangles = 0..mesh.triangles.len() as u32;
    let item = DrawItem {
        mesh: list.add_mesh(mesh),
        triangles,
        material: list.add_material(material),
        world_from_mesh: Mat4::IDENTITY,
        layer,
        feature,
    };
    list.items.push(item);
}

/// A square grid of `cells`² pairs of triangles on `height`.
pub fn ground_mesh(cells: usize, half_m: f32, height: impl Fn(f32, f32) -> f32) -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let step = 2.0 * half_m / cells as f32;
    for row in 0..=cells {
        for column in 0..=cells {
            let (x, y) = (column as f32 * step - half_m, row as f32 * step - half_m);
            mesh.vertex(vertex(Vec3::new(x, y, height(x, y)), Vec2::ZERO));
        }
    }
    let id = |column: usize, row: usize| VertexId::new(row * (cells + 1) + column);
    for row in 0..cells {
        for column in 0..cells {
            let [a, b] = [id(column, row), id(column + 1, row)];
            let [c, d] = [id(column, row + 1), id(column + 1, row + 1)];
            mesh.triangle([a, b, d]);
            mesh.triangle([a, d, c]);
        }
    }
    mesh
}

/// A ground map of `side`² posts on `height`, with a hypsometric ramp.
pub fn ground_map(side: u32, half_m: f32, contours: bool, height: impl Fn(f32, f32) -> f32) -> GroundMap {
    let cell = 2.0 * half_m / (side - 1) as f32;
    let post = |index: u32| {
        let (x, y) = ((index % side) as f32 * cell - half_m, (index / side) as f32 * cell - half_m);
        let rise = |dx: f32, dy: f32| (height(x + dx, y + dy) - height(x - dx, y - dy)) / (2.0 * cell);
        GroundPost {
            height_m: height(x, y),
            slope_east: rise(cell, 0.0),
            slope_north: rise(0.0, cell),
            sun_visibility: 1.0,
            sky_visibility: 1.0,
            water: 0.0,
        }
    };
    let stops = [
        (-150.0, Srgba::opaque(88, 140, 90)),
        (0.0, Srgba::opaque(150, 180, 110)),
        (120.0, Srgba::opaque(222, 208, 150)),
        (260.0, Srgba::opaque(190, 150, 100)),
        (420.0, Srgba::opaque(235, 230, 225)),
    ];
    GroundMap {
        origin: Vec2::splat(-half_m),
        cell: Vec2::splat(cell),
        z_per_m: 1.0,
        columns: side,
        rows: side,
        posts: (0..side * side).map(post).collect(),
        ramp: ColorRamp::new(stops.to_vec()).expect("rising stops"),
        contours: contours.then_some(Contours {
            interval_m: 20.0,
            major_every: 5,
            color: Srgba([90, 60, 30, 190]),
            width_px: 1.2,
            lit: None,
        }),
        imagery: None,
        cover: None,
        halvings: 0,
        is_curved: false,
        form_level: 3,
        z_factor: 1.0,
        shade_gain: ReliefShading::GAIN,
        detail: ReliefShading::DETAIL,
        has_grain: false,
    }
}

/// The ground's material.
pub fn ground_material() -> Material {
    Material { normals: NormalSource::Ground, albedo: Albedo::GroundMap, ..Material::default() }
}

/// A draped material with a texture or without.
pub fn draped_material(base_color: Srgba) -> Material {
    Material { base_color, normals: NormalSource::Ground, ..Material::default() }
}

/// The strip of `half_width` meters around the line through `center`, cut to the triangles of `ground`.
///
/// V runs along the strip in units of four half widths, U across it.
pub fn draped_strip(ground: &DrawMesh, center: &[DVec2], half_width: f64) -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let mut station = 0.0;
    for pair in center.windows(2) {
        let along = (pair[1] - pair[0]).normalize();
        let side = along.perp() * half_width;
        let quad = [pair[0] - side, pair[1] - side, pair[1] + side, pair[0] + side];
        let uv = |at: DVec2| {
            let from = at - pair[0];
            let across = from.dot(side) / (2.0 * half_width * half_width) + 0.5;
            Vec2::new(across as f32, ((station + from.dot(along)) / (4.0 * half_width)) as f32)
        };
        let (low, high) = quad.iter().fold((DVec2::MAX, DVec2::MIN), |(a, b), &p| (a.min(p), b.max(p)));
        for corners in &ground.triangles {
            let corners = corners.map(|id| Vec3::from(ground.vertices[id.index()].position).as_dvec3());
            let flat = corners.map(|corner| corner.truncate());
            let outside = flat.iter().all(|p| p.x < low.x)
                || flat.iter().all(|p| p.x > high.x)
                || flat.iter().all(|p| p.y < low.y)
                || flat.iter().all(|p| p.y > high.y);
            if outside {
                continue;
            }
            let polygon = (0..3).fold(quad.to_vec(), |left, i| cut(&left, flat[i], flat[(i + 1) % 3]));
            let ids: Vec<_> =
                polygon.iter().map(|&at| mesh.vertex(vertex(lifted(at, corners), uv(at)))).collect();
            for i in 2..ids.len() {
                mesh.triangle([ids[0], ids[i - 1], ids[i]]);
            }
        }
        station += (pair[1] - pair[0]).length();
    }
    mesh
}

/// The part of a polygon to the left of the line from `a` to `b`.
fn cut(polygon: &[DVec2], a: DVec2, b: DVec2) -> Vec<DVec2> {
    let side = |p: DVec2| (b - a).perp_dot(p - a);
    let mut left = Vec::new();
    for (i, &here) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (from, to) = (side(here), side(next));
        if from >= 0.0 {
            left.push(here);
        }
        if (from >= 0.0) != (to >= 0.0) {
            left.push(here + (next - here) * (from / (from - to)));
        }
    }
    left
}

/// The point of the triangle's plane above or below `at`.
fn lifted(at: DVec2, [a, b, c]: [glam::DVec3; 3]) -> Vec3 {
    let normal = (b - a).cross(c - a);
    let rise = normal.truncate().dot(at - a.truncate()) / normal.z;
    at.extend(a.z - rise).as_vec3()
}

/// A box on the ground, with one texture repeat on each side and outward normals.
pub fn box_mesh(foot: Vec3, size: Vec3) -> DrawMesh {
    let mut mesh = DrawMesh::default();
    for axis in 0..3 {
        for sign in [-1.0f32, 1.0] {
            let mut normal = Vec3::ZERO;
            normal[axis] = sign;
            let (u, v) = if axis == 2 { (Vec3::X, Vec3::Y * sign) } else { (Vec3::Z.cross(normal), Vec3::Z) };
            let middle = foot + size * 0.5 * Vec3::Z;
            let corner = |s: f32, t: f32| {
                let position = middle + (normal + u * s + v * t) * size * 0.5;
                let uv = [s * 0.5 + 0.5, 0.5 - t * 0.5];
                DrawVertex { position: position.into(), normal: normal.into(), uv, color: Srgba::WHITE }
            };
            let ids =
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(s, t)| mesh.vertex(corner(s, t)));
            mesh.triangle([ids[0], ids[1], ids[2]]);
            mesh.triangle([ids[0], ids[2], ids[3]]);
        }
    }
    mesh
}

/// Windows on a wall.
pub fn wall_texture() -> Pixels {
    Pixels::from_fn(64, 64, |x, y| {
        let window = (x / 8) % 2 == 1 && (y / 8) % 2 == 1;
        if window { Srgba::opaque(60, 70, 90) } else { Srgba::opaque(205, 190, 170) }
    })
}

/// Asphalt with a white middle line, broken, and border lines.
pub fn road_texture() -> Pixels {
    Pixels::from_fn(64, 64, |x, y| {
        let border = (3..6).contains(&x) || (58..61).contains(&x);
        let middle = (30..34).contains(&x) && y < 32;
        if border || middle { Srgba::opaque(235, 235, 230) } else { Srgba::opaque(90, 90, 95) }
    })
}

/// The whole landscape with `cells`² pairs of ground triangles.
pub fn landscape(cells: usize) -> DrawList {
    let lighting = Lighting::default();
    let mut list = DrawList {
        ground: Some(ground_map(901, HALF_M, true, height).into()),
        lighting: Lighting { haze: Haze { distance_m: 14_000.0, ..lighting.haze }, ..lighting },
        ..DrawList::default()
    };
    let ground = ground_mesh(cells, HALF_M, height);
    let line: Vec<_> = (0..80)
        .map(|i| {
            let y = -8_500.0 + 210.0 * f64::from(i);
            DVec2::new(500.0 * libm::sin(y / 900.0), y)
        })
        .collect();
    let road = draped_strip(&ground, &line, 12.0);
    let forest = draped_strip(&ground, &[DVec2::new(-2500.0, -5200.0), DVec2::new(-900.0, -3600.0)], 450.0);
    item(&mut list, ground, ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    let leaves = Material { alpha: AlphaMode::Blend, ..draped_material(Srgba([20, 90, 40, 150])) };
    item(&mut list, forest, leaves, DepthLayer::Draped(1), FOREST);
    let texture = Some(list.add_texture(road_texture()));
    item(&mut list, road, Material { texture, ..draped_material(Srgba::WHITE) }, DepthLayer::Draped(2), ROAD);
    let texture = Some(list.add_texture(wall_texture()));
    for (x, y) in [(60.0, -8_050.0), (-90.0, -7_900.0), (150.0, -7_600.0), (-120.0, -6_900.0)] {
        let foot = Vec3::new(x, y, height(x, y) - 6.0);
        let mesh = box_mesh(foot, Vec3::new(40.0, 25.0, 30.0));
        item(&mut list, mesh, Material { texture, ..Material::default() }, DepthLayer::Solid, BOX);
    }
    list
}
