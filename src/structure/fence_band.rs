//! A cross-section carried along a track over the displayed ground: walls, hedges, banks of earth, rails.
//!
//! Both feet of the section are laid on the displayed triangles and cut at their edges; wherever either foot is cut, the
//! band has a row, and what lies between the feet takes its height from them:
//!
//! ```text
//!        ┌──────┐  up                    row     row  row       row
//!        │      │                      ───┼───────┼────┼─────────┼── left foot
//!   ─────┴──────┴───── ground          ───┼───────┼────┼─────────┼── right foot
//!      right   left foot
//! ```
//!
//! So the feet lie on the displayed ground exactly, for any camera and level of detail: nothing sinks, nothing floats.

use glam::{DVec2, DVec3, Vec3};

use crate::faces::Faces;
use crate::fence_track::{self, Ends, TrackJoint, TrackStretch};
use sandtable_base::split_mix::split_mix64;
use sandtable_draw::color::Srgba;
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::profile::Profile;
use sandtable_terrain::support_surface;
use sandtable_terrain::triangle_surface::TriangleSurface;

/// A corner of a cross-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionCorner {
    /// Where between the feet: 0 at the right one, 1 at the left one; beyond them for what overhangs.
    pub share: f64,
    /// Meters above the ground there.
    pub up_m: f64,
}

/// A cross-section, seen along the track.
#[derive(Clone, Debug, PartialEq)]
pub struct BandSection {
    /// The right foot and the left foot across the track: −1 is its right side, 1 its left side.
    pub feet: (f64, f64),
    /// From the right up and over to the left: convex.
    pub corners: Vec<SectionCorner>,
    /// The color of each side, from the first corner to the second, and so on; where there is one for each corner, the
    /// last side closes the section.
    pub colors: Vec<Srgba>,
}

/// The irregularity of a band's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ruffle {
    /// By what share its corners above the ground wander, in 0..=1: 0 for masonry, more for leaves.
    pub share: f64,
    /// By how many steps of 255 its color varies.
    pub shade: f32,
    /// Meters between rows that are added for it, above 0.
    pub every_m: f64,
}

/// A cross-section carried along a track.
#[derive(Clone, Debug, PartialEq)]
pub struct FenceBand {
    /// The track's centerline and width.
    pub alignment: Alignment,
    /// What it looks like across.
    pub section: BandSection,
    /// How its surface departs from that; `None` for an even one.
    pub ruffle: Option<Ruffle>,
}

/// Both feet at one place along the track, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandRow {
    /// The right foot.
    pub right: DVec3,
    /// The left foot.
    pub left: DVec3,
}

/// Rows along a stretch of ground without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct FenceRows {
    /// At least two.
    pub rows: Vec<BandRow>,
    /// Whether they run round.
    pub ends: Ends,
}

impl FenceBand {
    /// The feet of the band on a ground, in stretches where there are gaps in it.
    pub fn rows(&self, ground: &dyn TriangleSurface) -> Vec<FenceRows> {
        fence_track::stretches(&self.alignment)
            .iter()
            .flat_map(|stretch| self.rows_along(stretch, ground))
            .collect()
    }

    /// Adds the band, set on a ground, to `faces`.
    pub fn build(&self, ground: &dyn TriangleSurface, faces: &mut Faces) {
        for rows in self.rows(ground) {
            let rings: Vec<Vec<Vec3>> = rows.rows.iter().map(|row| self.ring(row)).collect();
            for (pair, feet) in rings.windows(2).zip(&rows.rows) {
                self.sides(&pair[0], &pair[1], feet.right.truncate(), faces);
            }
            if let (Ends::Two, [first, .., last]) = (rows.ends, &rings[..]) {
                let color = self.section.colors[0];
                faces.polygon(first, color);
                faces.polygon(&last.iter().rev().copied().collect::<Vec<_>>(), color);
            }
        }
    }

    fn rows_along(&self, stretch: &TrackStretch, ground: &dyn TriangleSurface) -> Vec<FenceRows> {
        let mut found: Vec<FenceRows> = Vec::new();
        // Whether the rows found last reach the joint from which the next segment goes on.
        let mut goes_on = false;
        for pair in stretch.joints.windows(2) {
            let feet = [self.section.feet.0, self.section.feet.1].map(|share| Foot::new(pair, share, ground));
            let segments = self.segments(&feet);
            let begins = segments.first().is_some_and(|segment| segment.begins);
            for (index, segment) in segments.into_iter().enumerate() {
                match found.last_mut() {
                    Some(rows) if index == 0 && goes_on && begins => {
                        rows.rows.extend(segment.rows.into_iter().skip(1));
                    }
                    _ => found.push(FenceRows { rows: segment.rows, ends: Ends::Two }),
                }
                goes_on = segment.ends;
            }
            if !feet.iter().all(|foot| foot.reaches_end()) {
                goes_on = false;
            }
        }
        if let ([rows], Ends::None) = (&mut found[..], stretch.ends)
            && goes_on
        {
            rows.ends = Ends::None;
        }
        found
    }

