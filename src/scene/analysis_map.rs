//! The scene under the map of an analysis: ground alone, or a scene file, seen from straight above with a margin.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::assets::Assets;
use crate::build::build;
use crate::scene_file::{OpenSceneError, open_document};
use crate::scene_model::SceneModel;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_description::document::Document;
use sandtable_description::parse::parse;
use sandtable_description::words::{GridName, SheetLayout};
use sandtable_files::disk;
use sandtable_raster::raster::Raster;

/// How ground alone is drawn: pale, so that every tint is told.
const GROUND: &str = "
[style]
preset = \"military\"
[furniture]
legend = false
";

/// What every map has.
const MAP: &str = "
[terrain]
dem = \"ground\"
[[camera]]
name = \"map\"
projection = \"plan\"
";

/// The texts of a map.
pub struct MapTexts {
    /// Its title.
    pub title: String,
    /// The line below it.
    pub subtitle: String,
    /// What it does not know, a line each.
    pub notes: Vec<String>,
}

impl MapTexts {
    /// The texts of an analysis of a kind of a file, with its arguments as they are stated, names and values.
    pub fn of_analysis<'a>(
        kind: &AnalysisKind,
        file: &Path,
        stated: impl Iterator<Item = (&'a str, &'a str)>,
    ) -> Self {
        let file = std::iter::once(disk::file_name(file));
        let stated = stated.map(|(name, value)| format!("{name} {value}"));
        let source = format!("Method: {}", kind.source);
        let limits = kind.limits.iter().map(|limit| (*limit).to_owned());
        Self {
            title: kind.title.to_owned(),
            subtitle: file.chain(stated).collect::<Vec<_>>().join(" · "),
            notes: std::iter::once(source).chain(limits).collect(),
        }
    }
}

/// The scene of a file of elevation of which `ground` is read, in meters.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn ground_map(
    file: &Path,
    ground: Raster,
    texts: MapTexts,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let text = format!("{MAP}{GROUND}").replace("\"ground\"", &serde_json::Value::from(name).to_string());
    let mut document = parse("map", &text)?;
    if ground.crs.is_none() {
        document.furniture.grid = Some(GridName::Metric);
    }
    titled(&mut document, texts);
    let assets = Assets::new(file, &[])?.with_elevation(Arc::new(ground));
    Ok(build(&document, &assets, progress)?)
}

/// The scene of a scene file without its own analyses.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn scene_map(
    path: &Path,
    allowed: &[PathBuf],
    texts: MapTexts,
    progress: &dyn Fn(&'static str),
) -> Result<SceneModel, OpenSceneError> {
    progress("reading the scene file");
    let (mut document, assets) = open_document(path, allowed, None)?;
    document.analyses.clear();
    document.cameras = parse("map", MAP)?.cameras;
    document.flights.clear();
    titled(&mut document, texts);
    Ok(build(&document, &assets, progress)?)
}

fn titled(document: &mut Document, texts: MapTexts) {
    document.title = Some(texts.title);
    document.subtitle = Some(texts.subtitle);
    document.phase = None;
    if !matches!(document.furniture.layout, SheetLayout::Margin | SheetLayout::Military) {
        document.furniture.layout = SheetLayout::Margin;
    }
    let stated = document.furniture.notes.take().unwrap_or_default();
    document.furniture.notes = Some(stated.into_iter().chain(texts.notes).collect());
}
