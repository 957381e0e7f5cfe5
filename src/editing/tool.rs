//! Tools that draw into a scene: from clicks on the ground to an edit, without a window.
//!
//! ```text
//!  a tool with its sizes ─► click, click … finish ─► SceneEdit
//!                     └────► hover ─► the edit as it would be ─► its preview
//! ```

use crate::edit::{EarthworkDraft, SceneEdit};
use sandtable_base::message::choice::{Choice, ChoiceWord, word};

/// The kind of thing that a tool draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the words and their meanings explain the variants")]
pub enum ToolKind {
    Crater,
    Trench,
    Track,
    Level,
    Raise,
    Road,
    River,
    Area,
    Model,
    Label,
}

impl Choice for ToolKind {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Crater, "crater", "A bowl with a raised rim"),
        word(Self::Trench, "trench", "A ditch along a line"),
        word(Self::Track, "track", "The two ruts of a vehicle"),
        word(Self::Level, "level", "Level ground in an outline"),
        word(Self::Raise, "raise", "A bank along a line, a mound at a point"),
        word(Self::Road, "road", "A road along a line"),
        word(Self::River, "river", "A river, from its source to its mouth"),
        word(Self::Area, "area", "Ground cover in an outline"),
        word(Self::Model, "model", "A tree, a rock or a model file"),
        word(Self::Label, "label", "A name on the picture"),
    ];
}

/// The points that a tool takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolShape {
    /// One point, which finishes it.
    Point,
    /// At least two points.
    Line,
    /// One point or more.
    PointOrLine,
    /// At least three points.
    Outline,
}

impl ToolShape {
    /// The fewest points.
    pub fn least(self) -> usize {
        match self {
            Self::Point | Self::PointOrLine => 1,
            Self::Line => 2,
            Self::Outline => 3,
        }
    }
}

impl ToolKind {
    /// The points that it takes.
    pub fn shape(self) -> ToolShape {
        match self {
            Self::Crater | Self::Model | Self::Label => ToolShape::Point,
            Self::Trench | Self::Track | Self::Road | Self::River => ToolShape::Line,
            Self::Raise => ToolShape::PointOrLine,
            Self::Level | Self::Area => ToolShape::Outline,
        }
    }

    /// Whether it moves earth, so that there is something to preview.
    pub fn moves_earth(self) -> bool {
        matches!(self, Self::Crater | Self::Trench | Self::Track | Self::Level | Self::Raise)
    }
}

/// The sizes and words of all tools; each keeps its own while another is used. Lengths in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolSettings {
    /// From a crater's center to the crest of its rim.
    pub radius_m: f64,
    /// Width of a trench at the old ground.
    pub trench_m: f64,
    /// From rut to rut of a track.
    pub gauge_m: f64,
    /// Elevation of level ground; `None` for the mean of the ground in the outline.
    pub level_m: Option<f64>,
    /// Height of a bank or a mound.
    pub height_m: f64,
    /// Depth of a crater, a trench or a track; `None` for the one that suits it.
    pub depth_m: Option<f64>,
    /// Width of a road.
    pub road_m: f64,
    /// Width of a river.
    pub river_m: f64,
    /// What covers an area: a word of the key `cover`.
    pub cover: String,
    /// The model: a built-in one, or a file by its name in the scene file.
    pub model: String,
    /// The heading of its front, degrees clockwise from north.
    pub heading_deg: f64,
    /// The text of a label.
    pub text: String,
    /// What it names: a word of the key `kind` of labels.
    pub label_kind: String,
}

impl ToolSettings {
    /// Sizes for ground whose posts are `cell_m` apart: large enough to show on it.
    pub fn for_cell(cell_m: f64) -> Self {
        /// Cells across the narrowest thing that looks like what it is.
        const CELLS: f64 = 4.0;
        let across_m = (CELLS * cell_m).ceil();
        Self {
            radius_m: across_m.max(10.0),
            trench_m: across_m.max(2.0),
            gauge_m: across_m.max(2.0),
            level_m: None,
            height_m: 3.0,
            depth_m: None,
            road_m: 6.0,
            river_m: 8.0,
            cover: "forest".to_owned(),
            model: "broadleaf".to_owned(),
            heading_deg: 0.0,
            text: String::new(),
            label_kind: "place".to_owned(),
        }
    }
}

/// A tool in use. Places are map coordinates in the scene's system.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingTool {
    /// What it draws.
    pub kind: ToolKind,
    points: Vec<[f64; 2]>,
    hover: Option<[f64; 2]>,
}

impl DrawingTool {
    /// A tool without points.
    pub fn new(kind: ToolKind) -> Self {
        Self { kind, points: Vec::new(), hover: None }
    }

    /// Sets a point; the edit, where that finishes it.
    pub fn click(&mut self, at: [f64; 2], settings: &ToolSettings) -> Option<SceneEdit> {
        // The second click of a double click is the same point.
        if self.points.last() != Some(&at) {
            self.points.push(at);
        }
        if self.kind.shape() == ToolShape::Point { self.finish(settings) } else { None }
    }

    /// The place under the pointer; `None` where that is off the ground.
    pub fn hover(&mut self, at: Option<[f64; 2]>) {
        self.hover = at;
    }

