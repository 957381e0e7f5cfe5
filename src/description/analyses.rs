//! The scene file's tables of analyses and vehicles.
//!
//! The keys of `[[analysis]]` beside `kind` are the parameters of the kinds in the catalog: a kind that the catalog gains is
//! one that scene files know.

use std::sync::LazyLock;

use crate::bounds::Bounds::{self, Above, Within};
use crate::color::Color;
use crate::declaration::{KeyDeclaration, KeyKind, Presence};
use crate::finding_code::FindingCode;
use crate::key;
use crate::reader::TableReader;
use crate::stated::Stated;
use crate::table::Table;
use crate::table_key;
use crate::value::KeyValue;
use crate::words::{AnalysisDraw, BuiltInVehicle, WordDeclaration};
use sandtable_base::message::suggest::listed;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::parameter::{
    AnalysisParameter, PHASE_PREFIX, ParameterDefault, ParameterForm, SOURCE_GROUND,
};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

table! {
    /// `[[analysis]]`: what the ground allows, as a tint with hatching, lines, areas and places, and tables on a sheet.
    struct AnalysisTable {
        /// Name in the legend.
        name: Option<String> = key::text(), otherwise "the kind's title";
        /// What is analyzed; decides the keys of the table besides these. `sandtable analyze KIND --help` tells of each kind
        /// its source and its limits.
        kind: Stated<&'static AnalysisKind> = key::analysis_kind(), required;
        /// What pictures show of it.
        draw: AnalysisDraw = key::word::<AnalysisDraw>(), default "all";
        /// Color of its lines, areas and marks.
        color: Option<Color> = key::color(), otherwise "by what they are; routes and avenues in turn";
        /// Coordinate system of positions.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`";
        /// The parameters of the kind.
        arguments: DescribedArguments = table_key::analysis_arguments(), inline;
    }

    /// `[vehicle.NAME]`: a vehicle, or people on foot, by which analyses reckon movement. A stated name goes before that of a
    /// built-in vehicle.
    struct VehicleTable {
        /// The built-in vehicle whose numbers hold where none are stated.
        like: BuiltInVehicle = key::word::<BuiltInVehicle>(), default "wheeled";
        /// Slopes uphill: up to the first it goes freely, up to the second slowly, above that not.
        slope_up_percent: Option<[f64; 2]> = key::number_range(SLOPES, "%"), otherwise "by `like`";
        /// The same downhill.
        slope_down_percent: Option<[f64; 2]> = key::number_range(SLOPES, "%"), otherwise "by `like`";
        /// The same across its way.
        slope_across_percent: Option<[f64; 2]> = key::number_range(SLOPES, "%"), otherwise "by `like`";
        /// Its speed on level open ground.
        speed_kmh: Option<f64> = key::number(Within(0.1, 300.0), "km/h"), otherwise "by `like`";
        /// Its greatest speeds on a path, a track, a road, a main road and a motorway; 0 where it cannot go.
        road_speed_kmh: Option<Stated<Vec<f64>>> = key::numbers(Within(0.0, 300.0), "km/h"), otherwise "by `like`";
        /// Its speed in built-up ground beside roads; 0 where it cannot go.
        built_up_kmh: Option<f64> = key::number(Within(0.0, 300.0), "km/h"), otherwise "by `like`";
        /// The depth of water that it wades.
        ford_m: Option<f64> = key::number(SIZE, "m"), otherwise "by `like`";
        /// The width of a gap that it crosses.
        gap_m: Option<f64> = key::number(SIZE, "m"), otherwise "by `like`";
        /// The height of a step that it climbs.
        step_m: Option<f64> = key::number(SIZE, "m"), otherwise "by `like`";
        /// Its width.
        width_m: Option<f64> = key::number(SIZE, "m"), otherwise "by `like`";
        /// The diameter of stems that it pushes over.
        stem_m: Option<f64> = key::number(SIZE, "m"), otherwise "by `like`";
        /// Its mass with its load.
        mass_t: Option<f64> = key::number(SIZE, "t"), otherwise "by `like`";
    }
    check(reader) {
        let speeds = road_speed_kmh.as_ref().and_then(|stated: &Option<Stated<Vec<f64>>>| stated.as_ref());
        if let Some(stated) = speeds.filter(|speeds| speeds.len() != ROAD_CLASSES) {
            let message = format!("`road_speed_kmh` has {} speeds", stated.len());
            let help = format!("write {ROAD_CLASSES}: on a path, a track, a road, a main road and a motorway");
            reader.coded(FindingCode::WrongValue, stated.span().unwrap_or_default(), message, help);
        }
    }
}

