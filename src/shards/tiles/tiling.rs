//! The tiles of the globe: few at level 0, each four at the next.
//!
//! ```text
//! geographic   ┌───┬───┐      Web Mercator   0───┐
//!              │   │   │                     │   │   counted from the corner 0
//!              0───┴───┘                     └───┘
//! ```

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::DVec2;

use sandtable_geom::rect::Rect;

/// The finest level: places a meter apart and less.
pub const MOST_LEVEL: u32 = 22;

/// The division of the globe into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileScheme {
    /// By longitude and latitude: two tiles at level 0, counted from the south-west (TMS, global geodetic).
    Geographic,
    /// By spherical Mercator coordinates (EPSG:3857): one tile at level 0, counted from the north-west (XYZ, the numbers of
    /// slippy maps). It ends at 85.05 degrees north and south.
    WebMercator,
}

/// A tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TileAddress {
    pub level: u32,
    /// From the west.
    pub x: u64,
    /// From the south or the north, as the scheme says.
    pub y: u64,
}

/// The tiles of a level that meet a rectangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileRange {
    pub level: u32,
    /// From the west, apart from each other: two where the rectangle crosses the meridian of 180 degrees.
    pub x: Vec<RangeInclusive<u64>>,
    pub y: RangeInclusive<u64>,
}

impl TileScheme {
    /// Tiles per row of level 0; there is one row.
    fn columns(self) -> u64 {
        match self {
            Self::Geographic => 2,
            Self::WebMercator => 1,
        }
    }

    /// Longitude and latitude of a position in tiles of level 0.
    fn degrees_from_tiles(self, at: DVec2) -> DVec2 {
        match self {
            Self::Geographic => DVec2::new(180.0 * at.x - 180.0, 180.0 * at.y - 90.0),
            Self::WebMercator => {
                let latitude = libm::atan(libm::sinh(PI * (1.0 - 2.0 * at.y)));
                DVec2::new(360.0 * at.x - 180.0, latitude.to_degrees())
            }
        }
    }

    /// The position of a longitude and latitude in tiles of level 0; beyond the end of Web Mercator, one on it.
    fn tiles_from_degrees(self, at: DVec2) -> DVec2 {
        match self {
            Self::Geographic => DVec2::new((at.x + 180.0) / 180.0, (at.y + 90.0) / 180.0),
            Self::WebMercator => {
                let northing = libm::asinh(libm::tan(at.y.to_radians())) / PI;
                DVec2::new((at.x + 180.0) / 360.0, ((1.0 - northing) / 2.0).clamp(0.0, 1.0))
            }
        }
    }

    /// The longitude and latitude of a place in a tile, degrees. `at` counts `cells` along a side from the tile's first corner.
    ///
    /// The share of the way round the globe is exact for whole and half numbers, so that a place has the same bits in all tiles
    /// that it is a place of.
    pub fn place(self, tile: TileAddress, cells: u32, at: DVec2) -> DVec2 {
        let all = (u64::from(cells) << tile.level) as f64;
        let first = DVec2::new((tile.x * u64::from(cells)) as f64, (tile.y * u64::from(cells)) as f64);
        self.degrees_from_tiles((first + at) / all)
    }

    /// The longitudes and latitudes of a tile, degrees.
    pub fn extent(self, tile: TileAddress) -> Rect {
        Rect::around([DVec2::ZERO, DVec2::ONE].map(|corner| self.place(tile, 1, corner)))
    }

    /// The level at which `cells` along a side of each tile are no farther apart than `cell_deg` degrees of longitude.
    pub fn level_of(self, cells: u32, cell_deg: f64) -> u32 {
        let spacing = |level: u32| 360.0 / ((self.columns() * u64::from(cells)) << level) as f64;
        // A share of a cell is no reason for four times as many tiles.
        (0..MOST_LEVEL).find(|&level| spacing(level) <= cell_deg * 1.05).unwrap_or(MOST_LEVEL)
    }

