//! Rasterizes triangles to the pages of a level.
//!
//! Coverage is that of the picture's rasterizer, at the centers of texels. A triangle's height at a texel comes from its
//! plane, clamped to its corners, so that a surface does not shade itself.

use glam::{Vec2, Vec3, Vec3Swizzles};
use rayon::prelude::*;

use crate::cpu::alpha::AlphaMask;
use crate::cpu::raster::{PixelWindow, doubled_area, snapped};
use crate::shadow::casters::{CasterTriangle, LightBox, LightTriangles};
use crate::shadow::coverage::cover_centers;
use crate::shadow::cut::cut_at;
use crate::shadow::levels::{KeptPages, MapSource, PageRange};
use crate::shadow::{FLOATING_TEXELS, NOTHING, PAGE, ShadowLevel, ShadowPage, ShadowPurpose, ShadowTexel};
use sandtable_draw::material::{AlphaMode, TextureWrap};

/// How far outside a level corners may lie, in texels; triangles that reach farther are cut.
const GUARD_TEXELS: f32 = 8192.0;

/// More than snapping to the rasterizer's grid moves a corner, in texels.
const SNAPPED_TEXELS: f32 = 1e-3;

/// Rows of pages that a triangle in a bucket reaches at the most.
const SHORT_ROWS: u32 = 4;

pub struct Filling<'a> {
    pub source: &'a MapSource<'a>,
    pub solids: &'a LightTriangles,
    pub ground: &'a LightTriangles,
    pub level: &'a ShadowLevel,
    pub kept: &'a KeptPages<'a>,
}

/// The triangles of a portion that lie on a level.
struct LevelPortion<'a> {
    /// Those of up to [`SHORT_ROWS`] rows of pages, by the row that they begin in: few rows ask for a triangle.
    short: Vec<LevelTriangle<'a>>,
    /// The others: a list of enormous ones takes no more memory than any.
    tall: Vec<LevelTriangle<'a>>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum CasterKind {
    Solid,
    Ground,
}

struct LevelTriangle<'a> {
    triangle: &'a CasterTriangle,
    kind: CasterKind,
    range: PageRange,
}

/// The pages of one row of a level.
struct PageRow<'a> {
    row: u32,
    /// The place among those stored, by column.
    places: Vec<Option<usize>>,
    texels: &'a mut [ShadowTexel],
    /// The least height of a face that looks down, by texel; only for contact.
    undersides: Vec<f32>,
}

/// A triangle's functions over a level, in texels.
struct TexelPlane<'a> {
    start: Vec2,
    height: f32,
    rise: Vec2,
    range: [f32; 2],
    looks_down: bool,
    mask: Option<TexelMask<'a>>,
}

/// The alpha of a masked triangle over a level.
struct TexelMask<'a> {
    mask: Option<&'a AlphaMask>,
    wrap: [TextureWrap; 2],
    cutoff: f32,
    /// Texture coordinates and vertex alpha at the start, and their change per texel.
    start: Vec3,
    across: Vec3,
    along: Vec3,
}

