//! The ground map at a pixel: heights, slopes and light filtered over the pixel's footprint, ramp and contours.
//!
//! Near the eye this is the map's own bilinear reading. Far away, where a pixel spans many posts, the map is read from
//! its coarser levels, along the longer side of the footprint.

use std::sync::OnceLock;

use glam::{Vec2, Vec3};

use crate::cpu::hit::FacePoint;
use crate::cpu::texture::{Reading, Texel, TexelFootprint, Texture, Weighting};
use sandtable_draw::cover_noise::{CoverNoise, NoisePixel};
use sandtable_draw::ground::{Contours, GroundDetail, GroundMap, GroundPost, PixelChange};
use sandtable_draw::ground_cover::LandPixel;
use sandtable_draw::ground_grain::ground_grain;
use sandtable_draw::ground_imagery::{DrapedColor, GroundImagery};
use sandtable_draw::ground_levels::{GroundLevel, PostCount, add_weighted, coarser_levels};
use sandtable_draw::ground_tops::GroundTops;
use sandtable_draw::lighting::{ReceivedLight, ReliefPoint, ReliefShading};
use sandtable_draw::material::TextureWrap;
use sandtable_draw::relief_lanes::ReliefPixel;
use sandtable_draw::water::ShorePixel;
use sandtable_draw::water_relief::{MirroredRay, RayEnd};

#[derive(Debug)]
pub struct GroundShader<'a> {
    map: &'a GroundMap,
    /// The place of the map's world space in that of the noise, which goes on from map to map.
    noise_origin: Vec2,
    posts_per_meter: Vec2,
    /// The last column and row.
    last: Vec2,
    coarser: Vec<GroundLevel>,
    /// Made when the first ray asks for them: most pictures mirror no relief.
    tops: OnceLock<GroundTops>,
    draped: Option<(&'a GroundImagery, Texture<'a>)>,
    relief: ReliefShading,
    /// The direction to the light in plan, of length 1; zero for a light straight above.
    toward_light: Vec2,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct GroundPoint {
    /// Height, slopes and light.
    pub post: GroundPost,
    /// The rise of `height_m` eastward and northward, meters per meter.
    gradient: Vec2,
    /// The same of `water`, per meter.
    water_gradient: Vec2,
    /// The picture over the map.
    pub draped: DrapedColor,
    /// The slopes of forms too small for the map, where it has a cover that shows.
    small: Vec2,
    /// The color of its land in linear light, where it shows the map and land.
    land: Option<Vec3>,
}

/// A point whose cover is wanted.
pub struct CoveredPoint<'b> {
    pub point: &'b mut GroundPoint,
    pub hit: &'b FacePoint,
    /// Whether its color is the map's, and not that of what lies on the ground.
    pub shows_map: bool,
}

impl<'a> GroundShader<'a> {
    pub fn new(map: &'a GroundMap, to_sun: Vec3) -> Self {
        let coarser = coarser_levels(map).collect();
        let draped = map.imagery.as_deref().map(|imagery| (imagery, Texture::new(&imagery.pixels)));
        let fill = f32::from(u8::from(map.cover.is_some()));
        let relief = ReliefShading {
            shade_gain: map.shade_gain,
            fill,
            detail: map.detail,
            ..ReliefShading::new(to_sun)
        };
        Self {
            map,
            noise_origin: Vec2::ZERO,
            posts_per_meter: map.cell.recip(),
            last: Vec2::new((map.columns - 1) as f32, (map.rows - 1) as f32),
            coarser,
            tops: OnceLock::new(),
            draped,
            relief,
            toward_light: to_sun.truncate().normalize_or_zero(),
        }
    }

    /// The same for a finer map whose world space lies at `origin` in that of the outermost.
    pub fn within(self, origin: Vec2) -> Self {
        Self { noise_origin: origin, ..self }
    }

