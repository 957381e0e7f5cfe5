//! What an analysis gives: a raster, features, tables and figures, with units and notes.

use glam::DVec2;
use rayon::prelude::*;

use crate::round_classes::round_classes;

use crate::tally::FigureTally;

/// What an analysis gives.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// A value for each post.
    pub raster: Option<OutcomeRaster>,
    /// Points, lines and areas, in drawing order.
    pub features: Vec<OutcomeFeature>,
    /// Tables, such as the legs of a route.
    pub tables: Vec<OutcomeTable>,
    /// Single numbers, such as an area.
    pub figures: Vec<Figure>,
    /// What figures and tables are made of, where a kind can be parted.
    pub tally: FigureTally,
    /// What it left out or does not know, a sentence each.
    pub notes: Vec<String>,
}

/// A value for each post of the land, row by row from the south-west.
#[derive(Clone, Debug)]
pub struct OutcomeRaster {
    /// What the values are, such as `slope`.
    pub name: &'static str,
    /// Their unit; empty where they have none.
    pub unit: &'static str,
    /// The values.
    pub values: PostValues,
    /// How a picture divides them; rising, without gaps. Empty where [`OutcomeRaster::with_classes`] makes them.
    pub classes: Vec<ValueClass>,
}

impl Outcome {
    /// With classes of round numbers where the raster has none of its own.
    pub fn with_classes(self) -> Self {
        Self { raster: self.raster.map(OutcomeRaster::with_classes), ..self }
    }
}

impl OutcomeRaster {
    /// The number of posts that have no class, in [`OutcomeRaster::class_numbers`].
    pub const NO_CLASS: u16 = u16::MAX;

    /// With classes of round numbers over the range of its values where it has none of its own.
    pub fn with_classes(self) -> Self {
        let classes = if self.classes.is_empty() { round_classes(&self) } else { self.classes };
        Self { classes, ..self }
    }

    /// The class of a value; `None` below the first, and of no data.
    pub fn class_of(&self, value: f32) -> Option<usize> {
        // Not a number is below every class.
        self.classes.partition_point(|class| class.from <= value).checked_sub(1).filter(|_| !value.is_nan())
    }

    /// The number of each post's class; [`OutcomeRaster::NO_CLASS`] where it has none.
    pub fn class_numbers(&self) -> Vec<u16> {
        let number = |value: f32| self.class_of(value).map_or(Self::NO_CLASS, |class| class as u16);
        match &self.values {
            PostValues::Numbers(values) => {
                let values = values.par_iter().with_min_len(Self::CLASSED_TOGETHER);
                values.map(|&value| number(value)).collect()
            }
            PostValues::Codes(codes) => {
                let of_codes: Vec<u16> = (0..=u8::MAX)
                    .map(
                        |code| if code == PostValues::NO_CODE { Self::NO_CLASS } else { number(code.into()) },
                    )
                    .collect();
                let number = |&code: &u8| of_codes[usize::from(code)];
                codes.par_iter().with_min_len(Self::CLASSED_TOGETHER).map(number).collect()
            }
        }
    }

    /// Which of its classes a post has.
    pub fn held_classes(&self) -> Vec<bool> {
        let none = || vec![false; self.classes.len()];
        let numbers = self.class_numbers();
        let held = |few: &[u16]| {
            let mut held = none();
            few.iter()
                .filter(|&&class| class != Self::NO_CLASS)
                .for_each(|&class| held[usize::from(class)] = true);
            held
        };
        let either = |a: Vec<bool>, b: Vec<bool>| a.iter().zip(b).map(|(a, b)| *a || b).collect();
        numbers.par_chunks(Self::CLASSED_TOGETHER).map(held).reduce(none, either)
    }

    /// Posts that a thread finds the classes of together.
    const CLASSED_TOGETHER: usize = 1 << 16;
}

/// Values of posts.
#[derive(Clone, Debug, PartialEq)]
pub enum PostValues {
    /// Numbers; NaN is no data.
    Numbers(Vec<f32>),
    /// Codes; [`PostValues::NO_CODE`] is no data.
    Codes(Vec<u8>),
}

impl PostValues {
    /// The code of posts without data.
    pub const NO_CODE: u8 = 255;

    /// The number of posts.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Codes(codes) => codes.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a post; NaN where it has no data.
    #[inline]
    pub fn value(&self, index: usize) -> f32 {
        match self {
            Self::Numbers(values) => values[index],
            Self::Codes(codes) if codes[index] == Self::NO_CODE => f32::NAN,
            Self::Codes(codes) => f32::from(codes[index]),
        }
    }
}

/// Values that a picture shows alike: from `from`, below the next class's.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueClass {
    /// The least value of the class.
    pub from: f32,
    /// Its name in legends.
    pub label: String,
    /// How it is drawn.
    pub look: ClassLook,
}

