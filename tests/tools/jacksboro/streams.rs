//! Streams: flow lines that drain enough ground, split at their confluences, ordered and smoothed.
//!
//! The orders are Strahler's (1957): a spring has order 1, and where two streams of the same order meet, the
//! next has one more. A flow line on posts zigzags; a weighted average on a short leash and one round of
//! Chaikin's corner cutting take the zigzag out without leaving the valley floor.

use glam::DVec2;

use super::flow::{Flow, NONE};
use super::ground::Ground;
use super::line;

/// Ground that a stream must drain, in square kilometers: about two hours' walk round its catchment.
const THRESHOLD_KM2: f64 = 3.0;
/// A river that drains this much, in square kilometers, comes from outside the tile with its order: that of
/// the Clinch on a map of this scale.
const RIVER_KM2: f64 = 5_000.0;
/// Its order.
const RIVER_ORDER: u32 = 5;
/// Springs shorter than this are left out, in meters: they read as thorns on the stream.
const SHORTEST_SPRING_M: f64 = 700.0;
/// How far smoothing may move a vertex, in meters: less than the distance between posts.
const LEASH_M: f64 = 55.0;
/// How often the line is averaged.
const PASSES: usize = 6;
/// How much detail is dropped, in meters.
const DETAIL_M: f64 = 6.0;
/// Streams that are known by name: longitude and latitude of a place on them, and the name, which holds from
/// there down to the next larger stream. Upstream it is not carried: the drained area, as far as it lies in
/// the tile, does not tell which branch people call by the name. A tributary comes before the river it
/// joins, so that the river's name holds below the confluence.
const NAMED: [(f64, f64, &str); 6] = [
    (-84.1800, 36.1870, "Coal Creek"),
    (-84.2620, 36.3570, "Cove Creek"),
    (-84.1270, 36.3920, "Big Creek"),
    (-84.3360, 36.2370, "New River"),
    (-84.0900, 36.2210, "Clinch River"),
    (-84.0790, 36.2068, "Clinch River"),
];

/// One stretch of stream between confluences.
pub struct Stream {
    /// Its course, downstream.
    pub points: Vec<DVec2>,
    /// Strahler order.
    pub order: u32,
    /// Area drained at its lower end, in square kilometers, as far as it lies in the tile.
    pub area_km2: f64,
    /// Its name where it is known.
    pub name: Option<&'static str>,
}

/// All streams outside standing water, in the order of their uppermost posts.
pub fn trace(ground: &Ground, flow: &Flow, water: &[bool]) -> Vec<Stream> {
    let channel = channels(ground, flow);
    let order = strahler(flow, &channel);
    let names = names(ground, flow, &channel);
    let mut streams = Vec::new();
    let feeders = feeders(flow, &channel);
    for head in heads(flow, &channel, &feeders, water) {
        let posts = stretch(flow, &feeders, water, head);
        if posts.len() < 2 || joins_water(flow, water, &posts) {
            continue;
        }
        let inner = posts[posts.len() - 2];
        let places: Vec<DVec2> = posts.iter().map(|&post| ground.place(post)).collect();
        let points = line::cut_corners(&line::smooth(&places, PASSES, LEASH_M));
        streams.push(Stream {
            points: line::simplify(&points, DETAIL_M),
            order: order[inner],
            area_km2: flow.area_km2[inner],
            name: names[inner],
        });
    }
    streams
}

/// Which posts carry a stream: all that drain enough, but for short springs.
fn channels(ground: &Ground, flow: &Flow) -> Vec<bool> {
    let mut channel: Vec<bool> = flow.area_km2.iter().map(|&area| area >= THRESHOLD_KM2).collect();
    let feeders = feeders(flow, &channel);
    let springs: Vec<usize> =
        (0..channel.len()).filter(|&post| channel[post] && feeders[post] == 0).collect();
    for head in springs {
        let mut spring = vec![head];
        let mut long = 0.0;
        let mut post = flow.down[head];
        while post != NONE && feeders[post] < 2 {
            long += ground.place(post).distance(ground.place(spring[spring.len() - 1]));
            spring.push(post);
            post = flow.down[post];
        }
        if long < SHORTEST_SPRING_M {
            spring.iter().for_each(|&post| channel[post] = false);
        }
    }
    channel
}

