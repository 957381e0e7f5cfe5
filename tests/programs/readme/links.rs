//! Links and pictures in Markdown pages.

use std::fs;
use std::path::Path;

/// The targets of all links and pictures, outside of code.
pub fn all(page: &str) -> Vec<String> {
    let text = without_code(page);
    let mut found = between(&text, "](", &[')', ' ']);
    for attribute in ["src=\"", "href=\""] {
        found.extend(between(&text, attribute, &['"']));
    }
    let defined = text.lines().filter(|line| line.starts_with('[')).filter_map(|line| line.split_once("]: "));
    found.extend(defined.map(|(_, target)| target.trim().to_owned()));
    found
}

/// The targets of pictures, in order.
pub fn pictures(page: &str) -> Vec<String> {
    let text = without_code(page);
    let lines = text.lines().flat_map(|line| {
        let mut found: Vec<String> = Vec::new();
        if line.contains("![") {
            let after = line.split_once("![").map_or("", |(_, after)| after);
            found.extend(between(after, "](", &[')', ' ']).into_iter().take(1));
        }
        if line.contains("<img") {
            found.extend(between(line, "src=\"", &['"']));
        }
        found
    });
    lines.collect()
}

/// What is wrong with a link `target` of a page with `text` in `folder`; links to other sites are not followed.
pub fn fault(target: &str, folder: &Path, text: &str) -> Option<String> {
    let elsewhere = ["https://", "http://", "mailto:"].iter().any(|scheme| target.starts_with(scheme));
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    if elsewhere {
        return None;
    }
    let page = folder.join(path);
    if path.is_empty() {
        (!has_heading(text, anchor)).then(|| "no heading of this page is called that".into())
    } else if !page.exists() {
        Some("there is no such file".into())
    } else if anchor.is_empty() || !path.ends_with(".md") {
        None
    } else {
        let text = fs::read_to_string(&page).unwrap_or_default();
        (!has_heading(&text, anchor)).then(|| "no heading of that page is called that".into())
    }
}

/// Whether a link to `anchor` leads to a heading of `page`.
fn has_heading(page: &str, anchor: &str) -> bool {
    anchors(page).iter().any(|heading| heading == anchor)
}

/// What headings are called in links: small letters and digits, hyphens for spaces.
fn anchors(page: &str) -> Vec<String> {
    let headings = page.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let kept = heading.trim_start_matches('#').trim().chars();
        let kept = kept.filter(|letter| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_'));
        kept.map(|letter| if letter == ' ' { '-' } else { letter.to_ascii_lowercase() }).collect()
    };
    headings.map(anchor).collect()
}

fn between(text: &str, start: &str, ends: &[char]) -> Vec<String> {
    let rest = text.match_indices(start).map(|(at, _)| &text[at + start.len()..]);
    rest.filter_map(|rest| rest.split_once(ends)).map(|(target, _)| target.to_owned()).collect()
}

/// The page without fenced blocks and code between backticks.
fn without_code(page: &str) -> String {
    let mut fenced = false;
    let lines = page.lines().filter(|line| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    });
    lines.map(|line| line.split('`').step_by(2).collect::<Vec<_>>().join("")).collect::<Vec<_>>().join("\n")
}

#[test]
fn links_and_pictures_are_found_outside_of_code() {
    let page = "![a b](one.png)\n[two](two.md#x) and [three](#end)\n`[no](no)` <img src=\"four.png\">\n```\n[no](no)\n```\n# The End, of\n";
    assert_eq!(pictures(page), ["one.png", "four.png"]);
    assert_eq!(all(page), ["one.png", "two.md#x", "#end", "four.png"]);
    let here = Path::new(env!("SANDTABLE_ROOT"));
    assert_eq!(fault("Cargo.toml", here, page), None);
    assert_eq!(fault("#the-end-of", here, page), None);
    assert!(fault("#end", here, page).is_some() && fault("no.md", here, page).is_some());
    assert_eq!(fault("README.md#license", here, page), None);
    assert!(fault("README.md#no-such-heading", here, page).is_some());
}