impl ValueClass {
    /// The class of values from `from` on.
    pub fn new(from: f32, label: impl Into<String>, tint: [u8; 4], hatching: Hatching) -> Self {
        Self { from, label: label.into(), look: ClassLook { tint, hatching } }
    }

    /// The classes of the rows of a table: least value, label, tint, hatching.
    pub fn of_rows<const N: usize>(rows: [(f32, &str, [u8; 4], Hatching); N]) -> Vec<Self> {
        rows.map(|(from, label, tint, hatching)| Self::new(from, label, tint, hatching)).into()
    }
}

/// How a class is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassLook {
    /// The tint: red, green, blue and opacity; all zeros for none.
    pub tint: [u8; 4],
    /// Its hatching, which alone shows it in black on white.
    pub hatching: Hatching,
}

/// Hatching of an area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hatching {
    /// None.
    #[default]
    None,
    /// Lines in one direction: restricted ground.
    Single,
    /// Lines in two directions: severely restricted ground.
    Crossed,
    /// Dots.
    Dots,
    /// Level lines: water.
    Level,
}

/// A point, line or area.
#[derive(Clone, Debug)]
pub struct OutcomeFeature {
    /// Its shape, in map coordinates.
    pub shape: OutcomeShape,
    /// Its name on pictures; may be empty.
    pub name: String,
    /// How it is drawn.
    pub role: FeatureRole,
    /// Its properties, by name, in order.
    pub properties: Vec<(&'static str, PropertyValue)>,
}

/// The shape of a feature, in map coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum OutcomeShape {
    /// A point.
    Point(DVec2),
    /// A line of two positions or more.
    Line(Vec<DVec2>),
    /// Rings, the outer one first and counter-clockwise, holes clockwise, each without its closing position.
    Area(Vec<Vec<DVec2>>),
}

/// How a feature is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureRole {
    /// A place: a cross with its name.
    Place,
    /// An observer, a weapon, a radar: a dot in a ring.
    Post,
    /// A route: a strong line with way-points.
    Route,
    /// A corridor or an avenue: an arrow as wide as the ground.
    Corridor,
    /// What is carried from one place to another: a thin arrow.
    Haul,
    /// A line of equal value.
    Isoline,
    /// A stream; its property `order` gives its width.
    Stream,
    /// A ridge or valley line.
    FormLine,
    /// A site: an outline, filled lightly.
    Site,
    /// An outline without fill.
    Outline,
    /// A line of a graph in sight of each other (green) or not (red, dashed), by its property `seen`.
    Link,
}

/// The value of a property.
#[derive(Clone, Debug, PartialEq)]
pub enum PropertyValue {
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(i64),
    /// Text.
    Text(String),
    /// True or false.
    Truth(bool),
}

impl PropertyValue {
    /// It as text, a number with so many decimals.
    pub fn written(&self, decimals: usize) -> String {
        match self {
            Self::Number(number) => format!("{number:.decimals$}"),
            Self::Whole(number) => number.to_string(),
            Self::Text(text) => text.clone(),
            Self::Truth(truth) => if *truth { "yes" } else { "no" }.to_owned(),
        }
    }
}

/// A table.
#[derive(Clone, Debug)]
pub struct OutcomeTable {
    /// Its title.
    pub title: String,
    /// The heading of each column, with its unit, such as `km`.
    pub columns: Vec<TableColumn>,
    /// Its rows, a cell for each column.
    pub rows: Vec<Vec<PropertyValue>>,
}

impl OutcomeTable {
    /// The cells of each row as text, with the decimals of their columns.
    pub fn written_rows(&self) -> impl Iterator<Item = Vec<String>> {
        let cells = |row: &Vec<PropertyValue>| {
            row.iter().zip(&self.columns).map(|(value, column)| value.written(column.decimals)).collect()
        };
        self.rows.iter().map(cells)
    }
}

/// The heading of columns of grid references, such as `16S GF 5000 1800`.
pub const GRID_REFERENCE: &str = "grid reference";

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableColumn {
    /// Its heading.
    pub name: &'static str,
    /// The unit; empty where it has none.
    pub unit: &'static str,
    /// Decimals of its numbers on sheets.
    pub decimals: usize,
    /// Whether its cells are the names of features, such as the numbers of posts.
    pub is_of_marks: bool,
}

impl TableColumn {
    /// A column with this heading.
    pub const fn new(name: &'static str, unit: &'static str, decimals: usize) -> Self {
        Self { name, unit, decimals, is_of_marks: false }
    }

    /// A column of names of features.
    pub const fn of_marks(name: &'static str) -> Self {
        Self { name, unit: "", decimals: 0, is_of_marks: true }
    }
}

/// What numbers are, with their unit in brackets where they have one: `length (km)`.
pub fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// A number about the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it is.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
}

impl Figure {
    /// The figure of this name.
    pub fn new(name: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { name: name.into(), value, unit }
    }
}
