//! Military symbols against those of npm milsymbol, from the table that tests/tools/milsymbol_table.mjs writes.

use std::collections::BTreeSet;

use glam::Vec2;
use sandtable_annotate::annotation::{Annotations, PictureSymbol, SymbolHeight};
use sandtable_annotate::paint::annotate;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::entities::{SETS, entities};
use sandtable_symbology::symbol::MilitarySymbol;

const TABLE: &str = include_str!("../symbology/milsymbol.txt");

/// What the table draws, as its head says: pixels per unit, the corner and the size of the picture in units.
const PIXELS_PER_UNIT: f32 = 0.64;
const CORNER: Vec2 = Vec2::new(-50.0, -60.0);
const SIZE: (u32, u32) = (192, 218);
/// The standard deviation of the blur in pixels, and the darkness above which a pixel is dark.
const BLUR: f64 = 2.0;
const DARK: f64 = 0.25;

/// A line of the table.
struct OracleSymbol {
    code: &'static str,
    /// Left, top, right, bottom; units.
    bounds: [f32; 4],
    anchor: Vec2,
    /// In hexadecimal; `None` where only box and anchor count.
    dark: Option<&'static str>,
}

fn table() -> Vec<OracleSymbol> {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    let row = |line: &'static str| {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |index: usize| words[index].parse::<f32>().expect("a number");
        OracleSymbol {
            code: words[0],
            bounds: [1, 2, 3, 4].map(number),
            anchor: Vec2::new(number(5), number(6)),
            dark: Some(words[7]).filter(|dark| *dark != "-"),
        }
    };
    lines.map(row).collect()
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
fn overlap(dark: &[f64], row: &OracleSymbol, bits: &str) -> f64 {
    let [left, top, right, bottom] = row.bounds;
    let pixel = |value: f32, from: f32| ((value - from) * PIXELS_PER_UNIT).floor() as usize;
    let columns: Vec<usize> =
        (pixel(left - 4.0, CORNER.x)..pixel(right + 4.0, CORNER.x)).step_by(2).collect();
    let rows = (pixel(top - 4.0, CORNER.y)..pixel(bottom + 4.0, CORNER.y)).step_by(2);
    let ours = rows.flat_map(|y| columns.iter().map(move |x| dark[y * SIZE.0 as usize + x] > DARK));
    let digits = bits.chars().map(|digit| digit.to_digit(16).expect("hexadecimal"));
    let theirs = digits.flat_map(|digit| (0..4).rev().map(move |bit| digit >> bit & 1 == 1));
    let (mut both, mut either) = (0, 0);
    for (ours, theirs) in ours.zip(theirs) {
        both += usize::from(ours && theirs);
        either += usize::from(ours || theirs);
    }
    f64::from(both as u32) / f64::from(either.max(1) as u32)
}

#[test]
#[ignore = "slow: draws every symbol of the oracle"]
fn symbols_have_the_boxes_anchors_and_dark_pixels_of_milsymbol() {
    let (mut wrong, mut least) = (Vec::new(), (1.0, ""));
    for row in table() {
        let symbol = symbol(row.code);
        let (min, max) = (symbol.bounds.min, symbol.bounds.max);
        let off = [min.x, min.y, max.x, max.y].into_iter().zip(row.bounds).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f32::max);
        if off > 2.0 {
            wrong.push(format!("{}: box off by {off}", row.code));
        }
        if symbol.anchor.distance(row.anchor) > 1.0 {
            wrong.push(format!("{}: anchor at {}, not {}", row.code, symbol.anchor, row.anchor));
        }
        if let Some(bits) = row.dark {
            let overlap = overlap(&darkness(&symbol), &row, bits);
            if overlap < least.0 {
                least = (overlap, row.code);
            }
            if overlap < 0.8 {
                wrong.push(format!("{}: overlap {overlap:.3}", row.code));
            }
        }
    }
    println!("least overlap {:.3} ({})", least.0, least.1);
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), table().len(), wrong.join("\n"));
}

#[test]
fn every_entity_is_in_the_table() {
    let seen: BTreeSet<String> =
        table().iter().map(|row| row.code[4..6].to_owned() + &row.code[10..16]).collect();
    for set in SETS {
        for entity in entities(set) {
            let key = format!("{:02}{:06}", set.number(), entity.code);
            assert!(seen.contains(&key), "{key}: make tests/symbology/milsymbol.txt anew");
        }
    }
}
