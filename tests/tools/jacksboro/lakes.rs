//! The lakes that the elevation model holds: its perfectly flat patches, and the shore round each.
//!
//! SRTM's editors set standing water to one whole number of meters. So a lake begins as the connected patch
//! of posts with exactly that number, grown from a post that is known to be water. It is then filled to the
//! level at which it is drawn: posts up to that level that hang together with the patch are flooded too. The
//! shore is the contour at the level, by marching squares with linear interpolation (Lorensen & Cline 1987,
//! in two dimensions), so that the water meets the ground there and stands clear of the posts beneath.
//!
//! Ground lower than the flat patch lies behind a dam. It counts as high ground, so that neither flood nor
//! shore spills down the valley.

use glam::DVec2;

use super::ground::Ground;
use super::line;

/// A known lake: longitude and latitude of a post that is surely water, the level in meters, the name.
///
/// Norris Lake is drawn at its full summer pool, 1,020 feet; the radar saw it in February 2000, at its winter
/// pool, six meters lower. It enters the tile in two arms, whose confluence lies just outside. Cove Lake is
/// drawn as the radar saw it, a little fuller.
const KNOWN: [(f64, f64, f64, &str); 3] = [
    (-84.0889, 36.2285, 310.9, "Norris Lake"),
    (-84.0785, 36.2592, 310.9, "Norris Lake"),
    (-84.2140, 36.3030, 312.5, "Cove Lake"),
];
/// How much of the shore's detail is dropped, in meters: a tenth of the distance between posts.
const SHORE_DETAIL_M: f64 = 8.0;
/// The least area of an island in square meters; smaller ones are noise of single posts.
const ISLAND_M2: f64 = 20_000.0;
/// Elevation given to posts that stand for "not this water", in meters above the level.
const WALL_M: f64 = 4.0;

/// The lakes and which posts are theirs.
pub struct Lakes {
    /// Each lake's shore.
    pub lakes: Vec<Lake>,
    /// Whether a post is water.
    pub water: Vec<bool>,
}

/// One lake.
pub struct Lake {
    /// Its name.
    pub name: &'static str,
    /// The level at which it is drawn, in meters.
    pub level: f64,
    /// The outer shore, counter-clockwise, then islands, clockwise; rings are not closed.
    pub rings: Vec<Vec<DVec2>>,
    /// Area in square meters.
    pub area: f64,
}

/// Finds all known lakes.
pub fn find(ground: &Ground) -> Lakes {
    let mut water = vec![false; ground.z.len()];
    let mut lakes = Vec::new();
    for (lon, lat, level, name) in KNOWN {
        let seed = ground.post_at(ground.locate(lon, lat));
        let flat = ground.z[seed];
        let patch = flood(ground, seed, flat, level);
        assert!(patch.len() > 20, "{name} has no flat patch at its seed, where the ground is at {flat} m");
        patch.iter().for_each(|&post| water[post] = true);
        let rings = shore(ground, &patch, flat, level);
        let area = rings.iter().map(|ring| line::signed_area(ring)).sum();
        lakes.push(Lake { name, level, rings, area });
    }
    Lakes { lakes, water }
}

/// The posts from `flat` to `level` that hang together with the seed by sides and corners.
fn flood(ground: &Ground, seed: usize, flat: f64, level: f64) -> Vec<usize> {
    let mut seen = vec![false; ground.z.len()];
    let mut patch = vec![seed];
    seen[seed] = true;
    let mut next = 0;
    while next < patch.len() {
        let post = patch[next];
        next += 1;
        for (neighbor, _) in ground.neighbors(post) {
            if !seen[neighbor] && (flat..=level).contains(&ground.z[neighbor]) {
                seen[neighbor] = true;
                patch.push(neighbor);
            }
        }
    }
    patch
}

