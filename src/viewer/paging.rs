//! The ground of a file that is larger than the memory, brought up to date on a thread of its own.
//!
//! ```text
//!  window ─► camera ─► thread: reads pages, refines ─► changes of the ground ─► the frame that comes next
//!    ▲                   (one update at a time)    └─► pages ─► heights and rays in memory
//!    └── the overview, a scene of its own, until the terrain is measured and wherever no page is
//! ```
//!
//! No frame waits for the disk: what is not read yet is shown coarser. Questions that pages in memory do not answer are
//! answered by jobs that read the file.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use glam::{DVec2, DVec3};

use crate::worker::run_apart;
use sandtable_base::message::chain::error_text;
use sandtable_draw::patches::{GroundChanges, PatchId};
use sandtable_raster::answer::Answer;
use sandtable_raster::windows::Windows;
use sandtable_roam::paging::ground::{PagingCounts, PagingOptions};
use sandtable_roam::paging::region::PagedFrame;
use sandtable_terrain::lattice::LatticeError;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::ray::Ray;
use sandtable_view::camera::Camera;
use sandtable_walk::disk_ground::DiskGround;
use sandtable_walk::frame::WalkStatistics;
use sandtable_walk::page_heights::{PageHeights, page};
use sandtable_walk::paged::{PagedWalk, PagedWalkOptions};
use sandtable_walk::paged_elevation::{ElevationWindows, ReadingWatch};

/// Meters of distance per meter of error: one pixel of a picture 1080 pixels high that is opened 53°.
const REACH: f32 = 1080.0;

/// Pages that are kept: refined, in memory and by the renderer. 200 KB each in all.
pub const MOST_PAGES: usize = 1024;

/// Pages that are read in one update: some tens of milliseconds.
const MOST_LOADS: usize = 16;

/// Bytes of a page in memory: positions and radii for refinement, indices, heights for questions.
const PAGE_BYTES: usize = 65 * 65 * (4 + 4 + 4) + 140 * 1024;

/// What the thread is to do.
struct PagingRequest {
    camera: Camera,
    /// Whether the renderer has nothing of it any more.
    is_anew: bool,
}

enum PagingNews {
    Opened(PagedFrame),
    Updated(Box<PagedUpdate>),
    Failed(String),
}

/// The result of an update.
pub struct PagedUpdate {
    /// What changed since the update before.
    pub changes: GroundChanges,
    /// What it cost.
    pub statistics: WalkStatistics,
    pages: Vec<(PatchId, SightGround)>,
    counts: PagingCounts,
    meshes: usize,
}

/// The progress of the terrain.
#[derive(Clone, Debug, PartialEq)]
pub enum PagingStage {
    /// It is read once, this share of it so far, 0 to 1; the overview is shown.
    Measuring(f32),
    /// It is shown.
    Shown,
    /// It cannot be read; what is shown stays.
    Failed(String),
}

/// The pages in memory, for the panel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PagesKept {
    /// Pages in memory.
    pub pages: usize,
    /// Bytes of them.
    pub bytes: usize,
    /// Pages that wait to be read for what is in view.
    pub waiting: usize,
    /// The work of reading so far.
    pub counts: PagingCounts,
}

/// Terrain on disk.
pub struct PagedTerrain {
    /// Samples per row, and rows.
    pub size: (u32, u32),
    /// The pages in memory.
    pub kept: PagesKept,
    stage: PagingStage,
    requests: Sender<PagingRequest>,
    news: Receiver<PagingNews>,
    watch: Arc<ReadingWatch>,
    /// Samples that were read before it is measured.
    read_before: u64,
    heights: Option<PageHeights>,
    questions: Arc<Mutex<DiskGround<ElevationWindows>>>,
    /// The camera of the last request.
    asked: Option<Camera>,
    is_busy: bool,
    is_anew: bool,
    arrived: Option<Box<PagedUpdate>>,
    statistics: WalkStatistics,
}

