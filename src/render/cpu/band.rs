//! Tiles gathered in bands of 64 rows.
//!
//! A band lists its pieces by tile, in the list's order. Those that cover more than two tiles are listed once, so that the
//! bands in work take no more memory however many tiles the triangles of a hostile list cover:
//!
//! ```text
//! tile      0      1      2      3
//! narrow    a  c   c  d   —      f         wide    b e
//! drawn     abce   bcde   be     bef
//! ```
//!
//! Tiles differ in cost, the most by six times from the mean. The last that are begun are drawn in quarters, so that the
//! threads end together.

use std::iter;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::cpu::geometry::{FacePiece, ScreenGeometry};
use crate::cpu::raster::PixelWindow;
use crate::cpu::tile::{TileContext, TileScratch, draw_tile};
use crate::cpu::visibility::TILE;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;

#[derive(Debug)]
pub struct BandRows<'a> {
    pub colors: &'a mut [Srgba],
    pub depths_m: &'a mut [f32],
    pub features: &'a mut [FeatureId],
}

/// The tiles of some bands that nobody has begun.
#[derive(Debug)]
pub struct TilesLeft(AtomicU32);

impl TilesLeft {
    /// Those of all `rows` of a picture.
    pub fn new(width: u32, rows: u32) -> Self {
        Self(AtomicU32::new(width.div_ceil(TILE) * rows.div_ceil(TILE)))
    }

    /// Begins a tile: its parts, which a pixel does not depend on.
    fn begin(&self, window: PixelWindow) -> Vec<PixelWindow> {
        let threads = rayon::current_num_threads();
        let left = self.0.fetch_sub(1, Ordering::Relaxed) as usize;
        if threads == 1 || left > threads { vec![window] } else { quarters(window).to_vec() }
    }
}

/// The quarters of a window, some of them empty where a side has one pixel.
fn quarters(PixelWindow { from: [left, top], to: [right, bottom] }: PixelWindow) -> [PixelWindow; 4] {
    let (x, y) = (left + (right - left).div_ceil(2), top + (bottom - top).div_ceil(2));
    [
        PixelWindow { from: [left, top], to: [x, y] },
        PixelWindow { from: [x, top], to: [right, y] },
        PixelWindow { from: [left, y], to: [x, bottom] },
        PixelWindow { from: [x, y], to: [right, bottom] },
    ]
}

/// The pieces that may touch the tiles of a band.
struct PiecesByTile<'a> {
    /// Those that may touch one or two tiles, tile by tile, each time in the list's order.
    narrow: Vec<&'a FacePiece>,
    /// Where those of each tile end.
    ends: Vec<usize>,
    /// All others, in the list's order.
    wide: Vec<&'a FacePiece>,
}

impl<'a> PiecesByTile<'a> {
    fn new(geometry: &'a ScreenGeometry, band: PixelWindow) -> Self {
        let mut counts = vec![0; band.to[0].div_ceil(TILE) as usize];
        let mut wide = Vec::new();
        for piece in geometry.pieces_in(band) {
            match narrow_tiles(piece) {
                Some(tiles) => tiles.for_each(|tile| counts[tile] += 1),
                None => wide.push(piece),
            }
        }
        let mut total = 0;
        // Begun at their starts, they are ends once all pieces are listed.
        let mut ends: Vec<usize> = counts
            .iter()
            .map(|count| {
                total += count;
                total - count
            })
            .collect();
        let Some(any) = geometry.pieces_in(band).next().filter(|_| total > 0) else {
            return Self { narrow: Vec::new(), ends, wide };
        };
        let mut narrow = vec![any; total];
        for piece in geometry.pieces_in(band) {
            for tile in narrow_tiles(piece).into_iter().flatten() {
                narrow[ends[tile]] = piece;
                ends[tile] += 1;
            }
        }
        Self { narrow, ends, wide }
    }

    /// Those of tile number `tile` from the left, in the list's order, and perhaps others.
    fn of(&self, tile: usize) -> impl Iterator<Item = &'a FacePiece> {
        let start = tile.checked_sub(1).map_or(0, |before| self.ends[before]);
        let mut narrow = self.narrow[start..self.ends[tile]].iter().peekable();
        let mut wide = self.wide.iter().peekable();
        // Faces are numbered in the list's order, and pieces of one face have no sample in common.
        iter::from_fn(move || {
            let is_wide = match (narrow.peek(), wide.peek()) {
                (Some(narrow), Some(wide)) => wide.face.0 < narrow.face.0,
                (narrow, _) => narrow.is_none(),
            };
            if is_wide { wide.next() } else { narrow.next() }.copied()
        })
    }
}

/// The tiles that a piece may touch, counted from the left, where they are one or two.
fn narrow_tiles(piece: &FacePiece) -> Option<RangeInclusive<usize>> {
    let (first, last) = (piece.window.from[0] / TILE, (piece.window.to[0] - 1) / TILE);
    (last - first <= 1).then_some(first as usize..=last as usize)
}

