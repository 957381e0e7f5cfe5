//! Textures of land cover in the world: what grows, lies or is built on an area, without a repeat.
//!
//! One formula draws all covers; the numbers of an [`AreaTexture`] say which of its parts show:
//!
//! ```text
//! noise     octaves of value noise: stands of trees, patches of grass, streaks of scree; they bend the rest
//! parcels   cells around jittered points (Worley 1996), each with its own direction and tone, hedges or streets between
//! strips    bands of a parcel in different tones: fields, plots
//! rows      waves along a parcel or the whole area: furrows, vines, ripples, benches
//! figures   round or square ones in a lattice of the parcel: crowns, stones, pools, roofs
//! ```
//!
//! Each part fades to its mean before it is a few pixels wide, so that nothing sparkles and an area keeps its mean color from
//! afar. Everything depends on the place in the world alone: areas side by side go on into each other.

use std::cell::Cell;

use glam::{FloatExt, UVec2, Vec2, Vec3, Vec4};

use crate::cover_noise::{FINER, SHARE, TURN, WAVE_PX, pair, values};
use crate::floor::{floor, floor_each};
use crate::shown::shown;

/// The number of octaves of the noise.
pub(crate) const OCTAVES: u32 = 4;
/// A parcel, a strip, a row and a lattice of figures show in full where they are this many pixels wide, and not at all where
/// they are half as wide.
pub(crate) const PART_PX: f32 = 6.0;
/// How far the point of a parcel lies from the middle of its square, parts of the square's side.
pub(crate) const PARCEL_JITTER: f32 = 0.38;
/// The part of a parcel's tone in that of its strips.
pub(crate) const PARCEL_TONE: f32 = 0.45;
/// The length of a strip's pieces, parts of its width.
pub(crate) const STRIP_LENGTH: f32 = 3.6;
/// From which of its own numbers, -1..=1, the line between two strips is a border, and how wide, parts of that of parcels.
pub(crate) const STRIP_BORDER: [f32; 2] = [0.1, 0.7];
/// How far figures keep from the border of their parcel, parts of their lattice.
pub(crate) const FIGURE_MARGIN: f32 = 0.35;
/// What separates the hash of figures and of parcels from that of the noise.
pub(crate) const FIGURE_SALT: u32 = 0x51ed;
pub(crate) const PARCEL_SALT: u32 = 0x2c1b;
/// The distance from a border where there are no parcels, meters.
pub(crate) const ALONE_M: f32 = 1e9;
/// The width of the strip in which an area fades, meters: it is half of the cover throughout where pixels are too wide to show it.
pub(crate) const FADE_WIDE_M: f32 = 24.0;
/// The wavelength of the noise that moves that strip, meters, and by how much.
pub(crate) const FADE_M: f32 = 7.0;
pub(crate) const FADE_MOVED: f32 = 0.45;

/// The texture of a cover. Lengths are in meters; a part whose length is 0 is not there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaTexture {
    /// What lies between figures: linear rgb, alpha.
    pub ground: Vec4,
    /// The figures.
    pub figure: Vec4,
    /// The borders between parcels.
    pub border: Vec4,
    /// What a tone of 1 adds to the ground, linear rgb; of -1, takes away.
    pub tone: Vec3,
    /// By how much the noise changes the light.
    pub uneven: f32,
    /// The wavelength of the first octave.
    pub noise_m: f32,
    /// The mean width of a parcel.
    pub parcel_m: f32,
    /// The width of the border between parcels.
    pub border_m: f32,
    /// The width of a strip.
    pub strip_m: f32,
    /// From one row to the next.
    pub rows_m: f32,
    /// By how much rows change the light.
    pub rows: f32,
    /// How far the noise bends parcels and rows.
    pub warp_m: f32,
    /// By how much the side of a figure toward the north-west is lighter.
    pub light: f32,
    /// The lattice of figures along its rows and across.
    pub figure_m: Vec2,
    /// How far a figure lies from the middle of its cell of the lattice, parts of the cell.
    pub jitter: f32,
    /// The least and greatest radius of a figure, parts of the cell; with the jitter at most 1.
    pub radius: [f32; 2],
    /// 0: figures are round; 1: rectangles.
    pub square: f32,
    /// By how much the noise eats into figures, parts of their radius.
    pub ragged: f32,
    /// 1 on the strip along an outline in which the cover fades, 0 elsewhere.
    pub fades: f32,
    /// The mean shares of figures and of borders, which show from afar; [`AreaTexture::measured`] sets them.
    pub shares: [f32; 2],
}

