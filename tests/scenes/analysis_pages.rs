//! The pages of the book about the kinds of analysis: `src/book/analysis`, one for each kind and each family, with pictures.
//!
//! They are made from the catalog of kinds and from what the example of a kind gives, and the pictures by the program itself, so
//! that none goes stale: `SANDTABLE_BLESS=1 cargo test --test scenes analysis_pages` writes them.

mod examples;
mod page;
mod palette;
mod picture;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use sandtable_catalog::kind::{AnalysisFamily, AnalysisKind};
use sandtable_catalog::kinds;

use crate::analysis_pages::examples::{EXAMPLES, example};
use crate::analysis_pages::page::{contents, family_page, family_texts, kind_page};
use crate::analysis_pages::picture::{difference, made, write};
use crate::common::golden;

/// A picture has at most this many bytes, and all together.
const MOST_BYTES: u64 = 100_000;
const MOST_BYTES_TOGETHER: u64 = 3_000_000;

/// The line of the book's table of contents below which these pages stand.
const OVERVIEW: &str = "- [Terrain analysis](analysis.md)\n";

fn book() -> PathBuf {
    Path::new(env!("SANDTABLE_ROOT")).join("src/book")
}

fn folder() -> PathBuf {
    book().join("analysis")
}

/// Writes a page where pages are blessed; else says whether it is another one.
fn check_page(path: &Path, text: &str) -> Option<String> {
    if golden::is_blessing() {
        fs::write(path, text).expect("writable");
    }
    let is_same = fs::read_to_string(path).is_ok_and(|kept| kept == text);
    (!is_same).then(|| format!("{} is outdated", path.display()))
}

/// What is wrong with the page and the picture of a kind.
fn faults(kind: &'static AnalysisKind) -> Vec<String> {
    let example = example(kind);
    let (outcome, picture) = made(kind, example);
    let file = |extension: &str| folder().join(kind.name).with_extension(extension);
    let fresh = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("analysis-{}.png", kind.name));
    if golden::is_blessing() && difference(&picture, &file("png"), &fresh).is_some() {
        write(&picture, &file("png"));
    }
    let of_page = check_page(&file("md"), &kind_page(kind, example, &outcome));
    of_page.into_iter().chain(difference(&picture, &file("png"), &fresh)).collect()
}

#[test]
fn every_kind_has_its_page_and_its_picture_in_the_book() {
    let kinds: Vec<&AnalysisKind> = kinds().collect();
    let mut wrong: Vec<String> = kinds.into_par_iter().flat_map_iter(faults).collect();
    for family in AnalysisFamily::ALL {
        let [name, ..] = family_texts(family);
        wrong.extend(check_page(&folder().join(name).with_extension("md"), &family_page(family)));
    }
    let path = book().join("SUMMARY.md");
    let summary = fs::read_to_string(&path).expect("the table of contents");
    let (before, after) = summary.split_once(OVERVIEW).expect("the table of contents lists the overview");
    wrong.extend(check_page(&path, &format!("{before}{OVERVIEW}{}{}", contents(), after_pages(after))));
    assert!(wrong.is_empty(), "write them with SANDTABLE_BLESS=1:\n{}", wrong.join("\n"));
}

/// The lines of the table of contents after those of these pages, which are indented.
fn after_pages(lines: &str) -> &str {
    let is_page = |line: &&str| line.starts_with(' ');
    let length: usize = lines.split_inclusive('\n').take_while(is_page).map(str::len).sum();
    &lines[length..]
}

#[test]
fn every_file_beside_the_pages_is_of_a_kind_or_a_family_that_is_there() {
    if golden::is_blessing() {
        // They are being written beside this test.
        return;
    }
    let of_kinds =
        kinds().flat_map(|kind| ["md", "png"].map(|extension| format!("{}.{extension}", kind.name)));
    let of_families = AnalysisFamily::ALL.into_iter().map(|family| format!("{}.md", family_texts(family)[0]));
    let known: BTreeSet<String> = of_kinds.chain(of_families).collect();
    assert_eq!(
        known.len(),
        2 * kinds().count() + AnalysisFamily::ALL.len(),
        "a family has the name of a kind"
    );
    let entries = fs::read_dir(folder()).expect("the pages are there").map(|entry| entry.expect("readable"));
    let (mut names, mut bytes) = (BTreeSet::new(), 0);
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.ends_with(".png") {
            let length = entry.metadata().expect("a file").len();
            assert!(length <= MOST_BYTES, "{name} has {length} bytes");
            bytes += length;
        }
        names.insert(name);
    }
    assert_eq!(names, known, "files on the left");
    assert!(bytes <= MOST_BYTES_TOGETHER, "the pictures have {bytes} bytes together");
}

#[test]
fn every_example_is_of_a_kind_that_is_there() {
    let kinds: Vec<&str> = kinds().map(|kind| kind.name).collect();
    let examples: Vec<&str> = EXAMPLES.iter().map(|example| example.kind).collect();
    assert_eq!(examples, kinds, "examples on the left, kinds on the right, in one order");
}
