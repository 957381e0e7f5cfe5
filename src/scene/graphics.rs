//! Tactical graphics: from the tables of a scene file to points in world space, checked against their draw rules.

use std::ops::RangeInclusive;

use glam::DVec2;

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::feature::FeatureKind;
use crate::scene_findings::FeatureTable;
use crate::scene_graphic::SceneGraphic;
use crate::sources::Sources;
use sandtable_base::limits::SCENE_GRAPHICS;
use sandtable_base::message::numbers::fixed;
use sandtable_base::message::suggest::{nearest, quoted};
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::feature_value::FromScalar;
use sandtable_description::graphics::GraphicTable;
use sandtable_description::scalar::Scalar;
use sandtable_description::stated::Stated;
use sandtable_description::words::{GraphicOrder, GraphicSide, GraphicStatus};
use sandtable_draw::list::FeatureId;
use sandtable_geom::rect::Rect;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::fields::{SymbolIdentity, SymbolSet, SymbolStatus};
use sandtable_symbology::graphic::check::{GraphicError, MOST_RANGES, PlacedGraphic, check};
use sandtable_symbology::graphic::fields::{ECHELONS, GraphicFields, echelon_mark};
use sandtable_symbology::graphic::kind::{GraphicKind, GraphicShape};
use sandtable_symbology::graphic::kind_table::GRAPHIC_KINDS;
use sandtable_symbology::graphic::rules::points_of;
use sandtable_vector::feature::Geometry;

/// The mark of the enemy (field N).
const ENEMY: &str = "ENY";

/// The distances that a property may list, as those of the keys.
const LISTED_DISTANCES_M: RangeInclusive<f64> = 1e-3..=1e7;
/// The greatest width that a property may state, as the key.
const WIDEST_M: f64 = 1e6;

/// Adds the document's graphics to `collected`; those of files that lie off the ground are left out with a note. It keeps an
/// error where a source cannot be had, or a graphic does not fit its draw rule.
pub fn lay(document: &Document, sources: &Sources<'_>, extent: &Rect, collected: &mut SceneBuilder) {
    for table in &document.graphics {
        let mut off = 0;
        let placed = placed(table, sources);
        for (attributes, points) in collected.errors.keep(placed).into_iter().flatten() {
            let graphic = graphic(table, &attributes, points, document);
            let Some(graphic) = collected.errors.keep(graphic).flatten() else { continue };
            let reach_m = graphic.fields.distances_m.iter().copied().fold(0.0, f64::max);
            if !Rect::around(graphic.points.iter().copied()).grown(reach_m).meets(extent) {
                off += 1;
                continue;
            }
            if collected.graphics.len() == SCENE_GRAPHICS.count() {
                let message = format!("the scene has more than {SCENE_GRAPHICS} graphics");
                let help = format!("select fewer of them with `where`, or {SCENE_GRAPHICS:#}");
                let error = document.error_at(table.source.span(), message).with_help(help);
                collected.errors.keep::<()>(Err(error));
                return;
            }
            let name = attributes.name(table.name.as_deref());
            let feature = collected.add(FeatureKind::Graphic, name, attributes.origin(&table.source));
            collected.graphics.push(SceneGraphic { feature, ..graphic });
        }
        let name = table.name.as_deref();
        let named = FeatureTable { kind: FeatureKind::Graphic, name, source: &table.source };
        collected.findings.left_out(off, &named, "off the elevation model");
    }
}

/// The points of every graphic of a table, in world space, with the properties of its feature.
fn placed(table: &GraphicTable, sources: &Sources<'_>) -> Result<Vec<(Attributes, Vec<DVec2>)>, Diagnostic> {
    if table.source.points.is_some() {
        let lines = sources.lines(&table.source)?;
        return Ok(lines.into_iter().map(|line| (line.attributes, line.shape)).collect());
    }
    let (crs, features) = sources.features(&table.source)?;
    let frame = sources.frame;
    let mut placed = Vec::new();
    for attributes in features {
        let shapes: Vec<Vec<DVec2>> = match attributes.geometry() {
            Some(Geometry::Points(points)) => points.iter().map(|&point| vec![point]).collect(),
            Some(Geometry::Lines(lines)) => lines.clone(),
            Some(Geometry::Polygons(polygons)) => {
                polygons.iter().map(|polygon| polygon.exterior.clone()).collect()
            }
            None => Vec::new(),
        };
        for shape in shapes {
            let world: Result<Vec<DVec2>, _> = shape.into_iter().map(|at| frame.world(&crs, at)).collect();
            let world = world.map_err(|error| frame.document.error_at(table.source.span(), error))?;
            placed.push((attributes.clone(), world));
        }
    }
    Ok(placed)
}

