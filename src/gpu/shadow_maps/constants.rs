//! The constants of a level that is drawn, and the parts of it that are drawn one after the other.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use sandtable_render::shadow::plan::PlannedShadowMap;
use sandtable_render::shadow::{FLOATING_TEXELS, PAGE, ShadowLevel, ShadowMap, ShadowPurpose};

/// The most pages along a side of a tile: its target takes 16 MiB, and few levels are larger.
const MOST_TILE_PAGES: u32 = 4096 / PAGE;

/// The constants of a tile of a level: `Level` in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct LevelConstants {
    eye: [f32; 4],
    across: [[f32; 4]; 2],
    toward: [f32; 4],
    tile: [f32; 4],
    pages: [u32; 4],
    stored: [u32; 4],
    contact: [f32; 4],
}

/// What of the maps lies before a level, in pages.
#[derive(Clone, Copy, Debug, Default)]
pub struct PagesBefore {
    /// In the table, of the maps before.
    pub entries: u32,
    /// Stored ones of the maps before.
    pub of_maps: u32,
    /// Stored ones of the levels before, of the same map.
    pub of_levels: u32,
}

/// A part of a level that is drawn at once, in texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelTile {
    pub first: [u32; 2],
    pub size: [u32; 2],
}

impl LevelConstants {
    /// Those of a tile of the map's level `index`.
    pub fn new(planned: &PlannedShadowMap, index: usize, before: PagesBefore, tile: LevelTile) -> Self {
        let (map, level) = (&planned.map, &planned.map.levels[index]);
        let with = |vector: Vec3, w: f32| vector.extend(w).to_array();
        let [x, y] = tile.first.map(|first| first as f32);
        let [width, height] = tile.size.map(|side| 2.0 / side as f32);
        let is_contact = f32::from(u8::from(planned.purpose == ShadowPurpose::Contact));
        Self {
            eye: with(map.eye, 0.0),
            across: [0, 1].map(|axis| with(map.axes.across[axis], level.origin[axis])),
            toward: with(map.axes.toward, 1.0 / level.texel_m),
            tile: [x, y, width, height],
            pages: [level.columns, level.rows, before.entries + level.first, planned.stored * PAGE * PAGE],
            stored: [before.of_maps, before.of_levels, 0, 0],
            contact: [is_contact, FLOATING_TEXELS * level.texel_m, 0.0, 0.0],
        }
    }
}

/// How many pages of a level are stored.
pub fn stored_on(map: &ShadowMap, level: &ShadowLevel) -> u32 {
    map.pages[level.pages()].iter().filter(|page| page.number > 0).count() as u32
}

/// The tiles that cover the stored pages of a level, each of at most so many texels a side.
pub fn tiles(map: &ShadowMap, level: &ShadowLevel, longest: u32) -> Vec<LevelTile> {
    let side = (longest / PAGE).clamp(1, MOST_TILE_PAGES);
    let pages = &map.pages[level.pages()];
    let is_stored = |column: u32, row: u32| pages[(row * level.columns + column) as usize].number > 0;
    let columns = || (0..level.columns).filter(|&column| (0..level.rows).any(|row| is_stored(column, row)));
    let rows = || (0..level.rows).filter(|&row| (0..level.columns).any(|column| is_stored(column, row)));
    let [Some(left), Some(right), Some(bottom), Some(top)] =
        [columns().next(), columns().next_back(), rows().next(), rows().next_back()]
    else {
        return Vec::new();
    };
    let mut tiles = Vec::new();
    for row in (bottom..=top).step_by(side as usize) {
        for column in (left..=right).step_by(side as usize) {
            let [width, height] = [side.min(right + 1 - column), side.min(top + 1 - row)];
            let mut all =
                (row..row + height).flat_map(|row| (column..column + width).map(move |at| (at, row)));
            if all.any(|(column, row)| is_stored(column, row)) {
                tiles.push(LevelTile {
                    first: [column * PAGE, row * PAGE],
                    size: [width * PAGE, height * PAGE],
                });
            }
        }
    }
    tiles
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_render::shadow::{LevelScale, LightAxes, ShadowPage, ShadowTexel};

    /// A map of one level of which these pages are stored.
    fn map([columns, rows]: [u32; 2], stored: &[[u32; 2]]) -> ShadowMap {
        let page = |index: u32| {
            let number = stored.iter().position(|&[x, y]| y * columns + x == index);
            ShadowPage { number: number.map_or(0, |number| number as u32 + 1), highest: ShadowTexel::EMPTY }
        };
        ShadowMap {
            eye: Vec3::ZERO,
            forward: Vec3::Y,
            axes: LightAxes { across: [Vec3::X, Vec3::Y], toward: Vec3::Z },
            scale: LevelScale { texel_per_depth: 1.0, least: 0 },
            levels: vec![ShadowLevel { origin: [0.0; 2], texel_m: 1.0, columns, rows, first: 0 }],
            pages: (0..columns * rows).map(page).collect(),
            texels: Vec::new(),
        }
    }

    #[test]
    fn tiles_cover_each_stored_page_once_and_nothing_around_them() {
        let stored = [[3, 2], [4, 2], [9, 7], [3, 11]];
        let map = map([16, 12], &stored);
        let all = |longest| tiles(&map, &map.levels[0], longest);
        assert_eq!(all(4096), [LevelTile { first: [96, 64], size: [224, 320] }]);
        for longest in [32, 64, 100, 127, 4096] {
            let tiles = all(longest);
            assert!(tiles.iter().all(|tile| tile.size.into_iter().all(|side| side <= longest)));
            for [x, y] in stored.map(|page| page.map(|at| at * PAGE)) {
                let holds = |tile: &&LevelTile| {
                    [x, y]
                        .iter()
                        .zip(tile.first.iter().zip(tile.size))
                        .all(|(at, (first, size))| first <= at && at + PAGE <= first + size)
                };
                assert_eq!(tiles.iter().filter(holds).count(), 1, "{longest}");
            }
        }
        assert_eq!(all(32).len(), stored.len());
        let empty = self::map([4, 4], &[]);
        assert!(tiles(&empty, &empty.levels[0], 64).is_empty());
    }
}
