//! Finds out whether the features of a table lie on the ground.
//!
//! Every source is measured as it is placed, which costs a comparison a vertex. What lies wholly off the ground is an error:
//! nobody describes a scene's roads to see none of them.

use std::ops::Range;

use glam::DVec2;

use crate::misplacement::{Misplacement, misplacement};
use crate::world_frame::WorldFrame;
use sandtable_base::message::numbers::fixed;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// The most vertices of a source that are kept, as they are written, to find out why it lies off the ground.
const SAMPLED: usize = 256;

/// The vertices of a file that are kept to measure how much of it lies off the ground; between half of it and all.
const MEASURED: usize = 8192;

/// The places of the shapes of one source.
#[derive(Clone, Debug)]
pub struct SourceReach {
    /// The bytes of the scene file that state its points, or the name of its file.
    pub span: Range<usize>,
    /// The name of its file; `None` where the scene file states its points.
    pub file: Option<String>,
    /// The system of its points.
    crs: Crs,
    /// The first vertices, as they are written.
    written: Vec<DVec2>,
    /// The vertices of a source that the scene file states, in world coordinates; of a file every `step`-th.
    path: Vec<DVec2>,
    step: usize,
    vertices: usize,
    /// The world box of each shape.
    boxes: Vec<Rect>,
}

/// The places of the vertices of one shape.
pub struct ShapeReach {
    /// The first ones, as they are written.
    written: Vec<DVec2>,
    /// All of them in world coordinates.
    world: Vec<DVec2>,
    around: Rect,
}

impl Default for ShapeReach {
    fn default() -> Self {
        Self { written: Vec::new(), world: Vec::new(), around: Rect::EMPTY }
    }
}

impl ShapeReach {
    /// Adds a vertex, as it is written and in world coordinates.
    pub fn add(&mut self, written: DVec2, world: DVec2) {
        if self.written.len() < SAMPLED {
            self.written.push(written);
        }
        self.world.push(world);
        self.around = self.around.with(world);
    }
}

/// The extent to which a source lies off the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceOverlap {
    /// The bytes of the scene file that state its points, or the name of its file.
    pub span: Range<usize>,
    /// The name of its file; `None` where the scene file states its points.
    pub file: Option<String>,
    /// Its shapes: lines, polygons or points.
    pub shapes: usize,
    /// Those that lie wholly off the ground.
    pub off: usize,
    /// Those that lie partly off.
    pub partly: usize,
    /// Of a line that the scene file states, the share of its length that is off; else that of the vertices.
    pub share_off: f64,
    /// The rectangle around all shapes, in world coordinates.
    pub around: Rect,
}

impl SourceReach {
    /// A source without shapes yet.
    pub fn new(span: Range<usize>, file: Option<String>, crs: Crs) -> Self {
        let (written, path, boxes) = (Vec::new(), Vec::new(), Vec::new());
        Self { span, file, crs, written, path, step: 1, vertices: 0, boxes }
    }

    /// Adds the next shape.
    pub fn add_shape(&mut self, shape: &ShapeReach) {
        let wanted = SAMPLED - self.written.len();
        self.written.extend(shape.written.iter().take(wanted));
        for &world in &shape.world {
            self.add(world);
        }
        self.boxes.push(shape.around);
    }

    fn add(&mut self, world: DVec2) {
        if self.vertices.is_multiple_of(self.step) {
            self.path.push(world);
        }
        self.vertices += 1;
        if self.file.is_some() && self.path.len() == MEASURED {
            let mut index = 0;
            self.path.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.step *= 2;
        }
    }

    /// The part of the source that lies off the ground, whose extent is in world coordinates.
    pub fn overlap(&self, extent: &Rect) -> SourceOverlap {
        let is_inside = |rect: &Rect| extent.contains(rect.min) && extent.contains(rect.max);
        let off = self.boxes.iter().filter(|rect| !rect.meets(extent)).count();
        let inside = self.boxes.iter().filter(|rect| is_inside(rect)).count();
        let shapes = self.boxes.len();
        SourceOverlap {
            span: self.span.clone(),
            file: self.file.clone(),
            shapes,
            off,
            partly: shapes - off - inside,
            share_off: self.share_off(extent),
            around: self.around(),
        }
    }

