//! Reads a map: the share of the sun that reaches a point past solids, and the contact shade around their feet.
//!
//! The sun is read twice, as percentage-closer soft shadows do (Fernando 2005): the mean height of what lies between
//! gives the breadth of the half-shadow, and the share of that breadth that is covered is the shade. All texels within
//! the breadth are read, weighted by their distance, so that shade changes smoothly from pixel to pixel without noise.
//!
//! A texel is compared with the plane of the face that receives, at the texel's own center, where the map holds the
//! exact height of that face: a lit face does not shade itself, however steep, and shadows begin at the foot.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::shadow::{MOST_RADIUS, PAGE, ShadowLevel, ShadowMap, ShadowPage, ShadowTexel};

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

/// A search in a wider radius reads every other texel in both directions: it only asks how far away what casts is.
const SPARSE_RADIUS: f32 = 2.5;

/// Texels outside a level that filters ask for at the most: a page.
const OUTSIDE: i32 = PAGE as i32;

/// More texels in a row than any radius reads.
const MOST_WINDOW: usize = 12;

/// The radius of contact shade, in texels of the sky's map.
const CONTACT_RADIUS: f32 = 2.0;

/// The radius within which a wall looks for the ground, in the same texels: ground is smooth.
const WALL_RADIUS: f32 = 1.0;

/// The share of the sky that solids hide from the ground in the corner of a tall wall.
const GROUND_CONTACT: f32 = 0.9;

/// The share of the sky that the ground hides from the foot of a wall.
const WALL_CONTACT: f32 = 0.35;

/// The base-2 logarithm of [`PAGE`], and what of a texel's place lies within its page.
const PAGE_BITS: u32 = PAGE.trailing_zeros();
const PAGE_MASK: i32 = PAGE as i32 - 1;

/// Returns the constants of filters as shaders name them; see
/// [`shader_constants`](sandtable_draw::shader_constants::shader_constants).
pub fn shader_constants() -> Vec<(&'static str, Vec<f32>)> {
    vec![
        ("MOST_RADIUS", vec![MOST_RADIUS]),
        ("LEAST_RADIUS", vec![LEAST_RADIUS]),
        ("SPREAD", vec![SPREAD]),
        ("BIAS_TEXELS", vec![BIAS_TEXELS]),
        ("BIAS_PER_METER", vec![BIAS_PER_METER]),
        ("FULL_TEXELS", vec![FULL_TEXELS]),
        ("STEEPEST", vec![STEEPEST]),
        ("SPARSE_RADIUS", vec![SPARSE_RADIUS]),
        ("CONTACT_RADIUS", vec![CONTACT_RADIUS]),
        ("WALL_RADIUS", vec![WALL_RADIUS]),
        ("GROUND_CONTACT", vec![GROUND_CONTACT]),
        ("WALL_CONTACT", vec![WALL_CONTACT]),
    ]
}

/// The kind of point that receives a shadow, which decides what casts on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowReceiver {
    /// The ground and drapes: solids.
    Ground,
    /// Solids: solids and the ground.
    Solid,
}

/// A point as a map sees it.
struct ShadowPlace<'a> {
    map: &'a ShadowMap,
    level: &'a ShadowLevel,
    /// In texels from the level's corner.
    at: Vec2,
    /// Meters from the eye toward the light.
    height: f32,
}

/// The plane of the face that receives.
#[derive(Clone, Copy)]
struct ReceivingPlane {
    receiver: ShadowReceiver,
    /// Meters toward the light per texel.
    rise: Vec2,
    /// The least height over it that casts, in meters.
    bias: f32,
}

impl ShadowReceiver {
    fn height(self, texel: ShadowTexel) -> f32 {
        match self {
            Self::Ground => texel.solid,
            Self::Solid => texel.top(),
        }
    }
}

impl ShadowTexel {
    /// The height of the solid or of the ground, whichever is higher; neither is NaN.
    fn top(self) -> f32 {
        if self.solid > self.ground { self.solid } else { self.ground }
    }
}

