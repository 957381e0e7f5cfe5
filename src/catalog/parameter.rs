//! Parameters of an analysis.

/// A parameter: a key of `[[analysis]]`, an option of the command, a query of the service.
#[derive(Debug)]
pub struct AnalysisParameter {
    /// The key, in `snake_case`; the command line writes `-` for `_`.
    pub name: &'static str,
    /// What values it takes.
    pub form: ParameterForm,
    /// The unit of its numbers; empty where they have none.
    pub unit: &'static str,
    /// What holds where it is not stated.
    pub default: ParameterDefault,
    /// What it says, a sentence.
    pub doc: &'static str,
}

/// The values that a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterForm {
    /// A number from `least` to `greatest`.
    Number {
        /// The smallest that is allowed.
        least: f64,
        /// The largest.
        greatest: f64,
    },
    /// One number or more, rising, each from `least` to `greatest`.
    Numbers {
        /// The smallest that is allowed.
        least: f64,
        /// The largest.
        greatest: f64,
    },
    /// One of these words.
    Word(&'static [&'static str]),
    /// At least so many positions.
    Points {
        /// The fewest that are allowed.
        least: usize,
    },
    /// A line through at least two positions.
    Line,
    /// A ring of at least three positions, closed by itself.
    Area,
    /// The name of a vehicle: one of the scene's `[vehicle.NAME]`, or a built-in one.
    Vehicle,
    /// Another ground to compare with: an elevation file, [`SOURCE_GROUND`], or a phase after [`PHASE_PREFIX`].
    Ground,
    /// A part of the land: `x0,y0,x1,y1`, two positions at opposite corners, or an area of three positions or more.
    Extent,
}

impl ParameterForm {
    /// Whether its values are positions, which can be picked on the ground.
    pub const fn is_positions(self) -> bool {
        matches!(self, Self::Points { .. } | Self::Line | Self::Area | Self::Extent)
    }
}

/// The word for the elevation before the scene's earthworks.
pub const SOURCE_GROUND: &str = "source";

/// What the name of a phase of the scene follows, whose ground is meant.
pub const PHASE_PREFIX: &str = "phase:";

/// The parameter of every kind that limits an analysis to a part of the land.
pub const EXTENT: AnalysisParameter = AnalysisParameter::plain(
    "extent",
    ParameterForm::Extent,
    ParameterDefault::Otherwise("the whole land"),
    "The part of the land that the answer is about: x0,y0,x1,y1, two positions at opposite corners, or an area of three or more.",
);

/// What holds where a parameter is not stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterDefault {
    /// It must be stated.
    Required,
    /// This value, as it is written.
    Value(&'static str),
    /// No value; the text says what then holds.
    Otherwise(&'static str),
}

impl AnalysisParameter {
    /// A parameter with a number in a unit.
    pub const fn number(
        name: &'static str,
        (least, greatest): (f64, f64),
        unit: &'static str,
        default: ParameterDefault,
        doc: &'static str,
    ) -> Self {
        Self { name, form: ParameterForm::Number { least, greatest }, unit, default, doc }
    }

    /// A parameter with rising numbers in a unit.
    pub const fn numbers(
        name: &'static str,
        (least, greatest): (f64, f64),
        unit: &'static str,
        default: ParameterDefault,
        doc: &'static str,
    ) -> Self {
        Self { name, form: ParameterForm::Numbers { least, greatest }, unit, default, doc }
    }

    /// A parameter with one of `words`, the default among them.
    pub const fn word(
        name: &'static str,
        words: &'static [&'static str],
        default: &'static str,
        doc: &'static str,
    ) -> Self {
        let default = ParameterDefault::Value(default);
        Self { name, form: ParameterForm::Word(words), unit: "", default, doc }
    }

    /// A parameter of another form, without a unit.
    pub const fn plain(
        name: &'static str,
        form: ParameterForm,
        default: ParameterDefault,
        doc: &'static str,
    ) -> Self {
        Self { name, form, unit: "", default, doc }
    }

    /// The default as it is written, or what holds without one; empty where the parameter is required.
    pub const fn default_text(&self) -> &'static str {
        match self.default {
            ParameterDefault::Required => "",
            ParameterDefault::Value(text) | ParameterDefault::Otherwise(text) => text,
        }
    }
}