/// Slopes that a vehicle takes, percent.
const SLOPES: Bounds = Above(0.0, 200.0);
/// Depths, widths, heights, diameters and masses.
const SIZE: Bounds = Within(0.0, 10_000.0);
/// The classes of roads that have a speed.
const ROAD_CLASSES: usize = 5;

/// The arguments that an `[[analysis]]` states.
#[derive(Clone, Debug, Default)]
pub struct DescribedArguments(pub Vec<DescribedArgument>);

/// An argument of an analysis.
#[derive(Clone, Debug)]
pub struct DescribedArgument {
    /// Its parameter.
    pub parameter: &'static AnalysisParameter,
    /// Its value.
    pub value: Stated<DescribedValue>,
}

/// The value of an argument, in the form of its parameter.
#[derive(Clone, Debug)]
pub enum DescribedValue {
    /// A number.
    Number(f64),
    /// Rising numbers.
    Numbers(Vec<f64>),
    /// One of the parameter's words, the name of a vehicle, or the name of a file.
    Word(String),
    /// Positions.
    Places(Vec<Stated<Position>>),
}

impl DescribedArguments {
    /// The argument of this name; `None` where it is not stated.
    pub fn get(&self, name: &str) -> Option<&DescribedArgument> {
        self.0.iter().find(|argument| argument.parameter.name == name)
    }
}

impl Table for DescribedArguments {
    const KEYS: &'static [KeyDeclaration] = &[];

    fn read(reader: &mut TableReader<'_, '_>) -> Option<Self> {
        let kind = reader.word("kind").and_then(sandtable_catalog::kind)?;
        let mut arguments = Some(Vec::new());
        for parameter in kind.all_parameters() {
            let read = |value: KeyValue<'_, '_>| value.argument(parameter.form);
            match reader.read_with(parameter.name, read) {
                Some(Some(value)) => {
                    if let Some(list) = &mut arguments {
                        list.push(DescribedArgument { parameter, value });
                    }
                }
                Some(None) => arguments = None,
                None if parameter.default == ParameterDefault::Required => {
                    reader.lacks(parameter.name);
                    arguments = None;
                }
                None => {}
            }
        }
        let names: Vec<&str> = kind.all_parameters().map(|parameter| parameter.name).collect();
        let others = argument_keys().iter().map(|key| key.name).filter(|name| !names.contains(name));
        let help = match names[..] {
            [] => "remove it".to_owned(),
            _ => format!("{} knows {}", kind.name, listed(&names).replace(" or ", " and ")),
        };
        let others: Vec<&str> = others.collect();
        reader.without_effect(&others, &format!("on the analysis {}", kind.name), &help);
        arguments.map(Self)
    }
}

impl KeyValue<'_, '_> {
    /// One of the kinds of the catalog.
    pub fn analysis_kind(mut self) -> Option<&'static AnalysisKind> {
        let text = self.element(self.value).filled_text()?;
        sandtable_catalog::kind(&text).or_else(|| {
            let names: Vec<&str> = sandtable_catalog::kinds().map(|kind| kind.name).collect();
            self.none_of(&text, &names)
        })
    }

    /// The value of an argument of this form.
    fn argument(mut self, form: ParameterForm) -> Option<DescribedValue> {
        match form {
            ParameterForm::Number { least, greatest } => {
                self.number(Within(least, greatest)).map(DescribedValue::Number)
            }
            ParameterForm::Numbers { least, greatest } => {
                let numbers = self.element(self.value).numbers(Within(least, greatest))?;
                match numbers.is_sorted_by(|low, high| low < high) && !numbers.is_empty() {
                    true => Some(DescribedValue::Numbers(numbers)),
                    false => {
                        let message = format!("`{}` must rise from number to number", self.key);
                        self.wrong(message, "write each number greater than the one before")
                    }
                }
            }
            ParameterForm::Word(words) => {
                let text = self.element(self.value).filled_text()?;
                match words.contains(&text.as_str()) {
                    true => Some(DescribedValue::Word(text)),
                    false => self.none_of(&text, words),
                }
            }
            ParameterForm::Vehicle => self.filled_text().map(DescribedValue::Word),
            ParameterForm::Ground => {
                let text = self.element(self.value).filled_text()?;
                let is_file = text != SOURCE_GROUND && !text.starts_with(PHASE_PREFIX);
                if is_file { self.file() } else { Some(text) }.map(DescribedValue::Word)
            }
            ParameterForm::Points { least } => self.place_or_places(least).map(DescribedValue::Places),
            ParameterForm::Line => self.places(2).map(DescribedValue::Places),
            ParameterForm::Area => self.places(3).map(DescribedValue::Places),
            ParameterForm::Extent => self.places(2).map(DescribedValue::Places),
        }
    }
}

