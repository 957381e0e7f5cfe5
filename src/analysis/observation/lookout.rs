//! Lookouts: the places from which posts, weapons and radars look, and what each of them sees.
//!
//! A viewshed is computed on the posts of the lattice within its range alone, which gives the bits of the whole lattice:
//! with a short range, a look costs no more on a large land than on a small one.

use glam::DVec2;
use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::observation::sight_land::EDGE_M;
use crate::outcome::{FeatureRole, Hatching, OutcomeFeature, OutcomeShape, PropertyValue, ValueClass};
use crate::place::height_under;
use crate::tally::FigureTally;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{PostVisibility, Viewshed};

/// The tint of ground that nothing sees.
pub(crate) const DEAD_TINT: [u8; 4] = [90, 90, 90, 110];

/// Posts of ground that the viewsheds of an analysis may look at in all: some ten minutes on two cores.
const MOST_LOOKS: f64 = 1e10;

/// A place from which something looks.
#[derive(Clone, Debug)]
pub(crate) struct Lookout {
    /// Its number, from 1.
    pub number: usize,
    /// Its position and the height of its eye.
    pub end: SightEnd,
    /// The height of the ground there, meters.
    pub ground_m: f64,
}

/// The posts that a lookout looks at, and those between them and it.
///
/// ```text
///  ┌───────────┬─────┐
///  │ o lookout │     │  held: the ground of all lines of sight
///  ├───────────┼─────┤
///  │           │look-│  looked at: of some posts, those within range
///  └───────────┴─────┘
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LookWindow {
    /// The posts whose heights decide.
    pub held: PostRect,
    /// Those that are looked at.
    pub looked: PostRect,
}

/// What a lookout sees of the posts within its range.
pub(crate) struct LookoutView {
    /// The posts, among those of the land.
    pub window: LookWindow,
    /// The visibility of those that were held.
    pub view: Viewshed,
}

impl LookWindow {
    /// All posts within a range, and those of a cell around them.
    pub fn whole(ground: &Lattice, at: DVec2, range_m: f64) -> Self {
        let around = posts_around(ground, at, range_m);
        Self { held: around, looked: around }
    }

    /// Of `posts` those within a range, with the ground between them and the lookout; `None` where there are none.
    pub fn toward(ground: &Lattice, at: DVec2, range_m: f64, posts: PostRect) -> Option<Self> {
        let around = posts_around(ground, at, range_m);
        let looked = around.intersection(posts)?;
        let grid = ground.grid_from_map(at).clamp(DVec2::ZERO, ground.last_grid());
        let hull = looked.with(Post::at_grid(grid.floor())).with(Post::at_grid(grid.ceil()));
        // Lines along its border look at the cells on both sides, and posts under trees at the open ground beside them.
        let edge = (DVec2::splat(EDGE_M) / ground.cell()).max(DVec2::ONE).ceil().as_uvec2() + 1;
        let held = hull.grown((edge.x, edge.y), ground).intersection(around).unwrap_or(hull);
        Some(Self { held, looked })
    }

    /// Of `posts` those within a range, with all the ground within it; `None` where there are none.
    pub fn within(ground: &Lattice, at: DVec2, range_m: f64, posts: PostRect) -> Option<Self> {
        let held = posts_around(ground, at, range_m);
        Some(Self { held, looked: held.intersection(posts)? })
    }

    /// The number of posts that it holds.
    pub fn posts(&self) -> f64 {
        self.held.width() as f64 * self.held.height() as f64
    }
}

impl Lookout {
    /// The lookouts at the points of a parameter, all `above_m` above the ground.
    ///
    /// # Errors
    /// [`AnalysisError::Place`] of the first point without ground.
    pub fn all(
        land: &Land,
        arguments: &AnalysisArguments,
        key: &'static str,
        above_m: f64,
    ) -> Result<Vec<Self>, AnalysisError> {
        let heights: Result<Vec<f64>, AnalysisError> =
            arguments.points(key).iter().map(|&at| height_under(&land.ground, key, at)).collect();
        Ok(Self::with_heights(arguments, key, above_m, &heights?))
    }

    /// The lookouts at the points of a parameter, whose ground has these heights, all `above_m` above it.
    pub fn with_heights(
        arguments: &AnalysisArguments,
        key: &str,
        above_m: f64,
        heights_m: &[f64],
    ) -> Vec<Self> {
        let places = arguments.points(key).iter().zip(heights_m).enumerate();
        let lookout = |(index, (&at, &ground_m)): (usize, (&DVec2, &f64))| Self {
            number: index + 1,
            end: SightEnd { at, above_m },
            ground_m,
        };
        places.map(lookout).collect()
    }