/// The shore of a patch: its longest ring and the islands within.
fn shore(ground: &Ground, patch: &[usize], flat: f64, level: f64) -> Vec<Vec<DVec2>> {
    let field = Field::around(ground, patch, flat, level);
    let mut rings: Vec<Vec<DVec2>> = field
        .rings(level)
        .into_iter()
        .map(|ring| line::simplify_ring(&line::cut_corners_ring(&ring), SHORE_DETAIL_M))
        .collect();
    rings.sort_by(|a, b| line::signed_area(b).total_cmp(&line::signed_area(a)));
    let outer = line::signed_area(&rings[0]);
    assert!(outer > 0.0, "the outer shore runs counter-clockwise");
    rings.retain(|ring| {
        let area = line::signed_area(ring);
        area == outer || -area >= ISLAND_M2
    });
    rings
}

/// Elevations round a patch with a wall along the raster's edge, in which only the patch is low.
struct Field {
    width: usize,
    height: usize,
    z: Vec<f64>,
    origin: DVec2,
    post_m: DVec2,
}

impl Field {
    fn around(ground: &Ground, patch: &[usize], flat: f64, level: f64) -> Self {
        let (width, height) = (ground.width + 2, ground.height + 2);
        let mut z = vec![level + WALL_M; width * height];
        let mut near = vec![false; ground.z.len()];
        for &post in patch {
            near[post] = true;
            ground.neighbors(post).for_each(|(neighbor, _)| near[neighbor] = true);
        }
        for (post, _) in near.iter().enumerate().filter(|(_, near)| **near) {
            let inside = (post / ground.width + 1) * width + post % ground.width + 1;
            let behind_dam = ground.z[post] < flat;
            z[inside] = if behind_dam { level + WALL_M } else { ground.z[post] };
        }
        let origin = ground.place(0) + DVec2::new(-1.0, 1.0) * ground.post_m;
        Self { width, height, z, origin, post_m: ground.post_m }
    }

    /// Closed contours at `level`, the low side on the left, so that the shore of water runs
    /// counter-clockwise. No post stands at the level itself: elevations are whole meters, levels are not.
    fn rings(&self, level: f64) -> Vec<Vec<DVec2>> {
        // One contour leaves through every crossed lattice edge; edges are numbered 2·post (east) + 1 (south).
        let mut next = vec![usize::MAX; 2 * self.z.len()];
        for row in 0..self.height - 1 {
            for column in 0..self.width - 1 {
                self.cell(row * self.width + column, level, &mut next);
            }
        }
        let mut rings = Vec::new();
        for start in 0..next.len() {
            let mut ring = Vec::new();
            let mut edge = start;
            while next[edge] != usize::MAX {
                ring.push(self.crossing(edge, level));
                edge = std::mem::replace(&mut next[edge], usize::MAX);
            }
            if ring.len() >= 3 {
                rings.push(ring);
            }
        }
        rings
    }

    /// Links the edges of one cell of four posts. In a saddle the low corners are joined, as water would be.
    fn cell(&self, post: usize, level: f64, next: &mut [usize]) {
        let corners = [post, post + 1, post + self.width + 1, post + self.width];
        let sides = [2 * post, 2 * (post + 1) + 1, 2 * (post + self.width), 2 * post + 1];
        let low = corners.map(|corner| self.z[corner] < level);
        // Round the cell clockwise as seen with rows going down; the contour comes in where high turns to
        // low and goes out where low turned to high, so that it keeps the low side on its left.
        for (entry, &side) in sides.iter().enumerate() {
            if low[entry] && !low[(entry + 1) % 4] {
                let turns = (1..4).map(|turn| (entry + turn) % 4);
                let exit = turns.into_iter().find(|&exit| !low[exit] && low[(exit + 1) % 4]);
                next[sides[exit.expect("what turns high turns low again")]] = side;
            }
        }
    }

    fn crossing(&self, edge: usize, level: f64) -> DVec2 {
        let from = edge / 2;
        let to = if edge.is_multiple_of(2) { from + 1 } else { from + self.width };
        let part = (level - self.z[from]) / (self.z[to] - self.z[from]);
        let place = |post: usize| {
            self.origin + DVec2::new((post % self.width) as f64, -((post / self.width) as f64)) * self.post_m
        };
        place(from).lerp(place(to), part)
    }
}