impl<'a> Filling<'a> {
    /// Draws the `texels` of the stored pages of the level, whose entries are `pages`; sets the greatest values of each.
    pub fn fill(&self, pages: &mut [ShadowPage], mut texels: &mut [ShadowTexel]) {
        let on_level = |kind: CasterKind, casters: &'a LightTriangles| {
            let of_portion = move |portion: &'a Vec<_>| LevelPortion::new(kind, portion, self.kept);
            casters.portions.par_iter().map(of_portion).filter(|portion| !portion.is_empty())
        };
        let solids = on_level(CasterKind::Solid, self.solids);
        let portions: Vec<_> = solids.chain(on_level(CasterKind::Ground, self.ground)).collect();
        let mut rows = Vec::new();
        for (row, pages) in (0..).zip(pages.chunks_exact_mut(self.level.columns as usize)) {
            let stored = pages.iter().filter(|page| page.number > 0).count();
            let (own, others) = texels.split_at_mut(stored * (PAGE * PAGE) as usize);
            texels = others;
            if stored > 0 {
                rows.push((row, pages, own));
            }
        }
        rows.into_par_iter().for_each(|(row, pages, texels)| {
            self.row(row, pages, texels, &portions);
        });
    }

    /// Draws a row of pages, at least one of which is stored.
    fn row(
        &self,
        row: u32,
        pages: &mut [ShadowPage],
        texels: &mut [ShadowTexel],
        portions: &[LevelPortion<'_>],
    ) {
        let mut stored = 0;
        let place = |page: &ShadowPage| {
            stored += usize::from(page.number > 0);
            (page.number > 0).then(|| stored - 1)
        };
        let places: Vec<_> = pages.iter().map(place).collect();
        texels.fill(ShadowTexel::EMPTY);
        let undersides = match self.source.purpose {
            ShadowPurpose::Sun => Vec::new(),
            ShadowPurpose::Contact => vec![f32::MAX; texels.len()],
        };
        let mut work = PageRow { row, places, texels, undersides };
        for on in portions.iter().flat_map(|portion| portion.near_row(row)) {
            if on.range.from[1] <= row && row < on.range.to[1] {
                self.draw(on, &mut work);
            }
        }
        let floating_m = FLOATING_TEXELS * self.level.texel_m;
        for (texel, underside) in work.texels.iter_mut().zip(&work.undersides) {
            if *underside < f32::MAX && underside - texel.ground > floating_m {
                texel.solid = NOTHING;
            }
        }
        let kept = pages.iter_mut().filter(|page| page.number > 0);
        for (page, texels) in kept.zip(work.texels.chunks_exact((PAGE * PAGE) as usize)) {
            page.highest = texels.iter().fold(ShadowTexel::EMPTY, |highest, &texel| highest.highest(texel));
        }
    }

    fn draw(&self, on: &LevelTriangle, work: &mut PageRow<'_>) {
        let columns = on.range.from[0] as usize..on.range.to[0] as usize;
        if work.places[columns.clone()].iter().all(Option::is_none) {
            return;
        }
        let origin = Vec2::from(self.level.origin).extend(0.0);
        let scale = Vec3::new(1.0 / self.level.texel_m, 1.0 / self.level.texel_m, 1.0);
        let [a, b, c] = on.triangle.corners;
        let corners = [(a - origin) * scale, (b - origin) * scale, (c - origin) * scale];
        let size = [self.level.columns * PAGE, self.level.rows * PAGE];
        let plan = corners.map(|corner| corner.xy());
        if is_between_centers(&plan) {
            return;
        }
        let Some(plane) = self.plane(on, corners) else { return };
        if is_within_guard(&plan, size) {
            self.draw_piece(on, &plane, plan, work);
            return;
        }
        let outline = cut(plan, size);
        for pair in outline.get(1..).unwrap_or_default().windows(2) {
            self.draw_piece(on, &plane, [outline[0], pair[0], pair[1]], work);
        }
    }

    /// Draws a part of a triangle, its corners in texels.
    fn draw_piece(&self, on: &LevelTriangle, plane: &TexelPlane, corners: [Vec2; 3], work: &mut PageRow<'_>) {
        let snap = |corner: Vec2| [snapped(f64::from(corner.x)), snapped(f64::from(corner.y))];
        let [a, b, c] = corners.map(snap);
        let turned = if doubled_area(&[a, b, c]) < 0 { [a, c, b] } else { [a, b, c] };
        if doubled_area(&turned) == 0 {
            return;
        }
        let touched = PixelWindow::around(&turned, [self.level.columns * PAGE, self.level.rows * PAGE]);
        for column in on.range.from[0] as usize..on.range.to[0] as usize {
            let Some(place) = work.places[column] else { continue };
            let corner = [column as u32 * PAGE, work.row * PAGE];
            let page = PixelWindow { from: corner, to: corner.map(|side| side + PAGE) };
            let first = place * (PAGE * PAGE) as usize;
            let texels = &mut work.texels[first..][..(PAGE * PAGE) as usize];
            let mut undersides =
                work.undersides.get_mut(first..).filter(|all| plane.looks_down && !all.is_empty());
            cover_centers(&turned, page.intersection(touched), |x, y| {
                let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - plane.start;
                if plane.is_hole(at) {
                    return;
                }
                let index = ((y - corner[1]) * PAGE + x - corner[0]) as usize;
                let height = plane.height_at(at);
                let texel = &mut texels[index];
                if let Some(least) = undersides.as_mut().and_then(|all| all.get_mut(index)) {
                    *least = least.min(height);
                }
                match on.kind {
                    CasterKind::Solid => texel.solid = texel.solid.max(height),
                    CasterKind::Ground => texel.ground = texel.ground.max(height),
                }
            });
        }
    }

    /// The functions of a triangle; `None` where it is seen edge-on.
    fn plane(&self, on: &LevelTriangle, corners: [Vec3; 3]) -> Option<TexelPlane<'_>> {
        let [a, b, c] = corners;
        let (ab, ac) = (b - a, c - a);
        let area = ab.xy().perp_dot(ac.xy());
        // The change over one texel of what changes by `second` and `third` to those corners.
        let across = |second: f32, third: f32| (second * ac.y - third * ab.y) / area;
        let along = |second: f32, third: f32| (third * ab.x - second * ac.x) / area;
        let rise = Vec2::new(across(ab.z, ac.z), along(ab.z, ac.z));
        let heights = corners.map(|corner| corner.z);
        let least = heights.into_iter().fold(f32::MAX, f32::min);
        let most = heights.into_iter().fold(f32::MIN, f32::max);
        let item = &self.source.list.items[on.triangle.item as usize];
        let material = &self.source.list.materials[item.material.0 as usize];
        let mask = if let AlphaMode::Mask(cutoff) = material.alpha {
            let mesh = &self.source.list.meshes[item.mesh.0 as usize];
            let values = mesh.triangles[on.triangle.triangle as usize].map(|id| {
                let vertex = &mesh.vertices[id.index()];
                Vec2::from(vertex.uv).extend(vertex.color.alpha() * material.base_color.alpha())
            });
            let [start, second, third] = [values[0], values[1] - values[0], values[2] - values[0]];
            Some(TexelMask {
                mask: material.texture.and_then(|id| self.source.triangles.masks.get(&id.0)),
                wrap: material.texture_wrap,
                cutoff,
                start,
                across: (second * ac.y - third * ab.y) / area,
                along: (third * ab.x - second * ac.x) / area,
            })
        } else {
            None
        };
        let looks_down = on.kind == CasterKind::Solid && area < 0.0 && !material.two_sided;
        let range = [least, most];
        rise.is_finite().then_some(TexelPlane { start: a.xy(), height: a.z, rise, range, looks_down, mask })
    }
}

