//! The ground that observers see: computed on the ground of the picture when a picture first needs it, or beforehand on all
//! samples within reach where the picture's ground holds means of them.

use std::borrow::Cow;
use std::sync::OnceLock;

use glam::DVec2;

use sandtable_description::words::ViewshedTint;
use sandtable_draw::list::FeatureId;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::profile::profile;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::outlook::{VisibleStretch, visible_stretches};
use sandtable_terrain::sight::viewshed::{PostVisibility, Viewshed, ViewshedOptions, viewshed};

/// The ground that observers see.
pub struct SceneViewshed {
    /// Its name for the legend; may be empty.
    pub name: String,
    /// One for each observer, in map coordinates.
    pub observers: Vec<ViewshedOptions>,
    /// Which ground is tinted.
    pub tint: ViewshedTint,
    /// The feature it is.
    pub feature: FeatureId,
    seen: OnceLock<Option<SeenPosts>>,
}

/// The posts in sight, and their places.
pub struct SeenPosts {
    /// The posts.
    pub viewshed: Viewshed,
    /// Their places.
    pub frame: PostFrame,
}

/// The places of the posts that a lattice holds.
#[derive(Clone, Copy, Debug)]
pub struct PostFrame {
    origin: DVec2,
    /// The distance of posts, meters.
    pub cell: DVec2,
    /// The first post that is held, on the grid from `origin` on.
    first: DVec2,
}

/// The stretches in sight along a line.
#[derive(Clone)]
pub struct SightedLine {
    /// The ground in sight of the observer.
    pub stretches: Vec<VisibleStretch>,
    /// Whether the target is.
    pub is_clear: bool,
}

impl PostFrame {
    /// The places of the posts of a lattice.
    pub fn of(lattice: &Lattice) -> Self {
        let first = lattice.first().grid() + lattice.held().first.grid();
        Self { origin: lattice.origin(), cell: lattice.cell(), first }
    }

    /// The map position of a post, counted from the first that is held.
    pub fn map_position(&self, post: Post) -> DVec2 {
        self.origin + (post.grid() + self.first) * self.cell
    }
}

impl SceneViewshed {
    /// The viewshed of observers, on the ground of the picture.
    pub fn new(
        name: String,
        observers: Vec<ViewshedOptions>,
        tint: ViewshedTint,
        feature: FeatureId,
    ) -> Self {
        Self { name, observers, tint, feature, seen: OnceLock::new() }
    }

    /// The rectangle within reach of the observers, map coordinates; may be infinite. `None` without observers.
    pub(super) fn reach(&self) -> Option<Rect> {
        let corners = |options: &ViewshedOptions| {
            let at = options.observer.at;
            [at - options.range_m, at + options.range_m]
        };
        let around = Rect::around(self.observers.iter().flat_map(corners));
        (!around.is_empty()).then_some(around)
    }

    /// The posts that at least one observer sees, on `lattice` unless they were found before, computed on first use; `None`
    /// without observers on the ground.
    pub fn seen(&self, lattice: &Lattice) -> Option<&SeenPosts> {
        self.seen.get_or_init(|| self.compute(lattice)).as_ref()
    }

    fn compute(&self, lattice: &Lattice) -> Option<SeenPosts> {
        let mut observers = self.observers.iter().filter_map(|options| viewshed(lattice, options).ok());
        let mut seen = observers.next()?;
        for other in observers {
            for (post, other) in seen.posts.iter_mut().zip(other.posts) {
                *post = either(*post, other);
            }
        }
        Some(SeenPosts { viewshed: seen, frame: PostFrame::of(lattice) })
    }
}

/// What two observers see of a post together.
fn either(one: PostVisibility, other: PostVisibility) -> PostVisibility {
    use PostVisibility::{Beyond, Hidden, NoData, Visible};
    match (one, other) {
        (Visible, _) | (_, Visible) => Visible,
        (Hidden, _) | (_, Hidden) => Hidden,
        (NoData, _) | (_, NoData) => NoData,
        (Beyond, Beyond) => Beyond,
    }
}

/// Lines of sight from an observer.
pub struct SceneSight {
    /// Its name for the legend; may be empty.
    pub name: String,
    /// The observer, in map coordinates.
    pub observer: SightEnd,
    /// What is looked at.
    pub targets: Vec<SightEnd>,
    /// The feature it is.
    pub feature: FeatureId,
    /// What is in sight along each line, where that was found beforehand; `None` without ground under the observer.
    pub(super) found: Option<Vec<Option<SightedLine>>>,
}

impl SceneSight {
    /// The visible stretches of the line to each target, on `lattice` unless they were found before; `None` without ground
    /// under the observer.
    pub fn lines(&self, lattice: &Lattice) -> Cow<'_, [Option<SightedLine>]> {
        match &self.found {
            Some(found) => Cow::Borrowed(found),
            None => {
                let line = |target: &SightEnd| SightedLine::on(lattice, self.observer, *target);
                Cow::Owned(self.targets.iter().map(line).collect())
            }
        }
    }
}

impl SightedLine {
    /// That of a line on `lattice`; `None` without ground under the observer.
    pub(super) fn on(lattice: &Lattice, observer: SightEnd, target: SightEnd) -> Option<Self> {
        let curvature = Curvature::default();
        let foot_m = ground_height(lattice, Interpolation::Planar, observer.at).height_m()?;
        let stations = profile(lattice, &[observer.at, target.at]);
        let stretches = visible_stretches(&stations, foot_m + observer.above_m, curvature);
        let is_clear = line_of_sight(lattice, observer, target, curvature) == Sight::Clear;
        Some(Self { stretches, is_clear })
    }
}