    /// The tiles of a level that meet `[west, south, east, north]` in degrees, which crosses the meridian of 180 degrees where
    /// its west is east of its east. Level 0 has all tiles: a globe is made of them.
    pub fn tiles_meeting(self, level: u32, [west, south, east, north]: [f64; 4]) -> TileRange {
        if level == 0 {
            return TileRange { level, x: vec![0..=self.columns() - 1], y: 0..=0 };
        }
        if west > east {
            let TileRange { x: mut first, y, .. } = self.tiles_meeting(level, [-180.0, south, east, north]);
            let last = self.tiles_meeting(level, [west, south, 180.0, north]).x;
            match (first.pop(), last.first()) {
                (Some(low), Some(high)) if low.end() + 1 >= *high.start() => {
                    first.push(*low.start()..=*high.end());
                }
                (low, _) => first = low.into_iter().chain(last).collect(),
            }
            return TileRange { level, x: first, y };
        }
        let corners = [DVec2::new(west, south), DVec2::new(east, north)];
        let Rect { min, max } = Rect::around(corners.map(|corner| self.tiles_from_degrees(corner)));
        let rows = 1u64 << level;
        let range = |low: f64, high: f64, count: u64| {
            let first = ((low * rows as f64) as u64).min(count - 1);
            let last = (libm::ceil(high * rows as f64) as u64).saturating_sub(1).clamp(first, count - 1);
            first..=last
        };
        let x = vec![range(min.x, max.x, self.columns() * rows)];
        TileRange { level, x, y: range(min.y, max.y, rows) }
    }
}

impl TileAddress {
    /// The four tiles of the next level that lie in it, row by row.
    pub fn children(self) -> [Self; 4] {
        let Self { level, x, y } = self;
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(across, along)| Self {
            level: level + 1,
            x: 2 * x + across,
            y: 2 * y + along,
        })
    }

    /// The tiles of a finer level that lie in it.
    pub fn below(self, level: u32) -> TileRange {
        let shift = level - self.level;
        let range = |first: u64| (first << shift)..=((first + 1) << shift) - 1;
        TileRange { level, x: vec![range(self.x)], y: range(self.y) }
    }

    /// Its path in a folder of tiles.
    pub fn path(self, extension: &str) -> String {
        format!("{}/{}/{}.{extension}", self.level, self.x, self.y)
    }
}

impl TileRange {
    /// The tile with an address, where it is one of these.
    pub fn tile(&self, [level, x, y]: [u64; 3]) -> Option<TileAddress> {
        let tile = TileAddress { level: u32::try_from(level).ok()?, x, y };
        self.contains(tile).then_some(tile)
    }

    /// Whether it has a tile.
    pub fn contains(&self, tile: TileAddress) -> bool {
        let is_column = self.x.iter().any(|columns| columns.contains(&tile.x));
        tile.level == self.level && is_column && self.y.contains(&tile.y)
    }

    /// The number of its tiles.
    pub fn count(&self) -> u64 {
        self.columns().saturating_mul(self.y.end() - self.y.start() + 1)
    }

    /// Tiles per row.
    fn columns(&self) -> u64 {
        self.x.iter().map(|columns| columns.end() - columns.start() + 1).sum()
    }

    /// Its tiles, row by row from the first.
    pub fn tiles(&self) -> impl Iterator<Item = TileAddress> + use<> {
        let (level, x) = (self.level, self.x.clone());
        self.y
            .clone()
            .flat_map(move |y| x.clone().into_iter().flatten().map(move |x| TileAddress { level, x, y }))
    }

    /// The number of one of its tiles among [`TileRange::tiles`].
    pub fn index(&self, tile: TileAddress) -> u64 {
        let west_of =
            |columns: &RangeInclusive<u64>| (tile.x.min(columns.end() + 1)).saturating_sub(*columns.start());
        (tile.y - self.y.start()) * self.columns() + self.x.iter().map(west_of).sum::<u64>()
    }

