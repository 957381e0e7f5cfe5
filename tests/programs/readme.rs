//! What the README and the book promise: their commands run and write what they say, their scenes can be built, their
//! pictures are there, and no link leads nowhere.
//!
//! Commands run in a folder with copies of `scenes/` and `assets/`, without a shell. A line that this test does
//! not know how to run, and that is not among those it knows to leave alone, fails: an example nobody runs is an
//! example that stops working. Each page with commands has a test of its own, so that pages run side by side.

mod command;
mod links;
pub mod pages;
mod sandbox;

use std::path::{Component, Path, PathBuf};

use rayon::prelude::*;
use sandtable_description::parse::parse;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;

use crate::readme::command::{Command, Line};
use crate::readme::pages::{BOOK, ROOT, SUMMARY, text_of};
use crate::readme::sandbox::Sandbox;
use crate::serve::client::Server;

/// Someone in a hurry reads no more.
const MOST_LINES_OF_THE_README: usize = 150;

/// A row for each page with commands: the name of its test, and the page.
macro_rules! pages_with_commands {
    ($($test:ident: $page:literal,)*) => {
        const PAGES_WITH_COMMANDS: &[&str] = &[$($page),*];

        $(
            #[test]
            fn $test() {
                run_commands_of($page);
            }
        )*
    };
}

pages_with_commands! {
    every_command_of_the_readme_runs: "README.md",
    every_command_of_terrain_analysis_runs: "src/book/analysis.md",
    every_command_of_exports_runs: "src/book/exports.md",
    every_command_of_gis_and_python_runs: "src/book/gis-and-python.md",
    every_command_of_heights_runs: "src/book/heights.md",
    every_command_of_how_it_works_runs: "src/book/how-it-works.md",
    every_command_of_many_machines_runs: "src/book/many-machines.md",
    every_command_of_military_sheets_runs: "src/book/military-sheets.md",
    every_command_of_the_quick_start_runs: "src/book/quick-start.md",
    every_command_of_scenes_runs: "src/book/scenes.md",
}

/// Runs the commands of a page one after the other in a folder of their own; each must succeed.
fn run_commands_of(name: &str) {
    let stem = Path::new(name).file_stem().expect("a page has a name").to_string_lossy();
    let sandbox = Sandbox::new(&format!("page-{stem}"));
    let mut server = None;
    for Line { number, text } in command::lines_of(&text_of(name)) {
        match Command::parse(&text) {
            Some(Command::LeftAlone) => {}
            Some(Command::Sandtable { arguments, input }) => {
                let result = sandbox.run(&arguments, input.as_deref());
                result.unwrap_or_else(|reason| panic!("{name}:{number}: {text}\n{reason}"));
            }
            Some(Command::Serve { arguments }) => {
                let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
                server = Some(Server::start(sandbox.folder(), &arguments));
            }
            Some(Command::Ask { path }) => {
                let server = server.as_ref().unwrap_or_else(|| panic!("{name}:{number}: nothing serves yet"));
                let answer = server.get(&path);
                assert_eq!(answer.status, 200, "{name}:{number}: {text}\n{answer:?}");
            }
            None => panic!("{name}:{number}: the test knows no way to run this line: {text}"),
        }
    }
}

#[test]
fn the_pages_with_commands_are_those_that_are_run() {
    let has_commands = |name: &String| {
        let lines = command::lines_of(&text_of(name));
        lines.iter().any(|line| Command::parse(&line.text) != Some(Command::LeftAlone))
    };
    let pages = pages::of_the_readme_and_the_book().into_iter().filter(has_commands);
    assert_eq!(pages.collect::<Vec<_>>(), PAGES_WITH_COMMANDS, "pages with commands on the left");
}

#[test]
fn every_command_of_the_pages_of_analyses_runs() {
    let sandbox = Sandbox::new("pages-of-analyses");
    pages::of_the_analyses().into_par_iter().for_each(|name| {
        for Line { text, .. } in command::lines_of(&text_of(&name)) {
            let Some(Command::Sandtable { mut arguments, input: None }) = Command::parse(&text) else {
                panic!("{name}: the test knows no way to run this line: {text}");
            };
            // Another test makes the pictures; drawn as maps of this many kinds they would take long.
            let output = arguments.iter().position(|argument| argument == "-o").expect("it writes a map");
            let map = arguments.drain(output..output + 2).next_back().expect("a name follows");
            assert!(map.ends_with(".png"), "{name}: {text}");
            let result = sandbox.run(&arguments, None);
            result.unwrap_or_else(|reason| panic!("{name}: {text}\n{reason}"));
        }
    });
}

