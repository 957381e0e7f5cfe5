//! The ground as a map: heights, slopes and light per post, and the colors they are drawn in.
//!
//! The drawn mesh may be coarse. Color, contours and shading are read from this map at every pixel, so that the
//! picture shows the elevation model and not the triangles.

use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3};

use crate::color::Srgba;
use crate::cover_noise::{CoverNoise, NoisePixel};
use crate::ground_cover::{GroundCover, LandPixel};
use crate::ground_imagery::{DrapedColor, GroundImagery};
use crate::lighting::ReliefShading;
use crate::undergrowth::Undergrowth;
use crate::water::{ShorePixel, WaterColor};

/// The look of the ground at the posts of a regular grid; row 0 is the southernmost.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundMap {
    /// World X and Y of the south-west post, in meters.
    pub origin: Vec2,
    /// Distance between posts eastward and northward, in meters, both positive.
    pub cell: Vec2,
    /// World Z per meter of elevation, above 0: how far heights are exaggerated as they are drawn.
    pub z_per_m: f32,
    /// Posts per row.
    pub columns: u32,
    /// Rows of posts.
    pub rows: u32,
    /// One entry per post, row by row from the south-west.
    pub posts: Vec<GroundPost>,
    /// How often the cells of the model were halved: its own forms are `2^halvings` of the map's cells wide and wider.
    pub halvings: u32,
    /// Whether the ground may be shaded as curved between its posts: not where posts lie on planes between others.
    pub is_curved: bool,
    /// Color by height.
    pub ramp: ColorRamp,
    /// Contour lines; `None` draws none.
    pub contours: Option<Contours>,
    /// A picture over ramp and water.
    pub imagery: Option<Arc<GroundImagery>>,
    /// What grows and lies on it; `None` shows the ramp alone.
    pub cover: Option<GroundCover>,
    /// How often the distance between posts is doubled in the generalized ground whose large forms are shaded; see
    /// [`ReliefShading`].
    pub form_level: u32,
    /// The factor on slopes before they are shaded, at least 0: a z-factor, as if heights were exaggerated for their
    /// shading alone.
    pub z_factor: f32,
    /// The change of brightness with shade; see [`ReliefShading::shade_gain`].
    pub shade_gain: f32,
    /// How strongly forms show in the shade; see [`ReliefShading::detail`].
    pub detail: f32,
    /// Whether it is natural ground, with the grain of [`ground_grain`](crate::ground_grain::ground_grain).
    pub has_grain: bool,
}

/// The ground at one post.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct GroundPost {
    /// Elevation in meters, true to scale; posts without data hold a neighbor's height, and those of level ground at the
    /// height of a contour line are [moved off it](crate::contour_ground).
    pub height_m: f32,
    /// Rise eastward of the drawn ground, meters per meter.
    pub slope_east: f32,
    /// Rise northward of the drawn ground, meters per meter.
    pub slope_north: f32,
    /// Share of the sun that reaches the post past other terrain, 0..=1.
    pub sun_visibility: f32,
    /// Share of the sky seen from the post, 0..=1; of ground with texture shading up to [`Self::MOST_SKY`] on its crests, which
    /// are lighter than level ground.
    pub sky_visibility: f32,
    /// Below 0.5 on land and above it under water, so that the shore lies at 0.5 between posts. It rises evenly across the
    /// shore; from 0.75 to 1 it says how far open water is. Negative under trees: −1 where crowns cover all of the ground.
    pub water: f32,
}

/// Colors at rising heights, interpolated in linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorRamp {
    stops: Vec<(f32, Vec3)>,
}

impl ColorRamp {
    /// A ramp from `stops` of height in meters and color.
    ///
    /// `None` where there is no stop, or heights do not rise strictly or are not finite.
    pub fn new(stops: Vec<(f32, Srgba)>) -> Option<Self> {
        let finite = stops.iter().all(|(height, _)| height.is_finite());
        let rising = stops.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let linear = stops.into_iter().map(|(height, color)| (height, color.linear()));
        let ramp = Self { stops: linear.collect() };
        (!ramp.stops.is_empty() && finite && rising).then_some(ramp)
    }