/// The kinds of analyses as words of a key.
pub(super) fn kind_words() -> Vec<WordDeclaration> {
    let word = |kind: &'static AnalysisKind| WordDeclaration {
        word: kind.name,
        doc: kind.summary.trim_end_matches('.'),
    };
    sandtable_catalog::kinds().map(word).collect()
}

/// The keys of `[[analysis]]` that are parameters of kinds, each once, in the order of the catalog.
pub(super) fn argument_keys() -> &'static [KeyDeclaration] {
    static KEYS: LazyLock<Vec<KeyDeclaration>> = LazyLock::new(|| {
        let mut names: Vec<&'static str> = Vec::new();
        for parameter in sandtable_catalog::kinds().flat_map(AnalysisKind::all_parameters) {
            if !names.contains(&parameter.name) {
                names.push(parameter.name);
            }
        }
        names.into_iter().map(argument_key).collect()
    });
    &KEYS
}

/// The declaration of the parameters of one name: what each says, and of which kinds.
fn argument_key(name: &'static str) -> KeyDeclaration {
    let mut forms: Vec<ParameterForm> = Vec::new();
    let mut units: Vec<&str> = Vec::new();
    // Documentation and default, with the kinds that have them.
    let mut docs: Vec<(&AnalysisParameter, Vec<&str>)> = Vec::new();
    for kind in sandtable_catalog::kinds() {
        let Some(parameter) = kind.all_parameters().find(|parameter| parameter.name == name) else {
            continue;
        };
        if !forms.contains(&parameter.form) {
            forms.push(parameter.form);
        }
        if !units.contains(&parameter.unit) {
            units.push(parameter.unit);
        }
        let same = |(other, _): &&mut (&AnalysisParameter, Vec<&str>)| {
            other.doc == parameter.doc && other.default == parameter.default
        };
        match docs.iter_mut().find(same) {
            Some((_, kinds)) => kinds.push(kind.name),
            None => docs.push((parameter, vec![kind.name])),
        }
    }
    let says = |(parameter, kinds): &(&AnalysisParameter, Vec<&str>)| {
        let kinds: Vec<String> = kinds.iter().map(|kind| format!("`{kind}`")).collect();
        let default = match parameter.default {
            _ if docs.len() == 1 => String::new(),
            ParameterDefault::Required => " Needed.".to_owned(),
            ParameterDefault::Value(text) | ParameterDefault::Otherwise(text) => format!(" Default: {text}."),
        };
        match docs.len() == 1 && kinds.len() == sandtable_catalog::kinds().count() {
            true => parameter.doc.to_owned(),
            false => format!("Of {}: {}{default}", kinds.join(", "), parameter.doc),
        }
    };
    let doc = docs.iter().map(says).collect::<Vec<_>>().join(" ");
    let default = match docs[..] {
        [(parameter, _)] if parameter.default == ParameterDefault::Required => "needed",
        [(parameter, _)] => parameter.default_text(),
        _ => "by `kind`",
    };
    // Made once for a program's life.
    KeyDeclaration {
        name,
        doc: Box::leak(doc.into_boxed_str()),
        kind: KeyKind::Argument(Box::leak(forms.into_boxed_slice())),
        unit: if units.len() == 1 { units[0] } else { "" },
        presence: Presence::Otherwise(default),
        rivals: &[],
    }
}