    /// A point that receives `received` past solids, as its shading sees it; `form` is the [generalized ground](Self::form) there.
    pub fn relief_pixel(
        &self,
        albedo: Vec3,
        point: &GroundPoint,
        form: &GroundPost,
        received: ReceivedLight,
    ) -> ReliefPixel {
        let small = self.map.cover.map_or(Vec2::ZERO, |cover| cover.form(&point.post, point.small));
        let shaded = GroundPost {
            slope_east: point.post.slope_east + small.x,
            slope_north: point.post.slope_north + small.y,
            ..point.post
        };
        let point = ReliefPoint {
            normal: self.map.shaded_normal(&shaded),
            form: self.map.shaded_normal(form),
            sun_visibility: point.post.sun_visibility * received.sun,
            sky_visibility: point.post.sky_visibility * received.sky,
            elevation: self.map.ramp.elevation(point.post.height_m),
        };
        ReliefPixel { albedo, point }
    }

    /// The light that the ground returns at each of `pixels`, before haze; see [`ReliefShading`].
    pub fn lit_each(&self, pixels: &[ReliefPixel]) -> Vec<Vec3> {
        self.relief.shade_each(pixels)
    }

    /// The slopes of the generalized ground at a world position: all else that it has is 0, and shades nothing.
    pub fn form(&self, at: Vec2) -> GroundPost {
        let mut form = GroundPost::default();
        let level = self.coarser.len().min(self.map.form_level as usize);
        let cell = self.cell_at(at, level);
        for (post, share) in cell.corners.iter().zip(cell.weights()) {
            form.slope_east += post.slope_east * share;
            form.slope_north += post.slope_north * share;
        }
        form
    }

    /// The ray `direction`, of unit length, that water at world position `at` mirrors; `None` where it is upright.
    pub fn mirrored_ray(&self, at: Vec2, direction: Vec3) -> Option<MirroredRay> {
        MirroredRay::new(self.map, at, direction)
    }

    /// Where a mirrored ray first meets the map from `start_m` on.
    pub fn met_by(&self, ray: &MirroredRay, start_m: f32) -> RayEnd {
        ray.meets(self.map, self.tops.get_or_init(|| GroundTops::new(self.map)), start_m)
    }

    /// The light that the ground at a point returns to water, before haze: without the textures of its cover, grain and
    /// contours. `form` is the [generalized ground](Self::form) there.
    pub fn mirrored(&self, hit: &FacePoint, form: &GroundPost, most_taps: u32) -> Vec3 {
        let point = self.read(hit, most_taps);
        let albedo = self.map.mirrored_land(&point.post, &point.draped);
        let ReliefPixel { albedo, point: relief } =
            self.relief_pixel(albedo, &point, form, ReceivedLight::ALL);
        self.relief.shade(albedo, &relief).lerp(albedo, self.unlit_share(&point))
    }