    /// Rising heights in meters with their colors in linear light.
    pub fn stops(&self) -> &[(f32, Vec3)] {
        &self.stops
    }

    /// The ramp as `steps` colors in linear light, evenly spaced from the lowest to the highest stop.
    pub fn table(&self, steps: usize) -> Vec<Vec3> {
        let (low, high) = self.height_range();
        let height = |step: usize| low + (high - low) * step as f32 / (steps - 1).max(1) as f32;
        (0..steps).map(|step| self.linear_at(height(step))).collect()
    }

    /// `height_m` as a share of the range of the stops, 0..=1 between them; 0 where there is one stop.
    #[inline]
    pub fn elevation(&self, height_m: f32) -> f32 {
        let (low, high) = self.height_range();
        if high > low { (height_m - low) / (high - low) } else { 0.0 }
    }

    /// The heights of the lowest and the highest stop.
    pub fn height_range(&self) -> (f32, f32) {
        (self.stops[0].0, self.stops[self.stops.len() - 1].0)
    }

    /// The color at `height_m` in linear light; beyond the ends the color of the end.
    pub fn linear_at(&self, height_m: f32) -> Vec3 {
        let above = self.stops.partition_point(|stop| stop.0 <= height_m);
        let (low, below) = self.stops[above.saturating_sub(1)];
        match self.stops.get(above) {
            Some(&(high, color)) if above > 0 => below.lerp(color, (height_m - low) / (high - low)),
            _ => below,
        }
    }
}

/// Contour lines of constant width on the picture.
///
/// At a pixel, `w` is the change of height across one pixel, `sqrt((∂h/∂x)² + (∂h/∂y)²)` on the screen. A line
/// covers `clamp(width / 2 + 0.5 − |h − nearest line| / w, 0, 1)` of the pixel and is faded by `f(spacing)` with
/// `f(s) = clamp((s / w − 4) / 6, 0, 1)`, so that lines vanish before they run together. `spacing` is the interval
/// for ordinary lines and the interval × `major_every` for heavy ones, which vanish later. Ordinary lines are
/// `width_px` wide, heavy ones `width_px · (1 + f(interval))`.
///
/// Illuminated lines (Tanaka 1950) have the color `lit` on slopes toward the light and `color` on those away from it, and
/// are the wider the more the slope faces the light or turns its back to it, as the edges of a stack of boards would be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contours {
    /// Height between lines, in meters.
    pub interval_m: f32,
    /// Every how many lines one is heavy; 1 makes all heavy.
    pub major_every: u32,
    /// The color, with alpha as strength.
    pub color: Srgba,
    /// Width of an ordinary line in pixels.
    pub width_px: f32,
    /// The color of lines on slopes toward the light, whose alpha counts for nothing; `None` for lines of one color and width.
    pub lit: Option<Srgba>,
}

/// What a contour line adds to a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourInk {
    /// Its color in linear light.
    pub color: Vec3,
    /// The share of the pixel that it covers, its strength included.
    pub cover: f32,
}

impl Contours {
    /// The share of a pixel that a contour covers, 0..=1, faded: the formula above for ground at `height_m` whose
    /// height changes by `change_m` across the pixel.
    ///
    /// 0 where the ground is level over the pixel: a lake at the height of a line is no line.
    pub fn strength(&self, height_m: f32, change_m: f32) -> f32 {
        self.cover(height_m, change_m, self.width_px)
    }

    /// The width of illuminated lines along the light, of `width_px`, and what is added to it across the light.
    pub const LIT_WIDTH: [f32; 2] = [0.5, 1.9];
    /// How fast illuminated lines change their color where slopes turn from the light.
    pub const LIT_TURN: f32 = 6.0;