/// How many channel posts drain to each post.
fn feeders(flow: &Flow, channel: &[bool]) -> Vec<u32> {
    let mut feeders = vec![0; channel.len()];
    for post in (0..channel.len()).filter(|&post| channel[post] && flow.down[post] != NONE) {
        feeders[flow.down[post]] += 1;
    }
    feeders
}

fn strahler(flow: &Flow, channel: &[bool]) -> Vec<u32> {
    let mut order = vec![0u32; channel.len()];
    let mut seconds = vec![false; channel.len()];
    for &post in flow.order.iter().rev().filter(|&&post| channel[post]) {
        if flow.area_km2[post] >= RIVER_KM2 {
            order[post] = order[post].max(RIVER_ORDER);
        }
        order[post] = if seconds[post] { order[post] + 1 } else { order[post].max(1) };
        let down = flow.down[post];
        if down != NONE {
            seconds[down] =
                if order[post] == order[down] { true } else { seconds[down] && order[post] < order[down] };
            order[down] = order[down].max(order[post]);
        }
    }
    order
}

/// Where a stretch begins: at springs, below confluences, and where a stream leaves standing water.
fn heads(flow: &Flow, channel: &[bool], feeders: &[u32], water: &[bool]) -> Vec<usize> {
    let mut leaves_water = vec![false; channel.len()];
    for post in (0..channel.len()).filter(|&post| channel[post] && water[post] && flow.down[post] != NONE) {
        leaves_water[flow.down[post]] = true;
    }
    let begins = |post: usize| feeders[post] != 1 || leaves_water[post];
    (0..channel.len()).filter(|&post| channel[post] && !water[post] && begins(post)).collect()
}

/// The posts from `head` down to the next confluence, the first post of standing water, or the outlet.
fn stretch(flow: &Flow, feeders: &[u32], water: &[bool], head: usize) -> Vec<usize> {
    let mut posts = vec![head];
    let mut post = flow.down[head];
    while post != NONE {
        posts.push(post);
        if water[post] || feeders[post] > 1 {
            break;
        }
        post = flow.down[post];
    }
    posts
}

/// Whether a stretch is a neck between two parts of one lake, too narrow for a post.
fn joins_water(flow: &Flow, water: &[bool], posts: &[usize]) -> bool {
    let from_water = (0..water.len()).any(|post| water[post] && flow.down[post] == posts[0]);
    from_water && water[posts[posts.len() - 1]] && posts.len() < 8
}

fn names(ground: &Ground, flow: &Flow, channel: &[bool]) -> Vec<Option<&'static str>> {
    let mut names = vec![None; channel.len()];
    let mut largest_donor = vec![NONE; channel.len()];
    for post in (0..channel.len()).filter(|&post| channel[post] && flow.down[post] != NONE) {
        let donor = &mut largest_donor[flow.down[post]];
        if *donor == NONE || flow.area_km2[post] > flow.area_km2[*donor] {
            *donor = post;
        }
    }
    for (lon, lat, name) in NAMED {
        let Some(start) = nearest_channel(ground, flow, channel, ground.locate(lon, lat)) else {
            continue;
        };
        let mut post = start;
        names[start] = Some(name);
        let mut above = largest_donor[flow.down[start]];
        while flow.down[post] != NONE && above == post {
            post = flow.down[post];
            names[post] = Some(name);
            above = if flow.down[post] == NONE { NONE } else { largest_donor[flow.down[post]] };
        }
    }
    names
}

/// The channel post that drains most within six hundred meters of a place.
fn nearest_channel(ground: &Ground, flow: &Flow, channel: &[bool], at: DVec2) -> Option<usize> {
    let near = (0..channel.len()).filter(|&post| channel[post] && ground.place(post).distance(at) < 600.0);
    near.max_by(|&a, &b| flow.area_km2[a].total_cmp(&flow.area_km2[b]))
}
