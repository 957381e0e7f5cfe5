//! What a check may look at.

use std::ops::Range;

use crate::description::document::Document;
use crate::description::finding::Finding;
use crate::description::finding_code::FindingCode;
use crate::draw::list::FeatureId;
use crate::scene::sources::Sources;
use crate::scene::{FeatureKind, SceneFeature, SceneModel};

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

    /// A finding about a feature, at the points or the file that made it.
    pub fn about(&self, code: FindingCode, feature: FeatureId, message: impl Into<String>) -> Finding {
        self.finding(code, self.origin(feature), message)
    }

    /// The bytes of the scene file that state a feature's points or the file that holds it; `0..0` for the ground.
    pub fn origin(&self, feature: FeatureId) -> Range<usize> {
        self.feature(feature).map(|feature| feature.origin.span.clone()).unwrap_or_default()
    }

    /// The kind of a feature; `None` for the ground.
    pub fn kind(&self, feature: FeatureId) -> Option<FeatureKind> {
        self.feature(feature).map(|feature| feature.kind)
    }

    fn feature(&self, feature: FeatureId) -> Option<&SceneFeature> {
        self.scene.features.get(feature.index()?)
    }

    /// What a message calls a feature: its kind and its name, or its number in its file.
    pub fn name(&self, feature: FeatureId) -> String {
        self.feature(feature).map_or_else(|| self.scene.feature_name(feature), SceneFeature::described)
    }
}
