//! Military symbols against those of npm milsymbol, from the tables that tests/tools/milsymbol_table.mjs writes: a file for
//! each symbol set in tests/symbology/milsymbol/.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use glam::Vec2;
use rayon::prelude::*;
use sandtable_annotate::annotation::{Annotations, PictureSymbol, SymbolHeight};
use sandtable_annotate::paint::annotate;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::entities::{SETS, entities};
use sandtable_symbology::modifiers::modifiers;
use sandtable_symbology::symbol::MilitarySymbol;

/// What the table draws, as its head says: pixels per unit, the corner and the size of the picture in units.
const PIXELS_PER_UNIT: f32 = 0.64;
const CORNER: Vec2 = Vec2::new(-50.0, -62.5);
const SIZE: (u32, u32) = (192, 220);
/// The standard deviation of the blur in pixels, and the darkness above which a pixel is dark.
const BLUR: f64 = 2.0;
const DARK: f64 = 0.25;

/// A line of a table.
struct OracleSymbol {
    code: String,
    /// Left, top, right, bottom; units.
    bounds: [f32; 4],
    anchor: Vec2,
    /// Of every second pixel of every second row; `None` where only box and anchor count.
    dark: Option<Vec<bool>>,
}

/// The tables by name, such as `10` of land units.
fn tables() -> BTreeMap<String, Vec<OracleSymbol>> {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("tests/symbology/milsymbol");
    let files = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("a file").path());
    let named = |file: PathBuf| Some((file.file_stem()?.to_str()?.to_owned(), table(&file)));
    files.filter_map(named).collect()
}

fn table(file: &Path) -> Vec<OracleSymbol> {
    let text = std::fs::read_to_string(file).expect("a table");
    let mut frames: BTreeMap<String, Vec<bool>> = BTreeMap::new();
    let mut last = "";
    let mut rows = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |index: usize| words[index].parse::<f32>().expect("a number");
        let key = words[0][3..6].to_owned();
        let runs = if words[7] == "=" { last } else { words[7] };
        let dark = (runs != "-").then(|| match frames.get(&key) {
            Some(frame) => flipped(frame.clone(), runs),
            None => flipped(vec![false; (SIZE.0.div_ceil(2) * SIZE.1.div_ceil(2)) as usize], runs),
        });
        if let Some(dark) = &dark {
            last = runs;
            frames.entry(key).or_insert_with(|| dark.clone());
        }
        rows.push(OracleSymbol {
            code: words[0].to_owned(),
            bounds: [1, 2, 3, 4].map(number),
            anchor: Vec2::new(number(5), number(6)),
            dark,
        });
    }
    rows
}

/// The pixels with every second run turned.
fn flipped(mut pixels: Vec<bool>, runs: &str) -> Vec<bool> {
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let (mut at, mut turns, mut length, mut shift) = (0, false, 0, 0);
    for digit in runs.bytes().map(digit) {
        length |= usize::from(digit % 32) << shift;
        shift += 5;
        if digit < 32 {
            pixels[at..at + length].iter_mut().for_each(|pixel| *pixel ^= turns);
            (at, turns, length, shift) = (at + length, !turns, 0, 0);
        }
    }
    pixels
}

fn symbol(code: &str) -> MilitarySymbol {
    MilitarySymbol::new(&SymbolCode::parse(code).expect(code)).expect(code)
}

