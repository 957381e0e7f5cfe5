//! The pages of the repository: README, book and references.

use std::fs;
use std::path::Path;

/// The top of the repository.
pub const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The folder of the book.
pub const BOOK: &str = "src/book";

/// The folder of the pages about the kinds of analysis.
const ANALYSES: &str = "src/book/analysis";

/// The book's table of contents.
pub const SUMMARY: &str = "src/book/SUMMARY.md";

/// The pages whose links are followed, besides those of the book.
const REFERENCES: [&str; 13] = [
    "README.md",
    "CHANGELOG.md",
    "assets/README.md",
    "scenes/FINDINGS.md",
    "scenes/README.md",
    "scenes/SYMBOLS.md",
    "src/ARCHITECTURE.md",
    "src/base/LIMITS.md",
    "src/python/README.md",
    "src/serve/SERVE.md",
    "src/shards/SHARDS.md",
    "tests/bench/README.md",
    "tests/fuzz/README.md",
];

/// The text of a page, which is named from the top of the repository.
pub fn text_of(name: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The pages in a folder of the book, in order of their names.
fn in_folder(folder: &str) -> Vec<String> {
    let entries =
        fs::read_dir(Path::new(ROOT).join(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let names = entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
    let pages = names.filter(|name| name.ends_with(".md")).map(|name| format!("{folder}/{name}"));
    let mut pages: Vec<String> = pages.filter(|page| page != SUMMARY).collect();
    pages.sort();
    pages
}

/// The pages of the book without its table of contents, in order of their names.
pub fn of_the_book() -> Vec<String> {
    let mut pages: Vec<String> = in_folder(BOOK).into_iter().chain(of_the_analyses()).collect();
    pages.sort();
    pages
}

/// The pages about the kinds of analysis, which are made from their catalog.
pub fn of_the_analyses() -> Vec<String> {
    in_folder(ANALYSES)
}

/// The README and the pages of the book that are read one after the other.
pub fn of_the_readme_and_the_book() -> Vec<String> {
    std::iter::once("README.md".to_owned()).chain(in_folder(BOOK)).collect()
}

/// All pages whose links are followed.
pub fn all() -> Vec<String> {
    let others = REFERENCES.into_iter().chain([SUMMARY]).map(str::to_owned);
    others.chain(of_the_book()).collect()
}

/// The texts of a page's blocks that are marked `language`, in order.
pub fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let start = format!("```{language}\n");
    page.split(&start).skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

/// The rows of the table with this heading row, as they are written.
pub fn rows<'a>(page: &'a str, heading: &str) -> Vec<&'a str> {
    let rows = page.lines().skip_while(|line| *line != heading).skip(2);
    rows.take_while(|line| line.starts_with('|')).collect()
}
