//! Reads a map: the share of the sun that reaches a point past solids, and the contact shade around their feet.
//!
//! The sun is read twice, as percentage-closer soft shadows do (Fernando 2005): the mean height of what lies between
//! gives the breadth of the half-shadow, and the share of that breadth that is covered is the shade. All texels within
//! the breadth are read, weighted by their distance, so that shade changes smoothly from pixel to pixel without noise.
//!
//! A texel is compared with the plane of the face that receives, at the texel's own center, where the map holds the
//! exact height of that face: a lit face does not shade itself, however steep, and shadows begin at the foot.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::render::shadow::{MOST_RADIUS, NOTHING, PAGE, ShadowLevel, ShadowMap, ShadowTexel};

/// The half-shadow's half breadth per meter of distance: the terrain's sun, 0.75° in radius, whose disc is as broad as
/// a tent a quarter wider.
const SPREAD: f32 = 0.013 * 1.25;

/// The least half breadth, in texels: smaller shows texels as stairs.
const LEAST_RADIUS: f32 = 1.5;

/// The least height over the receiving face that casts, in texels: what rounding may add.
const BIAS_TEXELS: f32 = 0.05;

/// The same per meter from the eye: coordinates are of 24 bits.
const BIAS_PER_METER: f32 = 1e-6;

/// The height over the bias from which a texel casts its full share, in texels: less shows the texels of a lit wall
/// as teeth along its foot, more weakens the shadow of what is only a few pixels high.
const FULL_TEXELS: f32 = 1.0;

/// The steepest receiving face, meters toward the light per meter across: a face steeper than that is hardly lit.
const STEEPEST: f32 = 20.0;

/// The radius of contact shade, in texels of the sky's map.
const CONTACT_RADIUS: f32 = 3.0;

/// The share of the sky that solids hide from the ground in the corner of a tall wall.
const GROUND_CONTACT: f32 = 0.9;

/// The share of the sky that the ground hides from the foot of a wall.
const WALL_CONTACT: f32 = 0.35;

/// What casts on a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowReceiver {
    /// The ground and drapes: solids.
    Ground,
    /// Solids: solids and the ground.
    Solid,
}

/// A window of texels around a point, each weighted by its distance: a tent in both directions.
struct Readings<'a> {
    map: &'a ShadowMap,
    level: &'a ShadowLevel,
    at: Vec2,
}

impl ShadowReceiver {
    fn height(self, texel: ShadowTexel) -> f32 {
        match self {
            Self::Ground => texel.solid,
            Self::Solid => texel.solid.max(texel.ground),
        }
    }
}

impl ShadowMap {
    /// The share of the sun that reaches a point of a face with this normal (any length, either side), 0..=1.
    pub fn sun(&self, world: Vec3, normal: Vec3, receiver: ShadowReceiver) -> f32 {
        let offset = world - self.eye;
        let level = self.level_at(offset);
        let here = self.axes.turned(offset);
        let readings = Readings { map: self, level, at: level.position(here.xy()) };
        let highest = receiver.height(readings.highest(MOST_RADIUS)) - here.z;
        if highest <= 0.0 {
            return 1.0;
        }
        let texel_m = level.texel_m;
        let rise = rise(self.axes.turned(normal)) * texel_m;
        let error_m = BIAS_TEXELS * texel_m + BIAS_PER_METER * offset.length();
        let bias = error_m * (1.0 + rise.length() / texel_m);
        let radius = |height: f32| (SPREAD * height / texel_m).clamp(LEAST_RADIUS, MOST_RADIUS);
        let covered = |radius: f32| {
            // The weight of all texels, of those that cast, and of these times their height.
            readings.sum(radius, |texel, aside, weight| {
                let height = receiver.height(texel) - (here.z + rise.dot(aside));
                let casting = ((height - bias) / (FULL_TEXELS * texel_m)).clamp(0.0, 1.0) * weight;
                Vec3::new(weight, casting, casting * height)
            })
        };
        let search = radius(highest);
        let found = covered(search);
        if found.y == 0.0 || found.y >= found.x {
            return if found.y == 0.0 { 1.0 } else { 0.0 };
        }
        let breadth = radius(found.z / found.y);
        let shade = if breadth < search { covered(breadth) } else { found };
        1.0 - shade.y / shade.x
    }

