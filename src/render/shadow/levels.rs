//! The levels of a map: what the camera sees at their depths, as pages that solids touch.

use std::ops::Range;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::shadow::casters::{LightBox, LightTriangles, ListTriangles};
use crate::shadow::fill::Filling;
use crate::shadow::{
    LevelScale, LightAxes, MOST_LEVELS, MOST_PAGES, MOST_RADIUS, PAGE, ShadowLevel, ShadowMap, ShadowPage,
    ShadowPurpose, ShadowTexel,
};
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_draw::list::DrawList;
use sandtable_view::camera::Camera;

/// The most pages along a side of a level: its texels fit the rasterizer's sub-pixel coordinates.
const MOST_SIDE: f32 = 512.0;

/// How often texels are doubled until a map fits its limits; 2^24 covers every float that a picture can need.
const MOST_DOUBLINGS: u32 = 24;

/// Pages are stored for what lies this many texels from a solid, as far as filters read.
const PAGE_MARGIN: f32 = MOST_RADIUS + 1.0;

/// Bytes of a texel while its level is drawn: what is kept, and the height of an underside.
const BYTES_PER_TEXEL: u64 = 12;

/// A range of pages in both directions, its end excluded.
#[derive(Clone, Copy, Debug)]
pub struct PageRange {
    pub from: [u32; 2],
    pub to: [u32; 2],
}

/// The inputs of a map.
#[derive(Debug)]
pub struct MapSource<'a> {
    pub list: &'a DrawList,
    pub camera: &'a Camera,
    pub triangles: &'a ListTriangles,
    pub axes: LightAxes,
    pub purpose: ShadowPurpose,
}

/// What a light's map is planned by, besides the solids.
#[derive(Debug)]
pub struct LightView<'a> {
    pub camera: &'a Camera,
    pub axes: LightAxes,
    /// The least and greatest depth of what is seen, in meters; above 0 in perspective.
    pub depths_m: [f32; 2],
}

impl ShadowMap {
    /// The map with texels of up to `texel_px` pixels; `None` where no shadow is seen.
    ///
    /// # Errors
    /// There is not the memory for it.
    pub fn new(source: &MapSource, texel_px: f32) -> Result<Option<Self>, MemoryRefused> {
        let solids = LightTriangles::new(&source.triangles.solids, &source.axes);
        let MapSource { camera, axes, triangles, .. } = *source;
        let view = LightView { camera, axes, depths_m: triangles.depths_m };
        let Some(mut map) = Self::planned(&view, &solids, texel_px) else { return Ok(None) };
        let stored = map.stored();
        let bytes = stored as u64 * u64::from(PAGE * PAGE) * BYTES_PER_TEXEL;
        check_memory(bytes, "drawing shadow maps", "draw a smaller picture, or fewer solids")?;
        map.texels = bytemuck::zeroed_vec(stored * (PAGE * PAGE) as usize);
        let kept: Vec<_> = map.levels.iter().map(|level| KeptPages::new(level, &map.pages)).collect();
        let is_near = |bounds: LightBox| kept.iter().any(|kept| kept.pages_on(bounds).is_some());
        let ground = LightTriangles::near(&source.triangles.ground, &source.axes, is_near);
        let mut texels = map.texels.as_mut_slice();
        for (level, kept) in map.levels.iter().zip(&kept) {
            let pages = &mut map.pages[level.pages()];
            let filling = Filling { source, solids: &solids, ground: &ground, level, kept };
            let (own, others) = texels.split_at_mut(kept.count() * (PAGE * PAGE) as usize);
            filling.fill(pages, own);
            level.spread_highest(pages);
            texels = others;
        }
        Ok(Some(map))
    }

    /// The map without texels, its pages numbered; `None` where no shadow is seen. `solids` are along its axes.
    pub(super) fn planned<T: Sync>(
        view: &LightView,
        solids: &LightTriangles<T>,
        texel_px: f32,
    ) -> Option<Self> {
        let camera = view.camera;
        // By meter of depth; with parallel rays at any depth, and there is one level.
        let pixel = 1.0 / camera.pixels_per_meter(1.0);
        let (scale, levels, pages) = (0..MOST_DOUBLINGS).find_map(|doubling| {
            let scale =
                LevelScale { texel_per_depth: pixel * texel_px * (1u32 << doubling) as f32, least: 0 };
            plan(view, solids, scale)
        })?;
        let (eye, forward, axes) = (camera.eye(), camera.forward(), view.axes);
        let map = Self { eye, forward, axes, scale, levels, pages, texels: Vec::new() };
        (map.stored() > 0).then_some(map)
    }

