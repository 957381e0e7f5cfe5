//! The service that answers: whole epochs of the ground, one at a time.
//!
//! [`HeightService`] is a handle that every clone shares; what it answers from is an [`Epoch`], which never changes.
//! An edit makes the next epoch beside the one in use and puts it in place at once, so that a reader sees all of an
//! edit or nothing of it. Whoever asks several things that must agree takes [`HeightService::now`] once.

use std::sync::{Arc, PoisonError, RwLock};

use glam::DVec2;
use rayon::prelude::*;

use crate::dem::raster::Raster;
use crate::geom::crs::Crs;
use crate::terrain::facets::Facets;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Answer, Interpolation, Surface, ground_height, raster_height};

/// Answers height queries on the ground of one scene; cheap to clone, safe to share between threads while the ground
/// is edited.
#[derive(Clone)]
pub struct HeightService {
    now: Arc<RwLock<Arc<Epoch>>>,
}

/// The ground between two edits.
#[derive(Clone)]
pub struct Epoch {
    number: u64,
    source: Arc<Raster>,
    crs: Crs,
    lattice: Arc<Lattice>,
    displayed: Option<Displayed>,
}

/// What is drawn now.
#[derive(Clone)]
struct Displayed {
    facets: Arc<dyn Facets>,
    exaggeration: f64,
}

impl HeightService {
    /// A service on a raster as read and the lattice made of it, asked in coordinates of `crs`.
    pub fn new(source: Arc<Raster>, crs: Crs, lattice: Arc<Lattice>) -> Self {
        Self::at(Epoch { number: 0, source, crs, lattice, displayed: None })
    }

    fn at(epoch: Epoch) -> Self {
        Self { now: Arc::new(RwLock::new(Arc::new(epoch))) }
    }

    /// The epoch in use.
    pub fn now(&self) -> Arc<Epoch> {
        // An epoch is put in place whole, so a thread that panicked elsewhere left none half made.
        Arc::clone(&self.now.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Puts an edited lattice in place of the ground, for every clone of this service; returns the new epoch.
    pub fn publish(&self, lattice: Arc<Lattice>) -> Arc<Epoch> {
        let mut now = self.now.write().unwrap_or_else(PoisonError::into_inner);
        let next = Arc::new(Epoch { number: now.number + 1, lattice, ..Epoch::clone(&now) });
        *now = Arc::clone(&next);
        next
    }

    /// A service of its own, on the epoch in use now, with the surface displayed now, whose Z is the height times
    /// `exaggeration`.
    pub fn displaying(&self, facets: Arc<dyn Facets>, exaggeration: f64) -> Self {
        let displayed = Some(Displayed { facets, exaggeration });
        Self::at(Epoch { displayed, ..Epoch::clone(&self.now()) })
    }

    /// [`Epoch::height`] of the epoch in use.
    pub fn height(&self, surface: Surface, interpolation: Interpolation, at: DVec2) -> Answer {
        self.now().height(surface, interpolation, at)
    }

    /// [`Epoch::heights`] of the epoch in use: one epoch for the whole batch.
    pub fn heights(&self, surface: Surface, interpolation: Interpolation, at: &[DVec2], out: &mut [Answer]) {
        self.now().heights(surface, interpolation, at, out);
    }
}

impl Epoch {
    /// How many edits were put in place before it.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The raster as read.
    pub fn source(&self) -> &Arc<Raster> {
        &self.source
    }

    /// The system that positions are given in: the ground's.
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// The ground.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// The height of `surface` at map position `at`, in the scene's coordinates.
    ///
    /// [`Surface::Displayed`] answers [`Answer::Outside`] where nothing is displayed.
    pub fn height(&self, surface: Surface, interpolation: Interpolation, at: DVec2) -> Answer {
        match surface {
            Surface::Source => self.source_height(interpolation, at),
            Surface::Ground | Surface::Scene => ground_height(&self.lattice, interpolation, at),
            Surface::Displayed => self.displayed_height(at),
        }
    }

    /// The heights at many positions, in order, spread over all threads.
    ///
    /// # Panics
    /// Where `out` is not as long as `at`.
    pub fn heights(&self, surface: Surface, interpolation: Interpolation, at: &[DVec2], out: &mut [Answer]) {
        assert_eq!(at.len(), out.len(), "one answer per position");
        const CHUNK: usize = 4096;
        at.par_chunks(CHUNK).zip(out.par_chunks_mut(CHUNK)).for_each(|(at, out)| {
            for (&at, out) in at.iter().zip(out) {
                *out = self.height(surface, interpolation, at);
            }
        });
    }

    fn source_height(&self, interpolation: Interpolation, at: DVec2) -> Answer {
        source_height(&self.source, &self.crs, interpolation, at)
    }

    fn displayed_height(&self, at: DVec2) -> Answer {
        let Some(displayed) = &self.displayed else {
            return Answer::Outside;
        };
        let world = at - self.lattice.origin();
        match displayed.facets.displayed_z(world) {
            Some(z) => Answer::Height(z / displayed.exaggeration),
            None => Answer::Outside,
        }
    }
}

/// The height of a raster as read at a position in coordinates of `from`; a raster without a system lies in `from`.
pub fn source_height(source: &Raster, from: &Crs, interpolation: Interpolation, at: DVec2) -> Answer {
    let in_source = match &source.crs {
        Some(own) => from.transform(own, at),
        None => Ok(at),
    };
    let in_source = in_source.map(|at| match &source.crs {
        // Longitudes come back within ±180°; a raster across the date line counts them on from there.
        Some(own) if own.is_geographic() => at + DVec2::X * whole_turns(source.center().x - at.x),
        _ => at,
    });
    in_source.map_or(Answer::Outside, |at| raster_height(source, interpolation, at))
}

/// The whole turns, in degrees, nearest to `degrees`.
fn whole_turns(degrees: f64) -> f64 {
    360.0 * (degrees / 360.0).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read;

    fn lattice(height: impl Fn(u32, u32) -> f32) -> Lattice {
        let heights = (0..36).map(|index| height(index % 6, index / 6)).collect();
        Lattice::new(DVec2::new(1000.0, 2000.0), DVec2::new(10.0, 20.0), 6, heights).expect("sound")
    }

    #[test]
    fn the_source_across_the_date_line_answers_on_both_sides() {
        let text = "ncols 4\nnrows 2\nxllcorner 179.8\nyllcorner -16.1\ncellsize 0.1\n1 2 3 4\n1 2 3 4\n";
        let hints = read::Hints { crs: Some(Crs::wgs84()), ..read::Hints::default() };
        let source = read::read("a.asc", text.as_bytes(), &hints).expect("sound");
        let utm = Crs::from_epsg(32701).expect("a zone");
        let service = HeightService::new(Arc::new(source), utm.clone(), Arc::new(lattice(|_, _| 0.0)));
        for (longitude, height) in [(179.85, 1.0), (179.95, 2.0), (-179.95, 3.0), (180.15, 4.0)] {
            let at = Crs::wgs84().transform(&utm, DVec2::new(longitude, -16.0)).expect("inside");
            assert_eq!(service.height(Surface::Source, Interpolation::Nearest, at), Answer::Height(height));
        }
    }
}
