//! The posts of channels' beds, and the heights they are to have.

use crate::channel::carve::CenterlinePiece;
use crate::channel::course::{ChannelCourse, CourseStation};
use crate::channel::river_cut::{ChannelError, Cut};
use glam::DVec2;
use rayon::prelude::*;
use sandtable_base::limits::RIVER_POSTS;
use sandtable_geom::segment;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::volumes::Volumes;

/// Posts by where the lattice stores them, rising, each with what it is to become.
pub(super) struct ChannelBed {
    posts: Vec<u32>,
    /// Meters.
    pub heights_m: Vec<f64>,
    /// Whether a post keeps its height: a lake lies on it, or backs up to it.
    pub fixed: Vec<bool>,
    /// The lowest that each may become: as deep below its height as the deepest cut of those channels that touch it.
    pub floors_m: Vec<f64>,
    /// The highest that each may become before a lake: as far above its height.
    pub ceilings_m: Vec<f64>,
    /// The channel that a post counts for.
    owners: Vec<u32>,
}

/// What a channel would have of a post beside it.
#[derive(Clone, Copy)]
struct Wish {
    post: u32,
    channel: u32,
    /// How far aside, in widths of the bed: the nearest channel has its will.
    aside: f64,
    height_m: f64,
}

impl ChannelBed {
    /// The posts under the water set to its level and banks blended. Where the water stands above the ground, in a pit or
    /// before a lake, no post of the triangles that its centerline crosses stays below it.
    pub fn shaped(
        lattice: &Lattice,
        courses: &[ChannelCourse<'_>],
        pieces: &[CenterlinePiece],
    ) -> Result<Self, ChannelError> {
        let wishes = wishes(lattice, courses)?;
        let touched = pieces.iter().flat_map(|piece| piece.posts.map(|post| (post, piece)));
        let mut posts: Vec<u32> =
            wishes.iter().map(|wish| wish.post).chain(touched.clone().map(|(post, _)| post)).collect();
        posts.par_sort_unstable();
        posts.dedup();
        let heights = lattice.heights();
        let mut bed = Self {
            heights_m: posts.iter().map(|&post| f64::from(heights[post as usize])).collect(),
            fixed: posts.iter().map(|&post| lattice.pinned()[post as usize]).collect(),
            floors_m: Vec::new(),
            ceilings_m: Vec::new(),
            owners: vec![u32::MAX; posts.len()],
            posts,
        };
        let touching = touched.clone().map(|(post, piece)| (post, piece.channel));
        let touching = touching.chain(wishes.iter().map(|wish| (wish.post, wish.channel)));
        bed.limit(touching.map(|(post, channel)| (post, courses[channel as usize].channel.max_cut_m)));
        let mut levels_m = vec![f64::INFINITY; bed.posts.len()];
        for (post, piece) in touched {
            let place = bed.place(post);
            if piece.filled_m < levels_m[place] {
                (levels_m[place], bed.owners[place]) = (piece.filled_m, piece.channel);
            }
        }
        for (place, &level_m) in levels_m.iter().enumerate() {
            if level_m.is_finite() && !bed.fixed[place] {
                bed.heights_m[place] = bed.heights_m[place].max(level_m.min(bed.ceilings_m[place]));
            }
        }
        for wish in wishes {
            let place = bed.place(wish.post);
            if !bed.fixed[place] {
                let height_m = wish.height_m.max(bed.floors_m[place]).min(bed.ceilings_m[place]);
                (bed.heights_m[place], bed.owners[place]) = (height_m, wish.channel);
            }
        }
        Ok(bed)
    }

    /// Sets how far each post may move, from the posts that channels touch and how deep these may cut.
    fn limit(&mut self, touching: impl Iterator<Item = (u32, f64)>) {
        let mut limits_m = vec![0.0f64; self.posts.len()];
        for (post, max_cut_m) in touching {
            let place = self.place(post);
            limits_m[place] = limits_m[place].max(max_cut_m);
        }
        let both = || self.heights_m.iter().zip(&limits_m);
        let floors_m = both().map(|(height_m, limit_m)| height_m - limit_m).collect();
        let ceilings_m = both().map(|(height_m, limit_m)| height_m + limit_m).collect();
        (self.floors_m, self.ceilings_m) = (floors_m, ceilings_m);
    }

    /// Whether a post may be lowered.
    pub fn may_fall(&self, place: usize) -> bool {
        !self.fixed[place] && self.heights_m[place] > self.floors_m[place]
    }

    /// A post's place in this bed.
    ///
    /// # Panics
    /// Where it is no post of the bed.
    pub fn place(&self, post: u32) -> usize {
        self.posts.binary_search(&post).expect("the bed holds every post that is touched or wished for")
    }

    /// Sets the lattice to the bed's heights, and adds the earth moved to the channels it counts for.
    pub fn dig(&self, lattice: &mut Lattice, cuts: &mut [Cut]) {
        let cell_m2 = lattice.cell_m2();
        for (place, &index) in self.posts.iter().enumerate() {
            let post = lattice.post_at(index as usize);
            let (before, after) = (lattice.height(post), self.heights_m[place] as f32);
            if before.is_nan() || lattice.is_pinned(post) {
                continue;
            }
            lattice.pin(post, after);
            if let Some(cut) = cuts.get_mut(self.owners[place] as usize) {
                let rise_m = f64::from(after) - f64::from(before);
                cut.volumes += Volumes::from_rise(rise_m, cell_m2);
                cut.deepest_m = cut.deepest_m.max(-rise_m);
            }
        }
    }
}

/// The most wishes of all threads before all but the nearest are dropped: 100 MB. On wide rivers each post has one per cell of
/// river.
const MOST_WAITING: usize = 4_000_000;

/// What channels would have of the posts under their water and banks: for each post the wish of the nearest channel, of equals
/// the first.
fn wishes(lattice: &Lattice, courses: &[ChannelCourse<'_>]) -> Result<Vec<Wish>, ChannelError> {
    let stretches =
        |course| ChannelCourse::pairs(course).filter_map(move |ends| StretchPosts::of(lattice, course, ends));
    let posts = |course| stretches(course).map(|around| around.posts()).fold(0, usize::saturating_add);
    if courses.par_iter().map(posts).reduce(|| 0, usize::saturating_add) > RIVER_POSTS.count() {
        return Err(ChannelError::TooWide);
    }
    let most = MOST_WAITING / rayon::current_num_threads();
    let of_course = |(course, channel)| {
        let (mut wishes, mut kept) = (Vec::new(), 0);
        for around in stretches(course) {
            around.wish(lattice, channel, &mut wishes);
            if wishes.len() > most.max(2 * kept) {
                keep_nearest(&mut wishes);
                kept = wishes.len();
            }
        }
        keep_nearest(&mut wishes);
        wishes
    };
    let channels = 0..courses.len() as u32;
    let mut wishes = courses.par_iter().zip(channels).map(of_course).collect::<Vec<_>>().concat();
    keep_nearest(&mut wishes);
    Ok(wishes)
}

fn keep_nearest(wishes: &mut Vec<Wish>) {
    wishes.par_sort_by(|a, b| {
        a.post.cmp(&b.post).then(a.aside.total_cmp(&b.aside)).then(a.height_m.total_cmp(&b.height_m))
    });
    wishes.dedup_by_key(|wish| wish.post);
}

/// The posts around a stretch of centerline between two stations.
struct StretchPosts {
    ends: [CourseStation; 2],
    bed_m: f64,
    bank_m: f64,
    posts: PostRect,
}

impl StretchPosts {
    /// `None` where there is no ground or no post is near.
    fn of(lattice: &Lattice, course: &ChannelCourse<'_>, ends: [CourseStation; 2]) -> Option<Self> {
        if ends.iter().any(|end| end.level_m.is_nan()) {
            return None;
        }
        let bed_m = ends.map(|end| end.bed_m(lattice)).into_iter().fold(0.0, f64::max);
        let bank_m = course.channel.bank_m;
        let reach = DVec2::splat(bed_m + bank_m) / lattice.cell();
        let [from, to] = ends.map(|end| end.grid);
        let posts = PostRect::between(lattice, from.min(to) - reach, from.max(to) + reach)?;
        Some(Self { ends, bed_m, bank_m, posts })
    }

    fn posts(&self) -> usize {
        let PostRect { first, last } = self.posts;
        self.posts.width().saturating_mul((last.row - first.row) as usize + 1)
    }

    fn wish(&self, lattice: &Lattice, channel: u32, wishes: &mut Vec<Wish>) {
        let [from, to] = self.ends;
        let way = to.at - from.at;
        for post in self.posts.posts() {
            let at = lattice.map_position(post) - lattice.origin();
            let part = segment::nearest_part((from.at, to.at), at);
            let part = if part.is_nan() { 0.0 } else { part };
            let aside_m = at.distance(from.at + way * part);
            let ground_m = f64::from(lattice.height(post));
            if aside_m > self.bed_m + self.bank_m || ground_m.is_nan() {
                continue;
            }
            let level_m = from.level_m + (to.level_m - from.level_m) * part;
            let beyond_m = aside_m - self.bed_m;
            let blend = if beyond_m > 0.0 { beyond_m / self.bank_m } else { 0.0 };
            wishes.push(Wish {
                post: lattice.index(post) as u32,
                channel,
                aside: aside_m / self.bed_m,
                height_m: level_m + (ground_m - level_m) * blend,
            });
        }
    }
}
