//! The height service: whole snapshots of the ground, one at a time.
//!
//! [`HeightService`] is a handle that all clones share; it answers from a [`Snapshot`], which never changes. An edit
//! prepares the next snapshot beside the current one and publishes it at once, so that a reader sees all of an edit or
//! nothing of it. Several queries that must agree use one [`HeightService::snapshot`].

use std::sync::{Arc, PoisonError, RwLock};

use glam::DVec2;

use crate::lattice::Lattice;
use crate::query::batch::{self, HeightSlices};
use crate::query::deck::Deck;
use crate::query::source::{source_height, source_task};
use crate::query::source_raster::SourceRaster;
use crate::query::tiles::LazyTiles;
use crate::query::{Interpolation, Surface, ground_height};
use crate::triangle_surface::TriangleSurface;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::Answer;
use sandtable_raster::raster::Raster;

/// Positions between two checks whether tiles should be made, so that a single long batch gets them too.
const STRETCH: usize = 1 << 20;

/// Answers height queries on the ground of one scene; cheap to clone, safe to share between threads while the ground is
/// edited.
#[derive(Clone)]
pub struct HeightService {
    current: Arc<RwLock<Arc<Snapshot>>>,
}

/// The ground between two edits.
#[derive(Clone)]
pub struct Snapshot {
    number: u64,
    source: Arc<SourceRaster>,
    crs: Crs,
    lattice: Arc<Lattice>,
    /// Always those of `lattice`.
    tiles: Arc<LazyTiles>,
    decks: Option<Arc<Deck>>,
    displayed: Option<Displayed>,
}

/// The surface drawn now.
#[derive(Clone)]
struct Displayed {
    facets: Arc<dyn TriangleSurface>,
    z_per_m: f64,
}

impl HeightService {
    /// A service on a raster as read and the lattice made of it; positions are in coordinates of `crs`.
    pub fn new(source: Arc<SourceRaster>, crs: Crs, lattice: Arc<Lattice>) -> Self {
        let tiles = Arc::default();
        Self::from_snapshot(Snapshot { number: 0, source, crs, lattice, tiles, decks: None, displayed: None })
    }

    fn from_snapshot(snapshot: Snapshot) -> Self {
        Self { current: Arc::new(RwLock::new(Arc::new(snapshot))) }
    }

    /// The current snapshot.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        // A snapshot is replaced in one assignment, so a thread that panicked left none half made.
        Arc::clone(&self.current.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Replaces the ground by an edited lattice, for every clone of this service; returns the new snapshot.
    pub fn publish(&self, lattice: Arc<Lattice>) -> Arc<Snapshot> {
        self.replace(|current| Snapshot { lattice, tiles: Arc::default(), ..Snapshot::clone(current) })
    }

    /// Replaces the decks, for every clone of this service; returns the new snapshot.
    pub fn publish_decks(&self, decks: Arc<Deck>) -> Arc<Snapshot> {
        self.replace(|current| Snapshot { decks: Some(decks), ..Snapshot::clone(current) })
    }

    fn replace(&self, next: impl FnOnce(&Snapshot) -> Snapshot) -> Arc<Snapshot> {
        let mut current = self.current.write().unwrap_or_else(PoisonError::into_inner);
        let next = Arc::new(Snapshot { number: current.number + 1, ..next(&current) });
        *current = Arc::clone(&next);
        next
    }

    /// An independent service on the current snapshot, with decks over the ground.
    pub fn with_decks(&self, decks: Arc<Deck>) -> Self {
        Self::from_snapshot(Snapshot { decks: Some(decks), ..Snapshot::clone(&self.snapshot()) })
    }

    /// An independent service on the current snapshot, with a displayed surface whose Z is the height in meters
    /// times `z_per_m`.
    pub fn displaying(&self, facets: Arc<dyn TriangleSurface>, z_per_m: f64) -> Self {
        let displayed = Some(Displayed { facets, z_per_m });
        Self::from_snapshot(Snapshot { displayed, ..Snapshot::clone(&self.snapshot()) })
    }

    /// [`Snapshot::height`] of the current snapshot.
    pub fn height(&self, surface: Surface, interpolation: Interpolation, at: DVec2) -> Answer {
        self.snapshot().height(surface, interpolation, at)
    }

    /// [`Snapshot::heights`] of the current snapshot: one snapshot for the whole batch.
    pub fn heights(&self, surface: Surface, interpolation: Interpolation, at: &[DVec2], out: &mut [Answer]) {
        self.snapshot().heights(surface, interpolation, at, out);
    }

    /// [`Snapshot::heights_apart`] of the current snapshot: one snapshot for the whole batch.
    pub fn heights_apart(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        at: &[DVec2],
        out: HeightSlices<'_>,
    ) {
        self.snapshot().heights_apart(surface, interpolation, at, out);
    }
}

impl Snapshot {
    /// The number of edits published before it.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The raster as read, with its samples.
    pub fn source(&self) -> &Arc<Raster> {
        self.source.raster()
    }