/// One graphic, without its feature; `None` for a feature of a file whose properties name no kind.
pub(super) fn graphic(
    table: &GraphicTable,
    attributes: &Attributes,
    mut points: Vec<DVec2>,
    document: &Document,
) -> Result<Option<SceneGraphic>, Diagnostic> {
    let property = |key: &str| match attributes.get(key) {
        Some(Scalar::Text(text)) => Some(text),
        Some(Scalar::Number(number)) => Some(number.to_string()),
        _ => None,
    };
    let number = |key: &str| attributes.get(key).and_then(|value| value.number());
    let listed = |key: &str, range: RangeInclusive<f64>| {
        property(key).map_or_else(|| Ok(Vec::new()), |text| numbers_of(key, &text, range))
    };
    let text =
        |stated: &Option<String>, key: &str| stated.clone().or_else(|| property(key)).unwrap_or_default();
    let stated_or = |stated: &Option<Stated<String>>, rival: bool, key: &str| {
        stated.as_ref().map(|word| word.to_string()).or_else(|| property(key).filter(|_| !rival))
    };
    let sidc = stated_or(&table.sidc, table.kind.is_some(), "sidc");
    let word = stated_or(&table.kind, table.sidc.is_some(), "kind");
    let span = [&table.sidc, &table.kind].into_iter().flatten().find_map(Stated::span);
    let span = span.unwrap_or_else(|| table.source.span());
    let failed = |message: String, help: String| document.error_at(span.clone(), message).with_help(help);
    let code = match &sidc {
        Some(sidc) => Some(SymbolCode::parse(sidc).map_err(|error| document.error_at(span.clone(), error))?),
        None => None,
    };
    let kind = match (&code, &word) {
        (Some(code), _) => kind_of_code(code).map_err(|(message, help)| failed(message, help))?,
        (None, Some(word)) => kind_of_word(word).map_err(|(message, help)| failed(message, help))?,
        (None, None) => return Ok(None),
    };
    let echelon = text(&table.echelon, "echelon");
    let echelon =
        if echelon.is_empty() { code.map(|code| echelon_of(&code)).unwrap_or_default() } else { echelon };
    let side = table.side.or_else(|| code.map(|code| side_of(code.identity))).unwrap_or_default();
    let hostile = text(&table.hostile, "hostile");
    let is_marked = kind.set == 25 && (kind.is_area() || kind.shows("N"));
    let hostile = match (side, hostile.as_str()) {
        (GraphicSide::Hostile, "") if is_marked => ENEMY.to_owned(),
        _ => hostile,
    };
    let designation = match text(&table.designation, "designation") {
        stated if stated.is_empty() => property("unique_designation").unwrap_or_default(),
        stated => stated,
    };
    let heights = table.elevations.map(|range| range.map(|meters| format!("{} m", fixed(meters, 0))));
    let fields = GraphicFields {
        designation,
        designation_2: text(&table.designation_2, "designation_2"),
        echelon: echelon_mark(&echelon).to_owned(),
        country: text(&table.country, "country"),
        hostile,
        further: text(&table.further, "further"),
        equipment: text(&table.equipment, "type"),
        quantity: text(&table.quantity, "quantity"),
        location: text(&table.location, "location"),
        direction_deg: table.direction.or_else(|| number("direction")),
        target: text(&table.target, "target"),
        from: text(&table.from, "from"),
        until: text(&table.until, "until"),
        heights: heights.map(Vec::from).unwrap_or_default(),
        distances_m: match &table.distances {
            Some(stated) => numbers(stated, document)?,
            None => {
                listed("distances", LISTED_DISTANCES_M).map_err(|(message, help)| failed(message, help))?
            }
        },
        azimuths_deg: match table.azimuths.as_deref() {
            Some(stated) => stated.clone(),
            None => listed("azimuths", -360.0..=360.0).map_err(|(message, help)| failed(message, help))?,
        },
    };
    if kind.is_area() && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let width_m = table.width.or_else(|| number("width")).filter(|width| *width > 0.0 && *width < WIDEST_M);
    let order =
        table.order.or_else(|| attributes.get("order").and_then(|word| GraphicOrder::from_scalar(&word, ())));
    if order == Some(GraphicOrder::Drawn) && !kind.leads_from_tip() {
        let message = format!("`order` has no effect on {}, whose points do not lead from a tip", kind.word);
        return Err(failed(message, format!("its points are: {}", points_of(kind))));
    }
    let is_axis_with_width = kind.shape == GraphicShape::Axis && width_m.is_some();
    if order.unwrap_or(if is_axis_with_width { GraphicOrder::Drawn } else { GraphicOrder::Standard })
        == GraphicOrder::Drawn
    {
        kind.turn_to_standard(&mut points, width_m.is_some());
    }
    let placed = PlacedGraphic { points: &points, width_m, fields: &fields };
    check(kind, &placed).map_err(|error| {
        let place =
            if matches!(error, GraphicError::Missing { .. }) { span.clone() } else { table.source.span() };
        let help = error.help();
        document.error_at(place, error).with_help(help)
    })?;
    let planned = code.is_some_and(|code| code.status == SymbolStatus::Planned);
    let status = if planned { GraphicStatus::Planned } else { GraphicStatus::Present };
    Ok(Some(SceneGraphic {
        kind,
        points,
        width_m,
        fields,
        side,
        status: table.status.unwrap_or(status),
        elevations_m: table.elevations,
        style: None,
        feature: FeatureId::NONE,
    }))
}