    /// The line at a pixel of [this](Self::strength) height and change. `facing` is the cosine of the angle between the directions
    /// in plan down the slope and to the light.
    pub fn ink(&self, height_m: f32, change_m: f32, facing: f32) -> ContourInk {
        let (dark, alpha) = (self.color.linear(), self.color.alpha());
        let Some(lit) = self.lit else {
            return ContourInk { color: dark, cover: self.strength(height_m, change_m) * alpha };
        };
        let [along, across] = Self::LIT_WIDTH;
        let width_px = self.width_px * (along + across * facing.abs());
        let color = dark.lerp(lit.linear(), (0.5 + facing * Self::LIT_TURN).clamp(0.0, 1.0));
        ContourInk { color, cover: self.cover(height_m, change_m, width_px) * alpha }
    }

    fn cover(&self, height_m: f32, change_m: f32, width_px: f32) -> f32 {
        let interval = self.interval_m;
        if !(interval > 0.0 && change_m > interval * 1e-6) {
            return 0.0;
        }
        let number = (height_m / interval).round();
        let is_major = self.major_every > 0 && (number as i64).rem_euclid(self.major_every.into()) == 0;
        let fade = |spacing: f32| ((spacing / change_m - 4.0) / 6.0).clamp(0.0, 1.0);
        let minor = fade(interval);
        let (width, strength) = if is_major {
            (width_px * (1.0 + minor), fade(interval * self.major_every as f32))
        } else {
            (width_px, minor)
        };
        let away_px = (height_m - number * interval).abs() / change_m;
        (width / 2.0 + 0.5 - away_px).clamp(0.0, 1.0) * strength
    }
}

/// `land` with the undergrowth of the woods there.
#[inline]
fn undergrown(land: Vec3, post: &GroundPost) -> Vec3 {
    // Nearly everywhere there are no trees, and no share of undergrowth changes nothing.
    let woods = Undergrowth::cover(post.water);
    if woods > 0.0 { Undergrowth::over(land, woods) } else { land }
}

/// The values of a pixel of the ground besides the map's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundDetail {
    /// The factor of [`ground_grain`](crate::ground_grain::ground_grain).
    pub grain: f32,
    /// The color of its land in linear light: see [`GroundMap::land`].
    pub land: Vec3,
    /// The picture over the map.
    pub draped: DrapedColor,
    /// The cosine of the angle between the directions in plan down the slope and to the light; 0 where there is none.
    pub facing: f32,
}

/// The change of the ground's values across a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelChange {
    /// The change of the elevation, in meters.
    pub height_m: f32,
    /// The change of [`GroundPost::water`].
    pub water: f32,
}

/// Why a ground map cannot be rendered.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GroundMapError {
    /// The number of posts is 0, or not columns × rows.
    #[error("the ground map of {0}×{1} posts holds {2}")]
    PostCount(u32, u32, usize),
    /// The cell is not positive and finite, or the origin is not finite.
    #[error("the ground map has cells of {0} m from {1}")]
    Grid(Vec2, Vec2),
    /// The draped picture is empty or has no place.
    #[error("the picture over the ground map is empty or has no place")]
    Imagery,
}

impl GroundMap {
    /// A map of level ground in one color, for draw lists without visible ground.
    pub fn level() -> Self {
        Self {
            origin: Vec2::ZERO,
            cell: Vec2::ONE,
            z_per_m: 1.0,
            columns: 1,
            rows: 1,
            posts: vec![GroundPost { sun_visibility: 1.0, sky_visibility: 1.0, ..GroundPost::default() }],
            ramp: ColorRamp { stops: vec![(0.0, Vec3::ONE)] },
            contours: None,
            imagery: None,
            cover: None,
            halvings: 0,
            is_curved: false,
            form_level: 0,
            z_factor: 1.0,
            shade_gain: ReliefShading::GAIN,
            detail: ReliefShading::DETAIL,
            has_grain: false,
        }
    }