/// A pixel on an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaPixel {
    /// World X and Y, meters.
    pub at: Vec2,
    /// Its mean width, meters.
    pub mean_m: f32,
    /// Its greatest width, meters.
    pub longest_m: f32,
    /// How far within the strip in which the area fades: 0 on the outline, 1 within. No matter elsewhere.
    pub inward: f32,
}

impl Default for AreaTexture {
    /// White ground without any part.
    fn default() -> Self {
        Self {
            ground: Vec4::ONE,
            figure: Vec4::ONE,
            border: Vec4::ONE,
            tone: Vec3::ZERO,
            uneven: 0.0,
            noise_m: 0.0,
            parcel_m: 0.0,
            border_m: 0.0,
            strip_m: 0.0,
            rows_m: 0.0,
            rows: 0.0,
            warp_m: 0.0,
            light: 0.0,
            figure_m: Vec2::ZERO,
            jitter: 0.0,
            radius: [0.0; 2],
            square: 0.0,
            ragged: 0.0,
            fades: 0.0,
            shares: [0.0; 2],
        }
    }
}

/// The parcel around a place.
pub(crate) struct Parcel {
    /// The cell of its point.
    pub cell: UVec2,
    /// Its own two numbers, -1..=1.
    pub own: Vec2,
    /// Meters to its border.
    pub inside_m: f32,
}

impl Parcel {
    /// A place by axes of which the first runs along the parcel.
    pub fn along(&self, at: Vec2) -> Vec2 {
        turned(at, (self.own + Vec2::new(1e-3, 0.0)).normalize())
    }

    /// Its tone, -1..=1.
    pub fn tone(&self) -> f32 {
        values(self.cell.wrapping_add(UVec2::splat(FIGURE_SALT))).x
    }
}

impl AreaTexture {
    /// The numbers as shaders read them: nine times four.
    pub fn uniform(&self) -> [[f32; 4]; 9] {
        let Self { noise_m, parcel_m, border_m, strip_m, rows_m, rows, warp_m, light, .. } = *self;
        [
            self.ground.to_array(),
            self.figure.to_array(),
            self.border.to_array(),
            self.tone.extend(self.uneven).to_array(),
            [noise_m, parcel_m, border_m, strip_m],
            [rows_m, rows, warp_m, light],
            [self.figure_m.x, self.figure_m.y, self.jitter, self.square],
            [self.radius[0], self.radius[1], self.fades, self.ragged],
            [self.shares[0], self.shares[1], 0.0, 0.0],
        ]
    }

    /// This texture with its mean shares, from a lattice of places a few parcels wide.
    pub fn measured(self) -> Self {
        /// Places along a side: more would move the mean less than is seen.
        const SIDE: u32 = 64;
        let reach = self.parcel_m.max(self.figure_m.max_element()).max(1.0) * 9.0;
        let mut sums = Vec2::ZERO;
        for (column, row) in (0..SIDE * SIDE).map(|index| (index % SIDE, index / SIDE)) {
            // Off any lattice of whole meters.
            let at = Vec2::new(column as f32 + 0.37 * row as f32, row as f32) * (reach / SIDE as f32);
            let pixel = AreaPixel { at, mean_m: 1e-3, longest_m: 1e-3, inward: 1.0 };
            let (_, [figure, border], _) = self.parts(&pixel);
            sums += Vec2::new(figure, border);
        }
        Self { shares: (sums / (SIDE * SIDE) as f32).to_array(), ..self }
    }