    fn around(&self) -> Rect {
        let boxes = self.boxes.iter().filter(|rect| !rect.is_empty());
        Rect::around(boxes.flat_map(|rect| [rect.min, rect.max]))
    }

    fn share_off(&self, extent: &Rect) -> f64 {
        let length = |from: DVec2, to: DVec2| from.distance(to);
        let all: f64 = self.path.windows(2).map(|ends| length(ends[0], ends[1])).sum();
        if self.file.is_some() || self.boxes.len() > 1 || all == 0.0 {
            let off = self.path.iter().filter(|at| !extent.contains(**at)).count();
            return off as f64 / self.path.len().max(1) as f64;
        }
        let clipped = self.path.windows(2).filter_map(|ends| extent.clip_line(ends[0], ends[1]));
        let inside: f64 = clipped.map(|(from, to)| length(from, to)).sum();
        (1.0 - inside / all).clamp(0.0, 1.0)
    }

    /// The error for a source that lies wholly off the ground; `None` where some of it lies on the ground.
    pub fn error(&self, frame: &WorldFrame<'_>, extent: &Rect) -> Option<Finding> {
        let overlap = self.overlap(extent);
        if overlap.shapes == 0 || overlap.off < overlap.shapes {
            return None;
        }
        let what = match (&self.file, overlap.shapes) {
            (None, _) => "the feature lies".to_owned(),
            (Some(file), 1) => format!("the only feature of '{}' that is taken lies", quoted(file)),
            (Some(file), shapes) => format!("all {shapes} features of '{}' that are taken lie", quoted(file)),
        };
        let rect = self.around();
        let far_km = gap(&rect, extent) / 1000.0;
        let far = if rect.is_empty() { String::new() } else { format!(", {far_km:.1} km from it") };
        let map = Rect { min: extent.min + frame.origin, max: extent.max + frame.origin };
        let found = misplacement(&self.written, &self.crs, frame.crs, &map);
        let message = format!("{what} off the elevation model{far}");
        let (code, help) = match found {
            Some(found) => (found.code(), found.help(&self.crs)),
            None => (FindingCode::OffTerrain, help(&map, frame.crs)),
        };
        let finding = Finding::new(code, message).at(&frame.document.source, self.span.clone());
        Some(finding.with_help(help))
    }
}

/// The distance between two boxes in meters; 0 where they meet.
fn gap(one: &Rect, other: &Rect) -> f64 {
    (one.min - other.max).max(other.min - one.max).max(DVec2::ZERO).length()
}

fn help(map: &Rect, crs: &Crs) -> String {
    format!(
        "the model covers {} to {} east and {} to {} north in {}",
        fixed(map.min.x, 0),
        fixed(map.max.x, 0),
        fixed(map.min.y, 0),
        fixed(map.max.y, 0),
        crs.name()
    )
}

impl Misplacement {
    fn code(&self) -> FindingCode {
        match self {
            Self::AxesSwapped => FindingCode::AxesSwapped,
            Self::Zone(_) => FindingCode::WrongZone,
            Self::System(_) => FindingCode::CrsMismatch,
        }
    }

    fn help(&self, stated: &Crs) -> String {
        match self {
            Self::AxesSwapped if stated.is_geographic() => {
                "it lies on it as [latitude, longitude]: exchange the two coordinates of each point".into()
            }
            Self::AxesSwapped => {
                "it lies on it as [northing, easting]: exchange the two coordinates of each point".into()
            }
            Self::Zone(crs) | Self::System(crs) => {
                format!("it lies on it in {}: say crs = \"{0}\" in its table", crs.name())
            }
        }
    }
}