/// The stated distances, as many as a graphic may have.
fn numbers(distances: &Stated<Vec<f64>>, document: &Document) -> Result<Vec<f64>, Diagnostic> {
    if distances.len() > MOST_RANGES {
        let message = format!("{} distances are more than the {MOST_RANGES} allowed", distances.len());
        return Err(document.error(distances, message).with_help("leave some of them out"));
    }
    Ok(distances.to_vec())
}

/// The numbers that a property of a file's feature lists, separated by spaces, commas or semicolons.
fn numbers_of(key: &str, text: &str, range: RangeInclusive<f64>) -> Result<Vec<f64>, (String, String)> {
    /// More than the ranges of a fan, and their azimuths.
    const MOST_NUMBERS: usize = 2 * MOST_RANGES;
    let words = text.split([' ', ',', ';']).filter(|word| !word.is_empty());
    let numbers: Result<Vec<f64>, &str> = words
        .take(MOST_NUMBERS)
        .map(|word| word.parse().ok().filter(|number: &f64| range.contains(number)).ok_or(word))
        .collect();
    numbers.map_err(|word| {
        let message = format!("the property `{key}` lists '{}'", quoted(word));
        (message, format!("write it as `500, 1000`, each from {} to {}", range.start(), range.end()))
    })
}

fn kind_of_word(word: &str) -> Result<&'static GraphicKind, (String, String)> {
    // Six digits are of symbol set 25; eight begin with the set.
    let of_digits = || match word.split_at_checked(2) {
        Some((set, entity)) if entity.len() == 6 => GraphicKind::of_code(set.parse().ok()?, entity),
        _ => GraphicKind::of_code(25, word),
    };
    if let Some(kind) = GraphicKind::of_word(word).or_else(of_digits) {
        return Ok(kind);
    }
    let near = nearest(word, GRAPHIC_KINDS.iter().map(|kind| kind.word));
    let help = near.map_or_else(
        || "scenes/SYMBOLS.md lists the words and codes".to_owned(),
        |near| format!("did you mean `{near}`?"),
    );
    Err((format!("no graphic is called '{}'", quoted(word)), help))
}

fn kind_of_code(code: &SymbolCode) -> Result<&'static GraphicKind, (String, String)> {
    let help = "scenes/SYMBOLS.md lists the codes of graphics".to_owned();
    if !matches!(code.set, SymbolSet::ControlMeasure | SymbolSet::Atmosphere | SymbolSet::Ocean) {
        let message = format!(
            "the code is of symbol set {:02}, and graphics are of sets 25, 45 and 46",
            code.set.number()
        );
        return Err((message, "use `[[symbol]]` for it".to_owned()));
    }
    let digits = format!("{:06}", code.entity);
    GraphicKind::of_code(code.set.number(), &digits).ok_or_else(|| {
        (
            format!("symbol set {:02} has no line, area or point {digits} that is drawn", code.set.number()),
            help,
        )
    })
}

/// The word of a code's echelon; empty where it has none.
fn echelon_of(code: &SymbolCode) -> String {
    /// The numbers of [`ECHELONS`] in a code.
    const NUMBERS: [u8; 14] = [11, 12, 13, 14, 15, 16, 17, 18, 21, 22, 23, 24, 25, 26];
    let place = NUMBERS.iter().position(|&number| number == code.amplifier.number());
    place.map_or_else(String::new, |place| ECHELONS[place].0.to_owned())
}

fn side_of(identity: SymbolIdentity) -> GraphicSide {
    match identity {
        SymbolIdentity::Friend | SymbolIdentity::AssumedFriend => GraphicSide::Friend,
        SymbolIdentity::Suspect | SymbolIdentity::Hostile => GraphicSide::Hostile,
        SymbolIdentity::Neutral => GraphicSide::Neutral,
        _ => GraphicSide::Unknown,
    }
}