    /// Checks the invariants that renderers rely on: one entry per post, positive finite cells, a finite origin.
    ///
    /// # Errors
    /// The first [`GroundMapError`] found.
    pub fn check(&self) -> Result<(), GroundMapError> {
        let posts = u64::from(self.columns) * u64::from(self.rows);
        if posts == 0 || posts != self.posts.len() as u64 {
            return Err(GroundMapError::PostCount(self.columns, self.rows, self.posts.len()));
        }
        // Renderers divide by the cell.
        let is_grid = self.cell.min_element() > 0.0
            && self.cell.recip().is_finite()
            && self.cell.is_finite()
            && self.origin.is_finite();
        if !is_grid {
            return Err(GroundMapError::Grid(self.cell, self.origin));
        }
        match &self.imagery {
            Some(imagery) if !imagery.is_sound() => Err(GroundMapError::Imagery),
            _ => Ok(()),
        }
    }

    /// The color of a pixel of ground in linear light, from the map's values `post` at its center and their `change`
    /// across it: land or water, under a draped picture and contours.
    pub fn albedo(&self, post: &GroundPost, change: PixelChange, detail: &GroundDetail) -> Vec3 {
        let shore = ShorePixel::new(post.water, change.water);
        let land = detail.land * detail.grain;
        let is_dry = shore.cover <= 0.0 && shore.line <= 0.0 && shore.wet <= 0.0;
        let bare = if is_dry { land } else { WaterColor::over(land, post.height_m, &shore) };
        let bare = detail.draped.over(bare);
        let Some(contours) = &self.contours else { return bare };
        let line = contours.ink(post.height_m, change.height_m, detail.facing);
        bare.lerp(line.color, line.cover * (1.0 - shore.cover))
    }

    /// The color of ground that water mirrors, in linear light: dry land without the textures of its cover, grain and
    /// contours, under the picture `draped`.
    pub fn mirrored_land(&self, post: &GroundPost, draped: &DrapedColor) -> Vec3 {
        // Across a pixel with all heights strata are too thin to show.
        let tint = self.tint(post);
        draped.over(self.land(&LandPixel {
            tint,
            post: *post,
            change_m: f32::MAX,
            noise: CoverNoise::none(),
        }))
    }

    /// The width of the model's cells, meters: narrower forms are the noise's.
    pub fn model_cell_m(&self) -> f32 {
        self.cell.max_element() * (1u32 << self.halvings) as f32
    }

    /// The ramp's color in linear light: that of land without a cover.
    #[inline]
    pub fn tint(&self, post: &GroundPost) -> Vec3 {
        self.ramp.linear_at(post.height_m)
    }

    /// A pixel at `at`, world X and Y, `mean_m` and at the most `longest_m` meters wide in plan, where the map reads `post`, as its noise
    /// depends on it.
    pub fn noise_pixel(&self, post: &GroundPost, at: Vec2, mean_m: f32, longest_m: f32) -> NoisePixel {
        let true_rise = self.cover.map_or(1.0, |cover| cover.true_rise);
        NoisePixel { at, mean_m, longest_m, rise: Vec2::new(post.slope_east, post.slope_north) * true_rise }
    }

    /// The color of a pixel of dry land in linear light: the ramp with its cover and [`Undergrowth`].
    pub fn land(&self, pixel: &LandPixel) -> Vec3 {
        undergrown(self.cover.map_or(pixel.tint, |cover| cover.over(pixel)), &pixel.post)
    }

    /// [`Self::land`] of each of `pixels`, in less time.
    pub fn land_each(&self, pixels: &[LandPixel]) -> Vec<Vec3> {
        let mut colors = match &self.cover {
            Some(cover) => cover.over_each(pixels),
            None => pixels.iter().map(|pixel| pixel.tint).collect(),
        };
        for (color, pixel) in colors.iter_mut().zip(pixels) {
            *color = undergrown(*color, &pixel.post);
        }
        colors
    }

    /// The upward unit normal by which `post` is shaded.
    #[inline]
    pub fn shaded_normal(&self, post: &GroundPost) -> Vec3 {
        Vec3::new(-post.slope_east * self.z_factor, -post.slope_north * self.z_factor, 1.0).normalize()
    }