    /// Its color from afar, where no part shows: linear rgb, alpha.
    pub fn mean(&self) -> Vec4 {
        let [figure, border] = self.shares;
        self.ground.lerp(self.figure, figure).lerp(self.border, border)
    }

    /// The color at a pixel: linear rgb, straight alpha.
    pub fn color(&self, pixel: &AreaPixel) -> Vec4 {
        let (ground, [figure, border], light) = self.parts(pixel);
        let color = ground.lerp(self.figure, figure).lerp(self.border, border);
        let mut alpha = color.w;
        if self.fades > 0.0 {
            let octave = |wave_m: f32| shown(wave_m, WAVE_PX, pixel.mean_m) * pair(pixel.at / wave_m).0.x;
            let moved = FADE_MOVED * (octave(FADE_M) + 0.5 * octave(FADE_M * FINER));
            let within = pixel.inward * (1.0 - pixel.inward) * 4.0;
            let fade = (pixel.inward + moved * within).smoothstep(0.0, 1.0);
            alpha *= 0.5.lerp(fade, part_shown(FADE_WIDE_M, pixel.longest_m));
        }
        (color.truncate() * light).max(Vec3::ZERO).extend(alpha)
    }

    /// The color of the ground between figures, the shares of figures and of borders, and the factor of the light.
    fn parts(&self, pixel: &AreaPixel) -> (Vec4, [f32; 2], f32) {
        let AreaPixel { at, mean_m, longest_m, .. } = *pixel;
        let AreaNoise { sum: noise, bend } = octaves(at, self.noise_m, mean_m);
        let bent = at + bend * self.warp_m;
        let mut light = 1.0 + self.uneven * noise.x;
        let [mut figure, mut border] = self.shares;
        let mut tone = noise.y;
        // Rows that no parcel turns run with the second octave of the noise.
        let mut place = turned(bent, TURN);
        let mut inside_m = ALONE_M;
        let mut own = UVec2::ZERO;
        if self.parcel_m > 0.0 {
            let shown = part_shown(self.parcel_m, longest_m);
            tone = 0.0;
            if shown > 0.0 {
                let parcel = parcel(bent, self.parcel_m);
                place = parcel.along(bent);
                inside_m = parcel.inside_m;
                own = parcel.cell;
                border = border.lerp(line_cover(self.border_m, inside_m, longest_m), shown);
                tone = shown * parcel.tone();
                if self.strip_m > 0.0 {
                    let (own_tone, line) = self.strip(place, longest_m, own);
                    tone = tone.lerp(PARCEL_TONE * tone + own_tone, shown);
                    border = border.lerp(border.max(line), shown);
                }
            }
        }
        if self.rows_m > 0.0 {
            let across = place.y / self.rows_m;
            let wave = 1.0 - 4.0 * ((across - floor(across)) - 0.5).abs();
            light += self.rows * part_shown(self.rows_m, longest_m) * wave;
        }
        if self.figure_m.y > 0.0 {
            let shown = part_shown(self.figure_m.min_element(), longest_m);
            if shown > 0.0 {
                let (cover, facing) = self.figure_at(place, noise.x, longest_m, own);
                let margin = inside_m - 0.5 * self.border_m - FIGURE_MARGIN * self.figure_m.y;
                let kept = cover * (margin / longest_m + 0.5).clamp(0.0, 1.0);
                figure = figure.lerp(kept, shown);
                light += self.light * facing * kept * shown;
            }
        }
        let ground = (self.ground.truncate() + self.tone * tone).extend(self.ground.w);
        (ground, [figure, border], light.max(0.2))
    }

    /// The tone of the piece of a strip at a place in a parcel, -1..=1, and the share of a pixel that the border between two
    /// strips covers.
    fn strip(&self, place: Vec2, pixel_m: f32, own: UVec2) -> (f32, f32) {
        let shown = part_shown(self.strip_m, pixel_m);
        let [from, wide] = STRIP_BORDER;
        let wide_m = wide * self.border_m;
        let mean_line = 0.5 * (1.0 - from) * wide_m / self.strip_m;
        if shown <= 0.0 {
            return (0.0, mean_line);
        }
        let Strip { below, across_m } = Strip::at(place, self.strip_m);
        let line = line_cover(wide_m, across_m.abs(), pixel_m);
        let line = if strip_number(below, 0.0, own).x > from { line } else { 0.0 };
        (shown * strip_tone(self.strip_m, place, pixel_m, own), mean_line.lerp(line, shown))
    }