    /// Gives points that were [read](Self::read) their small forms, and those that show the map the color of their land.
    pub fn cover_each<'b>(&self, points: impl Iterator<Item = CoveredPoint<'b>>) {
        let mut points: Vec<_> = points.filter(|at| self.shows_land(at.point, at.hit)).collect();
        let mut noises = vec![CoverNoise::default(); points.len()];
        if self.map.cover.is_some() {
            let pixels: Vec<_> = points.iter().map(|at| self.noise_pixel(at.point, at.hit)).collect();
            noises = CoverNoise::of_each(&pixels, self.cell_m());
            points.iter_mut().zip(&noises).for_each(|(at, noise)| at.point.small = noise.form);
        }
        let shown = points.iter().zip(noises).filter(|(at, _)| at.shows_map);
        let pixels: Vec<_> = shown.map(|(at, noise)| self.land_pixel(at.point, at.hit, noise)).collect();
        points.retain(|at| at.shows_map);
        for (at, land) in points.iter_mut().zip(self.map.land_each(&pixels)) {
            at.point.land = Some(land);
        }
    }

    /// Whether a pixel shows land: open water hides it, and so does a picture, with all that the noise is for.
    fn shows_land(&self, point: &GroundPoint, hit: &FacePoint) -> bool {
        point.draped.share < 1.0 && !self.shore(point, hit).is_open()
    }

    fn cell_m(&self) -> f32 {
        self.map.model_cell_m()
    }

    fn noise_pixel(&self, point: &GroundPoint, hit: &FacePoint) -> NoisePixel {
        let at = hit.world.truncate() + self.noise_origin;
        self.map.noise_pixel(&point.post, at, hit.mean_pixel_m(), hit.pixel_m())
    }

    fn land_pixel(&self, point: &GroundPoint, hit: &FacePoint, noise: CoverNoise) -> LandPixel {
        let (tint, change_m) = (self.map.tint(&point.post), change(point.gradient, hit));
        LandPixel { tint, post: point.post, change_m, noise }
    }

    /// A point without its small forms and its land.
    pub fn read(&self, hit: &FacePoint, most_taps: u32) -> GroundPoint {
        let mut point = GroundPoint::default();
        self.read_to(&mut point, hit, most_taps);
        point
    }

    /// [`Self::read`] to a default point where it stays: sums of many small numbers that are moved are waited for.
    pub fn read_to(&self, point: &mut GroundPoint, hit: &FacePoint, most_taps: u32) {
        let [right, down] = [hit.right.truncate(), hit.down.truncate()];
        let footprint = TexelFootprint::new(right, down, self.posts_per_meter, most_taps);
        let level = footprint.level.min(self.coarser.len() as f32);
        let finer = level as u32;
        let (finer, part) = (finer as usize, level - finer as f32);
        let share = 1.0 / footprint.taps as f32;
        for offset in footprint.offsets() {
            let at = hit.world.truncate() + offset;
            self.add_bilinear(point, at, finer, share * (1.0 - part));
            if part > 0.0 {
                self.add_bilinear(point, at, finer + 1, share * part);
            }
        }
        if let Some((imagery, texture)) = &self.draped {
            point.draped = draped(imagery, texture, hit, most_taps);
        }
    }

    /// The share of a point whose color is shown as it is, without light.
    pub fn unlit_share(&self, point: &GroundPoint) -> f32 {
        if self.draped.as_ref().is_some_and(|(imagery, _)| !imagery.is_shaded) {
            point.draped.share
        } else {
            0.0
        }
    }

    /// The map's color at a point, in linear light: the ramp, water or the picture over them, with contours.
    pub fn albedo(&self, point: &GroundPoint, hit: &FacePoint) -> Vec3 {
        let change =
            PixelChange { height_m: change(point.gradient, hit), water: change(point.water_gradient, hit) };
        let down = (-point.gradient).try_normalize().unwrap_or_default();
        let land = point.land.unwrap_or_else(|| self.map.tint(&point.post));
        let detail = GroundDetail {
            grain: self.grain(point, hit),
            land,
            draped: point.draped,
            facing: down.dot(self.toward_light),
        };
        self.map.albedo(&point.post, change, &detail)
    }

    /// The share of a pixel that a contour line on dry ground covers.
    pub fn contour_cover(&self, point: &GroundPoint, hit: &FacePoint) -> f32 {
        let strength =
            |contours: &Contours| contours.strength(point.post.height_m, change(point.gradient, hit));
        self.map.contours.as_ref().map_or(0.0, strength) * (1.0 - self.water_cover(point, hit))
    }

    /// The factor of the ground's grain on its color, and on that of natural cover on it.
    pub fn grain(&self, point: &GroundPoint, hit: &FacePoint) -> f32 {
        if !self.map.has_grain {
            return 1.0;
        }
        let rise = Vec2::new(point.post.slope_east, point.post.slope_north).length();
        ground_grain(hit.world.truncate(), hit.pixel_m(), rise)
    }

    /// The share of a pixel that is under water.
    pub fn water_cover(&self, point: &GroundPoint, hit: &FacePoint) -> f32 {
        self.shore(point, hit).cover
    }

    fn shore(&self, point: &GroundPoint, hit: &FacePoint) -> ShorePixel {
        ShorePixel::new(point.post.water, change(point.water_gradient, hit))
    }

    /// The cell of a level around world position `at`.
    fn cell_at(&self, at: Vec2, level: usize) -> GroundCell<'_> {
        let (size, posts) = match level.checked_sub(1) {
            Some(index) => (self.coarser[index].size, self.coarser[index].posts.as_slice()),
            None => (PostCount::from_map(self.map), self.map.posts.as_slice()),
        };
        let (columns, rows) = (size.columns as usize, size.rows as usize);
        let scale = halved(level as u32);
        let grid = ((at - self.map.origin) * self.posts_per_meter).clamp(Vec2::ZERO, self.last) * scale;
        let (column, x) = split(grid.x, columns);
        let (row, y) = split(grid.y, rows);
        let east = usize::from(columns > 1);
        let north = if rows > 1 { columns } else { 0 };
        let first = row * columns + column;
        let corners = [first, first + east, first + north, first + north + east].map(|index| &posts[index]);
        GroundCell { corners, part: Vec2::new(x, y), scale }
    }

    /// Adds `weight` times the bilinear reading of a level at world position `at`.
    fn add_bilinear(&self, sum: &mut GroundPoint, at: Vec2, level: usize, weight: f32) {
        let cell = self.cell_at(at, level);
        for (post, share) in cell.corners.iter().zip(cell.weights()) {
            add_weighted(&mut sum.post, post, weight * share);
        }
        let per_meter = self.posts_per_meter * (cell.scale * weight);
        sum.gradient += cell.rise(cell.corners.map(|post| post.height_m)) * per_meter;
        let water = cell.corners.map(|post| post.water);
        // Nearly everywhere there is no shore.
        if water[1..] != [water[0]; 3] {
            sum.water_gradient += cell.rise(water) * per_meter;
        }
    }
}

