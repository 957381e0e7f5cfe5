//! A scene as one HTML file that any browser with WebGL 2 opens without a server and without a network.
//!
//! ```text
//!  DrawList ─► batches, textures ─┐
//!  lattice, ground map ─► ground ─┼─► container: sections of numbers ─► base64 ─┐
//!  labels, cameras, names ────────┴─► description: JSON ────────────────────────┴─► page.html with styles and scripts
//! ```
//!
//! The script shades as `draw/lighting` and `draw/ground` say, pixel by pixel from the ground map, so that tints, relief and
//! contours are as sharp as in a picture at every distance. It is written by hand: the library as WebAssembly would be
//! 2.8 MB packed before any terrain, needs a toolchain that few machines have, and parts of it are in C.

pub mod batches;
mod container;
mod ground;
mod textures;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DVec2, Vec2, Vec3};
use serde_json::{Value, json};

use crate::page::container::{PackedSections, PageSections};
use sandtable_draw::backdrop::Backdrop;
use sandtable_draw::bathymetry::bathymetry;
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::GroundMap;
use sandtable_draw::lighting::{Lighting, ReliefShading};
use sandtable_draw::pixels::Pixels;
use sandtable_draw::shader_constants::{ShaderLanguage, shader_constants};
use sandtable_draw::undergrowth::Undergrowth;
use sandtable_draw::water::WaterColor;
use sandtable_geom::chebyshev::ChebyshevTable;
use sandtable_picture::all_round::AllRoundScene;
use sandtable_picture::detail::ListedForm;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The largest page that is written: browsers take more, but mail and phones do not.
pub const MOST_BYTES: usize = 64_000_000;

/// Bytes that a vertex takes at least: with more of them nothing is packed to find out how many.
const LEAST_VERTEX_BYTES: usize = 2;

/// A scene for a page.
#[derive(Clone, Copy)]
pub struct PageScene<'a> {
    /// The draw list with its ground map, and when each item is shown.
    pub drawn: &'a AllRoundScene,
    /// The heights, true to scale.
    pub lattice: &'a Lattice,
    /// The rest.
    pub facts: &'a PageFacts,
}

/// The texts, names and views of a page.
#[derive(Clone, Debug, Default)]
pub struct PageFacts {
    /// The title; may be empty.
    pub title: String,
    /// A line under it; may be empty.
    pub subtitle: String,
    /// The classification, above and below all else; may be empty.
    pub classification: String,
    /// Sources of the data and remarks, a line each.
    pub credits: Vec<String>,
    /// The name of the coordinate system.
    pub crs: String,
    /// Longitude and latitude in degrees by map coordinates, the longitude without a step at ±180; `None` where the
    /// system has no known place.
    pub lon_lat: Option<ChebyshevTable>,
    /// World Z per meter of elevation.
    pub z_scale: f32,
    /// The greatest error of the drawn ground at any post, meters.
    pub max_error_m: f64,
    /// The box of the drawn ground in world space.
    pub bounds: [Vec3; 2],
    /// World Z of the foot of the block.
    pub base_z: f32,
    /// The distance at which 63 % is haze, 0 for clear air; `None` fits it to the view.
    pub haze_m: Option<f32>,
    /// Names by feature id from 2 on.
    pub features: Vec<String>,
    /// Names and heights on the picture.
    pub labels: Vec<PageLabel>,
    /// Symbols on the picture.
    pub symbols: Vec<PageSymbol>,
    /// Views, the first shown first; at least one.
    pub cameras: Vec<PageCamera>,
}

/// A name on a page.
#[derive(Clone, Debug, PartialEq)]
pub struct PageLabel {
    /// What it says.
    pub text: String,
    /// The place on the ground, world space.
    pub ground: Vec3,
    /// Where it stands, at or above the ground.
    pub anchor: Vec3,
    /// The word for the kind of thing it names.
    pub kind: &'static str,
    /// The lower, the more important.
    pub rank: f64,
    /// The color of its letters; `None` for that of its kind.
    pub color: Option<Srgba>,
}

