//! Military symbols of the scene: codes and texts from the scene file or from the features of a file, set on the ground.

use std::ops::Range;

use glam::Vec3;

use crate::attributes::{Attributes, written};
use crate::builder::SceneBuilder;
use crate::scene_findings::SceneFindings;
use crate::shape_place::place;
use crate::sources::Sources;
use crate::world_frame::WorldFrame;
use sandtable_base::limits::SCENE_SYMBOLS;
use sandtable_base::message::numbers::counted;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::expression::Expression;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::stated::Stated;
use sandtable_description::symbols::SymbolTable;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::engagement::EngagementBar;
use sandtable_symbology::symbol::MilitarySymbol;
use sandtable_symbology::texts::{SymbolNote, SymbolText, TEXT_FIELDS, placed_for};
use sandtable_terrain::lattice::Lattice;

/// A symbol at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSymbol {
    /// Its code.
    pub code: SymbolCode,
    /// The drawing.
    pub symbol: MilitarySymbol,
    /// The lines of text round it.
    pub texts: Vec<SymbolNote>,
    /// Its texts by field.
    pub fields: Vec<(SymbolText, String)>,
    /// What reports call it: its designation, else its code.
    pub name: String,
    /// The position on the ground, world space, displayed height.
    pub ground: Vec3,
    /// Where it moves to, radians clockwise from north.
    pub direction_rad: Option<f32>,
    /// How large it is.
    pub size: SymbolSize,
    /// The lower, the more important; never NaN.
    pub rank: f64,
}

/// The height of the frame of a friendly unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SymbolSize {
    /// Pixels of a picture 1080 pixels high.
    Design(f32),
    /// Meters on the ground.
    Ground(f32),
}

/// The symbols of the document; `collected` gets what is not drawn, and keeps an error where a code that the scene file states
/// is none, its place lies off the ground, or a file cannot be read or holds no feature that matches.
pub fn symbols(sources: &Sources<'_>, lattice: &Lattice, collected: &mut SceneBuilder) -> Vec<SceneSymbol> {
    let (mut symbols, mut first_beyond) = (Vec::new(), None);
    let SceneBuilder { findings, errors, .. } = collected;
    for table in &sources.frame.document.symbols {
        match &table.at {
            Some(at) => {
                symbols.extend(errors.keep(symbol_at(table, at, sources.frame, lattice, findings)));
            }
            None => {
                errors.keep(read_features(table, sources, lattice, &mut symbols, findings));
            }
        }
        if symbols.len() > SCENE_SYMBOLS.count() {
            first_beyond = first_beyond.or(Some(table));
        }
    }
    if let Some(table) = first_beyond {
        let more = symbols.len() - SCENE_SYMBOLS.count();
        let message = format!(
            "{} beyond the first {SCENE_SYMBOLS} left out: {SCENE_SYMBOLS:#}",
            counted(more, "symbol", "symbols")
        );
        let of_file = table.file.as_ref().and_then(Stated::span);
        let place = of_file.or_else(|| table.at.as_ref().and_then(Stated::span));
        findings.add(FindingCode::TooMany, place.unwrap_or_default(), message);
        symbols.truncate(SCENE_SYMBOLS.count());
    }
    symbols
}

fn symbol_at(
    table: &SymbolTable,
    at: &Stated<Position>,
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
    findings: &mut SceneFindings,
) -> Result<SceneSymbol, Diagnostic> {
    let error = |message: String| frame.document.error(&table.sidc, message);
    let code = SymbolCode::parse(&table.sidc).map_err(|found| error(found.to_string()))?;
    let symbol = MilitarySymbol::new(&code).ok_or_else(|| error(frameless(&code)))?;
    let world = frame.point(at, table.crs.as_ref())?;
    let ground = frame.on_ground(lattice, at, world)?;
    let text = |field| stated_text(table, field).map(|text| text.as_str());
    let texts = placed_for(&code, text);
    let fields =
        TEXT_FIELDS.iter().filter_map(|row| Some((row.field, text(row.field)?.to_owned()))).collect();
    let symbol = engaged(symbol, &code, EngagementBar::of(text), &texts);
    let found = FoundSymbol { code, symbol, texts, fields, name: name(text, &table.sidc), ground };
    Ok(found.finished(table, &Attributes::default(), findings))
}

/// Adds the symbols of the features of a file.
fn read_features(
    table: &SymbolTable,
    sources: &Sources<'_>,
    lattice: &Lattice,
    symbols: &mut Vec<SceneSymbol>,
    findings: &mut SceneFindings,
) -> Result<(), Diagnostic> {
    let frame = sources.frame;
    let Some(source) = table.source() else { return Ok(()) };
    let expression =
        |text: &Stated<String>| Expression::parse(text).map_err(|error| frame.document.error(text, error));
    let sidc = expression(&table.sidc)?;
    let mut fields = Vec::new();
    for row in &TEXT_FIELDS {
        if let Some(text) = stated_text(table, row.field) {
            fields.push((row.field, expression(text)?));
        }
    }
    let (crs, features) = sources.features(&source)?;
    let first = symbols.len();
    let mut left_out = LeftOutSymbols::default();
    for attributes in features {
        let stated = attributes.evaluated(&sidc).and_then(|code| written(&code)).unwrap_or_default();
        let code = SymbolCode::parse(&stated).map_err(|error| error.to_string());
        let symbol = code.and_then(|code| {
            MilitarySymbol::new(&code).map(|symbol| (code, symbol)).ok_or_else(|| frameless(&code))
        });
        let Some((code, symbol)) = symbol.map_err(|error| left_out.no_code(error)).ok() else { continue };
        let Some(ground) = on_ground(&attributes, &crs, frame, lattice) else {
            left_out.off += 1;
            continue;
        };
        let texts: Vec<(SymbolText, String)> = fields
            .iter()
            .filter_map(|(field, text)| Some((*field, written(&attributes.evaluated(text)?)?)))
            .collect();
        let text = |field| texts.iter().find(|text| text.0 == field).map(|text| text.1.as_str());
        let (lines, name) = (placed_for(&code, text), name(text, &stated));
        let symbol = engaged(symbol, &code, EngagementBar::of(text), &lines);
        let found = FoundSymbol { code, symbol, texts: lines, fields: texts, name, ground };
        symbols.push(found.finished(table, &attributes, findings));
        if symbols.len() > SCENE_SYMBOLS.count() {
            break;
        }
    }
    if symbols.len() == first && left_out.off > 0 {
        sources.measure(&source)?;
    }
    if let Some(sentence) = left_out.note(source.file.as_ref().map_or("", |file| file.as_str())) {
        findings.add(FindingCode::LeftOut, source.span(), sentence);
    }
    Ok(())
}

