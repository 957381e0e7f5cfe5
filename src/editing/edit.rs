//! Edits of a scene as values: what to add, set or remove, and where.

use std::fmt;

use glam::DVec2;

use crate::viewed_camera::ViewedCamera;

/// A place in a scene file: outside tables, or a table of a list such as `[[model]]`, by its number there counted from 0.
/// Tables of included files are not counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EditPlace {
    /// The keys outside lists of tables, such as `title` or `style.light.azimuth`.
    Root,
    /// A table of a list.
    Table {
        /// The name of the list, such as `model`.
        name: String,
        /// Its number in the list.
        number: usize,
    },
}

impl EditPlace {
    /// The table of the list `name` with a number, counted from 0.
    pub fn table(name: &str, number: usize) -> Self {
        Self::Table { name: name.to_owned(), number }
    }
}

impl fmt::Display for EditPlace {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => out.write_str("top of the file"),
            Self::Table { name, number } => write!(out, "[[{name}]] number {}", number + 1),
        }
    }
}

/// A value of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub enum EditValue {
    /// Text, a word or an expression.
    Text(String),
    /// A finite number.
    Number(f64),
    /// Several such numbers.
    Numbers(Vec<f64>),
    /// A place in map coordinates of the scene's system; written in the system that the table states.
    Point([f64; 2]),
    /// Several such places.
    Points(Vec<[f64; 2]>),
}

/// A table that is added to a list.
#[derive(Clone, Debug, PartialEq)]
pub struct NewTable {
    /// The name of the list, such as `road`.
    pub name: String,
    /// Its keys in the order in which they are written.
    pub keys: Vec<(String, EditValue)>,
}

impl NewTable {
    /// A table without keys.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), keys: Vec::new() }
    }

    /// This table with one more key.
    #[must_use]
    pub fn with(mut self, key: &str, value: EditValue) -> Self {
        self.keys.push((key.to_owned(), value));
        self
    }

    /// This table with one more key, whose value is a text.
    #[must_use]
    pub fn with_text(self, key: &str, text: &str) -> Self {
        self.with(key, EditValue::Text(text.to_owned()))
    }

    /// This table with one more key, whose value is a number.
    #[must_use]
    pub fn with_number(self, key: &str, number: f64) -> Self {
        self.with(key, EditValue::Number(number))
    }
}

/// A change of a scene. Places are map coordinates in the scene's system.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneEdit {
    /// Adds a table to a list, after those that are there.
    Add(NewTable),
    /// Sets a value: replaces the one that is stated, or states it.
    Set {
        /// The table, or the top of the file.
        place: EditPlace,
        /// The key, with those of the tables that it lies in: `["style", "light", "azimuth"]`.
        keys: Vec<String>,
        /// The value.
        value: EditValue,
    },
    /// Removes a table of a list.
    Remove(EditPlace),
    /// Several edits that are applied and undone as one.
    Together(Vec<SceneEdit>),
}

/// The shapes of earthworks that a user draws; sizes in meters, those that are `None` have the scene file's defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EarthworkDraft {
    /// A crater at one place.
    Crater {
        /// From its center to the crest of its rim.
        radius_m: f64,
        /// Down to its bottom.
        depth_m: Option<f64>,
    },
    /// A trench along a line.
    Trench {
        /// Width at the old ground.
        width_m: f64,
        /// Down to its bottom.
        depth_m: Option<f64>,
    },
    /// The track of a vehicle along a line.
    Track {
        /// From rut to rut.
        gauge_m: f64,
        /// Width of a rut.
        rut_m: Option<f64>,
        /// Down to its bottom.
        depth_m: Option<f64>,
    },
    /// Level ground in an outline.
    Level {
        /// Its elevation.
        level_m: Option<f64>,
    },
    /// A bank along a line, a mound at one place.
    Raise {
        /// Above the ground under each point.
        height_m: f64,
        /// Width of the crown.
        width_m: Option<f64>,
    },
}