    /// The share of a pixel that the nearest figure covers, and how far it turns to the north-west, -1..=1.
    fn figure_at(&self, place: Vec2, noise: f32, pixel_m: f32, own: UVec2) -> (f32, f32) {
        let lattice = place / self.figure_m;
        let corner = floor_each(lattice - 0.5);
        let mut nearest = f32::INFINITY;
        let (mut facing, mut radius) = (0.0, 1.0);
        for (east, north) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let cell = corner + Vec2::new(east, north);
            let index = cell.as_ivec2().as_uvec2().wrapping_add(own).wrapping_add(UVec2::splat(FIGURE_SALT));
            let hash = values(index);
            let away = lattice - cell - 0.5 - self.jitter * hash;
            // A third number and a fourth, from the low parts of the first two.
            let more = (hash * 61.0).fract_gl();
            let radii = Vec2::splat(self.radius[0]) + more * (self.radius[1] - self.radius[0]);
            let round = away.length() / radii.x;
            let square = (away.x / radii.x).abs().max((away.y / radii.y).abs());
            let distance = round.lerp(square, self.square) + self.ragged * noise;
            if distance < nearest {
                nearest = distance;
                let turned = (away.y - away.x) * std::f32::consts::FRAC_1_SQRT_2 / radii.x;
                facing = turned.lerp(if away.y > 0.0 { 1.0 } else { -1.0 }, self.square);
                radius = radii.x.min(radii.y) * self.figure_m.min_element();
            }
        }
        let cover = ((1.0 - nearest) * radius / pixel_m + 0.5).clamp(0.0, 1.0);
        (cover, facing.clamp(-1.0, 1.0))
    }
}

/// Where a place lies between strips.
struct Strip {
    /// The row of the strip whose middle lies below.
    below: f32,
    /// Meters from the line between that strip and the next.
    across_m: f32,
}

impl Strip {
    fn at(place: Vec2, strip_m: f32) -> Self {
        let along = place.y / strip_m - 0.5;
        let below = floor(along);
        Self { below, across_m: (along - below - 0.5) * strip_m }
    }
}

/// Two numbers of a piece of a strip, -1..=1; of column 0 those of the strip, too.
fn strip_number(row: f32, column: f32, own: UVec2) -> Vec2 {
    values(UVec2::new(row as i32 as u32, column as i32 as u32).wrapping_add(own))
}

/// The tone of the piece of a strip `strip_m` meters wide at `place` in the parcel `own`, -1..=1.
pub(crate) fn strip_tone(strip_m: f32, place: Vec2, pixel_m: f32, own: UVec2) -> f32 {
    let piece_m = STRIP_LENGTH * strip_m;
    let tone = |row: f32| {
        let along = place.x / piece_m + strip_number(row, 0.0, own).x - 0.5;
        let before = floor(along);
        between(|piece| strip_number(row, before + piece, own).y, (along - before - 0.5) * piece_m / pixel_m)
    };
    let Strip { below, across_m } = Strip::at(place, strip_m);
    between(|row| tone(below + row), across_m / pixel_m)
}

/// The tone so many pixels past the line between two, of which `tone` of 0 is the one before and of 1 the one behind.
fn between(tone: impl Fn(f32) -> f32, past_px: f32) -> f32 {
    // Most pixels lie in one of them.
    match past_px + 0.5 {
        part if part <= 0.0 => tone(0.0),
        part if part >= 1.0 => tone(1.0),
        part => tone(0.0).lerp(tone(1.0), part),
    }
}

