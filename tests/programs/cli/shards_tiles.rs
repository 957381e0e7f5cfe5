//! `plan tiles`: what a reader of quantized-mesh finds in the tiles.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;

use serde_json::Value;

use crate::cli::{bytes_of, run_in};
use crate::common::scratch::Scratch;

/// A tile as the format's specification says that it is read.
struct ReadTile {
    center: [f64; 3],
    radius: f64,
    range: [f32; 2],
    /// u, v and height of each vertex.
    vertices: Vec<[u16; 3]>,
    triangles: Vec<[usize; 3]>,
    /// The vertices along the west, the south, the east and the north.
    edges: Vec<Vec<usize>>,
}

/// Bytes from front to back.
struct TileBytes(Vec<u8>, usize);

impl TileBytes {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        self.1 += N;
        self.0[self.1 - N..self.1].try_into().expect("so many bytes")
    }

    fn double(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    fn short(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    fn count(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }
}

impl ReadTile {
    fn new(bytes: Vec<u8>) -> Self {
        let mut bytes = TileBytes(bytes, 0);
        let center = [bytes.double(), bytes.double(), bytes.double()];
        let range = [f32::from_le_bytes(bytes.take()), f32::from_le_bytes(bytes.take())];
        let sphere = [bytes.double(), bytes.double(), bytes.double()];
        assert_eq!(sphere, center);
        let radius = bytes.double();
        let horizon = [bytes.double(), bytes.double(), bytes.double()];
        assert!(horizon.iter().map(|part| part * part).sum::<f64>() >= 0.999_999, "{horizon:?}");
        let count = bytes.count();
        let mut vertices = vec![[0; 3]; count];
        for part in 0..3 {
            let mut value = 0i32;
            for vertex in &mut vertices {
                let code = i32::from(bytes.short());
                value += (code >> 1) ^ -(code & 1);
                vertex[part] = u16::try_from(value).expect("a coordinate");
            }
        }
        let mut highest = 0;
        let mut index = |bytes: &mut TileBytes| {
            let code = usize::from(bytes.short());
            let index = highest - code;
            highest += usize::from(code == 0);
            index
        };
        let triangles =
            (0..bytes.count()).map(|_| [index(&mut bytes), index(&mut bytes), index(&mut bytes)]).collect();
        let edges = (0..4)
            .map(|_| (0..bytes.count()).map(|_| usize::from(bytes.short())).collect::<Vec<usize>>())
            .collect();
        assert_eq!(bytes.1, bytes.0.len(), "nothing is left over");
        Self { center, radius, range, vertices, triangles, edges }
    }

    /// The coordinates along an edge, by the place along it, and the heights there.
    fn edge(&self, side: usize) -> BTreeMap<u16, u16> {
        let along = if side.is_multiple_of(2) { 1 } else { 0 };
        self.edges[side]
            .iter()
            .map(|&vertex| (self.vertices[vertex][along], self.vertices[vertex][2]))
            .collect()
    }

    fn height_m(&self, vertex: usize) -> f64 {
        let [low, high] = self.range.map(f64::from);
        low + f64::from(self.vertices[vertex][2]) / 32767.0 * (high - low)
    }
}

fn planned(arguments: &[&str]) -> (Scratch, usize) {
    let scratch = Scratch::new();
    scratch.write("dem.tif", bytes_of("assets/jacksboro/dem.tif"));
    let plan = [&["plan", "tiles", "dem.tif", "--json", "-o", "plan"], arguments].concat();
    let json: Value = serde_json::from_str(&run_in(scratch.folder(), &plan).ok()).expect("an object");
    let count = json["shards"].as_u64().expect("a number") as usize;
    (scratch, count)
}

fn tile(scratch: &Scratch, [level, x, y]: [u64; 3]) -> Option<ReadTile> {
    fs::read(scratch.at(&format!("plan/tiles/{level}/{x}/{y}.terrain"))).ok().map(ReadTile::new)
}

/// Level, x and y of all tiles that `layer.json` lists.
fn listed(scratch: &Scratch) -> Vec<[u64; 3]> {
    let layer: Value =
        serde_json::from_slice(&fs::read(scratch.at("plan/tiles/layer.json")).expect("written"))
            .expect("JSON");
    let mut tiles = Vec::new();
    for (level, ranges) in layer["available"].as_array().expect("levels").iter().enumerate() {
        let end = |name: &str| ranges[0][name].as_u64().expect("a number");
        for x in end("startX")..=end("endX") {
            tiles.extend((end("startY")..=end("endY")).map(|y| [level as u64, x, y]));
        }
    }
    tiles
}

#[test]
fn tiles_of_a_pyramid_agree_along_their_edges_and_with_the_elevation() {
    let (scratch, count) = planned(&["--max-zoom", "11"]);
    run_in(scratch.folder(), &["work", "plan", "--shards", &format!("0..{count}")]).ok();
    assert_eq!(run_in(scratch.folder(), &["gather", "plan"]).ok(), "plan/tiles/layer.json\n");
    let tiles = listed(&scratch);
    assert!(tiles.len() > 20 && tiles.contains(&[0, 0, 0]) && tiles.contains(&[0, 1, 0]), "{tiles:?}");
    let (mut meetings, mut points, mut expected) = (0, String::new(), Vec::new());
    for &[level, x, y] in &tiles {
        let own = tile(&scratch, [level, x, y]).expect("a listed tile is there");
        check(&own, [level, x, y]);
        for (neighbor, side, other) in [([level, x + 1, y], 2, 0), ([level, x, y + 1], 3, 1)] {
            if let Some(neighbor) = tile(&scratch, neighbor) {
                assert_eq!(own.edge(side).len(), 65);
                assert_eq!(own.edge(side), neighbor.edge(other), "{level}/{x}/{y}");
                meetings += 1;
            }
        }
        if level == 11 {
            for vertex in (0..own.vertices.len()).step_by(97) {
                let [lon, lat] = place(own.vertices[vertex], [level, x, y]);
                points += &format!("{lon},{lat}\n");
                expected.push(own.height_m(vertex));
            }
        }
    }
    assert!(meetings > 20, "{meetings}");
    scratch.write("posts.csv", &points);
    let query = ["height", "dem.tif", "--crs", "EPSG:4326", "--points", "posts.csv"];
    let heights = run_in(scratch.folder(), &query).ok();
    let mut found = 0;
    for (line, expected) in heights.lines().skip(1).zip(&expected) {
        let height: f64 = match line.split(',').nth(2).expect("a height") {
            "" => 0.0,
            height => height.parse().expect("a number"),
        };
        found += usize::from(height > 0.0);
        // A step of the heights, and what moving a post to its step across the tile changes.
        assert!((height - expected).abs() < 1.5, "{line}: {expected}");
    }
    assert!(found > 500, "{found}");
}

/// Longitude and latitude of a vertex.
fn place([u, v, _]: [u16; 3], [level, x, y]: [u64; 3]) -> [f64; 2] {
    let size = 180.0 / (1u64 << level) as f64;
    let at = |tile: u64, share: u16| (tile as f64 + f64::from(share) / 32767.0) * size;
    [at(x, u) - 180.0, at(y, v) - 90.0]
}

/// Checks that a tile's triangles cover it once, and that its sphere holds it.
fn check(tile: &ReadTile, address: [u64; 3]) {
    let mut area = 0;
    for corners in &tile.triangles {
        let [a, b, c] = corners.map(|vertex| tile.vertices[vertex].map(i64::from));
        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        assert!(doubled > 0, "counterclockwise");
        area += doubled;
    }
    assert_eq!(area, 2 * 32767 * 32767);
    for (vertex, &coordinates) in tile.vertices.iter().enumerate() {
        let [lon, lat] = place(coordinates, address).map(|degrees| degrees * PI / 180.0);
        let (squared, height) = (6.694_379_990_141_316e-3, tile.height_m(vertex));
        let across = 6_378_137.0 / (1.0 - squared * lat.sin() * lat.sin()).sqrt();
        let at = [
            (across + height) * lat.cos() * lon.cos(),
            (across + height) * lat.cos() * lon.sin(),
            (across * (1.0 - squared) + height) * lat.sin(),
        ];
        let distance = at.iter().zip(tile.center).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        // Coordinates along the tile are rounded.
        assert!(distance <= tile.radius * 1.0001 + 0.1, "{distance} m from the center, {} m", tile.radius);
    }
}

#[test]
fn shards_of_tiles_are_independent_and_done_once() {
    let (scratch, count) = planned(&["--max-zoom", "11"]);
    let (other, _) = planned(&["--max-zoom", "11"]);
    assert!(count >= 2, "{count}");
    for id in (0..count).rev() {
        run_in(other.folder(), &["work", "plan", "--shard", &id.to_string()]).ok();
    }
    let work = ["work", "plan", "--shards", &format!("0..{count}")];
    run_in(scratch.folder(), &work).ok();
    run_in(scratch.folder(), &["gather", "plan"]).ok();
    for [level, x, y] in listed(&scratch) {
        let path = format!("plan/tiles/{level}/{x}/{y}.terrain");
        let read = |scratch: &Scratch| fs::read(scratch.at(&path)).expect("written");
        assert!(read(&scratch) == read(&other), "{path}");
    }
    // A tile that is gone makes its shard stale, and only that.
    let [level, x, y] = *listed(&scratch).last().expect("a tile");
    fs::remove_file(scratch.at(&format!("plan/tiles/{level}/{x}/{y}.terrain"))).expect("it is there");
    let message = run_in(scratch.folder(), &["gather", "plan"]).failed(1);
    assert!(message.contains("1 stale"), "{message}");
    let out = run_in(scratch.folder(), &work).ok();
    assert_eq!(out.lines().filter(|line| line.ends_with("done")).count(), 1, "{out}");
    run_in(scratch.folder(), &["gather", "plan"]).ok();
    let message = run_in(scratch.folder(), &["gather", "plan", "-o", "layer.json"]).failed(1);
    assert!(message.contains("leave out -o"), "{message}");
}

#[test]
fn elevation_without_a_place_on_the_globe_has_no_tiles() {
    let scratch = Scratch::new();
    scratch.write("local.asc", "ncols 2\nnrows 2\nxllcorner 5000\nyllcorner 5000\ncellsize 10\n1 2 3 4\n");
    let message = run_in(scratch.folder(), &["plan", "tiles", "local.asc", "-o", "plan"]).failed(1);
    assert!(message.contains("local.asc: it names no coordinate system"), "{message}");
}
