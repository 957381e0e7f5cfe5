//! An analysis that a user prepares: its kind, a field for each parameter, and the `[[analysis]]` that keeps it.
//!
//! A field holds text, as the command `analyze` takes it, so that what is typed, picked and chosen is read by one reader, and an
//! error is shown at the field that its key names.

use glam::DVec2;

use crate::edit::{EditValue, NewTable, SceneEdit};
use sandtable_analysis::arguments::AnalysisArguments;
use sandtable_base::message::chain::error_text;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::parameter::{AnalysisParameter, EXTENT, ParameterDefault, ParameterForm};
use sandtable_geom::crs::Crs;
use sandtable_query::analysis::{AnalyzeError, WrittenArgument, extent, read};

/// Decimals of picked positions, in meters: far finer than a click, and written into a scene file without loss.
const PICKED_DECIMALS: usize = 1;

/// An analysis that is being prepared.
#[derive(Clone, Debug)]
pub struct AnalysisDraft {
    /// What is analyzed.
    pub kind: &'static AnalysisKind,
    /// Its name in the legend; empty for the kind's title.
    pub name: String,
    /// The parameters, in the order of the catalog.
    pub fields: Vec<DraftField>,
}

/// The field of a parameter.
#[derive(Clone, Debug)]
pub struct DraftField {
    /// The parameter.
    pub parameter: &'static AnalysisParameter,
    /// The value as it is written; empty where none is stated.
    pub text: String,
    /// What is wrong with it; `None` while nothing is known to be.
    pub problem: Option<String>,
}

impl DraftField {
    /// States positions in map coordinates of the scene.
    pub fn set_points(&mut self, points: &[DVec2]) {
        let written = |at: &DVec2| format!("{:.*},{:.*}", PICKED_DECIMALS, at.x, PICKED_DECIMALS, at.y);
        self.set(points.iter().map(written).collect::<Vec<_>>().join("; "));
    }

    /// States a value as it is written.
    pub fn set(&mut self, text: String) {
        (self.text, self.problem) = (text, None);
    }

    /// Whether it states something other than the default.
    fn is_stated(&self) -> bool {
        let text = self.text.trim();
        !text.is_empty() && !matches!(self.parameter.default, ParameterDefault::Value(value) if value == text)
    }
}

impl AnalysisDraft {
    /// The draft of a kind with its defaults.
    pub fn new(kind: &'static AnalysisKind) -> Self {
        let field = |parameter: &'static AnalysisParameter| {
            let text = match parameter.default {
                ParameterDefault::Value(text) => text,
                _ => "",
            };
            DraftField { parameter, text: text.to_owned(), problem: None }
        };
        Self { kind, name: String::new(), fields: kind.all_parameters().map(field).collect() }
    }

    /// The field of a parameter; `None` where the kind has no such parameter.
    pub fn field_mut(&mut self, name: &str) -> Option<&mut DraftField> {
        self.fields.iter_mut().find(|field| field.parameter.name == name)
    }

    /// Its name in the legend.
    pub fn title(&self) -> String {
        let name = self.name.trim();
        if name.is_empty() { self.kind.title } else { name }.to_owned()
    }

    /// The arguments that differ from the defaults, as the command takes them.
    pub fn arguments(&self) -> Vec<WrittenArgument> {
        let stated = self.fields.iter().filter(|field| field.is_stated());
        let argument = |field: &DraftField| WrittenArgument {
            name: field.parameter.name.to_owned(),
            text: field.text.trim().to_owned(),
        };
        stated.map(argument).collect()
    }

    /// Checks every argument alone and notes what is wrong at the fields; whether nothing is. Two numbers are a position in
    /// coordinates of `crs`.
    pub fn check(&mut self, crs: &Crs) -> bool {
        self.fields.iter_mut().for_each(|field| field.problem = None);
        let arguments = self.arguments();
        for argument in &arguments {
            let alone = std::slice::from_ref(argument);
            let checked = match argument.name == EXTENT.name {
                true => extent(alone, crs, crs).map(|_| ()),
                false => read(self.kind, alone, crs, crs).map(|_| ()),
            };
            // What others lack is noted at theirs.
            if let Err(error) = checked.or_else(|error| lack_of_others(error, &argument.name)) {
                self.note(&error);
            }
        }
        for field in &mut self.fields {
            if field.parameter.default == ParameterDefault::Required && field.text.trim().is_empty() {
                field.problem = Some(format!("`{}`: state it", field.parameter.name));
            }
        }
        self.fields.iter().all(|field| field.problem.is_none())
    }

    /// Notes an error at the field that its key names; whether there is one.
    pub fn note(&mut self, error: &AnalyzeError) -> bool {
        let text = error_text(error);
        let Some(field) = error.key().map(str::to_owned).and_then(|key| self.field_mut(&key)) else {
            return false;
        };
        field.problem = Some(text);
        true
    }

    /// The edit that writes it into a scene, whose system is `crs`, as a table `[[analysis]]`.
    ///
    /// # Errors
    /// See [`AnalyzeError`].
    pub fn edit(&self, crs: &Crs) -> Result<SceneEdit, AnalyzeError> {
        let written = self.arguments();
        let arguments = read(self.kind, &written, crs, crs)?;
        let name = self.name.trim();
        let table = NewTable::new("analysis");
        let table = if name.is_empty() { table } else { table.with_text("name", name) };
        let mut table = table.with_text("kind", self.kind.name);
        for WrittenArgument { name, .. } in &written {
            let value = match name == EXTENT.name {
                true => extent_value(&written, crs)?,
                false => self.kind.parameter(name).map(|parameter| value(parameter, &arguments)),
            };
            table = value.into_iter().fold(table, |table, value| table.with(name, value));
        }
        Ok(SceneEdit::Add(table))
    }
}