    /// How many pages are stored.
    pub fn stored(&self) -> usize {
        self.pages.iter().filter(|page| page.number > 0).count()
    }
}

/// The levels of a scale with their pages numbered; `None` where they exceed the limits.
fn plan<T: Sync>(
    view: &LightView,
    solids: &LightTriangles<T>,
    mut scale: LevelScale,
) -> Option<(LevelScale, Vec<ShadowLevel>, Vec<ShadowPage>)> {
    let is_parallel = view.camera.parallel_frame().is_some();
    let [least, most] = view.depths_m.map(|depth| scale.exponent(if is_parallel { 1.0 } else { depth }));
    scale.least = least.max(most - (MOST_LEVELS as i32 - 1));
    let (mut levels, mut pages, mut stored) = (Vec::new(), Vec::new(), 0);
    for exponent in scale.least..=most {
        let texel_m = libm::exp2f(exponent as f32);
        let nearest = if exponent == scale.least { 0.0 } else { texel_m };
        // A level reaches a little beyond its depths, since renderers round differently.
        let depths = if is_parallel {
            view.depths_m
        } else {
            [nearest * 0.98, texel_m * 2.04].map(|texel| texel / scale.texel_per_depth)
        };
        let seen = slab(view.camera, &view.axes, depths).intersection(solids.bounds);
        let seen = if seen.is_empty() { LightBox { low: Vec2::ZERO, high: Vec2::ZERO } } else { seen };
        let mut bounds = seen.grown(PAGE_MARGIN * texel_m);
        // Pages of a level lie at the same places whatever solids there are: what is out of view moves no texel.
        let page_m = texel_m * PAGE as f32;
        bounds.low = (bounds.low / page_m).floor() * page_m;
        let sides = ((bounds.high - bounds.low) / page_m).ceil();
        if !(sides.x <= MOST_SIDE && sides.y <= MOST_SIDE) {
            return None;
        }
        let [columns, rows] = [sides.x, sides.y].map(|side| (side as u32).max(1));
        let level =
            ShadowLevel { origin: bounds.low.to_array(), texel_m, columns, rows, first: pages.len() as u32 };
        for is_touched in level.touched(solids) {
            stored += u32::from(is_touched);
            let number = if is_touched { stored } else { 0 };
            pages.push(ShadowPage { number, highest: ShadowTexel::EMPTY });
        }
        if stored as usize > MOST_PAGES {
            return None;
        }
        levels.push(level);
    }
    Some((scale, levels, pages))
}

/// What the camera sees between two depths, across the light.
fn slab(camera: &Camera, axes: &LightAxes, depths: [f32; 2]) -> LightBox {
    let (width, height) = camera.size();
    let size = Vec2::new(width as f32, height as f32);
    let mut corners = [Vec3::ZERO; 8];
    for (index, corner) in corners.iter_mut().enumerate() {
        let pixel = size * Vec2::new((index & 1) as f32, (index >> 1 & 1) as f32);
        let origin = camera.ray_origin(pixel) - camera.eye();
        *corner = axes.turned(origin + camera.ray_through(pixel) * depths[index >> 2]);
    }
    LightBox::around(&corners)
}

/// Where the pages of a level are that are stored: how many of them lie south-west of each corner of its grid, so that
/// a box costs the same however large it is (Crow 1984).
#[derive(Debug)]
pub struct KeptPages<'a> {
    level: &'a ShadowLevel,
    counts: Vec<u32>,
}

impl<'a> KeptPages<'a> {
    pub fn new(level: &'a ShadowLevel, pages: &[ShadowPage]) -> Self {
        let stride = level.columns as usize + 1;
        let mut counts = vec![0; stride * (level.rows as usize + 1)];
        for (row, pages) in pages[level.pages()].chunks_exact(level.columns as usize).enumerate() {
            let mut in_row = 0;
            for (column, page) in pages.iter().enumerate() {
                in_row += u32::from(page.number > 0);
                counts[(row + 1) * stride + column + 1] = counts[row * stride + column + 1] + in_row;
            }
        }
        Self { level, counts }
    }

    /// How many are stored.
    fn count(&self) -> usize {
        self.counts[self.counts.len() - 1] as usize
    }

