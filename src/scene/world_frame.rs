//! From coordinates in a scene file to world space.

use glam::{DVec2, Vec3};
use toml::Spanned;

use crate::dem::answer::Answer;
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::geom::crs::Crs;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};

/// Brings a document's points to the world.
pub struct WorldFrame<'a> {
    /// The document, for messages.
    pub document: &'a Document,
    /// The scene's system.
    pub crs: &'a Crs,
    /// The system that inline points are in by default.
    pub points_crs: Crs,
    /// Map coordinates of world (0, 0).
    pub origin: DVec2,
    /// How many times heights are stretched when drawn.
    pub exaggeration: f32,
}

impl WorldFrame<'_> {
    /// The system that a feature's own `crs` key names, or the default for inline points.
    ///
    /// # Errors
    /// The key's text is no system.
    pub fn crs_of(&self, stated: Option<&Spanned<String>>) -> Result<Crs, Diagnostic> {
        parse_crs(self.document, stated).map(|crs| crs.unwrap_or_else(|| self.points_crs.clone()))
    }

    /// World X and Y of a point in `from`.
    ///
    /// # Errors
    /// A sentence saying why it cannot be brought there.
    pub fn world(&self, from: &Crs, at: DVec2) -> Result<DVec2, String> {
        let map = from.transform(self.crs, at).map_err(|error| error.to_string())?;
        Ok(map - self.origin)
    }

    /// World X and Y of a point written in the document.
    ///
    /// # Errors
    /// The point's system is unknown, or the point cannot be brought to the scene's.
    pub fn point(&self, at: &Spanned<[f64; 2]>, crs: Option<&Spanned<String>>) -> Result<DVec2, Diagnostic> {
        let from = self.crs_of(crs)?;
        let world = self.world(&from, DVec2::from(*at.get_ref()));
        world.map_err(|reason| self.document.error(at, reason))
    }

    /// The place on the ground below a world position, its drawn height as Z.
    ///
    /// # Errors
    /// The position lies off the elevation model, or where it holds no data.
    pub fn on_ground(
        &self,
        lattice: &Lattice,
        at: &Spanned<[f64; 2]>,
        world: DVec2,
    ) -> Result<Vec3, Diagnostic> {
        match ground_height(lattice, Interpolation::Planar, world + self.origin) {
            Answer::Height(height) => Ok(world.as_vec2().extend(height as f32 * self.exaggeration)),
            Answer::NoData => Err(self
                .document
                .error(at, "the elevation model holds no data at this point")
                .with_help("move the point to where there is ground")),
            Answer::Outside => Err(self.off_the_model(lattice, at)),
        }
    }

    fn off_the_model(&self, lattice: &Lattice, at: &Spanned<[f64; 2]>) -> Diagnostic {
        let [x, y] = *at.get_ref();
        let (low, high) = (self.origin, self.origin + lattice.extent().max);
        let message = format!("the point ({x}, {y}) lies off the elevation model");
        let mut help = format!(
            "the model covers {:.0} to {:.0} east and {:.0} to {:.0} north in {}",
            low.x,
            high.x,
            low.y,
            high.y,
            self.crs.name()
        );
        if looks_like_degrees(x, y) && !self.points_crs.is_geographic() {
            help += "; if the point is longitude and latitude, say points_crs = \"EPSG:4326\"";
        }
        self.document.error(at, message).with_help(help)
    }
}

fn looks_like_degrees(x: f64, y: f64) -> bool {
    x.abs() <= 180.0 && y.abs() <= 90.0
}

/// The system that a `crs` key names; `None` where there is no key.
///
/// # Errors
/// The key's text is no system.
pub fn parse_crs(document: &Document, stated: Option<&Spanned<String>>) -> Result<Option<Crs>, Diagnostic> {
    stated
        .map(|text| Crs::parse(text.get_ref()).map_err(|error| document.error(text, error.to_string())))
        .transpose()
}
