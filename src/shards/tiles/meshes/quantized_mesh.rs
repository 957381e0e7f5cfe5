//! The bytes of a tile: quantized-mesh 1.0 (Cesium, *quantized-mesh-1.0 terrain format*).
//!
//! ```text
//! header: center, heights, bounding sphere, horizon point │ u, v, height of vertices │ triangles │ west, south, east, north
//! ```
//!
//! All posts are vertices, so that neighbors share those along their edges. A post's coordinates count 32767 steps across the
//! tile and across the heights of all tiles.

use glam::{DVec2, DVec3};

use crate::tiles::meshes::posts::{POSTS, posts};
use crate::tiles::tiling::TileAddress;

/// The greatest coordinate in a tile.
const MOST: u16 = 32_767;
/// Half axes of the WGS 84 ellipsoid in meters.
const AXES_M: DVec3 = DVec3::new(6_378_137.0, 6_378_137.0, 6_356_752.314_245_179);

/// The tile with these heights of its posts, row by row from the south-west; `[low, high]` are the heights of coordinate 0
/// and the greatest, low below high. Heights beyond them count as the nearest.
pub fn tile_bytes(tile: TileAddress, heights: &[f64], [low, high]: [f32; 2]) -> Vec<u8> {
    let steps = f64::from(MOST) / (f64::from(high) - f64::from(low));
    let quantized =
        |&height: &f64| libm::round((height - f64::from(low)) * steps).clamp(0.0, f64::from(MOST)) as u16;
    let heights: Vec<u16> = heights.iter().map(quantized).collect();
    let height_m = |height: u16| f64::from(low) + f64::from(height) / steps;
    let positions: Vec<DVec3> =
        posts(tile).iter().zip(&heights).map(|(&at, &height)| ecef(at, height_m(height))).collect();
    let MeshOrder { order, place, triangles } = MeshOrder::of_posts();
    let mut bytes = header(&positions, [low, high]);
    bytes.extend((order.len() as u32).to_le_bytes());
    let across = |step: usize| ((step * usize::from(MOST) * 2 + (POSTS - 1)) / (2 * (POSTS - 1))) as u16;
    let coordinates: [&dyn Fn(usize) -> u16; 3] =
        [&|post| across(post % POSTS), &|post| across(post / POSTS), &|post| heights[post]];
    for coordinate in coordinates {
        let mut before = 0;
        for &post in &order {
            let value = coordinate(post);
            bytes.extend(zigzag(i32::from(value) - i32::from(before)).to_le_bytes());
            before = value;
        }
    }
    bytes.extend((triangles.len() as u32 / 3).to_le_bytes());
    let mut highest = 0u16;
    for index in triangles {
        bytes.extend((highest - index).to_le_bytes());
        highest += u16::from(index == highest);
    }
    let last = POSTS - 1;
    let edges: [&dyn Fn(usize) -> usize; 4] =
        [&|post| post * POSTS, &|post| post, &|post| post * POSTS + last, &|post| last * POSTS + post];
    for edge in edges {
        bytes.extend((POSTS as u32).to_le_bytes());
        bytes.extend((0..POSTS).flat_map(|post| place[edge(post)].to_le_bytes()));
    }
    bytes
}

/// Small numbers of either sign as small numbers.
fn zigzag(value: i32) -> u16 {
    ((value << 1) ^ (value >> 31)) as u16
}

/// The posts of a tile in the order in which its triangles use them first, which their indices must follow.
struct MeshOrder {
    /// The post of each vertex.
    order: Vec<usize>,
    /// The vertex of each post.
    place: Vec<u16>,
    /// Vertices, three a triangle, counterclockwise from above.
    triangles: Vec<u16>,
}

impl MeshOrder {
    fn of_posts() -> Self {
        let mut order = Vec::new();
        let mut place = vec![None; POSTS * POSTS];
        let mut triangles = Vec::new();
        for (row, column) in (0..POSTS - 1).flat_map(|row| (0..POSTS - 1).map(move |column| (row, column))) {
            let south_west = row * POSTS + column;
            let [sw, se, nw, ne] = [south_west, south_west + 1, south_west + POSTS, south_west + POSTS + 1];
            // Diagonals alternate, as those of the ground do.
            let corners =
                if (row + column) % 2 == 0 { [sw, se, ne, sw, ne, nw] } else { [sw, se, nw, se, ne, nw] };
            for post in corners {
                let vertex = *place[post].get_or_insert_with(|| {
                    order.push(post);
                    order.len() as u16 - 1
                });
                triangles.push(vertex);
            }
        }
        let place =
            place.into_iter().map(|vertex| vertex.expect("every post is a corner of a cell")).collect();
        Self { order, place, triangles }
    }
}

fn header(positions: &[DVec3], range: [f32; 2]) -> Vec<u8> {
    let (min, max) = positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &at| (min.min(at), max.max(at)));
    let center = (min + max) / 2.0;
    let radius = positions.iter().map(|at| at.distance(center)).fold(0.0, f64::max);
    let mut bytes: Vec<u8> = center.to_array().into_iter().flat_map(f64::to_le_bytes).collect();
    bytes.extend(range.into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(center.to_array().into_iter().flat_map(f64::to_le_bytes));
    bytes.extend(radius.to_le_bytes());
    bytes.extend(horizon_point(positions, center).to_array().into_iter().flat_map(f64::to_le_bytes));
    bytes
}

/// Meters from the Earth's center of a place in degrees, so many meters above the ellipsoid.
fn ecef(at: DVec2, height_m: f64) -> DVec3 {
    let (lon, lat) = (at.x.to_radians(), at.y.to_radians());
    let normal = DVec3::new(libm::cos(lat) * libm::cos(lon), libm::cos(lat) * libm::sin(lon), libm::sin(lat));
    let scaled = AXES_M * AXES_M * normal;
    let length = normal.dot(scaled).sqrt();
    scaled / length + normal * height_m
}

/// The point along the direction of `center`, in a space where the ellipsoid is the unit sphere, that is behind the horizon
/// only where all `positions` are (Cozzi and Ring 2011, *3D Engine Design for Virtual Globes*).
fn horizon_point(positions: &[DVec3], center: DVec3) -> DVec3 {
    let direction = (center / AXES_M).normalize_or_zero();
    let magnitude = |&at: &DVec3| {
        let at = at / AXES_M;
        // Points below the ellipsoid count as on it.
        let squared = at.length_squared().max(1.0);
        let length = squared.sqrt();
        let unit = at.normalize_or_zero();
        let cos_a = unit.dot(direction).clamp(-1.0, 1.0);
        let sin_a = unit.cross(direction).length();
        let (cos_b, sin_b) = (1.0 / length, (squared - 1.0).sqrt() / length);
        1.0 / (cos_a * cos_b - sin_a * sin_b)
    };
    let magnitudes: Vec<f64> = positions.iter().map(magnitude).collect();
    // A tile that reaches round the horizon of its own middle is behind none.
    let is_behind_none = magnitudes.iter().any(|magnitude| magnitude.is_nan() || *magnitude <= 0.0);
    let farthest = magnitudes.iter().copied().fold(1.0, f64::max);
    direction * if is_behind_none { 1e9 } else { farthest }
}
