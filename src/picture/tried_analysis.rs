//! An analysis that a user tries: drawn over the ground of a walk like the scene's own, until it is kept or discarded.

use std::sync::Arc;

use crate::overlay::GROUND_TINT_LAYER;
use crate::post_tint::{self, TintPlan};
use crate::recut::{DrapeSheet, GroundSheets, SheetPlan};
use crate::{analyses, graphic_lines};
use sandtable_analysis::extent::PlacedOutcome;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_description::words::AnalysisDraw;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_ribbon::patches::Drapes;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::scene_model::SceneModel;

/// An analysis that is tried, with its tint before it is draped over the ground.
pub struct TriedAnalysis {
    analysis: Arc<SceneAnalysis>,
    tint: Option<TintPlan>,
    /// The colors of its lines.
    colors: Vec<[u8; 4]>,
}

impl TriedAnalysis {
    /// What an analysis of the land of `scene` gave, in its map coordinates.
    pub fn new(kind: &'static AnalysisKind, name: String, placed: PlacedOutcome, scene: &SceneModel) -> Self {
        let analysis = SceneAnalysis {
            name,
            kind,
            number: scene.analyses.len(),
            draw: AnalysisDraw::All,
            color: None,
            feature: tried_feature(scene),
            ground: placed.ground,
            outcome: placed.outcome.with_classes(),
        };
        let tint = analyses::tint(&analysis, scene);
        let lines = analyses::colors(&analysis, scene).into_iter().chain([graphic_lines::CASING]);
        let colors = lines.map(|color| color.0).collect();
        Self { analysis: Arc::new(analysis), tint, colors }
    }

    /// The analysis.
    pub fn analysis(&self) -> &Arc<SceneAnalysis> {
        &self.analysis
    }
}

/// The feature that an analysis is that is tried: none of the scene's own.
pub fn tried_feature(scene: &SceneModel) -> FeatureId {
    FeatureId::of_index(scene.features.len())
}

impl GroundSheets {
    /// Adds the texture and the colors of an analysis to the materials, before it is draped.
    pub fn add_tried(&mut self, tried: &mut TriedAnalysis) {
        for color in &tried.colors {
            if !self.graphic_colors.contains_key(color) {
                let material = graphic_lines::add_material(&mut self.head, Srgba(*color));
                self.graphic_colors.insert(*color, material);
            }
        }
        let Some(TintPlan { color, texture, .. }) = &mut tried.tint else { return };
        let texture = texture.take();
        let known = self.tried_material.and_then(|id| self.head.materials[id.0 as usize].texture);
        match (known, texture) {
            // The tint before lies nowhere any more.
            (Some(id), Some(pixels)) => self.head.textures[id.0 as usize] = pixels,
            (_, texture) => {
                self.tried_material = Some(post_tint::add_material(&mut self.head, *color, texture));
            }
        }
    }

    /// Drapes an analysis whose materials were added over the ground, or removes the current one. Its lines are planned with
    /// the other graphics. It is not cut yet; returns the patches in which what lies has changed.
    pub fn lay_tried(&mut self, tried: Option<&TriedAnalysis>) -> Vec<usize> {
        self.tried = tried.map(|tried| Arc::clone(&tried.analysis));
        let tint = tried.and_then(|tried| tried.tint.as_ref()).zip(self.tried_material);
        let laid = tint.map(|(tint, material)| DrapeSheet {
            drapes: Drapes::new(&self.borders, [&tint.plan]),
            plans: vec![SheetPlan::tint(material, GROUND_TINT_LAYER, tint.feature)],
        });
        let before = std::mem::replace(&mut self.tried_tint, laid.unwrap_or_default());
        let is_held =
            |&patch: &usize| before.drapes.is_occupied(patch) || self.tried_tint.drapes.is_occupied(patch);
        (0..self.borders.patch_count()).filter(is_held).collect()
    }
}