    /// The share of the sky that contact with solids, or of solids with the ground, leaves to a point, 0..=1.
    pub fn contact(&self, world: Vec3, receiver: ShadowReceiver) -> f32 {
        let offset = world - self.eye;
        let level = self.level_at(offset);
        let here = self.axes.turned(offset);
        let readings = Readings { map: self, level, at: level.position(here.xy()) };
        let highest = readings.highest(CONTACT_RADIUS);
        let reach_m = CONTACT_RADIUS * level.texel_m;
        match receiver {
            ShadowReceiver::Ground => {
                if highest.solid <= here.z {
                    return 1.0;
                }
                let hidden = readings.sum(CONTACT_RADIUS, |texel, _, weight| {
                    Vec3::new(weight, weight * ((texel.solid - here.z) / reach_m).clamp(0.0, 1.0), 0.0)
                });
                1.0 - GROUND_CONTACT * hidden.y / hidden.x
            }
            ShadowReceiver::Solid => {
                if highest.ground <= here.z - reach_m {
                    return 1.0;
                }
                let hidden = readings.sum(CONTACT_RADIUS, |texel, _, weight| {
                    let near = (1.0 - (here.z - texel.ground) / reach_m).clamp(0.0, 1.0);
                    Vec3::new(weight, weight * near, 0.0)
                });
                1.0 - WALL_CONTACT * hidden.y / hidden.x
            }
        }
    }

    fn level_at(&self, offset: Vec3) -> &ShadowLevel {
        let above = self.scale.exponent(offset.dot(self.forward)) - self.scale.least;
        &self.levels[(above.max(0) as usize).min(self.levels.len() - 1)]
    }

    fn texel(&self, level: &ShadowLevel, [x, y]: [i32; 2]) -> ShadowTexel {
        let (column, row) = (x.div_euclid(PAGE as i32), y.div_euclid(PAGE as i32));
        let number = level.page(column, row).map_or(0, |index| self.pages[index].number);
        let Some(page) = number.checked_sub(1) else { return ShadowTexel::EMPTY };
        let (x, y) = (x.rem_euclid(PAGE as i32) as u32, y.rem_euclid(PAGE as i32) as u32);
        self.texels[((page * PAGE + y) * PAGE + x) as usize]
    }
}

impl ShadowLevel {
    /// Where a point lies, in texels from the level's corner.
    fn position(&self, across: Vec2) -> Vec2 {
        (across - Vec2::from(self.origin)) / self.texel_m
    }

    fn page(&self, column: i32, row: i32) -> Option<usize> {
        let is_inside = (0..self.columns as i32).contains(&column) && (0..self.rows as i32).contains(&row);
        is_inside.then(|| self.first as usize + row as usize * self.columns as usize + column as usize)
    }
}

impl Readings<'_> {
    /// The greatest values of the pages within `radius`, at most a page wide.
    fn highest(&self, radius: f32) -> ShadowTexel {
        let page = |at: f32| (at / PAGE as f32).floor() as i32;
        let (low, high) = (self.at - radius, self.at + radius);
        let (rows, columns) = (page(low.y)..=page(high.y), page(low.x)..=page(high.x));
        let mut highest = ShadowTexel { solid: NOTHING, ground: NOTHING };
        for row in rows {
            for column in columns.clone() {
                if let Some(index) = self.level.page(column, row) {
                    highest = highest.highest(self.map.pages[index].highest);
                }
            }
        }
        highest
    }

    /// The sum of `value(texel, texels from the point, weight)` over the texels within `radius`.
    fn sum(&self, radius: f32, value: impl Fn(ShadowTexel, Vec2, f32) -> Vec3) -> Vec3 {
        let (low, high) = ((self.at - 0.5 - radius).ceil(), (self.at - 0.5 + radius).floor());
        let mut sum = Vec3::ZERO;
        for y in low.y as i32..=high.y as i32 {
            for x in low.x as i32..=high.x as i32 {
                let aside = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - self.at;
                let weight = (Vec2::ONE - aside.abs() / radius).max(Vec2::ZERO);
                sum += value(self.map.texel(self.level, [x, y]), aside, weight.x * weight.y);
            }
        }
        sum
    }
}

/// How far a face with this normal, along the light's axes, rises toward the light per meter across.
fn rise(normal: Vec3) -> Vec2 {
    let toward = if normal.z < 0.0 { normal.z.min(-1e-30) } else { normal.z.max(1e-30) };
    let rise = -normal.xy() / toward;
    let steepness = rise.length();
    if steepness <= STEEPEST {
        rise
    } else if steepness.is_finite() {
        rise * (STEEPEST / steepness)
    } else {
        Vec2::ZERO
    }
}