impl ShadowMap {
    /// The share of the sun that reaches a point of a face with this normal (any length, either side), 0..=1.
    pub fn sun(&self, world: Vec3, normal: Vec3, receiver: ShadowReceiver) -> f32 {
        let offset = world - self.eye;
        let place = self.place(offset);
        let Some(highest) = place.highest() else { return 1.0 };
        let highest = receiver.height(highest) - place.height;
        if highest <= 0.0 {
            return 1.0;
        }
        let texel_m = place.level.texel_m;
        let rise = rise(self.axes.turned(normal)) * texel_m;
        let error_m = BIAS_TEXELS * texel_m + BIAS_PER_METER * offset.length();
        let plane = ReceivingPlane { receiver, rise, bias: error_m * (1.0 + rise.length() / texel_m) };
        let radius = |height: f32| (SPREAD * height / texel_m).clamp(LEAST_RADIUS, MOST_RADIUS);
        let search = radius(highest);
        let step = if search > SPARSE_RADIUS { 2 } else { 1 };
        let found = place.cover(search, step, &plane);
        if found.y == 0.0 || found.y >= found.x {
            return if found.y == 0.0 { 1.0 } else { 0.0 };
        }
        let breadth = radius(found.z / found.y);
        let shade = if breadth < search || step > 1 { place.cover(breadth, 1, &plane) } else { found };
        1.0 - shade.y / shade.x
    }

    /// The share of the sky that contact with solids, or of solids with the ground, leaves to a point, 0..=1.
    pub fn contact(&self, world: Vec3, receiver: ShadowReceiver) -> f32 {
        let place = self.place(world - self.eye);
        let Some(highest) = place.highest() else { return 1.0 };
        let reach_m = CONTACT_RADIUS * place.level.texel_m;
        let (radius, strength, is_near) = match receiver {
            ShadowReceiver::Ground => (CONTACT_RADIUS, GROUND_CONTACT, highest.solid > place.height),
            ShadowReceiver::Solid => (WALL_RADIUS, WALL_CONTACT, highest.ground > place.height - reach_m),
        };
        if !is_near {
            return 1.0;
        }
        let (mut all, mut hidden) = (0.0, 0.0);
        place.read(radius, 1, |texel, _, weight| {
            let share = match receiver {
                ShadowReceiver::Ground => (texel.solid - place.height) / reach_m,
                ShadowReceiver::Solid => 1.0 - (place.height - texel.ground) / reach_m,
            };
            all += weight;
            hidden += weight * share.clamp(0.0, 1.0);
        });
        1.0 - strength * hidden / all
    }

    fn place(&self, offset: Vec3) -> ShadowPlace<'_> {
        let above = self.scale.exponent(offset.dot(self.forward)) - self.scale.least;
        let level = &self.levels[(above.max(0) as usize).min(self.levels.len() - 1)];
        let here = self.axes.turned(offset);
        let at = (here.xy() - Vec2::from(level.origin)) / level.texel_m;
        ShadowPlace { map: self, level, at, height: here.z }
    }
}