impl PagedTerrain {
    /// Begins to read the terrain; jobs query it through `questions`. `wake` is called when [`PagedTerrain::follow`] has
    /// news.
    ///
    /// # Errors
    /// The file is no lattice.
    pub fn start(
        terrain: ElevationWindows,
        questions: ElevationWindows,
        wake: impl Fn() + Send + 'static,
    ) -> Result<Self, LatticeError> {
        let (size, watch) = (terrain.size(), Arc::clone(terrain.watch()));
        let read_before = watch.samples();
        let questions = Arc::new(Mutex::new(DiskGround::new(questions)?));
        let (requests, asked) = channel();
        let (sender, news) = channel();
        thread::spawn(move || {
            let tell = move |news| {
                // Nobody listens any more where another file was opened meanwhile.
                let _ = sender.send(news);
                wake();
            };
            run_apart(move || work(terrain, asked, tell));
        });
        Ok(Self {
            size,
            kept: PagesKept::default(),
            stage: PagingStage::Measuring(0.0),
            requests,
            news,
            watch,
            read_before,
            heights: None,
            questions,
            asked: None,
            is_busy: false,
            is_anew: false,
            arrived: None,
            statistics: WalkStatistics::default(),
        })
    }

    /// The stage that the terrain has reached.
    pub fn stage(&self) -> PagingStage {
        match &self.stage {
            PagingStage::Measuring(_) => {
                // Each piece is read with its surroundings: 1.6 times the samples, at most.
                let all = f64::from(self.size.0) * f64::from(self.size.1) * 1.6;
                let read = self.watch.samples() - self.read_before;
                PagingStage::Measuring((read as f64 / all).min(1.0) as f32)
            }
            known => known.clone(),
        }
    }

    /// Whether its patches take the place of the overview's.
    pub fn is_shown(&self) -> bool {
        self.heights.is_some()
    }

    /// Whether an update is on its way or patches wait to be read.
    pub fn is_busy(&self) -> bool {
        self.is_busy || self.kept.waiting > 0
    }

    /// Takes over the results of the thread.
    pub fn follow(&mut self) {
        loop {
            match self.news.try_recv() {
                Ok(PagingNews::Opened(frame)) => {
                    self.heights = Some(PageHeights::new(frame));
                    self.stage = PagingStage::Shown;
                }
                Ok(PagingNews::Updated(update)) => {
                    self.is_busy = false;
                    self.arrived = Some(update);
                }
                Ok(PagingNews::Failed(text)) => {
                    (self.is_busy, self.stage) = (false, PagingStage::Failed(text))
                }
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    if !matches!(self.stage, PagingStage::Failed(_)) {
                        self.stage = PagingStage::Failed("reading it ended; please report this".to_owned());
                    }
                    return;
                }
            }
        }
    }

    /// Hands everything over again, to a renderer that starts again.
    pub fn forget_handed(&mut self) {
        (self.is_anew, self.asked, self.arrived) = (true, None, None);
        self.heights.iter_mut().for_each(PageHeights::clear);
    }

    /// The changes of the ground since the last call, and their cost; begins to bring it up to date with `camera`.
    pub fn update(&mut self, camera: &Camera) -> (GroundChanges, WalkStatistics) {
        // What was asked for before the renderer was begun anew is of no use to it.
        let arrived = self.arrived.take().filter(|_| !self.is_anew);
        let mut changes = GroundChanges::default();
        if let Some(update) = arrived {
            let PagedUpdate { changes: new, statistics, pages, counts, meshes, .. } = *update;
            if let Some(heights) = &mut self.heights {
                heights.update(pages, &new.dropped);
                let pages = heights.count().max(meshes);
                let waiting = statistics.waiting_patches;
                self.kept = PagesKept { pages, bytes: pages * PAGE_BYTES, waiting, counts };
            }
            (changes, self.statistics) = (new, statistics);
        }
        let is_due = self.asked.as_ref() != Some(camera) || self.kept.waiting > 0;
        if self.is_shown() && !self.is_busy && is_due {
            let request = PagingRequest { camera: *camera, is_anew: self.is_anew };
            // Where the thread has ended, the stage says so.
            self.is_busy = self.requests.send(request).is_ok();
            (self.asked, self.is_anew) = (Some(*camera), false);
        }
        (changes, self.statistics)
    }

    /// The ground at a world position by a page in memory; `None` where none is there.
    pub fn height(&self, at: DVec2) -> Option<Answer> {
        self.heights.as_ref()?.height(at)
    }

    /// The pages in memory; `None` before the terrain is shown.
    pub fn pages(&self) -> Option<&PageHeights> {
        self.heights.as_ref()
    }

    /// The point where a ray meets the ground of pages in memory, or else the overview at `coarse`; `None` where it
    /// meets neither.
    pub fn pick(&self, ray: Ray, coarse: Option<DVec3>) -> Option<DVec3> {
        let Some(heights) = &self.heights else { return coarse };
        let page = heights.pick(ray).map(|hit| hit.at);
        // Where a page is, the overview's ground is not the one shown.
        let coarse_shown = coarse.filter(|at| heights.page_at(at.truncate()).is_none());
        let distance = |at: &DVec3| at.distance(ray.origin);
        let nearest = page.into_iter().chain(coarse_shown).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.or(coarse)
    }

    /// Why nothing is edited or drawn into this terrain.
    pub fn refusal(&self) -> String {
        let (columns, rows) = self.size;
        format!(
            "{columns} x {rows} samples are more than the window holds in memory: they are shown in pages that are read as \
             they are needed, and measured, but not edited, saved or drawn as a picture; a scene file with an `extent` holds \
             a part of them"
        )
    }

    /// The file, for jobs.
    pub fn questions(&self) -> DiskQuestions {
        DiskQuestions(Arc::clone(&self.questions))
    }
}

