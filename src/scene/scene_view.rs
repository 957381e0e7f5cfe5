//! A view of the scene: its eye and its target.

use glam::{DVec2, Vec3};

use crate::paper_sheet::PaperSheet;
use sandtable_geom::rect::Rect;

/// A view of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneView {
    /// Its name on the command line.
    pub name: String,
    /// The eye and the target.
    pub aim: ViewAim,
    /// Vertical field of view in radians; without effect on parallel rays.
    pub fov_y_rad: f32,
    /// The paper that it fills, where it is meant for print.
    pub paper: Option<PaperSheet>,
}

impl SceneView {
    /// Pixels per inch of its print; `None` where it has no print in mind.
    pub fn dpi(&self) -> Option<f64> {
        match self.aim {
            ViewAim::Parallel(ParallelView { dpi, .. }) => Some(dpi),
            _ => self.paper.map(|paper| paper.dpi),
        }
    }
}

impl SceneView {
    /// The part of the ground that it is fitted to, world X and Y; `None` where that is all, and where it has an eye.
    pub fn shown(&self) -> Option<Rect> {
        match self.aim {
            ViewAim::At { .. } | ViewAim::Panorama(_) => None,
            ViewAim::Fitted(FittedView { shown, .. }) | ViewAim::Parallel(ParallelView { shown, .. }) => {
                shown
            }
        }
    }

    /// This view with all of its places moved.
    pub fn moved(&self, by: DVec2) -> Self {
        let rect = |rect: Rect| Rect { min: rect.min + by, max: rect.max + by };
        let point = |at: Vec3| at + by.as_vec2().extend(0.0);
        let aim = match self.aim {
            ViewAim::At { eye, target } => ViewAim::At { eye: point(eye), target: point(target) },
            ViewAim::Panorama(view) => ViewAim::Panorama(PanoramaView { eye: point(view.eye), ..view }),
            ViewAim::Fitted(view) => ViewAim::Fitted(FittedView { shown: view.shown.map(rect), ..view }),
            ViewAim::Parallel(view) => ViewAim::Parallel(ParallelView {
                shown: view.shown.map(rect),
                middle: view.middle.map(|middle| middle + by),
                ..view
            }),
        };
        Self { aim, ..self.clone() }
    }
}

/// The eye and the target of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewAim {
    /// From a place to a place, world space.
    At {
        /// The eye.
        eye: Vec3,
        /// The point in the picture's middle.
        target: Vec3,
    },
    /// From as near as what it shows fits into the picture.
    Fitted(FittedView),
    /// By parallel rays, with one scale.
    Parallel(ParallelView),
    /// All around, or part of the way.
    Panorama(PanoramaView),
}

/// A view on a cylinder around its eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanoramaView {
    /// The eye, world space.
    pub eye: Vec3,
    /// The azimuth of the left border, clockwise from north, radians.
    pub from_rad: f32,
    /// How far round it reaches, radians; a full turn at most.
    pub span_rad: f32,
}

/// A view whose eye depends on the picture's shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedView {
    /// Where it looks, clockwise from north, radians; `None` for north, or for up to 45° from it where the ground fills the
    /// picture better so.
    pub azimuth_rad: Option<f32>,
    /// How far it looks down from the horizon, radians; `None` for what fills the picture best.
    pub pitch_rad: Option<f32>,
    /// The ground that it shows, world X and Y; `None` for all of it.
    pub shown: Option<Rect>,
}

/// A view by parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelView {
    /// Where it looks, clockwise from north, radians.
    pub azimuth_rad: f32,
    /// How far it looks down from the horizon, radians; a right angle at most.
    pub pitch_rad: f32,
    /// How many times as many pixels a meter spans up the picture as across it.
    pub stretch: f32,
    /// `n` of its scale 1:n; `None` for the largest at which what it shows fits into the picture.
    pub scale: Option<f64>,
    /// Pixels per inch of the print on which that scale is true.
    pub dpi: f64,
    /// The ground that it shows, world X and Y; `None` for all of it.
    pub shown: Option<Rect>,
    /// The ground in the middle of the picture, world X and Y; `None` for the middle of what it shows.
    pub middle: Option<DVec2>,
}