    /// The map at world position `at`, bilinear between posts; outside the map, the value at its border.
    pub fn sample(&self, at: Vec2) -> GroundPost {
        self.post_at(self.grid_at(at))
    }

    /// World position `at` in columns and rows; outside the map, the place at its border.
    pub fn grid_at(&self, at: Vec2) -> Vec2 {
        let last = Vec2::new((self.columns - 1) as f32, (self.rows - 1) as f32);
        ((at - self.origin) / self.cell).clamp(Vec2::ZERO, last)
    }

    /// The map at a place on it in columns and rows, bilinear between posts.
    pub fn post_at(&self, grid: Vec2) -> GroundPost {
        let ([sw, se, nw, ne], part) = self.around(grid);
        let south = sw.lerp(se, part.x);
        let upper = nw.lerp(ne, part.x);
        south.lerp(&upper, part.y)
    }

    /// The same of one of its values alone.
    pub fn value_at(&self, grid: Vec2, value: impl Fn(&GroundPost) -> f32) -> f32 {
        let (corners, part) = self.around(grid);
        let [sw, se, nw, ne] = corners.map(value);
        let (south, upper) = (sw + (se - sw) * part.x, nw + (ne - nw) * part.x);
        south + (upper - south) * part.y
    }

    /// The posts south-west, south-east, north-west and north-east of a place, and where between them it lies.
    pub(crate) fn around(&self, grid: Vec2) -> ([&GroundPost; 4], Vec2) {
        let cell = grid.as_uvec2().min(UVec2::new(self.columns, self.rows).max(UVec2::splat(2)) - 2);
        let stride = self.columns as usize;
        let east = usize::from(self.columns > 1);
        let north = if self.rows > 1 { stride } else { 0 };
        let first = cell.y as usize * stride + cell.x as usize;
        (
            [first, first + east, first + north, first + north + east].map(|index| &self.posts[index]),
            grid - cell.as_vec2(),
        )
    }
}

/// What a row of posts is made of, by post.
#[derive(Clone, Copy, Debug)]
pub struct PostRow<'a> {
    /// Elevations in meters.
    pub heights_m: &'a [f32],
    /// Rises eastward and northward, true to scale, meters per meter.
    pub slopes: &'a [Vec2],
    /// The factor on slopes as they are drawn.
    pub exaggeration: f32,
    /// See [`GroundPost::sun_visibility`].
    pub sun: &'a [f32],
    /// See [`GroundPost::sky_visibility`].
    pub sky: &'a [f32],
    /// See [`GroundPost::water`]; empty where there is none.
    pub water: &'a [f32],
    /// The share of the ground under crowns; empty where there are none.
    pub woods: &'a [f32],
}

impl PostRow<'_> {
    /// The posts, as many as there are heights.
    pub fn posts(&self) -> Vec<GroundPost> {
        let shape = self.heights_m.iter().zip(self.slopes);
        let light = self.sun.iter().zip(self.sky);
        let posts =
            shape.zip(light).map(|((&height_m, slopes), (&sun_visibility, &sky_visibility))| GroundPost {
                height_m,
                slope_east: slopes.x * self.exaggeration,
                slope_north: slopes.y * self.exaggeration,
                sun_visibility,
                sky_visibility,
                water: 0.0,
            });
        let mut posts: Vec<GroundPost> = posts.collect();
        posts.iter_mut().zip(self.water).for_each(|(post, water)| post.water = *water);
        for (post, share) in posts.iter_mut().zip(self.woods) {
            post.water = if post.water > 0.0 { post.water } else { -share };
        }
        posts
    }
}

impl GroundPost {
    /// The greatest [`Self::sky_visibility`], which is brighter than level ground by half.
    pub const MOST_SKY: f32 = 2.0;