impl<'a> LevelPortion<'a> {
    fn new(kind: CasterKind, portion: &'a [(CasterTriangle, LightBox)], kept: &KeptPages) -> Self {
        let (mut short, mut tall) = (Vec::new(), Vec::new());
        for (triangle, bounds) in portion {
            if let Some(range) = kept.pages_on(*bounds) {
                let rows = range.to[1] - range.from[1];
                let triangles = if rows <= SHORT_ROWS { &mut short } else { &mut tall };
                triangles.push(LevelTriangle { triangle, kind, range });
            }
        }
        short.sort_unstable_by_key(|on| on.range.from[1]);
        Self { short, tall }
    }

    fn is_empty(&self) -> bool {
        self.short.is_empty() && self.tall.is_empty()
    }

    /// The triangles that may touch a row of pages.
    fn near_row(&self, row: u32) -> impl Iterator<Item = &LevelTriangle<'a>> {
        let first = self.short.partition_point(|on| on.range.from[1] + SHORT_ROWS <= row);
        let begun = self.short.partition_point(|on| on.range.from[1] <= row);
        self.short[first..begun].iter().chain(&self.tall)
    }
}

impl TexelPlane<'_> {
    fn height_at(&self, offset: Vec2) -> f32 {
        (self.height + self.rise.dot(offset)).max(self.range[0]).min(self.range[1])
    }

    fn is_hole(&self, offset: Vec2) -> bool {
        let Some(mask) = &self.mask else { return false };
        let here = mask.start + mask.across * offset.x + mask.along * offset.y;
        let alpha = mask.mask.map_or(1.0, |alphas| {
            let footprint = alphas.footprint(mask.across.xy(), mask.along.xy(), 1);
            alphas.sample(here.xy(), &footprint, mask.wrap)
        });
        alpha * here.z < mask.cutoff
    }
}

/// Whether no texel's center lies in the box around the corners: so it is with most triangles of a distant tree.
fn is_between_centers(corners: &[Vec2; 3]) -> bool {
    let [a, b, c] = *corners;
    // Snapping moves a corner by less than this.
    let (low, high) = (a.min(b).min(c) - SNAPPED_TEXELS, a.max(b).max(c) + SNAPPED_TEXELS);
    let (first, last) = ((low - 0.5).ceil(), (high - 0.5).floor());
    first.x > last.x || first.y > last.y
}

fn is_within_guard(corners: &[Vec2; 3], size: [u32; 2]) -> bool {
    let low = Vec2::splat(-GUARD_TEXELS);
    let high = Vec2::new(size[0] as f32, size[1] as f32) + GUARD_TEXELS;
    corners.iter().all(|corner| corner.cmpge(low).all() && corner.cmple(high).all())
}

/// The part of a triangle that the rasterizer's coordinates can hold.
fn cut(corners: [Vec2; 3], size: [u32; 2]) -> Vec<Vec2> {
    let low = Vec2::splat(-GUARD_TEXELS);
    let high = Vec2::new(size[0] as f32, size[1] as f32) + GUARD_TEXELS;
    let mut outline = corners.to_vec();
    for (axis, limit, sign) in [(0, low.x, 1.0), (1, low.y, 1.0), (0, high.x, -1.0), (1, high.y, -1.0)] {
        outline = cut_at(&outline, |corner| (corner[axis] - limit) * sign);
    }
    outline
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_skipped_between_centers_covers_none() {
        let window = PixelWindow { from: [0, 0], to: [8, 8] };
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let (mut skipped, mut drawn) = (0, 0);
        for _ in 0..4000 {
            let at = Vec2::new(random(), random()) * 6.0;
            let size = random() * 2.0;
            let corners = [(); 3].map(|()| at + Vec2::new(random(), random()) * size);
            let snapped = corners.map(|at| [snapped(f64::from(at.x)), snapped(f64::from(at.y))]);
            let [a, b, c] = snapped;
            let turned = if doubled_area(&snapped) < 0 { [a, c, b] } else { snapped };
            let mut count = 0;
            if doubled_area(&turned) != 0 {
                cover_centers(&turned, window, |_, _| count += 1);
            }
            let is_skipped = is_between_centers(&corners);
            assert!(!is_skipped || count == 0, "{corners:?}");
            skipped += u32::from(is_skipped);
            drawn += u32::from(count > 0);
        }
        assert!(skipped > 500 && drawn > 100, "{skipped} {drawn}");
    }
}