/// The darkness of each pixel of a symbol on white, blurred.
fn darkness(symbol: &MilitarySymbol) -> Vec<f64> {
    let mut pixels = Pixels::filled(SIZE.0, SIZE.1, Srgba::WHITE);
    let placed = PictureSymbol {
        symbol: symbol.clone(),
        texts: Vec::new(),
        name: String::new(),
        reference: None,
        anchor_px: (symbol.anchor - CORNER) * PIXELS_PER_UNIT,
        direction_px: None,
        depth_m: 1.0,
        visible: true,
        is_on_map: true,
        rank: 0.0,
        height: SymbolHeight::Pixels(100.0 * PIXELS_PER_UNIT),
    };
    let report = annotate(&mut pixels, &Annotations { symbols: vec![placed], ..Annotations::default() });
    assert_eq!(report.symbols.placed.len(), 1, "the picture is large enough");
    let dark = |color: &Srgba| {
        let [red, green, blue, _] = color.0.map(|channel| f64::from(channel) / 255.0);
        (1.0 - (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 0.5).max(0.0)
    };
    blurred(&pixels.data().iter().map(dark).collect::<Vec<f64>>())
}

fn blurred(dark: &[f64]) -> Vec<f64> {
    let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
    let reach = (3.0 * BLUR) as i64;
    let weights: Vec<f64> =
        (-reach..=reach).map(|by| libm::exp(-((by * by) as f64) / (2.0 * BLUR * BLUR))).collect();
    let sum: f64 = weights.iter().sum();
    let pass = |from: &[f64], at: &dyn Fn(usize, usize, i64) -> usize| -> Vec<f64> {
        let one = |index: usize| {
            let parts = (-reach..=reach).zip(&weights);
            parts.map(|(by, weight)| weight * from[at(index % width, index / width, by)]).sum::<f64>() / sum
        };
        (0..from.len()).map(one).collect()
    };
    let moved = |value: usize, by: i64, most: usize| (value as i64 + by).clamp(0, most as i64 - 1) as usize;
    let rows = pass(dark, &|x, y, by| y * width + moved(x, by, width));
    pass(&rows, &|x, y, by| moved(y, by, height) * width + x)
}

/// The share of the dark pixels of either that are dark in both.
fn overlap(dark: &[f64], theirs: &[bool]) -> f64 {
    let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
    let ours =
        (0..height).step_by(2).flat_map(|y| (0..width).step_by(2).map(move |x| dark[y * width + x] > DARK));
    let (mut both, mut either) = (0, 0);
    for (ours, &theirs) in ours.zip(theirs) {
        both += usize::from(ours && theirs);
        either += usize::from(ours || theirs);
    }
    // Both may be light all over, as the track of one's own ship is.
    if either == 0 { 1.0 } else { f64::from(both as u32) / f64::from(either as u32) }
}

/// What is wrong with a symbol, and how well it overlaps.
fn compared(row: &OracleSymbol) -> (Vec<String>, f64) {
    let symbol = symbol(&row.code);
    let mut wrong: Vec<String> = symbol.notes.iter().map(|note| format!("{}: {note}", row.code)).collect();
    let (min, max) = (symbol.bounds.min, symbol.bounds.max);
    let off = [min.x, min.y, max.x, max.y].into_iter().zip(row.bounds).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f32::max);
    if off > 2.0 {
        wrong.push(format!("{}: box off by {off}", row.code));
    }
    if symbol.anchor.distance(row.anchor) > 1.0 {
        wrong.push(format!("{}: anchor at {}, not {}", row.code, symbol.anchor, row.anchor));
    }
    let overlap = row.dark.as_ref().map_or(1.0, |dark| overlap(&darkness(&symbol), dark));
    if overlap < 0.8 {
        wrong.push(format!("{}: overlap {overlap:.3}", row.code));
    }
    (wrong, overlap)
}

/// `SANDTABLE_SYMBOL_SETS="10 15"` looks at these tables alone.
#[test]
#[ignore = "slow: draws every symbol of the oracle"]
fn symbols_have_the_boxes_anchors_and_dark_pixels_of_milsymbol() {
    let wanted = std::env::var("SANDTABLE_SYMBOL_SETS").ok();
    let is_wanted = |name: &str| wanted.as_ref().is_none_or(|names| names.split(' ').any(|one| one == name));
    let (mut wrong, mut count) = (Vec::new(), 0);
    for (name, rows) in tables().into_iter().filter(|(name, _)| is_wanted(name)) {
        let mut least = (1.0, "");
        let all: Vec<(Vec<String>, f64)> = rows.par_iter().map(compared).collect();
        for (row, (reasons, overlap)) in rows.iter().zip(all) {
            wrong.extend(reasons);
            if overlap < least.0 {
                least = (overlap, &row.code);
            }
        }
        println!("{name}: {} symbols, least overlap {:.3} ({})", rows.len(), least.0, least.1);
        count += rows.len();
    }
    assert!(count > 0 && wrong.is_empty(), "{} of {count}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn every_entity_and_modifier_is_in_the_tables() {
    let seen: BTreeSet<String> =
        tables().into_values().flatten().map(|row| row.code[4..6].to_owned() + &row.code[10..20]).collect();
    let is_seen = |key: String| assert!(seen.contains(&key), "{key}: make tests/symbology/milsymbol anew");
    for set in SETS {
        let number = set.number();
        for entity in entities(set) {
            is_seen(format!("{number:02}{:06}0000", entity.code));
        }
        for modifier in modifiers(set, 1) {
            is_seen(format!("{number:02}000000{:02}00", modifier.code));
        }
        for modifier in modifiers(set, 2) {
            is_seen(format!("{number:02}00000000{:02}", modifier.code));
        }
    }
}

#[test]
fn runs_turn_pixels() {
    let turned = flipped(vec![false; 70], "ChBB");
    assert!(turned.iter().enumerate().all(|(at, &pixel)| pixel == (2..35).contains(&at)));
}