    /// Its feature, with its number as its name and these properties after the height of its ground.
    pub fn feature(&self, properties: Vec<(&'static str, PropertyValue)>) -> OutcomeFeature {
        let ground = ("ground_m", PropertyValue::Number(self.ground_m));
        OutcomeFeature {
            shape: OutcomeShape::Point(self.end.at),
            name: self.number.to_string(),
            role: FeatureRole::Post,
            properties: std::iter::once(ground).chain(properties).collect(),
        }
    }
}

/// The Earth's shape, with the refraction of the parameter of that name.
pub(crate) fn curvature(arguments: &AnalysisArguments) -> Curvature {
    let usual = Curvature::default();
    Curvature { refraction: arguments.number_if("refraction").unwrap_or(usual.refraction), ..usual }
}

/// The range of the parameter of that name in meters; infinite where none is stated.
pub(crate) fn range_m(arguments: &AnalysisArguments) -> f64 {
    arguments.number_if("range").unwrap_or(f64::INFINITY)
}

/// The number of posts of the land that lie in the square around a range at most.
pub(crate) fn posts_within(ground: &Lattice, range_m: f64) -> f64 {
    let along = |cell_m: f64, posts: u32| (2.0 * range_m / cell_m + 4.0).min(f64::from(posts));
    along(ground.cell().x, ground.columns()) * along(ground.cell().y, ground.rows())
}

/// Checks that so many looks over as many posts of ground each end in bounded time.
///
/// # Errors
/// They do not; the message names `key`.
pub(crate) fn check_looks(key: &'static str, looks: f64, posts_each: f64) -> Result<(), AnalysisError> {
    check_work(key, looks, posts_each, MOST_LOOKS)
}

/// [`check_looks`] with another limit.
///
/// # Errors
/// There are more than `most`.
pub(crate) fn check_work(
    key: &'static str,
    looks: f64,
    posts_each: f64,
    most: f64,
) -> Result<(), AnalysisError> {
    if looks * posts_each <= most {
        return Ok(());
    }
    let problem = format!(
        "asks for {looks} looks over {posts_each:.0} places each, more than {most:e} in all; state fewer places, a \
         shorter range or a smaller extent"
    );
    Err(AnalysisError::argument(key, problem))
}

/// Checks that looks over these windows end in bounded time.
///
/// # Errors
/// As [`check_looks`].
pub(crate) fn check_windows<'a>(
    key: &'static str,
    windows: impl Iterator<Item = &'a LookWindow>,
) -> Result<(), AnalysisError> {
    let (looks, largest) =
        windows.fold((0.0, 0.0_f64), |(looks, largest), window| (looks + 1.0, largest.max(window.posts())));
    check_looks(key, looks, largest)
}

/// The posts within a range and those of a cell around them.
pub(crate) fn posts_around(ground: &Lattice, at: DVec2, range_m: f64) -> PostRect {
    let reach = DVec2::splat(range_m) / ground.cell() + 2.0;
    let at = ground.grid_from_map(at);
    let around = PostRect::between(ground, (at - reach).floor(), (at + reach).ceil());
    around.unwrap_or_else(|| PostRect::all(ground))
}

impl LookoutView {
    /// Merges the view into values of `posts`: `merge` changes a value by what is seen there.
    pub fn merge_into<T: Send>(
        &self,
        values: &mut [T],
        posts: PostRect,
        merge: impl Fn(&mut T, PostVisibility) + Sync,
    ) {
        let LookWindow { held, looked } = self.window;
        let (from, to) = (looked.counted_in(held).first, looked.counted_in(posts).first);
        let rows = values.par_chunks_mut(posts.width()).skip(to.row as usize).take(looked.height());
        rows.zip(self.view.posts.par_chunks(held.width()).skip(from.row as usize)).for_each(
            |(values, seen)| {
                let values = &mut values[to.column as usize..][..looked.width()];
                let seen = &seen[from.column as usize..][..looked.width()];
                values.iter_mut().zip(seen).for_each(|(value, &post)| merge(value, post));
            },
        );
    }

    /// The number of posts in sight, and of those that could be: within range and sector, with data.
    pub fn seen_of(&self) -> (usize, usize) {
        let LookWindow { held, looked } = self.window;
        if looked == held {
            let counts = self.view.counts();
            return (counts.visible, counts.visible + counts.hidden);
        }
        let from = looked.counted_in(held).first;
        let rows = self.view.posts.par_chunks(held.width()).skip(from.row as usize).take(looked.height());
        let counts = rows.map(|seen| {
            let seen = &seen[from.column as usize..][..looked.width()];
            let count = |kind: PostVisibility| seen.iter().filter(|&&post| post == kind).count();
            let visible = count(PostVisibility::Visible);
            (visible, visible + count(PostVisibility::Hidden))
        });
        counts.reduce(|| (0, 0), |one, other| (one.0 + other.0, one.1 + other.1))
    }
}

/// What a tally says of each lookout, and last of all together: the posts that it sees, and those that it could.
pub(crate) fn shares(tally: &FigureTally) -> (Vec<(usize, usize)>, (usize, usize)) {
    let pair = |pair: &[u64]| (pair[0] as usize, pair[1] as usize);
    let mut shares: Vec<(usize, usize)> = tally.counts().chunks_exact(2).map(pair).collect();
    let all = shares.pop().unwrap_or_default();
    (shares, all)
}

/// Classes for the number of lookouts that see or hit a place: none, one, two, three, and more; as many as can occur.
pub(crate) fn count_classes(lookouts: usize, [none, some]: [&str; 2]) -> Vec<ValueClass> {
    const LOOKS: [([u8; 4], Hatching); 5] = [
        (DEAD_TINT, Hatching::Dots),
        ([255, 237, 160, 110], Hatching::None),
        ([173, 221, 142, 110], Hatching::None),
        ([65, 171, 93, 110], Hatching::None),
        ([0, 90, 50, 120], Hatching::None),
    ];
    let label = |count: usize| match count {
        0 => none.to_owned(),
        4 if lookouts > 4 => format!("{some} 4 or more"),
        count => format!("{some} {count}"),
    };
    let class = |(count, (tint, hatching))| ValueClass::new(count as f32, label(count), tint, hatching);
    LOOKS.into_iter().enumerate().take(lookouts.saturating_add(1)).map(class).collect()
}