    /// The tiles of both ranges, which are of one level.
    pub fn intersection(&self, other: &Self) -> Self {
        let both = |a: &RangeInclusive<u64>, b: &RangeInclusive<u64>| {
            *a.start().max(b.start())..=*a.end().min(b.end())
        };
        let columns = self.x.iter().flat_map(|a| other.x.iter().map(move |b| both(a, b)));
        let x = columns.filter(|columns| !columns.is_empty()).collect();
        Self { level: self.level, x, y: both(&self.y, &other.y) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_of_the_geographic_scheme_meet_what_they_share_more_than_an_edge_with() {
        let meeting = |level, bounds| TileScheme::Geographic.tiles_meeting(level, bounds);
        let all = meeting(2, [-180.0, -90.0, 180.0, 90.0]);
        assert_eq!((all.x, all.y), (vec![0..=7], 0..=3));
        let edge = meeting(1, [0.0, 0.0, 90.0, 90.0]);
        assert_eq!((edge.x, edge.y), (vec![2..=2], 1..=1));
    }

    #[test]
    fn tiles_of_web_mercator_have_the_numbers_of_slippy_maps() {
        // x = (lon + 180) / 360, y = (1 - ln(tan lat + 1 / cos lat) / pi) / 2, in tiles of level 0.
        for (lon, lat, level) in
            [(-98.2f64, 33.2f64, 12), (7.66, 45.98, 15), (174.8, -41.3, 9), (0.1, 84.9, 3)]
        {
            let tiles = f64::from(1u32 << level);
            let angle = lat.to_radians();
            let x = ((lon + 180.0) / 360.0 * tiles).floor() as u64;
            let y = ((1.0 - (angle.tan() + 1.0 / angle.cos()).ln() / PI) / 2.0 * tiles).floor() as u64;
            let range = TileScheme::WebMercator.tiles_meeting(level, [lon, lat, lon + 1e-9, lat + 1e-9]);
            assert_eq!((range.x, range.y), (vec![x..=x], y..=y), "{lon} {lat} {level}");
            let extent = TileScheme::WebMercator.extent(TileAddress { level, x, y });
            assert!(extent.contains(DVec2::new(lon, lat)), "{extent:?}");
        }
        // The Matterhorn, as in the addresses of map services.
        let matterhorn = TileScheme::WebMercator.tiles_meeting(10, [7.6586, 45.9764, 7.6587, 45.9765]);
        assert_eq!((matterhorn.x, matterhorn.y), (vec![533..=533], 364..=364));
        let end = TileScheme::WebMercator.extent(TileAddress { level: 0, x: 0, y: 0 });
        assert!((end.max - DVec2::new(180.0, 85.051_128_779_806_59)).length() < 1e-9, "{end:?}");
        assert_eq!(end.min.y, -end.max.y);
        let whole = TileScheme::WebMercator.tiles_meeting(1, [-180.0, -90.0, 180.0, 90.0]);
        assert_eq!((whole.x, whole.y), (vec![0..=1], 0..=1));
    }

    #[test]
    fn what_crosses_the_meridian_of_180_degrees_meets_the_tiles_at_both_ends_alone() {
        // Fiji: from 176.8 degrees east to 178.2 degrees west.
        let fiji = [176.8, -19.3, -178.2, -16.0];
        for scheme in [TileScheme::Geographic, TileScheme::WebMercator] {
            let range = scheme.tiles_meeting(7, fiji);
            let count = scheme.columns() << 7;
            let [low, high] = &range.x[..] else { panic!("{range:?}") };
            assert_eq!((*low.start(), *high.end()), (0, count - 1));
            assert!(range.count() < count, "{} of {count} columns", range.count());
            let tiles: Vec<TileAddress> = range.tiles().collect();
            assert_eq!(tiles.len() as u64, range.count());
            for (index, &tile) in (0..).zip(&tiles) {
                assert_eq!((range.index(tile), range.contains(tile)), (index, true), "{tile:?}");
                let Rect { min, max } = scheme.extent(tile);
                assert!(max.x > fiji[0] || min.x < fiji[2], "{tile:?}");
            }
            assert!(!range.contains(TileAddress { x: count / 2, ..tiles[0] }));
            let below = tiles[0].below(7);
            assert_eq!(range.intersection(&below), below);
        }
        let halves = TileScheme::WebMercator.tiles_meeting(1, fiji);
        assert_eq!(halves.x, [0..=1], "tiles that meet are listed once");
    }

    #[test]
    fn children_lie_in_their_tile_and_have_numbers_in_a_range() {
        let tile = TileAddress { level: 5, x: 6, y: 13 };
        let below = tile.below(6);
        let children: Vec<TileAddress> = below.tiles().collect();
        assert_eq!(children, tile.children());
        assert_eq!(children.iter().map(|&child| below.index(child)).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert_eq!(below.tile([6, 13, 26]), Some(children[1]));
        assert_eq!((below.tile([6, 14, 26]), below.tile([5, 13, 26])), (None, None));
    }

    #[test]
    fn the_finest_level_has_places_as_close_as_the_samples() {
        let (globe, map) = (TileScheme::Geographic, TileScheme::WebMercator);
        assert_eq!(globe.level_of(64, 180.0 / 64.0), 0);
        // Three and one arc second.
        assert_eq!([3.0, 1.0].map(|second| globe.level_of(64, second / 3600.0)), [12, 14]);
        assert_eq!([3.0, 1.0].map(|second| map.level_of(256, second / 3600.0)), [11, 13]);
        assert_eq!(map.level_of(256, 1e-12), MOST_LEVEL);
    }
}