    /// Ends the line or the outline: the edit, where it has points enough. The tool begins anew.
    pub fn finish(&mut self, settings: &ToolSettings) -> Option<SceneEdit> {
        let edit = self.edit_of(&self.points, settings)?;
        self.points.clear();
        Some(edit)
    }

    /// Takes the last point back; `false` where there is none.
    pub fn take_back(&mut self) -> bool {
        self.points.pop().is_some()
    }

    /// The edit as it would be with the place under the pointer; `None` where it has too few points.
    pub fn pending(&self, settings: &ToolSettings) -> Option<SceneEdit> {
        self.edit_of(&self.drawn(), settings)
    }

    /// The points with the place under the pointer, for a line on the picture.
    pub fn drawn(&self) -> Vec<[f64; 2]> {
        let hover = self.hover.filter(|at| self.points.last() != Some(at));
        self.points.iter().copied().chain(hover).collect()
    }

    /// Whether a line or an outline is begun.
    pub fn is_begun(&self) -> bool {
        !self.points.is_empty()
    }

    /// A hint for the user: what to do next.
    pub fn hint(&self) -> &'static str {
        let enough = self.points.len() >= self.kind.shape().least();
        match (self.kind.shape(), self.points.len()) {
            (ToolShape::Point, _) => "Click on the ground",
            (_, 0) => "Click where it begins",
            (ToolShape::Outline, _) if !enough => "Click along the outline",
            (ToolShape::Outline, _) => {
                "Click along the outline; Enter or a double click closes it, Backspace takes a point back"
            }
            _ if !enough => "Click along the line",
            _ => "Click along the line; Enter or a double click ends it, Backspace takes a point back",
        }
    }

    fn edit_of(&self, points: &[[f64; 2]], settings: &ToolSettings) -> Option<SceneEdit> {
        if points.len() < self.kind.shape().least() {
            return None;
        }
        let (at, points) = (points[0], points.to_vec());
        let ToolSettings { depth_m, .. } = *settings;
        let earthwork = |draft| Some(SceneEdit::add_earthwork(&draft, points.clone()));
        match self.kind {
            ToolKind::Crater => earthwork(EarthworkDraft::Crater { radius_m: settings.radius_m, depth_m }),
            ToolKind::Trench => earthwork(EarthworkDraft::Trench { width_m: settings.trench_m, depth_m }),
            ToolKind::Track => {
                // Ruts as wide as a quarter of what lies between them, as those of a truck.
                let (gauge_m, rut_m) = (settings.gauge_m, Some(settings.gauge_m / 4.0));
                earthwork(EarthworkDraft::Track { gauge_m, rut_m, depth_m })
            }
            ToolKind::Level => earthwork(EarthworkDraft::Level { level_m: settings.level_m }),
            ToolKind::Raise => {
                earthwork(EarthworkDraft::Raise { height_m: settings.height_m, width_m: None })
            }
            ToolKind::Road => Some(SceneEdit::add_road(points, settings.road_m)),
            ToolKind::River => Some(SceneEdit::add_river(points, settings.river_m)),
            ToolKind::Area => Some(SceneEdit::add_area(points, &settings.cover)),
            ToolKind::Model => Some(SceneEdit::add_model(&settings.model, at, settings.heading_deg)),
            ToolKind::Label => (!settings.text.is_empty())
                .then(|| SceneEdit::add_label(&settings.text, at, &settings.label_kind)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tool_draws_once_it_has_points_enough() {
        let settings = ToolSettings { text: "Hill".to_owned(), ..ToolSettings::for_cell(10.0) };
        for choice in ToolKind::CHOICES {
            let mut tool = DrawingTool::new(choice.value);
            let least = choice.value.shape().least();
            for number in 1..=4usize {
                let at = [number as f64, (number * number) as f64];
                tool.hover(Some(at));
                assert_eq!(tool.pending(&settings).is_some(), number >= least, "{} {number}", choice.word);
                if let Some(edit) = tool.click(at, &settings) {
                    assert_eq!(choice.value.shape(), ToolShape::Point, "{edit:?}");
                    break;
                }
                assert_eq!(tool.click(at, &settings), None, "a double click adds no point");
            }
            let is_point = choice.value.shape() == ToolShape::Point;
            assert_eq!(tool.finish(&settings).is_none(), is_point, "{}", choice.word);
            assert!(!tool.is_begun());
        }
    }

    #[test]
    fn a_label_without_a_text_is_not_drawn() {
        let settings = ToolSettings::for_cell(1.0);
        assert_eq!(DrawingTool::new(ToolKind::Label).click([0.0, 0.0], &settings), None);
    }

    #[test]
    fn points_are_taken_back_one_by_one() {
        let settings = ToolSettings::for_cell(1.0);
        let mut tool = DrawingTool::new(ToolKind::Trench);
        tool.click([0.0, 0.0], &settings);
        tool.click([9.0, 0.0], &settings);
        assert!(tool.take_back() && tool.finish(&settings).is_none() && tool.is_begun());
        tool.hover(Some([5.0, 5.0]));
        assert_eq!(tool.drawn(), [[0.0, 0.0], [5.0, 5.0]]);
        assert!(tool.take_back() && !tool.take_back());
    }
}