/// A place by axes of which the first runs along `axis`, of length 1.
fn turned(at: Vec2, axis: Vec2) -> Vec2 {
    Vec2::new(axis.x, -axis.y).rotate(at)
}

/// The share of a pixel that a line covers whose middle is so far away.
fn line_cover(wide_m: f32, away_m: f32, pixel_m: f32) -> f32 {
    let [near, far] = [0.5, -0.5].map(|side| ((side * wide_m - away_m) / pixel_m + 0.5).clamp(0.0, 1.0));
    near - far
}

/// How far a part of this width shows in pixels that wide, 0..=1.
pub(crate) fn part_shown(wide_m: f32, pixel_m: f32) -> f32 {
    shown(wide_m, PART_PX, pixel_m)
}

/// The noise of a place.
struct AreaNoise {
    /// Two sums of octaves, each about -1..=1.
    sum: Vec2,
    /// The same with octaves as high as they are wide, which bend lines without folding them.
    bend: Vec2,
}

fn octaves(at: Vec2, first_m: f32, pixel_m: f32) -> AreaNoise {
    let (mut sum, mut bend, mut height) = (Vec2::ZERO, Vec2::ZERO, 1.0);
    let (mut wave_m, mut turn) = (first_m, Vec2::X);
    for _ in 0..OCTAVES {
        let shown = shown(wave_m, WAVE_PX, pixel_m);
        if shown > 0.0 {
            let place = turn.rotate(at) / wave_m;
            let value = pair(place).0 * (SHARE * shown);
            sum += value;
            bend += value * height;
        }
        height *= FINER;
        wave_m *= FINER;
        turn = TURN.rotate(turn);
    }
    AreaNoise { sum, bend }
}

/// The points of parcels in the squares around one.
#[derive(Clone, Copy, Debug)]
struct ParcelPoints {
    /// The corner of the square in the middle, in squares.
    corner: Vec2,
    /// Two numbers of each square, -1..=1, row by row from the south-western one.
    hashes: [Vec2; Self::COUNT],
}

impl ParcelPoints {
    /// The squares whose points may be the nearest ones.
    const COUNT: usize = 9;
    /// Those around no square.
    const NONE: Self = Self { corner: Vec2::NAN, hashes: [Vec2::ZERO; Self::COUNT] };

    /// The points around the square with this corner: a pixel next to another looks at the same ones, which each thread keeps.
    fn around(corner: Vec2) -> Self {
        let last = LAST_POINTS.get();
        if last.corner == corner {
            return last;
        }
        let cell = |index: usize| corner + Vec2::new((index % 3) as f32 - 1.0, (index / 3) as f32 - 1.0);
        let hashes = std::array::from_fn(|index| values(Self::salted(cell(index))));
        let points = Self { corner, hashes };
        LAST_POINTS.set(points);
        points
    }

    fn salted(cell: Vec2) -> UVec2 {
        cell.as_ivec2().as_uvec2().wrapping_add(UVec2::splat(PARCEL_SALT))
    }
}

thread_local! {
    /// The points around the last square that the thread looked at.
    static LAST_POINTS: Cell<ParcelPoints> = const { Cell::new(ParcelPoints::NONE) };
}

