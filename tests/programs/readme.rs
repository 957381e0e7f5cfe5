//! What the pages promise: the commands in README.md run and write what they say, its picture is there, and no
//! link leads nowhere.
//!
//! Commands run in a folder with copies of `scenes/` and `assets/`, without a shell. A line that this test does
//! not know how to run, and that is not among those it knows to leave alone, fails: an example nobody runs is an
//! example that stops working.

mod command;
mod links;
mod sandbox;
use std::fs;
use std::path::Path;

use sandtable_description::parse::parse;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;

use crate::readme::command::{Command, Line};
use crate::readme::sandbox::Sandbox;
use crate::serve::client::Server;

const ROOT: &str = env!("SANDTABLE_ROOT");

/// The pages whose links are followed.
const PAGES: [&str; 10] = [
    "README.md",
    "CHANGELOG.md",
    "assets/README.md",
    "scenes/FINDINGS.md",
    "scenes/README.md",
    "src/ARCHITECTURE.md",
    "src/python/README.md",
    "src/serve/SERVE.md",
    "src/shards/SHARDS.md",
    "tests/bench/README.md",
];

fn page(name: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn every_command_of_the_readme_runs_and_writes_what_it_says() {
    let sandbox = Sandbox::new("readme");
    let (mut ran, mut server) = (0, None);
    for Line { number, text } in command::lines_of(&page("README.md")) {
        match Command::parse(&text) {
            Some(Command::LeftAlone) => {}
            Some(Command::Sandtable { arguments, input }) => {
                let result = sandbox.run(&arguments, input.as_deref());
                result.unwrap_or_else(|reason| panic!("README.md:{number}: {text}\n{reason}"));
                ran += 1;
            }
            Some(Command::Serve { arguments }) => {
                let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
                server = Some(Server::start(sandbox.folder(), &arguments));
            }
            Some(Command::Ask { path }) => {
                let server =
                    server.as_ref().unwrap_or_else(|| panic!("README.md:{number}: nothing serves yet"));
                let answer = server.get(&path);
                assert_eq!(answer.status, 200, "README.md:{number}: {text}\n{answer:?}");
                ran += 1;
            }
            None => panic!("README.md:{number}: the test knows no way to run this line: {text}"),
        }
    }
    assert!(ran > 0, "README.md has no command in a block marked sh");
}

#[test]
fn the_scene_that_the_readme_shows_is_a_whole_one() {
    let page = page("README.md");
    let scene = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a scene");
    let place = Path::new(ROOT).join("scenes/shown-in-the-readme.toml");
    let document = parse(&place.to_string_lossy(), scene).unwrap_or_else(|error| panic!("{error}"));
    let assets = Assets::new(&place, &[]).expect("the folder is there");
    let built = build(&document, &assets, &|_| {}).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(built.ribbons.len(), 1, "its road lies on its ground");
}

#[test]
fn the_readme_s_first_picture_is_there_and_is_a_picture() {
    let page = page("README.md");
    let target = links::pictures(&page).into_iter().next().expect("README.md shows a picture");
    let path = Path::new(ROOT).join(&target);
    let picture = image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(picture.width() >= 800, "{target} is {} pixels wide", picture.width());
}

#[test]
fn no_link_leads_nowhere() {
    let mut wrong = Vec::new();
    for name in PAGES {
        let text = page(name);
        let folder = Path::new(ROOT).join(name);
        let folder = folder.parent().expect("a page lies in a folder");
        for target in links::all(&text) {
            wrong.extend(
                links::fault(&target, folder, &text).map(|reason| format!("{name}: {target}: {reason}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
