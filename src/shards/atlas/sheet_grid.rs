//! The sheets of an atlas: where they lie, and what they are called.

use glam::DVec2;

use crate::atlas::arguments::{AtlasArguments, pixel_m};
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{PictureSize, page_frame};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;

/// Sheets of one size around the ground, whose middle is theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetGrid {
    /// The north-west corner, world X and Y.
    corner: DVec2,
    /// Width and height of a sheet on the ground, meters.
    sheet_m: DVec2,
    pub columns: u64,
    pub rows: u64,
}

impl SheetGrid {
    /// The sheets of a scene.
    pub fn new(scene: &SceneModel, arguments: &AtlasArguments) -> Self {
        let (width, height) = arguments.paper().size_px();
        let frame = page_frame(scene, PictureSize { width, height });
        let (width, height) = frame.map_or((width, height), |frame| frame.picture_size());
        let m_per_px = pixel_m(arguments.scale, arguments.dpi);
        Self::around(scene.lattice.extent(), DVec2::new(f64::from(width), f64::from(height)) * m_per_px)
    }

    fn around(ground: Rect, sheet_m: DVec2) -> Self {
        let count = (ground.size() / sheet_m).ceil().max(DVec2::ONE);
        let half = count * sheet_m / 2.0;
        let corner = ground.center() + DVec2::new(-half.x, half.y);
        Self { corner, sheet_m, columns: count.x as u64, rows: count.y as u64 }
    }

    /// The ground of a sheet, world X and Y; rows count from the north.
    pub fn rect(&self, row: u64, column: u64) -> Rect {
        let west_north = self.corner + DVec2::new(column as f64, -(row as f64)) * self.sheet_m;
        Rect { min: west_north - DVec2::Y * self.sheet_m.y, max: west_north + DVec2::X * self.sheet_m.x }
    }
}

/// The name of a sheet: its row in letters from the north, its column as a number from the west.
pub fn sheet_name(row: u64, column: u64) -> String {
    let mut letters = Vec::new();
    let mut rest = row + 1;
    while rest > 0 {
        letters.push(char::from(b'A' + ((rest - 1) % 26) as u8));
        rest = (rest - 1) / 26;
    }
    format!("{}{}", letters.iter().rev().collect::<String>(), column + 1)
}

/// The number of posts with elevation in a rectangle, world X and Y.
pub fn posts_in(lattice: &Lattice, rect: &Rect) -> usize {
    let posts = PostRect::within(lattice, rect);
    posts.map_or(0, |posts| posts.posts().filter(|&post| !lattice.height(post).is_nan()).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_are_named_as_columns_of_tables_are() {
        let names: Vec<String> = [0, 25, 26, 51, 52, 701, 702].map(|row| sheet_name(row, 2)).into();
        assert_eq!(names, ["A3", "Z3", "AA3", "AZ3", "BA3", "ZZ3", "AAA3"]);
    }

    #[test]
    fn sheets_cover_the_ground_from_its_middle_and_meet() {
        let ground = Rect { min: DVec2::ZERO, max: DVec2::new(1000.0, 500.0) };
        let grid = SheetGrid::around(ground, DVec2::new(400.0, 300.0));
        assert_eq!((grid.columns, grid.rows), (3, 2));
        assert_eq!(grid.rect(0, 0).min, DVec2::new(-100.0, 250.0));
        assert_eq!(grid.rect(1, 2).max, DVec2::new(1100.0, 250.0));
        assert_eq!(grid.rect(0, 1).min.x, grid.rect(0, 0).max.x);
        assert_eq!(grid.rect(0, 1).min.y, grid.rect(1, 1).max.y);
    }
}