/// A symbol on a page, such as that of a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct PageSymbol {
    /// What it is called.
    pub name: String,
    /// The place on the ground, world space.
    pub ground: Vec3,
    /// Its picture, for a page 1080 pixels high.
    pub pixels: Pixels,
    /// The place on the ground in its picture, pixels from the upper left.
    pub anchor_px: Vec2,
    /// The lower, the more important.
    pub rank: f64,
}

/// A view of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct PageCamera {
    /// Its name.
    pub name: String,
    /// The eye, world space.
    pub eye: Vec3,
    /// The viewing direction, of unit length.
    pub forward: Vec3,
    /// The direction to the top of the picture, of unit length.
    pub up: Vec3,
    /// The tangent of half the vertical field of view, on a picture 16 wide and 9 high; or half the height in meters,
    /// across parallel rays.
    pub half_height: f32,
    /// Whether rays are parallel.
    pub is_parallel: bool,
    /// How many times as many pixels a meter spans up the picture as across it.
    pub stretch: f32,
}

/// A page that is too large.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the page would have {:.1} MB or more; a page may have {:.0} MB, so that it can be mailed and opened on a phone: state a larger \
     --max-error, a smaller `extent` in [terrain], or a smaller picture in [style.imagery]",
    *.0 as f64 / 1e6, MOST_BYTES as f64 / 1e6
)]
pub struct PageTooLarge(pub usize);

/// The bytes of the page. `watch` says how much of what waits is packed.
///
/// # Errors
/// [`PageTooLarge`].
pub fn page(scene: &PageScene<'_>, watch: &StopFlag) -> Result<Vec<u8>, PageTooLarge> {
    let least =
        LEAST_VERTEX_BYTES * scene.drawn.list.meshes.iter().map(|mesh| mesh.vertices.len()).sum::<usize>();
    if least > MOST_BYTES {
        return Err(PageTooLarge(least));
    }
    let mut sections = PageSections::default();
    let mut description = description(scene, &mut sections);
    let PackedSections { bytes, places, .. } = sections.finish(watch);
    description["sections"] = json!(places);
    let text = as_script_data(&description.to_string());
    let size = text.len() + bytes.len().div_ceil(3) * 4;
    if size > MOST_BYTES {
        return Err(PageTooLarge(size));
    }
    Ok(assemble(&scene.facts.title, &text, &STANDARD.encode(&bytes)).into_bytes())
}

/// The parts of a page, in the order of their marks in `page.html`.
fn assemble(title: &str, description: &str, numbers: &str) -> String {
    const SCRIPTS: [&str; 10] = [
        include_str!("script/numbers.js"),
        include_str!("script/camera.js"),
        include_str!("script/areas.js"),
        include_str!("script/shaders.js"),
        include_str!("script/scene.js"),
        include_str!("script/draw.js"),
        include_str!("script/ground.js"),
        include_str!("script/controls.js"),
        include_str!("script/overlay.js"),
        include_str!("script/main.js"),
    ];
    let title = if title.is_empty() { "Scene".to_owned() } else { as_text(title) };
    let constants = ShaderLanguage::Glsl.declarations(&shader_constants());
    let scripts = format!("const CONSTANTS = `{constants}`;\n{}", SCRIPTS.concat());
    let parts = [
        ("{{title}}", title.as_str()),
        ("{{style}}", include_str!("page.css")),
        ("{{description}}", description),
        ("{{numbers}}", numbers),
        ("{{script}}", scripts.as_str()),
    ];
    let mut page = String::with_capacity(description.len() + numbers.len() + 200_000);
    let mut rest = include_str!("page.html");
    for (mark, part) in parts {
        let (before, after) = rest.split_once(mark).expect("the template has its marks in this order");
        page.push_str(before);
        page.push_str(part);
        rest = after;
    }
    page.push_str(rest);
    page
}