    /// The rows of one segment of the track, wherever there is ground under both feet.
    fn segments(&self, [right, left]: &[Foot; 2]) -> Vec<BandSegment> {
        let mut found = Vec::new();
        for right_run in &right.runs {
            for left_run in &left.runs {
                let ([right_low, right_high], [left_low, left_high]) = (right_run.span(), left_run.span());
                let (low, high) = (right_low.max(left_low), right_high.min(left_high));
                if high - low <= SAME_PART {
                    continue;
                }
                let parts = self.parts([right_run, left_run], (low, high), right.from.distance(right.to));
                let row = |&part: &f64| BandRow {
                    right: right.from.lerp(right.to, part).extend(right_run.at(part)),
                    left: left.from.lerp(left.to, part).extend(left_run.at(part)),
                };
                let rows = parts.iter().map(row).collect();
                found.push(BandSegment { rows, begins: low <= SAME_PART, ends: high >= 1.0 - SAME_PART });
            }
        }
        found
    }

    /// Where along a segment rows stand: where either foot is cut, and where the ruffle needs more.
    fn parts(&self, runs: [&Profile; 2], (low, high): (f64, f64), length_m: f64) -> Vec<f64> {
        let inside = |part: &f64| *part > low + SAME_PART && *part < high - SAME_PART;
        let cuts = runs.into_iter().flat_map(Profile::stations).copied();
        let mut parts: Vec<f64> = cuts.filter(inside).collect();
        if let Some(ruffle) = &self.ruffle {
            let steps = (length_m / ruffle.every_m).min(MOST_STEPS) as u32;
            parts.extend((1..steps).map(|step| f64::from(step) / f64::from(steps)).filter(inside));
        }
        parts.extend([low, high]);
        parts.sort_by(f64::total_cmp);
        parts.dedup_by(|next, before| *next - *before <= SAME_PART);
        parts
    }

    /// The section's corners at a row.
    fn ring(&self, row: &BandRow) -> Vec<Vec3> {
        let corner = |(index, corner): (usize, &SectionCorner)| {
            let (mut share, mut up_m) = (corner.share, corner.up_m);
            if let Some(ruffle) = self.ruffle.filter(|_| corner.up_m > 0.0) {
                let [aside, above] = [0, 1].map(|salt| noise(row.right.truncate(), index as u64 * 2 + salt));
                share += (share - 0.5) * ruffle.share * aside;
                up_m *= 1.0 + ruffle.share * above;
            }
            (row.right.lerp(row.left, share) + DVec3::Z * up_m).as_vec3()
        };
        self.section.corners.iter().enumerate().map(corner).collect()
    }

    /// The faces between two rows.
    fn sides(&self, near: &[Vec3], far: &[Vec3], at: DVec2, faces: &mut Faces) {
        for (side, &color) in self.section.colors.iter().enumerate() {
            let next = (side + 1) % near.len();
            let color = match &self.ruffle {
                Some(ruffle) => shaded(color, noise(at, 1000 + side as u64) as f32 * ruffle.shade),
                None => color,
            };
            faces.polygon(&[near[side], far[side], far[next], near[next]], color);
        }
    }
}

/// Parts of a segment nearer to each other than this are one.
const SAME_PART: f64 = 1e-7;

/// The most rows that a ruffle adds to a segment.
const MOST_STEPS: f64 = 10_000.0;

/// One foot's line along a segment of the track.
struct Foot {
    from: DVec2,
    to: DVec2,
    runs: Vec<Profile>,
}

impl Foot {
    fn new(pair: &[TrackJoint], share: f64, ground: &dyn TriangleSurface) -> Self {
        let (from, to) = (pair[0].across(share), pair[1].across(share));
        Self { from, to, runs: support_surface::ground_runs(ground, from, to) }
    }

    fn reaches_end(&self) -> bool {
        self.runs.last().is_some_and(|run| run.span()[1] >= 1.0 - SAME_PART)
    }
}

/// Rows along a part of one segment.
struct BandSegment {
    rows: Vec<BandRow>,
    /// Whether it begins where the segment does.
    begins: bool,
    /// Whether it ends where the segment does.
    ends: bool,
}

/// A fixed number in −1..=1 for each place (to the centimeter) and salt (see [`split_mix64`]).
pub fn noise(at: DVec2, salt: u64) -> f64 {
    let place = (at * 100.0).round();
    let hash = (place.x as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (place.y as i64 as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ salt.wrapping_mul(0x1656_67b1_9e37_79f9);
    (split_mix64(hash) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A color, lighter or darker by some steps of 255.
pub fn shaded(color: Srgba, by: f32) -> Srgba {
    let [red, green, blue, alpha] = color.0;
    let channel = |value: u8| (f32::from(value) + by).clamp(0.0, 255.0) as u8;
    Srgba([channel(red), channel(green), channel(blue), alpha])
}

/// The largest vertical distance in meters between the feet of `band` and the ground, at every row and half-way to the
/// next: 0 but for rounding, whatever the ground. Infinite where there is no ground under a foot.
pub fn check_feet(band: &FenceBand, ground: &dyn TriangleSurface) -> f64 {
    let off = |at: DVec3| match ground.displayed_z(at.truncate()) {
        Some(z) => (z - at.z).abs(),
        None => f64::INFINITY,
    };
    let mut most: f64 = 0.0;
    for rows in band.rows(ground) {
        for pair in rows.rows.windows(2) {
            let middles = [pair[0].right.midpoint(pair[1].right), pair[0].left.midpoint(pair[1].left)];
            most = middles.into_iter().map(off).fold(most, f64::max);
        }
    }
    most
}