impl Drop for PagedTerrain {
    fn drop(&mut self) {
        self.watch.stop();
    }
}

/// The file of a terrain, for queries on any thread but the window's.
#[derive(Clone)]
pub struct DiskQuestions(Arc<Mutex<DiskGround<ElevationWindows>>>);

impl DiskQuestions {
    /// Answers a question; one at a time.
    pub fn answer<T>(&self, question: impl FnOnce(&mut DiskGround<ElevationWindows>) -> T) -> T {
        question(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Measures the terrain, then brings it up to date with each camera that is asked for.
fn work(terrain: ElevationWindows, requests: Receiver<PagingRequest>, tell: impl Fn(PagingNews)) {
    let options = PagedWalkOptions {
        reach: REACH,
        // Refined pages may be a quarter more for a while.
        paging: PagingOptions { capacity: MOST_PAGES / 4 * 3, ..PagingOptions::default() },
        kept_patches: MOST_PAGES,
        most_near: MOST_PAGES / 2,
        most_loads: MOST_LOADS,
    };
    let mut walk = match PagedWalk::open(terrain, &options) {
        Ok(walk) => walk,
        Err(error) => return tell(PagingNews::Failed(error_text(&error))),
    };
    let frame = *walk.ground().frame();
    tell(PagingNews::Opened(frame));
    while let Ok(PagingRequest { camera, is_anew }) = requests.recv() {
        if is_anew {
            walk.forget_handed();
        }
        match updated(&mut walk, &frame, &camera) {
            Ok(update) => tell(PagingNews::Updated(Box::new(update))),
            Err(text) => tell(PagingNews::Failed(text)),
        }
    }
}

fn updated(
    walk: &mut PagedWalk<ElevationWindows>,
    frame: &PagedFrame,
    camera: &Camera,
) -> Result<PagedUpdate, String> {
    let made = walk.update(camera).map_err(|error| error_text(&error))?;
    let new = made.changes.vertices.iter().filter_map(|patch| Some((patch.patch, walk.page(patch.patch)?)));
    let pages = new.map(|(patch, (corner, block))| Ok((patch, page(frame, corner, block)?)));
    let pages: Result<Vec<_>, LatticeError> = pages.collect();
    Ok(PagedUpdate {
        changes: made.changes,
        statistics: made.statistics,
        pages: pages.map_err(|error| error_text(&error))?,
        counts: walk.counts(),
        meshes: walk.meshes(),
    })
}