    /// The pages that a box touches; `None` where none of them is stored.
    pub fn pages_on(&self, bounds: LightBox) -> Option<PageRange> {
        let range = self.level.pages_near(bounds, 0.0)?;
        let stride = self.level.columns as usize + 1;
        let below = |column: u32, row: u32| self.counts[row as usize * stride + column as usize];
        let PageRange { from: [left, bottom], to: [right, top] } = range;
        let stored = below(right, top) + below(left, bottom) - below(left, top) - below(right, bottom);
        (stored > 0).then_some(range)
    }
}

impl ShadowLevel {
    /// Where its pages are in [`ShadowMap::pages`].
    pub fn pages(&self) -> Range<usize> {
        self.first as usize..(self.first + self.columns * self.rows) as usize
    }

    /// The box that it covers along the map's first two axes, meters from the eye.
    pub fn bounds(&self) -> LightBox {
        let low = Vec2::from(self.origin);
        let side = Vec2::new(self.columns as f32, self.rows as f32) * (PAGE as f32 * self.texel_m);
        LightBox { low, high: low + side }
    }

    /// The pages within `margin` texels of a box; `None` where there are none.
    pub fn pages_near(&self, bounds: LightBox, margin: f32) -> Option<PageRange> {
        let (low, high) = (Vec2::from(self.origin), self.bounds().high);
        let near = bounds.grown(margin * self.texel_m);
        if !(near.low.x <= high.x && near.low.y <= high.y && near.high.x >= low.x && near.high.y >= low.y) {
            return None;
        }
        let (from, last) = (self.page_at(near.low), self.page_at(near.high));
        Some(PageRange { from, to: [last[0] + 1, last[1] + 1] })
    }

    /// The page nearest to a place.
    fn page_at(&self, at: Vec2) -> [u32; 2] {
        let page = (at - Vec2::from(self.origin)) / (self.texel_m * PAGE as f32);
        // Casts saturate.
        [(page.x as u32).min(self.columns - 1), (page.y as u32).min(self.rows - 1)]
    }

    /// Sets the greatest values of each stored page to those of the pages around it too, so that a filter asks for one.
    fn spread_highest(&self, pages: &mut [ShadowPage]) {
        let (columns, rows) = (self.columns as usize, self.rows as usize);
        let own: Vec<ShadowTexel> = pages.iter().map(|page| page.highest).collect();
        for (index, page) in pages.iter_mut().enumerate().filter(|(_, page)| page.number > 0) {
            let (column, row) = (index % columns, index / columns);
            for y in row.saturating_sub(1)..(row + 2).min(rows) {
                for x in column.saturating_sub(1)..(column + 2).min(columns) {
                    page.highest = page.highest.highest(own[y * columns + x]);
                }
            }
        }
    }

    /// Whether a solid is on or near each page. Counts the boxes that begin and end, so that a box costs the same
    /// however large it is.
    fn touched<T: Sync>(&self, solids: &LightTriangles<T>) -> Vec<bool> {
        /// Portions of boxes that a thread counts at once: each has a grid of its own.
        const COUNTED: usize = 16;
        let stride = self.columns as usize + 1;
        let size = stride * (self.rows as usize + 1);
        let counted = |portions: &[Vec<(T, LightBox)>]| {
            let mut counts = vec![0i64; size];
            let boxes = portions.iter().flatten();
            for range in boxes.filter_map(|(_, bounds)| self.pages_near(*bounds, PAGE_MARGIN)) {
                let [[left, bottom], [right, top]] =
                    [range.from, range.to].map(|at| at.map(|page| page as usize));
                counts[bottom * stride + left] += 1;
                counts[bottom * stride + right] -= 1;
                counts[top * stride + left] -= 1;
                counts[top * stride + right] += 1;
            }
            counts
        };
        let sum = |mut counts: Vec<i64>, others: Vec<i64>| {
            counts.iter_mut().zip(&others).for_each(|(count, other)| *count += other);
            counts
        };
        let counts = solids.portions.par_chunks(COUNTED).map(counted).reduce_with(sum);
        let mut counts = counts.unwrap_or_else(|| vec![0; size]);
        for index in 0..counts.len() {
            let west = if index % stride > 0 { counts[index - 1] } else { 0 };
            let south = if index >= stride { counts[index - stride] } else { 0 };
            let both = if index % stride > 0 && index >= stride { counts[index - stride - 1] } else { 0 };
            counts[index] += west + south - both;
        }
        let rows = counts.chunks_exact(stride).take(self.rows as usize);
        rows.flat_map(|row| row[..stride - 1].iter().map(|&count| count > 0)).collect()
    }
}
