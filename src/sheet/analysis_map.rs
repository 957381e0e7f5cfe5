//! The map of an analysis: the land from above, what the analysis gives over it, a legend and tables.

use std::sync::Arc;

use crate::picture::{PictureError, PictureSize, RenderedView, render_view};
use sandtable_analysis::outcome::Outcome;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;

/// The picture of a map from [`sandtable_scene::analysis_map`] with an analysis that was made on `ground`.
///
/// # Errors
/// See [`PictureError`].
///
/// # Panics
/// Where the scene has no view: every map has one.
pub fn analysis_map(
    mut map: SceneModel,
    kind: &'static AnalysisKind,
    (ground, outcome): (&Arc<Lattice>, &Outcome),
    progress: &dyn Fn(&'static str),
) -> Result<RenderedView, PictureError> {
    map.add_analysis((kind, kind.title.to_owned()), Arc::clone(ground), outcome.clone());
    let view = map.view(None).expect("a map has a view");
    let size = PictureSize::of(&map, view);
    render_view(&map, view, size, RenderBackend::Cpu, progress)
}
