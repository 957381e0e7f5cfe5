//! The ground with the measures that culling and criteria read, each made at first use and kept.

use std::sync::{Arc, OnceLock};

use crate::criterion::Criterion;
use crate::criterion::flat::Flat;
use crate::criterion::screen::ScreenError;
use crate::culling::{PatchHeights, patches_in_view};
use crate::displayed::DisplayedTerrain;
use crate::emit::world::drawn_posts;
use crate::errors::ErrorMap;
use crate::errors::coarse::CoarseErrors;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::patched_ground::PatchedGround;
use crate::refine::rebuild::rebuild_by_parts;
use crate::shown::{LocalTriangle, local};
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The most posts whose errors are kept from picture to picture: 32 MiB. Those of the largest ground would take as much memory as
/// its heights; a picture takes a quarter of that, and a tenth of a second to measure them.
const MOST_KEPT: usize = 1 << 23;

/// A displayed lattice, the patches over it, and measures of both.
#[derive(Debug)]
pub struct MeasuredGround {
    lattice: Arc<Lattice>,
    layout: PatchLayout,
    heights: OnceLock<PatchHeights>,
    whole: OnceLock<Vec<bool>>,
    exact: OnceLock<ErrorMap>,
    midpoint: OnceLock<ErrorMap>,
    relief: OnceLock<ErrorMap>,
}

impl MeasuredGround {
    /// Lays patches of `patch` cells over `lattice`; `None` where they cannot be laid (see [`PatchLayout::new`]). Nothing
    /// is measured yet.
    pub fn new(lattice: impl Into<Arc<Lattice>>, patch: u32) -> Option<Self> {
        let lattice = lattice.into();
        let layout = PatchLayout::new(lattice.columns(), lattice.rows(), patch)?;
        Some(Self::with_layout(lattice, layout))
    }

    /// [`MeasuredGround::new`] with patches that are laid already, over as many posts as `lattice` has.
    pub fn with_layout(lattice: Arc<Lattice>, layout: PatchLayout) -> Self {
        Self {
            lattice,
            layout,
            heights: OnceLock::new(),
            whole: OnceLock::new(),
            exact: OnceLock::new(),
            midpoint: OnceLock::new(),
            relief: OnceLock::new(),
        }
    }

    /// The heights, as they are displayed.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// The patches over them.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Both, as refinement reads them.
    pub fn patched(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    /// The range of heights in each patch.
    pub fn heights(&self) -> &PatchHeights {
        self.heights.get_or_init(|| PatchHeights::new(self.patched()))
    }

    /// [`ErrorMap::exact`].
    pub fn exact(&self) -> &ErrorMap {
        self.exact.get_or_init(|| ErrorMap::exact(&self.lattice, &self.layout))
    }

    /// [`ErrorMap::midpoint`].
    pub fn midpoint(&self) -> &ErrorMap {
        self.midpoint.get_or_init(|| ErrorMap::midpoint(&self.lattice, &self.layout))
    }

    /// [`ErrorMap::relief`].
    pub fn relief(&self) -> &ErrorMap {
        self.relief.get_or_init(|| ErrorMap::relief(&self.lattice, &self.layout))
    }

    /// [`PatchedGround::is_whole`], measured once for all patches.
    pub fn is_whole(&self, corner: Vertex) -> bool {
        self.whole()[self.layout.patch_index(corner)]
    }

    fn whole(&self) -> &[bool] {
        self.whole
            .get_or_init(|| self.layout.patches().map(|corner| self.patched().is_whole(corner)).collect())
    }

    /// Makes the measures of patches, for a caller who times what comes after.
    pub fn measure_patches(&self) {
        self.heights();
        self.whole();
    }

    /// A function from a triangle in the patch with south-west corner `corner` to its indices there; `None` for one
    /// that is beyond the border or over no data.
    pub fn drawn_in(&self, corner: Vertex) -> impl Fn([Vertex; 3]) -> Option<LocalTriangle> + '_ {
        let (patched, is_whole) = (self.patched(), self.is_whole(corner));
        move |corners| {
            let is_drawn = is_whole || drawn_posts(patched, corners).is_some();
            is_drawn.then(|| corners.map(|vertex| local(&self.layout, corner, vertex)))
        }
    }

    /// The south-west corners of the patches that `camera` may see.
    pub fn in_view(&self, camera: &Camera) -> Vec<Vertex> {
        patches_in_view(self.patched(), self.heights(), &Frustum::new(camera))
    }

    /// The screen-space criterion by the exact errors.
    pub fn screen_error(&self, camera: &Camera, tolerance_px: f32) -> ScreenError<'_> {
        ScreenError::new(self.patched(), self.exact(), self.heights(), camera, tolerance_px)
    }

    /// The ground as `camera` shows it, off by at most `tolerance_px` pixels. Errors of ground with more than
    /// eight million posts are not kept, unless [`Self::exact`] has them already.
    pub fn displayed_to(&self, camera: &Camera, tolerance_px: f32) -> DisplayedTerrain {
        if self.exact.get().is_none() && self.lattice.heights().len() > MOST_KEPT {
            let errors = CoarseErrors::new(&self.lattice, &self.layout);
            let criterion = ScreenError::new(self.patched(), &errors, self.heights(), camera, tolerance_px);
            return self.displayed(&criterion, self.in_view(camera));
        }
        self.displayed(&self.screen_error(camera, tolerance_px), self.in_view(camera))
    }

    /// All of the ground as an eye shows it that turns around where `camera` is, off by at most `tolerance_px` pixels of `camera`.
    pub fn displayed_around(&self, camera: &Camera, tolerance_px: f32) -> DisplayedTerrain {
        let criterion = self.screen_error(camera, tolerance_px).all_around();
        self.displayed(&criterion, self.layout.patches().collect())
    }

    /// All of the ground, off by at most `max_error_m` at every post.
    pub fn displayed_within(&self, max_error_m: f32) -> DisplayedTerrain {
        let criterion = Flat::new(&self.layout, self.exact(), max_error_m);
        self.displayed(&criterion, self.layout.patches().collect())
    }

    fn displayed(&self, criterion: &impl Criterion, patches: Vec<Vertex>) -> DisplayedTerrain {
        let active = rebuild_by_parts(&self.layout, criterion, &patches);
        DisplayedTerrain::new(Arc::clone(&self.lattice), active, patches)
    }
}