/// Draws band `number`, counted from the top, into its rows.
pub fn draw_band<const N: usize>(frame: &TileContext<N>, number: u32, rows: BandRows, left: &TilesLeft) {
    let [width, height] = frame.screen.size;
    let (top, bottom) = (number * TILE, (number * TILE + TILE).min(height));
    let band = PixelWindow { from: [0, top], to: [width, bottom] };
    let pieces = PiecesByTile::new(frame.geometry, band);
    let window =
        |tile: u32| PixelWindow { from: [tile * TILE, top], to: [(tile * TILE + TILE).min(width), bottom] };
    let draw = |scratch: &mut TileScratch<N>, tile: u32, part: PixelWindow| {
        (part, draw_tile(frame, pieces.of(tile as usize), part, scratch))
    };
    let tiles: Vec<Vec<_>> = (0..width.div_ceil(TILE))
        .into_par_iter()
        // A thread that is done takes any tile that is left, one at a time.
        .with_max_len(1)
        .map_init(TileScratch::new, |scratch, tile| match &left.begin(window(tile))[..] {
            [whole] => vec![draw(scratch, tile, *whole)],
            parts => parts
                .par_iter()
                .filter(|part| !part.is_empty())
                .map_init(TileScratch::new, |scratch, part| draw(scratch, tile, *part))
                .collect(),
        })
        .collect();
    for (part, pixels) in tiles.into_iter().flatten() {
        let columns = (part.to[0] - part.from[0]) as usize;
        for (row, line) in (part.from[1] - top..).zip(pixels.chunks_exact(columns)) {
            let start = (row * width + part.from[0]) as usize;
            for (index, pixel) in (start..).zip(line) {
                rows.colors[index] = pixel.color;
                rows.depths_m[index] = pixel.depth_m;
                rows.features[index] = pixel.feature;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::cpu::geometry::GeometrySource;
    use crate::cpu::pattern::FOUR;
    use crate::cpu::screen::Screen;
    use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex};
    use sandtable_draw::material::Material;
    use sandtable_mesh::sink::MeshSink;
    use sandtable_view::camera::Camera;

    #[test]
    fn each_tile_has_the_pieces_that_touch_it_in_the_order_of_the_list() {
        let (mut list, mut mesh) = (DrawList::default(), DrawMesh::default());
        for at in 0..600 {
            // Every ninth is wide.
            let size = if at % 9 == 0 { 90.0 } else { 3.0 };
            let corner = Vec3::new((at * 37 % 200) as f32 - 120.0, 100.0, (at * 53 % 160) as f32 - 80.0);
            let ids = [Vec3::ZERO, Vec3::X, Vec3::Z].map(|side| {
                let position = (corner + side * size).to_array();
                mesh.vertex(DrawVertex {
                    position,
                    normal: [0.0, -1.0, 0.0],
                    uv: [0.0; 2],
                    color: Srgba::WHITE,
                })
            });
            mesh.triangle(ids);
        }
        let (mesh, two_sided) = (list.add_mesh(mesh), Material { two_sided: true, ..Material::default() });
        let material = list.add_material(two_sided);
        list.items.push(DrawItem {
            triangles: 0..600,
            mesh,
            material,
            world_from_mesh: Mat4::IDENTITY,
            layer: DepthLayer::Solid,
            feature: FeatureId(2),
        });
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.9, (330, 150), (0.5, 1000.0)).expect("sound");
        let screen = Screen::new(&camera);
        let source = GeometrySource::new(&list, &screen, &FOUR).expect("few triangles");
        let geometry = source.geometry(&source.rows(), &[]);
        let band = PixelWindow { from: [0, TILE], to: [330, 2 * TILE] };
        let pieces = PiecesByTile::new(&geometry, band);
        assert!(pieces.wide.len() > 10 && pieces.narrow.len() > 100, "both kinds are tested");
        for tile in 0..330_u32.div_ceil(TILE) {
            let window =
                PixelWindow { from: [tile * TILE, TILE], to: [(tile * TILE + TILE).min(330), 2 * TILE] };
            let touching = |piece: &&FacePiece| !piece.window.intersection(window).is_empty();
            let listed: Vec<_> =
                pieces.of(tile as usize).filter(touching).map(|piece| piece.face.0).collect();
            let expected: Vec<_> = geometry.pieces_in(window).map(|piece| piece.face.0).collect();
            assert!(listed == expected && !listed.is_empty(), "tile {tile}");
        }
    }

    #[test]
    fn the_last_tiles_are_drawn_in_quarters_that_hold_each_pixel_once() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        let window = PixelWindow { from: [64, 128], to: [101, 129] };
        let left = TilesLeft::new(65, 129);
        let parts: Vec<_> = pool.install(|| (0..6).map(|_| left.begin(window)).collect());
        assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1, 1, 4, 4, 4]);
        let holds = |part: &PixelWindow, [x, y]: [u32; 2]| {
            let PixelWindow { from, to } = part;
            (from[0]..to[0]).contains(&x) && (from[1]..to[1]).contains(&y)
        };
        for at in (60..110).flat_map(|x| (126..132).map(move |y| [x, y])) {
            let count = parts[5].iter().filter(|part| holds(part, at)).count();
            assert_eq!(count, usize::from(holds(&window, at)), "{at:?}");
        }
    }

    #[test]
    fn one_thread_draws_whole_tiles() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let window = PixelWindow { from: [0, 0], to: [64, 64] };
        assert_eq!(pool.install(|| TilesLeft::new(64, 64).begin(window)), [window]);
    }
}
