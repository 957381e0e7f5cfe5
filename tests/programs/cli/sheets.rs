//! `render` to paper: sheets at a true scale, as PNG, PDF and SVG.

use std::path::Path;
use std::process::Command;

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// What a program of poppler prints; `None` where it is not installed, which fails in CI.
fn poppler(program: &str, arguments: &[&str], folder: &Path) -> Option<String> {
    match Command::new(program).args(arguments).current_dir(folder).output() {
        Ok(ran) => {
            assert!(ran.status.success(), "{program}: {}", String::from_utf8_lossy(&ran.stderr));
            Some(String::from_utf8_lossy(&ran.stdout).into_owned())
        }
        Err(error) => {
            skipped(&format!("{program} does not run: {error}"));
            assert!(std::env::var_os("SANDTABLE_REQUIRE_VALIDATOR").is_none(), "{program} is needed");
            None
        }
    }
}

#[test]
fn a_sheet_on_a4_is_a_pdf_with_searchable_texts_at_its_size() {
    let scratch = Scratch::new();
    let scene = project("scenes/paper.toml");
    run_in(scratch.folder(), &["render", &scene, "-o", "sheet.pdf"]).ok();
    let Some(text) = poppler("pdftotext", &["sheet.pdf", "-"], scratch.folder()) else { return };
    for expected in ["Caryville", "1:50 000", "SRTM", "MGRS"] {
        assert!(text.contains(expected), "no '{expected}' in {text}");
    }
    let info = poppler("pdfinfo", &["sheet.pdf"], scratch.folder()).expect("installed with pdftotext");
    assert!(info.contains("A4"), "{info}");
    poppler("pdftoppm", &["-r", "50", "-png", "sheet.pdf", "page"], scratch.folder());
    let page = image::open(scratch.folder().join("page-1.png")).expect("one page").to_rgb8();
    // A4 is 297 × 210 mm.
    assert!(page.width().abs_diff(585) <= 1 && page.height().abs_diff(413) <= 1, "{:?}", page.dimensions());
    let darks = page.pixels().filter(|pixel| pixel.0.iter().all(|&channel| channel < 110)).count();
    assert!(darks > 500, "the page shows {darks} dark pixels");
}

#[test]
fn a_sheet_as_svg_holds_its_texts_and_the_picture() {
    let scratch = Scratch::new();
    let scene = project("scenes/paper.toml");
    run_in(scratch.folder(), &["render", &scene, "--size", "640x480", "-o", "sheet.svg"]).ok();
    let svg = std::fs::read_to_string(scratch.folder().join("sheet.svg")).expect("written");
    assert!(svg.starts_with("<svg") && svg.contains("data:image/png;base64,"));
    assert!(svg.contains("Caryville") && svg.matches("<path").count() > 20);
}
