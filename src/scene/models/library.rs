//! The models that a document names, each read once: files and built-in models.
//!
//! In `file`, `variants` and `of` the bare name of a built-in model is that model; any other text is the path of a file. A
//! file of such a name is written with `./`.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::Range;

use crate::assets::Assets;
use crate::builder::SceneBuilder;
use crate::footprint::ModelFootprint;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::Clamp;
use sandtable_model::Model;
use sandtable_model::{built_in, read};

/// The origin of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelOrigin {
    File,
    BuiltIn,
}

/// Models by their names in the document.
pub struct Library<'a> {
    document: &'a Document,
    assets: &'a Assets,
    models: Vec<Model>,
    about: Vec<(ModelFootprint, ModelOrigin)>,
    known: BTreeMap<String, usize>,
}

impl<'a> Library<'a> {
    /// An empty library that reads through `assets`.
    pub fn new(document: &'a Document, assets: &'a Assets) -> Self {
        Self { document, assets, models: Vec::new(), about: Vec::new(), known: BTreeMap::new() }
    }

    /// The index of the model called `name`, read on first use; its notes are added to those of the scene.
    ///
    /// # Errors
    /// The file cannot be read; the error points at `span`.
    pub fn get(
        &mut self,
        name: &str,
        span: Option<Range<usize>>,
        collected: &mut SceneBuilder,
    ) -> Result<usize, Diagnostic> {
        if let Some(&model) = self.known.get(name) {
            return Ok(model);
        }
        let (model, origin) = match built_in::by_name(name) {
            Some(model) => (model, ModelOrigin::BuiltIn),
            None => (self.load(name, span.clone())?, ModelOrigin::File),
        };
        for note in &model.notes {
            let span = span.clone().unwrap_or_default();
            let is_texture = note.starts_with("texture '");
            let code = if is_texture { FindingCode::TextureMissing } else { FindingCode::ModelRead };
            collected.findings.add(code, span, format!("{name}: {note}"));
        }
        self.about.push((ModelFootprint::of(&model), origin));
        self.models.push(model);
        self.known.insert(name.to_owned(), self.models.len() - 1);
        Ok(self.models.len() - 1)
    }

    fn load(&self, name: &str, span: Option<Range<usize>>) -> Result<Model, Diagnostic> {
        let read = || -> Result<Model, Box<dyn Error + Send + Sync>> {
            let bytes = self.assets.read(name)?;
            Ok(read::read(name, &bytes, &self.assets.beside(name)?)?)
        };
        read().map_err(|cause| {
            let error = self.document.error_at(span.unwrap_or_default(), cause);
            if name.contains(['.', '/', '\\']) {
                return error;
            }
            error.with_help(format!("the built-in models are {}", built_in::NAMES.join(", ")))
        })
    }

    /// The footprint of a model.
    pub fn footprint(&self, model: usize) -> &ModelFootprint {
        &self.about[model].0
    }

    /// The reference of a model's height. A built-in model stands on the ground by its origin, since its root lies
    /// below that.
    pub fn clamp(&self, model: usize, stated: Clamp) -> Clamp {
        match (stated, self.about[model].1) {
            (Clamp::Ground, ModelOrigin::BuiltIn) => Clamp::Relative,
            _ => stated,
        }
    }

    /// The greatest distance of a model from its origin in plan, in its own units.
    pub fn reach(&self, model: usize) -> f32 {
        let bounds = self.models[model].bounds();
        bounds.map_or(0.0, |bounds| bounds.min.abs().max(bounds.max.abs()).truncate().max_element())
    }

    /// All models, in the order of their indices.
    pub fn into_models(self) -> Vec<Model> {
        self.models
    }
}
