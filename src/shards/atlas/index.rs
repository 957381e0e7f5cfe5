//! The page of an atlas: its sheets in their places, as a file that a browser opens without a server.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::record::ShardState;
use crate::shard::{Shard, SheetNeighbors};
use sandtable_base::message::xml::escaped;

/// A sheet of the page.
pub struct IndexedSheet {
    /// Its shard.
    pub shard: Shard,
    /// How far it is.
    pub state: ShardState,
    /// Where its picture is, from the page.
    pub href: String,
}

const STYLE: &str = "body{font:15px/1.4 system-ui,sans-serif;margin:1.5em;background:#f4f2ec;color:#222}\
table{border-collapse:collapse}th{font-weight:600;padding:.3em .6em;color:#666}\
td{border:1px solid #bbb;background:#fff;padding:.3em;text-align:center;vertical-align:bottom;min-width:9em}\
td.none{border:0;background:none}td img{display:block;width:14em;margin:0 auto .2em}\
td.missing,td.stale{background:#f7d9d3}small{display:block;color:#666}:target{outline:3px solid #c33}";

/// The page of an atlas called `title`.
pub fn page(title: &str, scale: f64, sheets: &[IndexedSheet]) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n<p>{}</p>\n<table>\n",
        summary(scale, sheets),
        title = escaped(title),
    );
    let places: BTreeMap<(u64, u64), &IndexedSheet> =
        sheets.iter().filter_map(|sheet| Some((place(sheet)?, sheet))).collect();
    let columns: Vec<u64> = distinct(places.keys().map(|place| place.1));
    page += "<tr><th>";
    for column in &columns {
        let _ = write!(page, "<th>{}", column + 1);
    }
    for row in distinct(places.keys().map(|place| place.0)) {
        let first = places.range((row, 0)..).next().map_or("", |(_, sheet)| &sheet.shard.name);
        let letters = first.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let _ = write!(page, "\n<tr><th>{}", escaped(letters));
        for &column in &columns {
            page += "\n";
            match places.get(&(row, column)) {
                Some(sheet) => page += &cell(sheet, sheets),
                None => page += "<td class=\"none\">",
            }
        }
    }
    page + "\n</table>\n</html>\n"
}

fn place(sheet: &IndexedSheet) -> Option<(u64, u64)> {
    sheet.shard.sheet.map(|[row, column]| (row, column))
}

fn distinct(numbers: impl Iterator<Item = u64>) -> Vec<u64> {
    numbers.collect::<std::collections::BTreeSet<u64>>().into_iter().collect()
}

fn summary(scale: f64, sheets: &[IndexedSheet]) -> String {
    let with = |state: ShardState| sheets.iter().filter(|sheet| sheet.state == state).count();
    let (missing, stale) = (with(ShardState::Missing), with(ShardState::Stale));
    let mut summary = format!("1:{scale}, {} sheets", sheets.len());
    for (count, word) in [(missing, "missing"), (stale, "stale")] {
        if count > 0 {
            let _ = write!(summary, ", {count} {word}");
        }
    }
    summary
}

fn cell(IndexedSheet { shard, state, href }: &IndexedSheet, sheets: &[IndexedSheet]) -> String {
    let (name, href) = (escaped(&shard.name), escaped(href));
    let mut cell = match state {
        ShardState::Done => {
            let picture = format!("<img loading=\"lazy\" src=\"{href}\" alt=\"\">");
            format!("<td id=\"{name}\"><a href=\"{href}\">{picture}{name}</a>")
        }
        ShardState::Missing => format!("<td id=\"{name}\" class=\"missing\">{name}: missing"),
        ShardState::Stale => format!("<td id=\"{name}\" class=\"stale\">{name}: stale"),
    };
    let sides = shard.neighbors.iter().flat_map(SheetNeighbors::sides);
    let beside = sides.filter_map(|(side, id)| Some((side, escaped(&sheets.get(id)?.shard.name))));
    let links: Vec<String> =
        beside.map(|(side, other)| format!("{side} <a href=\"#{other}\">{other}</a>")).collect();
    let _ = write!(cell, "<small>{}</small>", links.join(", "));
    cell
}
