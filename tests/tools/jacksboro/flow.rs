//! Where water runs: depressions filled by Priority-Flood, then eight flow directions and accumulation.
//!
//! Barnes, Lehman & Mulla (2014) flood the raster inward from its edge, always from the lowest post reached
//! so far; a post's filled elevation is the higher of its own and that of the post it was reached from.
//! O'Callaghan & Mark (1984) let every post drain to its steepest lower neighbor. In a filled depression
//! there is none: there a post drains to the one it was reached from. Posts of equal filled elevation are
//! taken in the order of their raw elevation, so that in a depression the flow keeps to its lowest line
//! rather than crossing it straight. Each step goes to a lower filled elevation or to an earlier post, so
//! the directions cannot form a ring.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::ground::Ground;

/// A post with no way down.
pub const NONE: usize = usize::MAX;
/// Where a river enters that gathers its water outside the tile: longitude, latitude, square kilometers.
///
/// The Clinch appears below Norris Dam, leaves the tile for a bend, and comes back. The Tennessee Valley
/// Authority gives the catchment at the dam as 2,912 square miles.
const INFLOWS: [(f64, f64, f64); 2] = [(-84.0905, 36.2215, 7_542.0), (-84.0785, 36.2068, 7_545.0)];
/// The stretch of the eastern edge where the Clinch comes back, from south to north: no outlet.
const NO_OUTLET: (f64, f64) = (36.1980, 36.2105);

/// Flow over the ground.
pub struct Flow {
    /// Elevation after filling, never below the raw one.
    pub filled: Vec<f64>,
    /// The post that each post drains to; [`NONE`] at outlets.
    pub down: Vec<usize>,
    /// Area drained through each post, its own included, in square kilometers.
    pub area_km2: Vec<f64>,
    /// All posts, outlets first: every post comes after the one it drains to.
    pub order: Vec<usize>,
}

/// What waits in the flood's queue, lowest first; elevations in millimeters so that they have a total order.
type Waiting = Reverse<(i64, i64, usize)>;

impl Flow {
    /// Floods the ground from its edge. Water that touches the edge is no outlet: it lies behind its dam.
    pub fn over(ground: &Ground, water: &[bool]) -> Self {
        let count = ground.z.len();
        let mut flow = Self {
            filled: ground.z.clone(),
            down: vec![NONE; count],
            area_km2: vec![0.0; count],
            order: Vec::with_capacity(count),
        };
        flow.flood(ground, water);
        flow.descend(ground);
        flow.accumulate(ground);
        flow
    }

    fn flood(&mut self, ground: &Ground, water: &[bool]) {
        let mut reached = vec![false; ground.z.len()];
        let mut queue: BinaryHeap<Waiting> = BinaryHeap::new();
        for post in (0..ground.z.len()).filter(|&post| is_outlet(ground, post) && !water[post]) {
            reached[post] = true;
            queue.push(waiting(ground.z[post], ground.z[post], post));
        }
        while let Some(Reverse((_, _, post))) = queue.pop() {
            for (neighbor, _) in ground.neighbors(post) {
                if !std::mem::replace(&mut reached[neighbor], true) {
                    self.down[neighbor] = post;
                    self.filled[neighbor] = ground.z[neighbor].max(self.filled[post]);
                    queue.push(waiting(self.filled[neighbor], ground.z[neighbor], neighbor));
                }
            }
        }
    }

    /// Replaces the way the flood came by the steepest descent, wherever there is one.
    fn descend(&mut self, ground: &Ground) {
        for post in 0..ground.z.len() {
            if self.down[post] == NONE {
                continue;
            }
            let slope = |&(neighbor, far): &(usize, f64)| (self.filled[post] - self.filled[neighbor]) / far;
            let steepest = ground.neighbors(post).max_by(|a, b| slope(a).total_cmp(&slope(b)));
            if let Some(lower) = steepest.filter(|lower| slope(lower) > 0.0) {
                self.down[post] = lower.0;
            }
        }
    }

    fn accumulate(&mut self, ground: &Ground) {
        let (donors, starts) = donors(&self.down);
        self.order = (0..self.down.len()).filter(|&post| self.down[post] == NONE).collect();
        let mut next = 0;
        while next < self.order.len() {
            let post = self.order[next];
            self.order.extend_from_slice(&donors[starts[post]..starts[post + 1]]);
            next += 1;
        }
        assert_eq!(self.order.len(), self.down.len(), "flow directions form no ring");
        self.area_km2.fill(ground.post_m.x * ground.post_m.y / 1e6);
        for (lon, lat, area) in INFLOWS {
            self.area_km2[ground.post_at(ground.locate(lon, lat))] += area;
        }
        for &post in self.order.iter().rev() {
            if self.down[post] != NONE {
                self.area_km2[self.down[post]] += self.area_km2[post];
            }
        }
    }
}

/// Whether water may leave the tile at a post.
fn is_outlet(ground: &Ground, post: usize) -> bool {
    let eastern = post % ground.width + 1 == ground.width;
    let latitude = ground.lon_lat(ground.place(post)).y;
    ground.on_edge(post) && !(eastern && (NO_OUTLET.0..NO_OUTLET.1).contains(&latitude))
}

/// The posts that drain to each post: a flat list and where each post's part of it starts.
fn donors(down: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut starts = vec![0; down.len() + 2];
    down.iter().filter(|&&to| to != NONE).for_each(|&to| starts[to + 2] += 1);
    for at in 2..starts.len() {
        starts[at] += starts[at - 1];
    }
    let mut list = vec![0; starts[down.len() + 1]];
    for (post, &to) in down.iter().enumerate().filter(|(_, to)| **to != NONE) {
        list[starts[to + 1]] = post;
        starts[to + 1] += 1;
    }
    (list, starts)
}

fn waiting(filled: f64, raw: f64, post: usize) -> Waiting {
    let millimeters = |elevation: f64| (elevation * 1e3).round() as i64;
    Reverse((millimeters(filled), millimeters(raw), post))
}
