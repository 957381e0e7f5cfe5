//! The sun's shadow: two sheets swept over the ground away from the sun, one sinking with the rays of the sun's upper
//! edge and one with those of its lower edge.
//!
//! ```text
//!            ridge
//!  sun        /\ ` - .  lower edge's rays
//!   ↘        /  \ `      ` - .
//!           /    \   ` .        ` - .
//! _________/      \______` .____________` - .____
//!                  shadow  | penumbra       | lit
//! ```
//!
//! Each line of posts takes the sheet from the line before it, interpolated where the rays pass between posts, so that
//! the cost is constant per post. Where the ground has more posts than a picture has pixels, the sheets are swept over a
//! reduced lattice whose posts cast what any post around them casts; heights are compared with them post by post.

use glam::{Vec2, Vec2Swizzles, Vec3, Vec3Swizzles};

use crate::light::field::{CoarseField, Reduction};
use sandtable_base::vectorized::vectorized;

/// Half the sun's breadth, radians: 0.75°. The true sun's is 0.27°, whose penumbra a picture of the whole ground shows as
/// a hard edge with the stairs of the lattice.
const SUN_RADIUS: f32 = 0.013;

/// The least height over which the sun emerges, as a share of the cell size: smaller shows the lattice as stairs along
/// the edges of short shadows, larger washes them out.
const LEAST_PENUMBRA_CELLS: f32 = 0.35;

/// The most cells along a side of the lattice that is swept: a picture of 1920 pixels shows no more.
const MOST_CELLS: usize = 2048;

/// The height of a sheet where nothing casts a shadow: so far down that no sum of heights comes near, and finite, since
/// interpolating between infinities gives NaN.
const NOTHING: f32 = -1e30;

/// The heights up to which the ground is in shadow.
#[derive(Debug)]
pub struct SunShadow {
    /// Without any sun.
    full: CoarseField<'static>,
    /// Without all of it.
    partial: CoarseField<'static>,
    /// The height over which the sun emerges at the least, meters.
    least_penumbra_m: f32,
}

impl SunShadow {
    /// The shadow of heights under a sun in direction `to_sun` (unit vector); `None` where it is overhead, or below the
    /// horizon and so throws no light to shade.
    pub fn cast(heights: &CoarseField, to_sun: Vec3) -> Option<Self> {
        let level = to_sun.xy().try_normalize().filter(|_| to_sun.z > 0.0)?;
        let altitude = libm::atan2f(to_sun.z, to_sun.xy().length());
        // Rays that do not sink, or fall straight down, would reach too far or nowhere.
        let sheet = |altitude: f32| sheet(heights, level, libm::tanf(altitude.clamp(0.0, 1.55)));
        let (full, partial) = rayon::join(|| sheet(altitude + SUN_RADIUS), || sheet(altitude - SUN_RADIUS));
        // Level ground lies as far above its sheets as rays sink from post to post, and is fully lit.
        let sinking_m = heights.cell.min_element() * to_sun.z / to_sun.xy().length();
        let least_penumbra_m = (LEAST_PENUMBRA_CELLS * heights.cell.max_element()).min(2.0 * sinking_m);
        Some(Self { full, partial, least_penumbra_m })
    }

    /// The share of the sun that reaches each post of a row of `heights`, 0..=1; 1 where there is no data.
    pub fn visibility(&self, row: usize, heights: &[f32]) -> Vec<f32> {
        let [mut full, partial] =
            [&self.full, &self.partial].map(|sheet| sheet.finer_row(row, sheet.every, heights.len()));
        vectorized(
            #[inline(always)]
            || {
                for ((full, partial), &height) in full.iter_mut().zip(partial).zip(heights) {
                    let middle = 0.5 * (*full + partial);
                    let share = (height - middle) / (partial - *full).max(self.least_penumbra_m) + 0.5;
                    *full = if share < 1.0 { share.max(0.0) } else { 1.0 };
                }
            },
        );
        full
    }
}

/// The highest of what the posts around a post cast, moved to it along rays; `rise` is that of the rays per post
/// eastward and northward.
struct Caster {
    rise: Vec2,
}

impl Reduction for Caster {
    type Sum = f32;
    const NONE: f32 = NOTHING;

    /// Every post counts once: shadows of rough ground would grow with posts that count to several.
    fn before(by: usize) -> usize {
        (by - 1) / 2
    }

    #[inline(always)]
    fn add(&self, sum: f32, value: f32, north: f32) -> f32 {
        sum.max(value - self.rise.y * north)
    }

    #[inline(always)]
    fn join(&self, sum: f32, column: f32, east: f32) -> f32 {
        sum.max(column - self.rise.x * east)
    }

    #[inline(always)]
    fn value(&self, sum: f32) -> f32 {
        sum
    }
}

/// The heights below which rays that rise by `tangent` toward `level` (unit vector) meet ground.
fn sheet(heights: &CoarseField, level: Vec2, tangent: f32) -> CoarseField<'static> {
    let caster = Caster { rise: level * heights.cell * tangent };
    let casting = heights.reduced(heights.factor(MOST_CELLS), &caster);
    let steps = (level / casting.cell).abs();
    if steps.y >= steps.x {
        swept_by_rows(casting, level, tangent)
    } else {
        swept_by_columns(casting, level, tangent)
    }
}

