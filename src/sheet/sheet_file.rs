//! Writes a sheet as PNG, PDF or SVG, by its file's name.

use std::path::Path;

use sandtable_annotate::paint::ComposedSheet;
use sandtable_annotate::pdf::PdfError;
use sandtable_files::disk::WriteFileError;
use sandtable_files::error::FileError;
use sandtable_files::output_files::OutputFiles;
use sandtable_files::png::{PngNotes, encode_png, encode_png_with};
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;

/// Pixels per inch where a view has no print in mind.
const SCREEN_DPI: f64 = 96.0;

/// A sheet that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WriteSheetError {
    #[error(transparent)]
    File(#[from] WriteFileError),
    #[error(transparent)]
    Pdf(#[from] FileError<PdfError>),
}

/// A description of the camera of a picture of `scene`, for those who find it later.
pub fn picture_description(scene: &SceneModel, view: &SceneView) -> String {
    format!("camera {}, coordinates {}, heights times {}", view.name, scene.crs.name(), scene.scale.0)
}

/// Writes a sheet among other `files`: with letters and lines as vectors where the name ends in `.pdf` or `.svg`, otherwise as PNG. `dpi` are
/// the pixels per inch of its print, where it has one in mind; a PNG holds `description` as well.
///
/// # Errors
/// See [`WriteSheetError`].
pub fn write_sheet(
    files: &mut OutputFiles,
    path: &Path,
    sheet: ComposedSheet,
    dpi: Option<f64>,
    (title, description): (Option<&str>, &str),
) -> Result<(), WriteSheetError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let print_dpi = dpi.unwrap_or(SCREEN_DPI) as f32;
    let bytes = match extension.as_str() {
        "pdf" => sheet.pdf(print_dpi, title).map_err(FileError::at(path))?,
        "svg" => sheet.svg(print_dpi, &encode_png(&sheet.pixels)).into_bytes(),
        _ => sheet_png(sheet, dpi, (title, description)),
    };
    Ok(files.write(path, &bytes)?)
}

/// A sheet as PNG, with its title, what it shows and, where its print is known, the size of that.
pub fn sheet_png(
    sheet: ComposedSheet,
    dpi: Option<f64>,
    (title, description): (Option<&str>, &str),
) -> Vec<u8> {
    let mut texts = vec![("Software", concat!("sandtable ", env!("CARGO_PKG_VERSION")).to_owned())];
    texts.extend(title.map(|title| ("Title", title.to_owned())));
    texts.push(("Description", description.to_owned()));
    encode_png_with(&sheet.painted(), &PngNotes { dpi, texts })
}