    /// The raster as read; its samples may be left out.
    pub fn source_header(&self) -> &Arc<Raster> {
        self.source.header()
    }

    /// Whether all samples of the raster as read that are numbers are whole.
    pub fn holds_whole_numbers(&self) -> bool {
        self.source.holds_whole_numbers()
    }

    /// The system of positions: the ground's.
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// The ground.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// The decks over the ground, if there are any.
    pub fn decks(&self) -> Option<&Arc<Deck>> {
        self.decks.as_ref()
    }

    /// The height of `surface` at map position `at`, in the scene's coordinates.
    ///
    /// [`Surface::Displayed`] answers [`Answer::Outside`] where nothing is displayed.
    pub fn height(&self, surface: Surface, interpolation: Interpolation, at: DVec2) -> Answer {
        match surface {
            Surface::Source => source_height(self.source(), &self.crs, interpolation, at),
            Surface::Ground => ground_height(&self.lattice, interpolation, at),
            Surface::Scene => self.or_deck(at, ground_height(&self.lattice, interpolation, at)),
            Surface::Displayed => self.displayed_height(at),
        }
    }

    /// The heights at many positions, in order, spread over all threads: to the last bit [`Snapshot::height`] of each.
    ///
    /// # Panics
    /// Where `out` is not as long as `at`.
    pub fn heights(&self, surface: Surface, interpolation: Interpolation, at: &[DVec2], out: &mut [Answer]) {
        assert_eq!(at.len(), out.len(), "one answer per position");
        for (at, out) in at.chunks(STRETCH).zip(out.chunks_mut(STRETCH)) {
            self.tiles.make_if_worthwhile(&self.lattice);
            batch::answers(at, out, |at, out| self.task(surface, interpolation, at, out));
        }
    }

    /// [`Snapshot::heights`] as heights and statuses in slices of their own: the fastest form, since less is written.
    ///
    /// # Panics
    /// Where the slices are not as long as `at`.
    pub fn heights_apart(
        &self,
        surface: Surface,
        interpolation: Interpolation,
        at: &[DVec2],
        mut out: HeightSlices<'_>,
    ) {
        out.check_len(at.len());
        for (at, out) in at.chunks(STRETCH).zip(out.chunks_mut(STRETCH)) {
            self.tiles.make_if_worthwhile(&self.lattice);
            batch::spread(at, out, |at, out| self.task(surface, interpolation, at, out));
        }
    }

    /// One task of a batch, on this thread.
    fn task(&self, surface: Surface, interpolation: Interpolation, at: &[DVec2], mut out: HeightSlices<'_>) {
        if surface == Surface::Source {
            return source_task(self.source(), &self.crs, interpolation, at, out);
        }
        let is_ground = surface == Surface::Ground || (surface == Surface::Scene && self.decks.is_none());
        if is_ground && interpolation == Interpolation::Bilinear {
            let scattered = batch::bilinear_ground(&self.lattice, self.tiles.get(), at, out);
            return self.tiles.count(scattered);
        }
        out.fill(at, |at| self.height(surface, interpolation, at));
    }