/// Four posts around a place.
struct GroundCell<'a> {
    /// South-west, south-east, north-west, north-east.
    corners: [&'a GroundPost; 4],
    /// Where in the cell the place is, 0..=1 eastward and northward.
    part: Vec2,
    /// Cells of the finest level per cell, inverted.
    scale: f32,
}

impl GroundCell<'_> {
    /// The weights of the corners; their sum is 1.
    fn weights(&self) -> [f32; 4] {
        let Vec2 { x, y } = self.part;
        [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
    }

    /// The rise over the cell of what is this at its corners.
    fn rise(&self, [sw, se, nw, ne]: [f32; 4]) -> Vec2 {
        let Vec2 { x, y } = self.part;
        Vec2::new((se - sw) * (1.0 - y) + (ne - nw) * y, (nw - sw) * (1.0 - x) + (ne - se) * x)
    }
}

/// The draped picture over a pixel.
fn draped(imagery: &GroundImagery, texture: &Texture<'_>, hit: &FacePoint, most_taps: u32) -> DrapedColor {
    let Some(uv) = imagery.uv(hit.world.truncate()) else { return DrapedColor::default() };
    // V runs southward.
    let uv_per_m = Vec2::new(1.0, -1.0) / imagery.size;
    let [right, down] = [hit.right, hit.down].map(|side| side.truncate() * uv_per_m);
    let footprint = TexelFootprint::new(right, down, texture.size(), most_taps);
    let reading = Reading { weighting: Weighting::ByAlpha, wrap: [TextureWrap::Repeat; 2] };
    let Texel { color, alpha } = texture.sample(uv, &footprint, reading);
    DrapedColor { color, share: alpha }
}

