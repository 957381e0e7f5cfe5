//! The ground map as a texture: tints, water, a draped picture and contours seen from straight above, without light and shadow.

use glam::Vec2;
use rayon::prelude::*;

use sandtable_draw::color::Srgba;
use sandtable_draw::cover_noise::CoverNoise;
use sandtable_draw::ground::{GroundDetail, GroundMap, GroundPost, PixelChange};
use sandtable_draw::ground_cover::LandPixel;
use sandtable_draw::pixels::Pixels;

/// The longest side in pixels: the most that every graphics adapter supports.
const LONGEST_PX: u32 = 4096;

/// Pixels a cell: fewer make contours between posts jagged.
const PIXELS_PER_CELL: f32 = 2.0;

/// A ground map as pixels, and the rectangle that they cover.
pub struct BakedGround {
    /// North up.
    pub pixels: Pixels,
    origin: Vec2,
    size: Vec2,
}

impl BakedGround {
    /// The texture coordinates of a world position; V runs downward.
    pub fn uv(&self, at: Vec2) -> Vec2 {
        let part = (at - self.origin) / self.size;
        Vec2::new(part.x, 1.0 - part.y)
    }
}

/// All of `map`, which must be sound ([`GroundMap::check`]).
pub fn bake(map: &GroundMap) -> BakedGround {
    let cells = Vec2::new((map.columns.max(2) - 1) as f32, (map.rows.max(2) - 1) as f32);
    let size = cells * map.cell;
    // Square pixels.
    let draped_px_m = map.imagery.as_deref().map(|imagery| imagery.pixels_per_m().recip().min_element());
    let wanted_m = (map.cell.min_element() / PIXELS_PER_CELL).min(draped_px_m.unwrap_or(f32::INFINITY));
    let meters_per_px = wanted_m.max(size.max_element() / LONGEST_PX as f32);
    let pixels = (size / meters_per_px).round().max(Vec2::ONE);
    let (width, height) = (pixels.x as u32, pixels.y as u32);
    let step = size / pixels;
    let pixel = |index: u32| {
        let (x, y) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        color(map, map.origin + Vec2::new(x * step.x, size.y - y * step.y), step)
    };
    let data = (0..width * height).into_par_iter().map(pixel).collect();
    let pixels = Pixels::from_data(width, height, data).expect("as many pixels as the size says");
    BakedGround { pixels, origin: map.origin, size }
}

fn color(map: &GroundMap, at: Vec2, step: Vec2) -> Srgba {
    let half = step / 2.0;
    let [west, east, south, north] = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)]
        .map(|(x, y)| map.sample(at + Vec2::new(x, y) * half));
    let change =
        |of: fn(&GroundPost) -> f32| Vec2::new(of(&east) - of(&west), of(&north) - of(&south)).length();
    let change = PixelChange { height_m: change(|post| post.height_m), water: change(|post| post.water) };
    let draped = map.imagery.as_deref().map(|imagery| imagery.at(at)).unwrap_or_default();
    let post = map.sample(at);
    let wide_m = step.max_element();
    let noise = |_| CoverNoise::new(&map.noise_pixel(&post, at, wide_m, wide_m), map.model_cell_m());
    let noise = map.cover.map(noise).unwrap_or_default();
    let land = map.land(&LandPixel { tint: map.tint(&post), post, change_m: change.height_m, noise });
    Srgba::from_linear(map.albedo(&post, change, &GroundDetail { grain: 1.0, land, draped, facing: 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::ground::{ColorRamp, Contours, GroundPost};

    /// Ground that rises eastward, 10 m a post of 20 m, colored dark below and light above.
    fn map(contours: Option<Contours>) -> GroundMap {
        let post = |index: u32| GroundPost { height_m: (index % 5) as f32 * 10.0, ..GroundPost::default() };
        GroundMap {
            origin: Vec2::new(100.0, 50.0),
            cell: Vec2::new(20.0, 40.0),
            columns: 5,
            rows: 3,
            posts: (0..15).map(post).collect(),
            ramp: ColorRamp::new(vec![(0.0, Srgba::opaque(0, 0, 0)), (40.0, Srgba::WHITE)]).expect("rising"),
            contours,
            ..GroundMap::level()
        }
    }

    #[test]
    fn west_is_left_and_north_is_up() {
        let baked = bake(&map(None));
        assert_eq!((baked.pixels.width(), baked.pixels.height()), (8, 8));
        assert!(baked.pixels.at(0, 3).0[0] < baked.pixels.at(7, 3).0[0]);
        assert_eq!(baked.uv(Vec2::new(100.0, 50.0)), Vec2::new(0.0, 1.0));
        assert_eq!(baked.uv(Vec2::new(180.0, 130.0)), Vec2::new(1.0, 0.0));
    }

    #[test]
    fn contours_are_painted_where_they_run() {
        let red = Srgba::opaque(255, 0, 0);
        let contours = Contours { interval_m: 400.0, major_every: 5, color: red, width_px: 1.0, lit: None };
        let painted = bake(&map(Some(Contours { interval_m: 20.0, ..contours })));
        let is_red = |x: u32| painted.pixels.at(x, 2).0[1] < painted.pixels.at(x, 2).0[0];
        assert!(!is_red(1), "at 7 m");
        assert_eq!(bake(&map(Some(contours))).pixels.at(4, 2), bake(&map(None)).pixels.at(4, 2));
    }
}
