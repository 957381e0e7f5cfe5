//! The elevation model as a lattice of posts, and a flat metric frame over it.
//!
//! Posts are numbered row by row from the north-west. The frame is a plate carrée true to scale at the
//! tile's middle latitude: x east and y north of the south-west corner, in meters. Over a tile of a third of
//! a degree its scale is off by less than 0.3 %, which is nothing to a road; no projection library is
//! needed, so the result is the same everywhere.

use glam::DVec2;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;

/// WGS 84 semi-major axis in meters.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// WGS 84 first eccentricity squared.
const ECCENTRICITY_2: f64 = 0.006_694_379_990_14;

/// Elevations on posts with their place on the Earth.
pub struct Ground {
    /// Posts per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Elevation in meters, row by row from the north.
    pub z: Vec<f64>,
    /// Longitude of the western edge of the raster.
    pub west: f64,
    /// Latitude of its northern edge.
    pub north: f64,
    /// Degrees between posts.
    pub step: f64,
    /// Meters between posts, eastward and northward.
    pub post_m: DVec2,
}

impl Ground {
    /// Reads the committed GeoTIFF: 16-bit samples, pixel scale and tie point, square pixels in degrees.
    pub fn read(bytes: &[u8]) -> Self {
        let raster = read("dem.tif", bytes, &DemHints::default()).expect("dem.tif is a GeoTIFF");
        let [west, step, _, north, ..] = raster.geotransform();
        let z = raster.samples.iter().collect();
        Self::new(raster.width as usize, raster.height as usize, z, DVec2::new(west, north), step)
    }

    /// A ground from its posts; `corner` is the longitude and latitude of the raster's north-west edge.
    pub fn new(width: usize, height: usize, z: Vec<f64>, corner: DVec2, step: f64) -> Self {
        assert_eq!(z.len(), width * height, "one elevation per post");
        let middle = (corner.y - step * height as f64 / 2.0).to_radians();
        let squeeze = 1.0 - ECCENTRICITY_2 * libm::sin(middle) * libm::sin(middle);
        let east = SEMI_MAJOR_M / squeeze.sqrt() * libm::cos(middle);
        let north = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_2) / (squeeze * squeeze.sqrt());
        let post_m = DVec2::new(east, north) * step.to_radians();
        Self { width, height, z, west: corner.x, north: corner.y, step, post_m }
    }

    /// Where post `index` stands in the metric frame.
    pub fn place(&self, index: usize) -> DVec2 {
        let (row, column) = (index / self.width, index % self.width);
        DVec2::new(column as f64 + 0.5, (self.height - row) as f64 - 0.5) * self.post_m
    }

    /// The post nearest to a point of the metric frame, clamped to the raster.
    pub fn post_at(&self, at: DVec2) -> usize {
        let grid = at / self.post_m;
        let column = grid.x.clamp(0.0, self.width as f64 - 1.0) as usize;
        let row = (self.height as f64 - grid.y).clamp(0.0, self.height as f64 - 1.0) as usize;
        row * self.width + column
    }

    /// Elevation at a point of the metric frame, bilinear between posts, clamped at the edge.
    pub fn at(&self, at: DVec2) -> f64 {
        let grid = at / self.post_m;
        let column = (grid.x - 0.5).clamp(0.0, self.width as f64 - 1.000_001);
        let row = (self.height as f64 - grid.y - 0.5).clamp(0.0, self.height as f64 - 1.000_001);
        let (left, top) = (column as usize, row as usize);
        let (right, down) = (column - left as f64, row - top as f64);
        let post = |row: usize, column: usize| self.z[row * self.width + column];
        let upper = post(top, left) * (1.0 - right) + post(top, left + 1) * right;
        let lower = post(top + 1, left) * (1.0 - right) + post(top + 1, left + 1) * right;
        upper * (1.0 - down) + lower * down
    }

    /// The direction of steepest rise times its slope, over a base of `reach_m` on each side.
    pub fn gradient(&self, at: DVec2, reach_m: f64) -> DVec2 {
        let across = |step: DVec2| (self.at(at + step) - self.at(at - step)) / (2.0 * reach_m);
        DVec2::new(across(DVec2::X * reach_m), across(DVec2::Y * reach_m))
    }

    /// A point of the metric frame from longitude and latitude.
    pub fn locate(&self, lon: f64, lat: f64) -> DVec2 {
        let south = self.north - self.step * self.height as f64;
        DVec2::new(lon - self.west, lat - south) / self.step * self.post_m
    }

    /// Longitude and latitude of a point of the metric frame.
    pub fn lon_lat(&self, at: DVec2) -> DVec2 {
        let south = self.north - self.step * self.height as f64;
        DVec2::new(self.west, south) + at / self.post_m * self.step
    }

    /// The eight neighbors of a post that lie in the raster, with their distance in meters, in the fixed
    /// order N, NE, E, SE, S, SW, W, NW.
    pub fn neighbors(&self, index: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        const AROUND: [(isize, isize); 8] =
            [(-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1)];
        let (row, column) = (index / self.width, index % self.width);
        AROUND.iter().filter_map(move |&(down, right)| {
            let row = row.checked_add_signed(down).filter(|&row| row < self.height)?;
            let column = column.checked_add_signed(right).filter(|&column| column < self.width)?;
            let far = (self.post_m * DVec2::new(right as f64, down as f64)).length();
            Some((row * self.width + column, far))
        })
    }

    /// Whether a post is on the raster's outermost ring.
    pub fn on_edge(&self, index: usize) -> bool {
        let (row, column) = (index / self.width, index % self.width);
        row == 0 || column == 0 || row + 1 == self.height || column + 1 == self.width
    }
}