    /// The higher of the ground's answer and the deck over it; the deck's own where the ground has none.
    fn or_deck(&self, at: DVec2, ground: Answer) -> Answer {
        let deck = self.decks.as_ref().and_then(|decks| decks.height_m(at - self.lattice.origin()));
        match (deck, ground) {
            (Some(deck), Answer::Height(ground)) => Answer::Height(deck.max(ground)),
            (Some(deck), _) => Answer::Height(deck),
            (None, ground) => ground,
        }
    }

    fn displayed_height(&self, at: DVec2) -> Answer {
        let world = at - self.lattice.origin();
        let displayed = self.displayed.as_ref().filter(|_| world.is_finite());
        let z = displayed.and_then(|shown| Some(shown.facets.displayed_z(world)? / shown.z_per_m));
        z.map_or(Answer::Outside, Answer::Height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle_surface::SurfaceTriangle;
    use glam::Vec3;

    fn service(height: impl Fn(u32, u32) -> f32) -> HeightService {
        let heights: Vec<f32> = (0..36).map(|index| height(index % 6, index / 6)).collect();
        let lattice =
            Lattice::new(DVec2::new(1000.0, 2000.0), DVec2::new(10.0, 20.0), 6, heights).expect("sound");
        let text = "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1\n";
        let source = sandtable_dem::read::read("a.asc", text.as_bytes(), &Default::default()).expect("sound");
        HeightService::new(Arc::new(SourceRaster::from(Arc::new(source))), Crs::local(), Arc::new(lattice))
    }

    fn bridge(z: f32) -> Arc<Deck> {
        let at = |x: f32, y: f32| Vec3::new(x, y, z);
        let facets: [SurfaceTriangle; 2] = [
            [at(10.0, 30.0), at(60.0, 30.0), at(60.0, 50.0)],
            [at(10.0, 30.0), at(60.0, 50.0), at(10.0, 50.0)],
        ];
        Arc::new(Deck::new(&facets).expect("sound"))
    }

    #[test]
    fn the_scene_is_the_higher_of_the_ground_and_the_deck_over_it() {
        let plain = service(|column, _| if column == 2 { f32::NAN } else { column as f32 * 10.0 });
        let bridged = plain.with_decks(bridge(15.0));
        let ask = |service: &HeightService, surface, x: f64| {
            service.height(surface, Interpolation::Nearest, DVec2::new(1000.0 + x, 2040.0))
        };
        for (x, ground, scene) in [
            (0.0, Answer::Height(0.0), Answer::Height(0.0)),
            (12.0, Answer::Height(10.0), Answer::Height(15.0)),
            (20.0, Answer::NoData, Answer::Height(15.0)),
            (40.0, Answer::Height(40.0), Answer::Height(40.0)),
            (55.0, Answer::Outside, Answer::Height(15.0)),
            (65.0, Answer::Outside, Answer::Outside),
        ] {
            assert_eq!(ask(&bridged, Surface::Ground, x), ground, "at {x}");
            assert_eq!(ask(&bridged, Surface::Scene, x), scene, "at {x}");
            assert_eq!(ask(&plain, Surface::Scene, x), ground, "no deck was added to the other's");
        }
    }

    #[test]
    fn decks_stay_when_the_ground_changes_and_make_a_snapshot() {
        let service = service(|_, _| 0.0);
        let clone = service.clone();
        let (first, at) = (service.snapshot(), DVec2::new(1030.0, 2040.0));
        assert_eq!(service.publish_decks(bridge(9.0)).number(), 1);
        let flat = vec![2.0; 36];
        let lattice = Lattice::new(first.lattice().origin(), first.lattice().cell(), 6, flat).expect("sound");
        assert_eq!(service.publish(Arc::new(lattice)).number(), 2);
        let ask = |surface| clone.height(surface, Interpolation::Bilinear, at);
        assert_eq!(ask(Surface::Scene), Answer::Height(9.0));
        assert_eq!(ask(Surface::Ground), Answer::Height(2.0));
        assert_eq!(first.height(Surface::Scene, Interpolation::Bilinear, at), Answer::Height(0.0));
    }
}