/// An error of the argument `name`; `Ok` for one of another that is not stated.
fn lack_of_others(error: AnalyzeError, name: &str) -> Result<(), AnalyzeError> {
    if error.key().is_some_and(|key| key != name) { Ok(()) } else { Err(error) }
}

fn value(parameter: &AnalysisParameter, arguments: &AnalysisArguments) -> EditValue {
    let name = parameter.name;
    match parameter.form {
        ParameterForm::Number { .. } => EditValue::Number(arguments.number(name)),
        ParameterForm::Numbers { .. } => EditValue::Numbers(arguments.numbers(name)),
        ParameterForm::Points { .. } | ParameterForm::Line | ParameterForm::Area | ParameterForm::Extent => {
            EditValue::Points(arguments.points(name).iter().map(DVec2::to_array).collect())
        }
        ParameterForm::Word(_) | ParameterForm::Vehicle | ParameterForm::Ground => {
            EditValue::Text(arguments.word(name))
        }
    }
}

/// The corners of a rectangle, or the ring of an area.
fn extent_value(written: &[WrittenArgument], crs: &Crs) -> Result<Option<EditValue>, AnalyzeError> {
    let extent = extent(written, crs, crs)?;
    Ok(extent.map(|extent| {
        let bounds = extent.bounds();
        let points = extent.ring().map_or_else(|| vec![bounds.min, bounds.max], <[DVec2]>::to_vec);
        EditValue::Points(points.iter().map(DVec2::to_array).collect())
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::SceneEditor;
    use std::path::Path;

    fn draft(kind: &str, stated: &[(&str, &str)]) -> AnalysisDraft {
        let mut draft = AnalysisDraft::new(sandtable_catalog::kind(kind).expect("a kind"));
        for (name, text) in stated {
            draft.field_mut(name).expect("a parameter").set((*text).to_owned());
        }
        draft
    }

    #[test]
    fn a_draft_has_a_field_for_every_parameter_with_its_default() {
        for kind in sandtable_catalog::kinds() {
            let draft = AnalysisDraft::new(kind);
            assert_eq!(draft.fields.len(), kind.parameters.len() + 1, "{}", kind.name);
            assert!(draft.arguments().is_empty(), "{}: defaults are not stated", kind.name);
            for field in &draft.fields {
                if let ParameterDefault::Value(text) = field.parameter.default {
                    assert_eq!(field.text, text);
                }
            }
        }
        let slope = draft("slope", &[("unit", " degrees ")]);
        let one = WrittenArgument { name: "unit".into(), text: "degrees".into() };
        assert_eq!(slope.arguments(), [one]);
    }

    #[test]
    fn what_is_wrong_is_noted_at_the_field_of_its_key() {
        let zone = Crs::from_epsg(32616).expect("known");
        let problem = |draft: &mut AnalysisDraft, name: &str| {
            draft.field_mut(name).expect("a parameter").problem.clone().unwrap_or_default()
        };
        let mut time = draft("time", &[("from", "nowhere at all"), ("extent", "1,2"), ("method", "tobler")]);
        assert!(!time.check(&zone));
        assert!(problem(&mut time, "from").contains("`from`"), "{}", problem(&mut time, "from"));
        assert!(problem(&mut time, "extent").contains("one position"), "{}", problem(&mut time, "extent"));
        assert_eq!(problem(&mut time, "method"), "");
        time.field_mut("from").expect("there").set("16S GF 49000 17500".into());
        time.field_mut("extent").expect("there").set(String::new());
        assert!(time.check(&zone), "{:?}", time.fields);
        let mut lacking = draft("time", &[]);
        assert!(!lacking.check(&zone));
        assert_eq!(problem(&mut lacking, "from"), "`from`: state it");
    }

    #[test]
    fn a_draft_is_kept_as_a_table_of_the_scene_and_undone() {
        let path = Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"));
        let mut editor = SceneEditor::open(path, &[], None).expect("readable");
        let scene = editor.source().build(&|_| ()).expect("sound");
        let before = editor.text().to_owned();
        let mut draft = draft("time", &[("vehicle", "wheeled"), ("extent", "748500,4017000,750500,4018500")]);
        draft.name = "From the pass".to_owned();
        let at = [DVec2::new(749_000.04, 4_017_500.06), DVec2::new(749_200.0, 4_017_600.0)];
        draft.field_mut("from").expect("there").set_points(&at);
        assert!(draft.check(&scene.crs), "{:?}", draft.fields);
        let edit = draft.edit(&scene.crs).expect("sound");
        editor.apply(&edit, &scene).expect("sound");
        let table = "[[analysis]]\nname = \"From the pass\"\nkind = \"time\"\n";
        assert!(editor.text().contains(table), "{}", editor.text());
        for line in [
            "from = [[749000, 4017500.1], [749200, 4017600]]\n",
            "vehicle = \"wheeled\"\n",
            "extent = [[748500, 4017000], [750500, 4018500]]\n",
        ] {
            assert!(editor.text().contains(line), "{line} in {}", editor.text());
        }
        let kept = &editor.document().analyses;
        assert_eq!(kept.len(), 1);
        editor.undo().expect("undone");
        assert_eq!(editor.text(), before);
    }

    #[test]
    fn numbers_and_words_are_kept_as_the_scene_file_has_them() {
        let with_numbers = sandtable_catalog::kinds().flat_map(|kind| {
            let numbers = |known: &&AnalysisParameter| matches!(known.form, ParameterForm::Numbers { .. });
            kind.parameters.iter().filter(numbers).map(move |parameter| (kind, parameter))
        });
        let mut tried = 0;
        for (kind, parameter) in with_numbers {
            let ParameterForm::Numbers { least, greatest } = parameter.form else { continue };
            let middle = f64::midpoint(least, greatest).round();
            let text = format!("{},{}", middle, greatest);
            let mut draft = draft(kind.name, &[(parameter.name, &text)]);
            for field in &mut draft.fields {
                if field.parameter.default == ParameterDefault::Required {
                    field.set_points(&[DVec2::ZERO, DVec2::splat(9.0), DVec2::new(9.0, 1.0)]);
                }
            }
            let Ok(SceneEdit::Add(table)) = draft.edit(&Crs::local()) else { continue };
            let value = table.keys.iter().find(|(key, _)| key == parameter.name).map(|(_, value)| value);
            assert_eq!(value, Some(&EditValue::Numbers(vec![middle, greatest])), "{}", kind.name);
            tried += 1;
        }
        assert!(tried > 0);
    }
}