#[test]
fn every_scene_that_a_page_shows_is_a_whole_one() {
    let place = Path::new(ROOT).join("scenes/shown-on-a-page.toml");
    let assets = Assets::new(&place, &[]).expect("the folder is there");
    let mut ribbons = Vec::new();
    for name in pages::of_the_readme_and_the_book() {
        for scene in pages::blocks(&text_of(&name), "toml") {
            let document =
                parse(&place.to_string_lossy(), scene).unwrap_or_else(|error| panic!("{name}: {error}"));
            let built = build(&document, &assets, &|_| {}).unwrap_or_else(|error| panic!("{name}: {error}"));
            ribbons.push((name.clone(), built.ribbons.len()));
        }
    }
    let with_a_road = ribbons.iter().filter(|(name, ribbons)| name.ends_with("/scenes.md") && *ribbons == 1);
    assert_eq!(with_a_road.count(), 1, "the road of the first scene lies on its ground: {ribbons:?}");
}

#[test]
fn the_readme_s_first_picture_is_there_and_is_a_picture() {
    let page = text_of("README.md");
    let target = links::pictures(&page).into_iter().next().expect("README.md shows a picture");
    let path = Path::new(ROOT).join(&target);
    let picture = image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(picture.width() >= 800, "{target} is {} pixels wide", picture.width());
}

#[test]
fn the_readme_is_short() {
    let lines = text_of("README.md").lines().count();
    assert!(lines <= MOST_LINES_OF_THE_README, "README.md has {lines} lines: move some to {BOOK}");
}

#[test]
fn the_summary_lists_every_page_of_the_book_once() {
    let listed = links::all(&text_of(SUMMARY)).into_iter().map(|target| format!("{BOOK}/{target}"));
    let mut listed: Vec<String> = listed.collect();
    listed.sort();
    assert_eq!(listed, pages::of_the_book(), "pages that {SUMMARY} lists on the left");
}

#[test]
fn links_that_leave_the_book_begin_at_the_top_of_the_repository() {
    // `src/book/book.toml` says why: the built book lies as deep below the top, but elsewhere.
    let mut wrong = Vec::new();
    for name in pages::of_the_book() {
        let folder = Path::new(&name).parent().expect("a page lies in a folder");
        let top = "../".repeat(folder.components().count());
        for target in links::all(&text_of(&name)) {
            let path = target.split('#').next().unwrap_or_default();
            let elsewhere = path.contains("://") || path.starts_with(&top);
            if !elsewhere && !resolved(&folder.join(path)).starts_with(BOOK) {
                wrong.push(format!("{name}: {target}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The path without steps to the folder above.
fn resolved(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut whole, part| {
        match part {
            Component::ParentDir => {
                whole.pop();
            }
            part => whole.push(part),
        }
        whole
    })
}

#[test]
fn the_book_says_where_new_things_go_as_the_architecture_does() {
    let heading = "| new | where |";
    let (architecture, book) = (text_of("src/ARCHITECTURE.md"), text_of("src/book/contributing.md"));
    let known = pages::rows(&book, heading);
    let rows = pages::rows(&architecture, heading);
    assert!(rows.len() > 5, "the table of the architecture was not found");
    let missing: Vec<&str> = rows.into_iter().filter(|row| !known.contains(row)).collect();
    assert!(missing.is_empty(), "rows that {BOOK}/contributing.md lacks:\n{}", missing.join("\n"));
}

#[test]
fn no_link_leads_nowhere() {
    let mut wrong = Vec::new();
    for name in pages::all() {
        let text = text_of(&name);
        let folder = Path::new(ROOT).join(&name);
        let folder = folder.parent().expect("a page lies in a folder");
        for target in links::all(&text) {
            wrong.extend(
                links::fault(&target, folder, &text).map(|reason| format!("{name}: {target}: {reason}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