impl SceneEdit {
    /// Adds an earthwork with its points: the centers of craters, a line, or an outline.
    pub fn add_earthwork(draft: &EarthworkDraft, points: Vec<[f64; 2]>) -> Self {
        let (kind, sizes): (&str, Vec<(&str, Option<f64>)>) = match *draft {
            EarthworkDraft::Crater { radius_m, depth_m } => {
                ("crater", vec![("radius", Some(radius_m)), ("depth", depth_m)])
            }
            EarthworkDraft::Trench { width_m, depth_m } => {
                ("trench", vec![("width", Some(width_m)), ("depth", depth_m)])
            }
            EarthworkDraft::Track { gauge_m, rut_m, depth_m } => {
                ("track", vec![("width", Some(gauge_m)), ("rut", rut_m), ("depth", depth_m)])
            }
            EarthworkDraft::Level { level_m } => ("level", vec![("level", level_m)]),
            EarthworkDraft::Raise { height_m, width_m } => {
                ("raise", vec![("height", Some(height_m)), ("width", width_m)])
            }
        };
        let table =
            NewTable::new("earthwork").with_text("kind", kind).with("points", EditValue::Points(points));
        let stated = sizes.into_iter().filter_map(|(key, size_m)| Some((key, size_m?)));
        Self::Add(stated.fold(table, |table, (key, size_m)| table.with_number(key, size_m)))
    }

    /// Adds a model: a file, or the name of a built-in one.
    pub fn add_model(file: &str, at: [f64; 2], heading_deg: f64) -> Self {
        let table = NewTable::new("model").with_text("file", file).with("at", EditValue::Point(at));
        Self::Add(table.with_number("heading", heading_deg))
    }

    /// Moves the model with a number.
    pub fn move_model(number: usize, at: [f64; 2]) -> Self {
        Self::set(EditPlace::table("model", number), "at", EditValue::Point(at))
    }

    /// Turns the model with a number: the direction of its front, clockwise from north.
    pub fn turn_model(number: usize, heading_deg: f64) -> Self {
        Self::set(EditPlace::table("model", number), "heading", EditValue::Number(heading_deg))
    }

    /// Adds a label; `kind` is a word of the key `kind`.
    pub fn add_label(text: &str, at: [f64; 2], kind: &str) -> Self {
        let table = NewTable::new("label").with_text("text", text).with("at", EditValue::Point(at));
        Self::Add(table.with_text("kind", kind))
    }

    /// Adds a road along a line of at least two points.
    pub fn add_road(points: Vec<[f64; 2]>, width_m: f64) -> Self {
        let table = NewTable::new("road").with("points", EditValue::Points(points));
        Self::Add(table.with_number("width", width_m))
    }

    /// Adds a river along a line of at least two points, from its source to its mouth.
    pub fn add_river(points: Vec<[f64; 2]>, width_m: f64) -> Self {
        let table = NewTable::new("river").with("points", EditValue::Points(points));
        Self::Add(table.with_number("width", width_m))
    }

    /// Adds an area in an outline of at least three points; `cover` is a word of the key `cover`.
    pub fn add_area(points: Vec<[f64; 2]>, cover: &str) -> Self {
        Self::Add(NewTable::new("area").with("points", EditValue::Points(points)).with_text("cover", cover))
    }

    /// Adds a camera in perspective.
    pub fn add_camera(name: &str, camera: &ViewedCamera) -> Self {
        let place = |at: DVec2| EditValue::Point(at.to_array());
        let table = NewTable::new("camera").with_text("name", name).with("eye", place(camera.eye));
        let table = table.with_number("eye_elevation", camera.eye_elevation_m);
        let table = table.with("look_at", place(camera.look_at));
        let table = table.with_number("look_at_height", camera.look_at_height_m);
        Self::Add(table.with_number("field_of_view", camera.field_of_view_deg))
    }

    /// Sets a value outside lists of tables by its dotted key, such as `style.light.azimuth`.
    pub fn set_value(dotted: &str, value: EditValue) -> Self {
        let keys = dotted.split('.').map(str::to_owned).collect();
        Self::Set { place: EditPlace::Root, keys, value }
    }

    /// Sets a key of a table.
    pub fn set(place: EditPlace, key: &str, value: EditValue) -> Self {
        Self::Set { place, keys: vec![key.to_owned()], value }
    }
}
