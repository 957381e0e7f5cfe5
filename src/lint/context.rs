//! The data that a check may read.

use std::ops::Range;

use sandtable_description::document::Document;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::FeatureId;
use sandtable_scene::feature::{FeatureKind, SceneFeature};
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::sources::Sources;
use sandtable_scene::symbols::LineSymbol;

/// A scene with the document and the files that it was built of.
pub struct LintContext<'a> {
    /// The scene file, as it was read.
    pub document: &'a Document,
    /// The scene.
    pub scene: &'a SceneModel,
    /// Reads the vector files of its tables, each once.
    pub sources: &'a Sources<'a>,
}

impl LintContext<'_> {
    /// A finding about the bytes `span` of the scene file.
    pub fn finding(&self, code: FindingCode, span: Range<usize>, message: impl Into<String>) -> Finding {
        Finding::new(code, message).at(&self.document.source, span)
    }

    /// The bytes of the scene file that state a feature's points or the file that holds it; `0..0` for the ground.
    pub fn origin(&self, feature: FeatureId) -> Range<usize> {
        self.feature(feature).map(|feature| feature.origin.span.clone()).unwrap_or_default()
    }

    /// The kind of a feature; `None` for the ground.
    pub fn kind(&self, feature: FeatureId) -> Option<FeatureKind> {
        self.feature(feature).map(|feature| feature.kind)
    }

    /// The roads that lie on the ground, and the stretches of roads that do.
    pub fn roads_on_ground(&self) -> impl Iterator<Item = &LineSymbol> {
        let is_road = |line: &&LineSymbol| self.kind(line.feature) == Some(FeatureKind::Road);
        self.scene.symbols.iter().filter(is_road).filter(|line| line.alignment.is_on_ground())
    }

    fn feature(&self, feature: FeatureId) -> Option<&SceneFeature> {
        self.scene.features.get(feature.index()?)
    }

    /// The name of a feature in messages: its kind and its name, or its number in its file.
    pub fn name(&self, feature: FeatureId) -> String {
        self.feature(feature).map_or_else(|| self.scene.feature_name(feature), SceneFeature::described)
    }
}