    /// Combines each value with the same value of `other`.
    #[inline]
    pub fn zip_with(&self, other: &Self, combine: impl Fn(f32, f32) -> f32) -> Self {
        let [own, other]: [[f32; 6]; 2] = [bytemuck::cast(*self), bytemuck::cast(*other)];
        bytemuck::cast::<[f32; 6], _>(std::array::from_fn(|index| combine(own[index], other[index])))
    }

    #[inline]
    fn lerp(&self, other: &Self, share: f32) -> Self {
        self.zip_with(other, |a, b| a + (b - a) * share)
    }

    /// The upward unit normal of the drawn ground.
    pub fn normal(&self) -> Vec3 {
        Vec3::new(-self.slope_east, -self.slope_north, 1.0).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unsound_maps_are_refused_with_the_reason() {
        let map = GroundMap {
            origin: Vec2::new(-30.0, 70.0),
            cell: Vec2::new(2.0, 5.0),
            columns: 3,
            rows: 2,
            posts: vec![GroundPost::default(); 6],
            ..GroundMap::level()
        };
        let fault = |map: GroundMap| map.check().expect_err("unsound").to_string();
        assert_eq!(map.check(), Ok(()));
        assert_eq!(fault(GroundMap { columns: 9, ..map.clone() }), "the ground map of 9×2 posts holds 6");
        assert!(fault(GroundMap { columns: 0, posts: Vec::new(), ..map.clone() }).ends_with("holds 0"));
        for cell in [Vec2::new(0.0, 1.0), Vec2::new(1.0, -1.0), Vec2::splat(1e-40), Vec2::NAN, Vec2::INFINITY]
        {
            assert!(fault(GroundMap { cell, ..map.clone() }).contains("has cells of"), "{cell}");
        }
        assert!(fault(GroundMap { origin: Vec2::NAN, ..map.clone() }).contains("from [NaN, NaN]"));
    }

    #[test]
    fn illuminated_lines_are_light_toward_the_light_dark_away_and_thin_along_it() {
        const BROWN: Srgba = Srgba([112, 74, 40, 150]);
        let lit = Srgba::opaque(255, 255, 255);
        let lines =
            Contours { interval_m: 10.0, major_every: 5, color: BROWN, width_px: 1.0, lit: Some(lit) };
        let at = |away_px: f32, facing: f32| lines.ink(10.0 + away_px * 0.5, 0.5, facing);
        assert_eq!(at(0.0, 1.0).color, Vec3::ONE);
        assert_eq!(at(0.0, -1.0).color, BROWN.linear());
        // A pixel from its middle, the line still covers something across the light, and nothing along it.
        assert!(at(1.0, 1.0).cover > 0.3 && at(1.0, -1.0).cover > 0.3);
        assert_eq!(at(1.0, 0.0).cover, 0.0);
        let plain = Contours { lit: None, ..lines };
        assert_eq!(plain.ink(10.2, 0.5, 1.0).cover, plain.strength(10.2, 0.5) * BROWN.alpha());
    }

    #[test]
    fn contours_follow_their_formula_and_survive_odd_settings() {
        let plain =
            Contours { interval_m: 10.0, major_every: 5, color: Srgba::WHITE, width_px: 1.0, lit: None };
        assert_eq!(plain.strength(20.0, 0.5), 1.0);
        assert!((plain.strength(20.3, 0.5) - 0.4).abs() < 1e-5);
        assert!((plain.strength(50.7, 0.5) - 0.1).abs() < 1e-5, "the fifth is twice as wide");
        assert_eq!(plain.strength(20.0, 4.0), 0.0, "too close together");
        assert_eq!(plain.strength(50.0, 4.0), 1.0, "every fifth line outlasts the others");
        assert_eq!(plain.strength(50.0, 15.0), 0.0, "and vanishes in its turn");
        for interval_m in [0.0, -1.0, f32::NAN] {
            assert_eq!(Contours { interval_m, ..plain }.strength(20.0, 0.5), 0.0);
        }
        assert!(Contours { major_every: 0, ..plain }.strength(f32::NAN, 0.5).is_nan());
    }
}