impl ShadowPlace<'_> {
    /// The greatest values around the point; `None` where nothing is near.
    fn highest(&self) -> Option<ShadowTexel> {
        let page =
            self.page((self.at.x.floor() as i32) >> PAGE_BITS, (self.at.y.floor() as i32) >> PAGE_BITS);
        page.filter(|page| page.number > 0).map(|page| page.highest)
    }

    fn page(&self, column: i32, row: i32) -> Option<&ShadowPage> {
        // A negative number becomes a large one.
        let (column, row) = (column as u32, row as u32);
        if column >= self.level.columns || row >= self.level.rows {
            return None;
        }
        self.map.pages.get((self.level.first + row * self.level.columns + column) as usize)
    }

    /// The weight of all texels within `radius`, of those that cast, and of these times their height.
    fn cover(&self, radius: f32, step: i32, plane: &ReceivingPlane) -> Vec3 {
        match plane.receiver {
            ShadowReceiver::Ground => self.cover_of(radius, step, plane, |texel| texel.solid),
            ShadowReceiver::Solid => self.cover_of(radius, step, plane, ShadowTexel::top),
        }
    }

    fn cover_of(
        &self,
        radius: f32,
        step: i32,
        plane: &ReceivingPlane,
        top: impl Fn(ShadowTexel) -> f32,
    ) -> Vec3 {
        let full = 1.0 / (FULL_TEXELS * self.level.texel_m);
        let (mut all, mut casting, mut heights) = (0.0, 0.0, 0.0);
        self.read(radius, step, |texel, aside, weight| {
            all += weight;
            let height = top(texel) - self.height - plane.rise.x * aside.x - plane.rise.y * aside.y;
            if height > plane.bias {
                let share = ((height - plane.bias) * full).min(1.0) * weight;
                casting += share;
                heights += share * height;
            }
        });
        Vec3::new(all, casting, heights)
    }

    /// Calls `visit(texel, texels from the point, weight)` for every `step`-th texel within `radius`, weighted by a tent
    /// in both directions. `step` is 1 or 2.
    ///
    /// Most windows lie within a page: its texels are found once and not row by row.
    fn read(&self, radius: f32, step: i32, mut visit: impl FnMut(ShadowTexel, Vec2, f32)) {
        let (low, high) = (self.at - (0.5 + radius), self.at - (0.5 - radius));
        let [left, bottom] = [first_texel(low.x, step), first_texel(low.y, step)];
        let [right, top] = [rounded_down(high.x), rounded_down(high.y)];
        let tent = |texel: i32, at: f32| {
            let aside = texel as f32 + 0.5 - at;
            (aside, (1.0 - aside.abs() / radius).max(0.0))
        };
        let mut tents = [(0.0, 0.0); MOST_WINDOW];
        let mut count = 0;
        let mut x = left;
        while x <= right && count < MOST_WINDOW {
            tents[count] = tent(x, self.at.x);
            count += 1;
            x += step;
        }
        let tents = &tents[..count];
        // None where the place is NaN.
        let Some(last) = count.checked_sub(1) else { return };
        let within_page = ((left ^ right) | (bottom ^ top)) >> PAGE_BITS == 0;
        let page = if within_page { self.texels(left >> PAGE_BITS, bottom >> PAGE_BITS) } else { &[] };
        let mut y = bottom;
        while y <= top {
            let (aside_y, weight_y) = tent(y, self.at.y);
            let first = ((y & PAGE_MASK) * PAGE as i32 + (left & PAGE_MASK)) as usize;
            if let Some(line) = page.get(first..=first + last * step as usize) {
                for (texel, &(aside_x, weight_x)) in line.iter().step_by(step as usize).zip(tents) {
                    visit(*texel, Vec2::new(aside_x, aside_y), weight_x * weight_y);
                }
            } else {
                let mut line: &[ShadowTexel] = &[];
                let mut x = left;
                for (index, &(aside_x, weight_x)) in tents.iter().enumerate() {
                    if index == 0 || x & PAGE_MASK == 0 {
                        line = self.line(x, y);
                    }
                    let texel = line.get((x & PAGE_MASK) as usize).copied().unwrap_or(ShadowTexel::EMPTY);
                    visit(texel, Vec2::new(aside_x, aside_y), weight_x * weight_y);
                    x += step;
                }
            }
            y += step;
        }
    }

    /// The texels of a page; none where it is not stored.
    fn texels(&self, column: i32, row: i32) -> &[ShadowTexel] {
        let number = self.page(column, row).map_or(0, |page| page.number);
        let Some(page) = number.checked_sub(1) else { return &[] };
        let first = (page * PAGE * PAGE) as usize;
        &self.map.texels[first..][..(PAGE * PAGE) as usize]
    }

    /// The row of texels of the page with texel `(x, y)`; empty where it is not stored.
    fn line(&self, x: i32, y: i32) -> &[ShadowTexel] {
        let page = self.texels(x >> PAGE_BITS, y >> PAGE_BITS);
        let first = ((y & PAGE_MASK) as u32 * PAGE) as usize;
        page.get(first..first + PAGE as usize).unwrap_or_default()
    }
}

/// A place rounded down to a whole texel; places lie at most [`OUTSIDE`] texels outside a level. Truncating is much
/// cheaper than `floor`.
fn rounded_down(texels: f32) -> i32 {
    (texels + OUTSIDE as f32) as i32 - OUTSIDE
}

/// The first texel from a place on that is a multiple of `step`, 1 or 2.
fn first_texel(texels: f32, step: i32) -> i32 {
    let texel = rounded_down(texels) + 1;
    texel + (texel & (step - 1))
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