/// Sweeps away from the sun, which is `level` and more north or south than east or west in cells: the heights that cast become
/// those in shadow.
fn swept_by_rows(mut field: CoarseField<'static>, level: Vec2, tangent: f32) -> CoarseField<'static> {
    let (columns, rows) = (field.columns, field.rows);
    let mut sweep = SheetSweep::new(field.cell, level, tangent, columns);
    let heights = field.values.to_mut();
    for row in away(rows, level.y) {
        sweep.pass(&mut heights[row * columns..][..columns]);
    }
    field
}

/// The same where the sun is more east or west. Few columns at a time are copied into lines, so that no second field is held.
fn swept_by_columns(mut field: CoarseField<'static>, level: Vec2, tangent: f32) -> CoarseField<'static> {
    /// Columns that are copied together: their values in a row share lines of the cache.
    const TOGETHER: usize = 16;
    let (columns, rows) = (field.columns, field.rows);
    let mut sweep = SheetSweep::new(field.cell.yx(), level.yx(), tangent, rows);
    let heights = field.values.to_mut();
    let mut lines = vec![0.0; TOGETHER * rows];
    for block in away(columns.div_ceil(TOGETHER), level.x) {
        let block = block * TOGETHER..columns.min((block + 1) * TOGETHER);
        for (row, heights) in heights.chunks_exact(columns).enumerate() {
            let values = lines[row..].iter_mut().step_by(rows);
            values.zip(&heights[block.clone()]).for_each(|(value, height)| *value = *height);
        }
        for column in away(block.len(), level.x) {
            sweep.pass(&mut lines[column * rows..][..rows]);
        }
        for (row, heights) in heights.chunks_exact_mut(columns).enumerate() {
            let values = lines[row..].iter().step_by(rows);
            heights[block.clone()].iter_mut().zip(values).for_each(|(height, value)| *height = *value);
        }
    }
    field
}

/// The numbers below `count`, from the last down where the sun lies `toward` their end.
fn away(count: usize, toward: f32) -> impl Iterator<Item = usize> {
    (0..count).map(move |step| if toward > 0.0 { count - 1 - step } else { step })
}

/// A sheet on its way from line to line.
struct SheetSweep {
    /// The sheet at the last line. One value more at the beginning and two at the end, where nothing casts a shadow.
    before: Vec<f32>,
    shadow: Vec<f32>,
    /// Where the rays through the first value of a line leave the last one.
    first: usize,
    /// How far past that, as a share of the way to the next value.
    part: f32,
    /// How far rays sink from line to line, meters.
    drop: f32,
}

impl SheetSweep {
    /// Lines follow each other along Y of `cell` and `level`, and have `count` values.
    fn new(cell: Vec2, level: Vec2, tangent: f32, count: usize) -> Self {
        let per_line = cell.y / level.y.abs();
        let aside = level.x * per_line / cell.x;
        Self {
            before: vec![NOTHING; count + 3],
            shadow: vec![NOTHING; count],
            first: (1.0 + aside.floor()) as usize,
            part: aside - aside.floor(),
            drop: per_line * tangent,
        }
    }

    /// Moves on to the next line, whose heights become those in shadow.
    fn pass(&mut self, line: &mut [f32]) {
        let Self { before, shadow, first, part, drop } = self;
        vectorized(
            #[inline(always)]
            || {
                let (near, far) = (&before[*first..], &before[*first + 1..]);
                for ((shadow, &near), &far) in shadow.iter_mut().zip(near).zip(far) {
                    *shadow = between(near, far, *part) - *drop;
                }
                for ((before, line), shadow) in before[1..].iter_mut().zip(line).zip(shadow) {
                    *before = line.max(*shadow);
                    *line = *shadow;
                }
            },
        );
    }
}

/// The height between two, linear where both cast a shadow; else that of the nearer.
#[inline(always)]
fn between(from: f32, to: f32, part: f32) -> f32 {
    let nearer = if part > 0.5 { to } else { from };
    if from.min(to) > 0.5 * NOTHING { from + (to - from) * part } else { nearer }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(
        [columns, rows]: [usize; 2],
        cell: Vec2,
        height: impl Fn(usize, usize) -> f32,
    ) -> CoarseField<'static> {
        let values: Vec<f32> = (0..columns * rows).map(|at| height(at % columns, at / columns)).collect();
        CoarseField { columns, rows, every: 1, cell, values: values.into() }
    }

    #[test]
    fn columns_are_swept_as_the_rows_of_the_ground_turned() {
        let height =
            |x: usize, y: usize| ((x * 7919 + y * 104_729) % 101) as f32 + 40.0 * libm::sinf(x as f32 * 0.2);
        for level in [Vec2::new(0.8, 0.6), Vec2::new(-0.96, 0.28), Vec2::new(0.8, -0.6), Vec2::X, Vec2::NEG_X]
        {
            let (columns, rows, cell) = (53, 37, Vec2::new(10.0, 12.0));
            let swept = swept_by_columns(field([columns, rows], cell, height), level, 0.3);
            let turned = field([rows, columns], cell.yx(), |x, y| height(y, x));
            let turned = swept_by_rows(turned, level.yx(), 0.3);
            for (at, value) in swept.values.iter().enumerate() {
                let other = turned.line(at % columns)[at / columns];
                assert_eq!(value.to_bits(), other.to_bits(), "{level}: {at}");
            }
        }
    }
}