/// What changes by `gradient` per meter changes by this across a pixel.
fn change(gradient: Vec2, hit: &FacePoint) -> f32 {
    Vec2::new(gradient.dot(hit.right.truncate()), gradient.dot(hit.down.truncate())).length()
}

/// The cell of a coordinate among `count` posts, and the place in it. By way of 32 bits, to which processors round in one step.
fn split(coordinate: f32, count: usize) -> (usize, f32) {
    let cell = (coordinate as u32).min((count as u32).saturating_sub(2));
    (cell as usize, coordinate - cell as f32)
}

/// 1, halved `times` times, at most 32: there are no more levels.
fn halved(times: u32) -> f32 {
    const ONE: u32 = 127;
    f32::from_bits((ONE - times) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::ground::ColorRamp;

    fn map(columns: u32, rows: u32, height: impl Fn(f32, f32) -> f32) -> GroundMap {
        let post = |index: u32| GroundPost {
            height_m: height((index % columns) as f32, (index / columns) as f32),
            sun_visibility: 0.5,
            ..GroundPost::default()
        };
        let stops = [(0.0, Srgba::opaque(10, 60, 200)), (9.0, Srgba::WHITE), (20.0, Srgba::opaque(0, 0, 0))];
        GroundMap {
            origin: Vec2::new(-30.0, 70.0),
            cell: Vec2::new(2.0, 5.0),
            columns,
            rows,
            posts: (0..columns * rows).map(post).collect(),
            ramp: ColorRamp::new(stops.to_vec()).expect("rising"),
            ..GroundMap::level()
        }
    }

    fn hit(world: Vec3, pixel_m: f32) -> FacePoint {
        FacePoint { world, distance_m: 1.0, right: Vec3::X * pixel_m, down: Vec3::Y * pixel_m }
    }

    #[test]
    fn halves_of_one_are_powers_of_two() {
        assert!((0..=32).all(|times| halved(times) == 1.0 / (1u64 << times) as f32));
    }

    #[test]
    fn close_up_the_reading_is_that_of_the_map() {
        let map = map(6, 5, |x, y| x * x - 3.0 * y + x * y);
        let ground = GroundShader::new(&map, Vec3::Z);
        for at in [(-30.0, 70.0), (-27.3, 81.2), (-20.0, 90.0), (-99.0, 77.0), (99.0, 999.0)] {
            let at = Vec2::from(at);
            let point = ground.read(&hit(at.extend(0.0), 0.01), 8);
            assert!((point.post.height_m - map.sample(at).height_m).abs() < 1e-4, "{at}");
        }
    }

    #[test]
    fn every_level_keeps_an_even_slope_in_place() {
        let map = map(129, 129, |x, y| 3.0 * x - 2.0 * y);
        let ground = GroundShader::new(&map, Vec3::Z);
        let middle = Vec2::new(-30.0 + 2.0 * 64.0, 70.0 + 5.0 * 64.0);
        for pixel_m in [0.1, 4.0, 9.0, 20.0] {
            let point = ground.read(&hit(middle.extend(0.0), pixel_m), 1);
            assert!((point.post.height_m - 64.0).abs() < 1e-3, "{pixel_m}: {}", point.post.height_m);
            assert!((point.post.sun_visibility - 0.5).abs() < 1e-5);
            let rise = point.gradient - Vec2::new(1.5, -0.4);
            assert!(rise.length() < 1e-3, "{pixel_m}: {}", point.gradient);
        }
    }

    #[test]
    fn far_away_sharp_ground_reads_as_its_mean() {
        let map = map(64, 64, |x, y| if (x + y) % 2.0 == 0.0 { 0.0 } else { 10.0 });
        let point = GroundShader::new(&map, Vec3::Z).read(&hit(Vec3::new(31.0, 230.0, 0.0), 100.0), 8);
        assert!((point.post.height_m - 5.0).abs() < 0.2, "{}", point.post.height_m);
    }
}