/// The parcel around a place.
pub(crate) fn parcel(at: Vec2, parcel_m: f32) -> Parcel {
    let grid = at / parcel_m;
    let corner = floor_each(grid);
    let points = ParcelPoints::around(corner);
    let (mut first, mut second) = ((f32::INFINITY, Vec2::ZERO), (f32::INFINITY, Vec2::ZERO));
    let (mut found, mut own) = (corner, Vec2::ZERO);
    for index in 0..ParcelPoints::COUNT {
        let cell = corner + Vec2::new((index % 3) as f32 - 1.0, (index / 3) as f32 - 1.0);
        let hash = points.hashes[index];
        let away = cell + 0.5 + PARCEL_JITTER * hash - grid;
        let distance = away.length_squared();
        if distance < first.0 {
            (second, first) = (first, (distance, away));
            (found, own) = (cell, hash);
        } else if distance < second.0 {
            second = (distance, away);
        }
    }
    // To the line halfway between the two points.
    let apart = (second.1 - first.1).length().max(1e-3);
    Parcel {
        cell: ParcelPoints::salted(found),
        own,
        inside_m: (second.0 - first.0) / (2.0 * apart) * parcel_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn town() -> AreaTexture {
        AreaTexture {
            ground: Vec4::new(0.5, 0.45, 0.4, 0.7),
            figure: Vec4::new(0.4, 0.2, 0.15, 0.8),
            border: Vec4::new(0.7, 0.7, 0.7, 0.6),
            tone: Vec3::new(-0.05, 0.05, -0.05),
            uneven: 0.1,
            noise_m: 200.0,
            parcel_m: 90.0,
            border_m: 8.0,
            strip_m: 24.0,
            rows_m: 9.0,
            rows: 0.1,
            warp_m: 4.0,
            light: 0.2,
            figure_m: Vec2::new(16.0, 24.0),
            jitter: 0.1,
            radius: [0.25, 0.4],
            square: 1.0,
            ragged: 0.1,
            ..AreaTexture::default()
        }
        .measured()
    }

    fn pixel(at: Vec2, wide_m: f32) -> AreaPixel {
        AreaPixel { at, mean_m: wide_m, longest_m: wide_m, inward: 1.0 }
    }

    fn places() -> impl Iterator<Item = Vec2> {
        (0..10_000).map(|index| Vec2::new((index % 100) as f32 * 17.31 - 900.0, (index / 100) as f32 * 15.77))
    }

    #[test]
    fn from_afar_an_area_is_the_mean_of_what_it_is_near_by() {
        let town = town();
        let far = town.color(&pixel(Vec2::new(40.0, 7.0), 1e4));
        assert_eq!(far, town.mean());
        for wide_m in [0.2, 3.0, 12.0, 40.0] {
            let sum: Vec4 = places().map(|at| town.color(&pixel(at, wide_m))).sum();
            let mean = sum / 10_000.0;
            assert!((mean - far).abs().max_element() < 0.02, "{wide_m} m: {mean} {far}");
        }
    }

    #[test]
    fn neighboring_pixels_differ_less_the_wider_they_are() {
        let town = town();
        let rough = |wide_m: f32| {
            places()
                .map(|at| {
                    let [here, next] = [at, at + Vec2::X * wide_m].map(|at| town.color(&pixel(at, wide_m)));
                    (here - next).truncate().length()
                })
                .sum::<f32>()
                / 10_000.0
        };
        assert!(rough(20.0) < 0.5 * rough(2.0), "{} {}", rough(20.0), rough(2.0));
        assert!(rough(60.0) < 0.1 * rough(2.0), "{}", rough(60.0));
    }

    #[test]
    fn nothing_repeats_within_a_country() {
        let town = town();
        for shift in [90.0, 360.0, 1024.0, 5760.0, 46_080.0] {
            let differing = places()
                .filter(|&at| {
                    let [here, there] = [at, at + Vec2::X * shift].map(|at| town.color(&pixel(at, 1.0)));
                    (here - there).truncate().length() > 0.02
                })
                .count();
            assert!(differing > 5000, "{shift} m: {differing}");
        }
    }

    #[test]
    fn a_fading_edge_goes_from_nothing_to_the_whole() {
        let edge = AreaTexture { fades: 1.0, ..town() };
        for at in places().take(500) {
            let alpha = |inward: f32| edge.color(&AreaPixel { inward, ..pixel(at, 1.0) }).w;
            assert_eq!(alpha(0.0), 0.0);
            assert_eq!(alpha(1.0), town().color(&pixel(at, 1.0)).w);
        }
    }

    #[test]
    fn places_that_are_no_numbers_have_a_color() {
        for at in [Vec2::splat(f32::NAN), Vec2::splat(f32::INFINITY), Vec2::splat(1e30)] {
            let _ = town().color(&pixel(at, 1.0));
        }
        let _ = town().color(&pixel(Vec2::ONE, 0.0));
    }
}
