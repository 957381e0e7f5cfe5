//! Transforms coordinates in a scene file to world space.

use glam::{DVec2, Vec3};

use crate::vertical_scale::VerticalScale;
use sandtable_base::message::numbers::fixed;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::stated::Stated;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_geom::position::Position;
use sandtable_geom::rect::Rect;
use sandtable_raster::answer::Answer;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The transform of a document's points to world space.
pub struct WorldFrame<'a> {
    /// The document, for messages.
    pub document: &'a Document,
    /// The scene's system.
    pub crs: &'a Crs,
    /// The system that inline points are in by default.
    pub points_crs: Crs,
    /// Map coordinates of world (0, 0).
    pub origin: DVec2,
    /// The ground, in map coordinates.
    pub extent: Rect,
    /// How elevations are drawn.
    pub scale: VerticalScale,
}

impl<'a> WorldFrame<'a> {
    /// The frame of a document whose ground is `extent` of `crs`; `stated_crs` is the system that the document or its
    /// elevation states.
    pub fn new(document: &'a Document, crs: &'a Crs, stated_crs: &Crs, extent: Rect) -> Self {
        let points_crs = document.points_crs.as_ref().unwrap_or(stated_crs).clone();
        let scale = VerticalScale(document.terrain.vertical_exaggeration as f32);
        Self { document, crs, points_crs, origin: extent.min, extent, scale }
    }

    /// World X and Y of a point in `from`.
    ///
    /// # Errors
    /// The point cannot be transformed to the scene's system.
    pub fn world(&self, from: &Crs, at: DVec2) -> Result<DVec2, CrsError> {
        Ok(from.transform(self.crs, at)? - self.origin)
    }

    /// World X and Y of a point written in the document; without a `crs` in the default system of inline points.
    ///
    /// # Errors
    /// The point cannot be transformed to the scene's system.
    pub fn point(&self, at: &Stated<Position>, crs: Option<&Crs>) -> Result<DVec2, Diagnostic> {
        self.position(at, crs).map_err(|error| self.document.error(at, error))
    }

    /// As [`Self::point`], of a position by itself.
    ///
    /// # Errors
    /// The position cannot be transformed to the scene's system.
    pub fn position(&self, at: &Position, crs: Option<&Crs>) -> Result<DVec2, CrsError> {
        match at.numbers() {
            Some(numbers) => self.world(crs.unwrap_or(&self.points_crs), numbers),
            None => Ok(at.in_system(self.crs)? - self.origin),
        }
    }

    /// The ground at a world position, as it is drawn.
    ///
    /// # Errors
    /// The position lies off the elevation model, or where it holds no data.
    pub fn on_ground(
        &self,
        lattice: &Lattice,
        at: &Stated<Position>,
        world: DVec2,
    ) -> Result<Vec3, Diagnostic> {
        match ground_height(lattice, Interpolation::Planar, world + self.origin) {
            Answer::Height(height) => Ok(world.as_vec2().extend(self.scale.world_z(height as f32))),
            Answer::NoData => Err(self
                .document
                .error(at, "the elevation model holds no data at this point")
                .with_code(FindingCode::NoDataUnder)
                .with_help("move the point to where there is ground")),
            Answer::Outside => Err(self.off_the_model(lattice, at, world)),
        }
    }

    /// The ground at a world position, as it is drawn; `None` off the model and where it holds no data.
    pub fn ground_at(&self, lattice: &Lattice, world: DVec2) -> Option<Vec3> {
        let height = ground_height(lattice, Interpolation::Planar, world + self.origin).height_m()?;
        Some(world.as_vec2().extend(self.scale.world_z(height as f32)))
    }

    fn off_the_model(&self, lattice: &Lattice, at: &Stated<Position>, world: DVec2) -> Diagnostic {
        let map = world + self.origin;
        let DVec2 { x, y } = at.numbers().unwrap_or_else(|| (map * 10.0).round() / 10.0);
        let (low, high) = (self.origin, self.origin + lattice.extent().max);
        let message = format!("the point ({x}, {y}) lies off the elevation model");
        let mut help = format!(
            "the model covers {} to {} east and {} to {} north in {}",
            fixed(low.x, 0),
            fixed(high.x, 0),
            fixed(low.y, 0),
            fixed(high.y, 0),
            self.crs.name()
        );
        if at.numbers().is_some() && looks_like_degrees(x, y) && !self.points_crs.is_geographic() {
            help += "; if the point is longitude and latitude, say points_crs = \"EPSG:4326\"";
        }
        self.document.error(at, message).with_code(FindingCode::OffTerrain).with_help(help)
    }
}

fn looks_like_degrees(x: f64, y: f64) -> bool {
    x.abs() <= 180.0 && y.abs() <= 90.0
}
