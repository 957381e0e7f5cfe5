//! What a check may look at.

use std::ops::Range;

use crate::description::document::Document;
use crate::description::finding::Finding;
use crate::description::finding_code::FindingCode;
use crate::draw::list::FeatureId;
use crate::scene::SceneModel;
use crate::scene::assets::Assets;

/// A scene with the document and the files that it was built of.
pub struct LintContext<'a> {
    /// The scene file, as it was read.
    pub document: &'a Document,
    /// The files that it may read.
    pub assets: &'a Assets,
    /// The scene.
    pub scene: &'a SceneModel,
}

impl LintContext<'_> {
    /// A finding about the bytes `span` of the scene file.
    pub fn finding(&self, code: FindingCode, span: Range<usize>, message: impl Into<String>) -> Finding {
        Finding::new(code, message).at(&self.document.source, span)
    }

    /// A finding about a feature, at the points or the file that made it.
    pub fn about(&self, code: FindingCode, feature: FeatureId, message: impl Into<String>) -> Finding {
        let origin = feature.index().and_then(|index| self.scene.features.get(index));
        let span = origin.map(|feature| feature.origin.span.clone()).unwrap_or_default();
        self.finding(code, span, message)
    }

    /// What a message calls a feature: its kind and its name, or its number in its file.
    pub fn name(&self, feature: FeatureId) -> String {
        let Some(feature) = feature.index().and_then(|index| self.scene.features.get(index)) else {
            return self.scene.feature_name(feature);
        };
        feature.described()
    }
}