/// Text as content of an HTML element.
fn as_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// JSON as content of a script element, which ends at the first `</script` and must not hold `<!--`.
fn as_script_data(json: &str) -> String {
    json.replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

fn description(scene: &PageScene<'_>, sections: &mut PageSections) -> Value {
    let PageScene { drawn: AllRoundScene { list, shown, bands_m, forms, .. }, lattice, facts } = *scene;
    let level = GroundMap::level();
    let map = list.ground.as_deref().unwrap_or(&level);
    let imagery = map.imagery.as_deref().map(|imagery| {
        json!({
            "picture": textures::picture(sections, &imagery.pixels),
            "origin": imagery.origin.to_array(),
            "size": imagery.size.to_array(),
            "isShaded": imagery.is_shaded,
        })
    });
    let textures: Vec<Value> =
        list.textures.iter().map(|pixels| textures::picture(sections, pixels)).collect();
    json!({
        "title": facts.title,
        "subtitle": facts.subtitle,
        "classification": facts.classification,
        "credits": facts.credits,
        "crs": facts.crs,
        "lonLat": facts.lon_lat.as_ref().map(lon_lat),
        "zScale": facts.z_scale,
        "maxError": facts.max_error_m,
        "bounds": facts.bounds.map(|corner| corner.to_array()),
        "baseZ": facts.base_z,
        "haze": facts.haze_m,
        "bands": bands_m,
        "features": facts.features,
        "labels": facts.labels.iter().map(label).collect::<Vec<_>>(),
        "symbols": facts.symbols.iter().map(|it| symbol(it, sections)).collect::<Vec<_>>(),
        "forms": forms.iter().map(form).collect::<Vec<_>>(),
        "cameras": facts.cameras.iter().map(camera).collect::<Vec<_>>(),
        "light": light(&list.lighting),
        "ground": ground::heights(sections, lattice),
        "map": ground::map(sections, map),
        "imagery": imagery,
        "materials": list.materials.iter().map(batches::material).collect::<Vec<_>>(),
        "textures": textures,
        "batches": batches::batches(sections, list, shown),
    })
}

fn lon_lat(table: &ChebyshevTable) -> Value {
    let pair = |at: &DVec2| [at.x, at.y];
    json!({
        "min": pair(&table.rect.min),
        "max": pair(&table.rect.max),
        "points": table.points,
        "values": table.values.iter().map(pair).collect::<Vec<_>>(),
        "error": table.error,
    })
}

fn label(label: &PageLabel) -> Value {
    json!({
        "text": label.text,
        "ground": label.ground.to_array(),
        "anchor": label.anchor.to_array(),
        "kind": label.kind,
        "rank": label.rank,
        "color": label.color.map(|color| color.0),
    })
}

fn symbol(symbol: &PageSymbol, sections: &mut PageSections) -> Value {
    json!({
        "name": symbol.name,
        "ground": symbol.ground.to_array(),
        "picture": textures::picture(sections, &symbol.pixels),
        "anchor": symbol.anchor_px.to_array(),
        "rank": symbol.rank,
    })
}

fn form(form: &ListedForm) -> Value {
    json!({
        "group": form.group,
        "error": form.error,
        "center": form.center.to_array(),
        "radius": form.radius,
        "isPlant": form.is_plant,
    })
}

fn camera(camera: &PageCamera) -> Value {
    json!({
        "name": camera.name,
        "eye": camera.eye.to_array(),
        "forward": camera.forward.to_array(),
        "up": camera.up.to_array(),
        "halfHeight": camera.half_height,
        "isParallel": camera.is_parallel,
        "stretch": camera.stretch,
    })
}

/// The light, and the constants of colors that no scene changes; all in linear light.
fn light(light: &Lighting) -> Value {
    let sides = ReliefShading::new(light.to_sun).sides;
    let stop = |(height, color): &(f32, Vec3)| [*height, color.x, color.y, color.z];
    json!({
        "toSun": light.to_sun.to_array(),
        "sun": light.sun.to_array(),
        "sky": light.sky.to_array(),
        "bounce": light.bounce.to_array(),
        "haze": light.haze.color.to_array(),
        "zenith": light.zenith.to_array(),
        "sides": sides.map(|side| side.to_array()),
        "sideShares": ReliefShading::SIDE_SHARES,
        "studioTop": ground::srgb(Backdrop::STUDIO_TOP.linear()),
        "studioBottom": ground::srgb(Backdrop::STUDIO_BOTTOM.linear()),
        "horizon": Backdrop::HORIZON,
        "bathymetry": bathymetry().stops().iter().map(stop).collect::<Vec<_>>(),
        "undergrowth": Undergrowth::COLOR.linear().extend(Undergrowth::MOST).to_array(),
        "shallow": WaterColor::SHALLOW.linear().extend(WaterColor::OFF_SHORE).to_array(),
        "open": WaterColor::OPEN.linear().to_array(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::list::DrawList;

    fn page_of(facts: &PageFacts) -> String {
        let heights = (0..12u8).map(f32::from).collect();
        let lattice = Lattice::new(DVec2::new(500.0, 900.0), DVec2::splat(10.0), 4, heights).expect("sound");
        let drawn = AllRoundScene {
            list: DrawList::default(),
            shown: Vec::new(),
            bands_m: Vec::new(),
            forms: Vec::new(),
            graphic_texts: Vec::new(),
        };
        let scene = PageScene { drawn: &drawn, lattice: &lattice, facts };
        String::from_utf8(page(&scene, &StopFlag::default()).expect("small")).expect("text")
    }

    /// What a script element holds.
    fn element<'a>(page: &'a str, id: &str) -> &'a str {
        let start = page.find(&format!("<script id=\"{id}\"")).expect("it is there");
        let content = &page[start + page[start..].find('>').expect("its tag ends") + 1..];
        &content[..content.find("</script").expect("it ends")]
    }

    #[test]
    fn a_page_names_no_other_file_and_no_address() {
        let page = page_of(&PageFacts::default());
        for word in [
            "http:",
            "https:",
            "//cdn",
            "fetch(",
            "XMLHttpRequest",
            "WebSocket",
            "import(",
            "@import",
            "src=",
        ] {
            assert!(!page.contains(word), "{word}");
        }
        assert!(page.contains("Content-Security-Policy") && page.contains("default-src 'none'"));
        assert_eq!(page.matches("href=").count(), page.matches("href=\"data:,\"").count());
        assert_eq!(page.matches("{{").count(), 0, "a mark of the template is left");
    }

    #[test]
    fn names_cannot_end_the_script_that_holds_them() {
        let evil = "</script><script>alert(1)</script><!-- {{numbers}} \u{2028} \" & <b>";
        let label = PageLabel {
            text: evil.into(),
            ground: Vec3::ZERO,
            anchor: Vec3::Z,
            kind: "point",
            rank: 1.0,
            color: None,
        };
        let facts = PageFacts {
            title: evil.into(),
            features: vec![evil.into()],
            labels: vec![label],
            credits: vec![evil.into()],
            ..PageFacts::default()
        };
        let page = page_of(&facts);
        assert_eq!(page.matches("<script").count(), 3);
        assert!(!page.contains("<!--") && !page.contains("alert(1)</") && !page.contains("<b>"));
        let description: Value = serde_json::from_str(element(&page, "description")).expect("sound JSON");
        for text in [&description["title"], &description["features"][0], &description["labels"][0]["text"]] {
            assert_eq!(text, evil);
        }
    }

    #[test]
    fn heights_in_a_page_are_those_of_the_lattice_to_the_bit() {
        let page = page_of(&PageFacts::default());
        let description: Value = serde_json::from_str(element(&page, "description")).expect("sound JSON");
        let bytes = STANDARD.decode(element(&page, "numbers")).expect("sound base64");
        let places = serde_json::from_value(description["sections"].clone()).expect("pairs of numbers");
        let mut sections = PackedSections::default();
        (sections.bytes, sections.places) = (bytes, places);
        let heights = container::tests::words(&sections, &description["ground"]["heights"]);
        assert_eq!(heights, (0..12u8).map(|height| f32::from(height).to_bits()).collect::<Vec<_>>());
        assert_eq!(description["ground"]["origin"], json!([500.0, 900.0]));
    }

    #[test]
    fn a_page_too_large_says_how_large_and_what_to_do() {
        let text = PageTooLarge(123_456_789).to_string();
        assert!(text.starts_with("the page would have 123.5 MB or more; a page may have 64 MB"), "{text}");
        assert!(text.contains("--max-error") && text.contains("extent"));
    }
}