fn on_ground(attributes: &Attributes, crs: &Crs, frame: &WorldFrame<'_>, lattice: &Lattice) -> Option<Vec3> {
    Some(place(attributes.geometry()?, crs, frame, lattice)?.as_vec3())
}

pub(super) fn frameless(code: &SymbolCode) -> String {
    let (number, name) = (code.set.number(), code.set.name());
    format!(
        "the set {number:02} of the symbol code, {name}, has no symbols with frames: use another set, or a graphic"
    )
}

/// The text or expression of a field.
fn stated_text(table: &SymbolTable, field: SymbolText) -> Option<&Stated<String>> {
    let key = TEXT_FIELDS.iter().find(|row| row.field == field)?.key;
    table.texts().into_iter().find(|(name, _)| *name == key)?.1.as_ref()
}

/// The symbol with its engagement bar, if it has one.
pub(super) fn engaged(
    symbol: MilitarySymbol,
    code: &SymbolCode,
    bar: Option<EngagementBar<'_>>,
    texts: &[SymbolNote],
) -> MilitarySymbol {
    match bar {
        Some(bar) => symbol.with_engagement_bar(code, bar, texts),
        None => symbol,
    }
}

/// What reports call a symbol.
pub(super) fn name<'a>(text: impl Fn(SymbolText) -> Option<&'a str>, code: &str) -> String {
    match (text(SymbolText::UniqueDesignation), text(SymbolText::HigherFormation)) {
        (Some(unit), Some(higher)) => format!("{unit}/{higher}"),
        (Some(unit), None) => unit.to_owned(),
        _ => code.to_owned(),
    }
}

/// A symbol before what its table says of it.
pub(super) struct FoundSymbol {
    pub code: SymbolCode,
    pub symbol: MilitarySymbol,
    pub texts: Vec<SymbolNote>,
    pub fields: Vec<(SymbolText, String)>,
    pub name: String,
    pub ground: Vec3,
}

/// What a table says of its symbols.
pub(super) struct SymbolLook {
    pub direction_deg: Option<f64>,
    pub size: SymbolSize,
    pub rank: f64,
}

impl FoundSymbol {
    fn finished(
        self,
        table: &SymbolTable,
        attributes: &Attributes,
        findings: &mut SceneFindings,
    ) -> SceneSymbol {
        let look = SymbolLook {
            direction_deg: attributes.value(table.direction.as_deref()),
            size: SymbolSize::stated(table.size, table.extent),
            rank: match table.rank.stated() {
                Some(rank) => attributes.value(Some(rank)).unwrap_or(f64::INFINITY),
                None => *table.rank.default(),
            },
        };
        self.looking(look, &table.sidc.span().unwrap_or_default(), findings)
    }

    /// The symbol of the scene; what its code has that is not drawn is told at the bytes `span` of the scene file.
    pub fn looking(self, look: SymbolLook, span: &Range<usize>, findings: &mut SceneFindings) -> SceneSymbol {
        let Self { code, symbol, texts, fields, name, ground } = self;
        for note in &symbol.notes {
            let message = format!("symbol {name}: {note}");
            if !findings.state(&message) {
                findings.add(FindingCode::SymbolIncomplete, span.clone(), message);
            }
        }
        let SymbolLook { direction_deg, size, rank } = look;
        let direction_rad = direction_deg.map(|degrees| degrees.to_radians() as f32);
        SceneSymbol { code, symbol, texts, fields, name, ground, direction_rad, size, rank }
    }
}

impl SymbolSize {
    /// The height in pixels, or that on the ground where one is stated.
    pub(super) fn stated(size: f64, extent_m: Option<f64>) -> Self {
        extent_m.map_or(Self::Design(size as f32), |meters| Self::Ground(meters as f32))
    }
}

/// The features of a file without a symbol.
#[derive(Default)]
struct LeftOutSymbols {
    codeless: usize,
    first: Option<String>,
    off: usize,
}

impl LeftOutSymbols {
    fn no_code(&mut self, error: String) {
        self.codeless += 1;
        self.first.get_or_insert(error);
    }

    fn note(&self, file: &str) -> Option<String> {
        let codeless = self.first.as_ref().map(|first| format!("{} (the first: {first})", self.codeless));
        let off = (self.off > 0).then(|| format!("{} lie off the elevation model", self.off));
        let told: Vec<String> = codeless.into_iter().chain(off).collect();
        (!told.is_empty()).then(|| format!("features of '{file}' without a symbol: {}", told.join(", ")))
    }
}
