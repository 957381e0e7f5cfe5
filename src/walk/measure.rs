//! Measures of the ground as it is now: lines, areas, lines of sight and what is seen from a place.
//!
//! Positions are map coordinates in the scene's system; elevations are meters, true to scale, with all edits.

use std::sync::Arc;

use glam::DVec2;

use crate::Walk;
use sandtable_geom::polygon;
use sandtable_picture::recut::SeenTint;
use sandtable_query::viewshed::ViewshedSummary;
use sandtable_raster::answer::Answer;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::profile::{ProfileStation, ProfileSummary, profile};
use sandtable_terrain::query::pieces::{GridRegion, RegionError};
use sandtable_terrain::query::zone::{Zone, zone};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::line::{Sight, SightEnd};
use sandtable_terrain::sight::viewshed::{Viewshed, ViewshedOptions, viewshed};

/// A measured line.
#[derive(Clone, Debug, PartialEq)]
pub struct LineMeasure {
    /// The ground at its vertices and at every crossing with an edge of the finest triangles, in order.
    pub stations: Vec<ProfileStation>,
    /// Lengths in plan and over the ground, climbs and extremes.
    pub summary: ProfileSummary,
}

/// A measured area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaMeasure {
    /// Square meters in plan, whether there is ground or not.
    pub plan_m2: f64,
    /// The length of its border in plan, meters.
    pub perimeter_m: f64,
    /// The ground in it.
    pub zone: Zone,
}

/// The viewshed from a place.
pub struct SeenGround {
    /// The visibility of each post.
    pub viewshed: Viewshed,
    /// The area in sight.
    pub summary: ViewshedSummary,
}

/// The task of computing a viewshed on another thread. While it is kept, the next edit copies the heights.
pub struct ViewshedTask {
    elevations: Arc<Lattice>,
    options: ViewshedOptions,
}

impl ViewshedTask {
    /// Computes the viewshed.
    ///
    /// # Errors
    /// The ground's answer at the observer, where it has no height there.
    pub fn seen(&self) -> Result<SeenGround, Answer> {
        let viewshed = viewshed(&self.elevations, &self.options)?;
        let summary = ViewshedSummary::new(&self.elevations, &viewshed);
        Ok(SeenGround { viewshed, summary })
    }

    /// The tint of what is seen; `None` where nobody looked.
    pub fn tint(&self, seen: &SeenGround) -> Option<SeenTint> {
        SeenTint::new(&seen.viewshed, &self.elevations)
    }
}

/// Ground that is measured.
pub trait MeasurableGround {
    /// The elevations, true to scale.
    fn elevations(&self) -> &Arc<Lattice>;

    /// The same for rays and lines of sight.
    fn sight(&self) -> &SightGround;

    /// The ground along a line of at least one vertex.
    fn measure_line(&self, line: &[DVec2]) -> LineMeasure {
        let stations = profile(self.elevations(), line);
        LineMeasure { summary: ProfileSummary::from_stations(&stations), stations }
    }

    /// The ground inside a ring, whichever way round; the last vertex need not be the first.
    ///
    /// # Errors
    /// The ring has fewer than three vertices, or one that is not finite.
    fn measure_area(&self, ring: &[DVec2]) -> Result<AreaMeasure, RegionError> {
        let elevations = self.elevations();
        let region = GridRegion::new(elevations, &[ring.to_vec()])?;
        Ok(AreaMeasure {
            plan_m2: polygon::doubled_area(ring).abs() / 2.0,
            perimeter_m: polygon::edges(ring).map(|(from, to)| from.distance(to)).sum(),
            zone: zone(elevations, &region),
        })
    }

    /// Whether the target is seen from the observer, on the curved Earth with the usual refraction.
    fn line_of_sight(&self, observer: SightEnd, target: SightEnd) -> Sight {
        self.sight().line_of_sight(observer, target, Curvature::default())
    }
}

impl MeasurableGround for Walk {
    fn elevations(&self) -> &Arc<Lattice> {
        Walk::elevations(self)
    }

    fn sight(&self) -> &SightGround {
        Walk::sight(self)
    }
}

impl MeasurableGround for SightGround {
    fn elevations(&self) -> &Arc<Lattice> {
        self.lattice()
    }

    fn sight(&self) -> &SightGround {
        self
    }
}

impl Walk {
    /// The task of computing a viewshed.
    pub fn viewshed_task(&self, options: ViewshedOptions) -> ViewshedTask {
        ViewshedTask { elevations: Arc::clone(self.elevations()), options }
    }
}
