//! Buildings of CityJSON: their own surfaces, at their own heights or set on the ground.
//!
//! An object and its parts keep their heights to each other. Where the table does not say at which height they stand,
//! they keep those of the file, unless most of them lie far off the ground there: then those are counted from another
//! zero, and each building is set on its ground. The scene's notes say which was done, and by how many meters the heights
//! of the file and of the ground differ. Under all of them walls reach into the ground.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::attributes::Attributes;
use crate::builder::SceneBuilder;
use crate::buildings::{FOUNDATION_M, GroundUnder, pad, stated_colors};
use crate::city_paint::{CityPaint, role};
use crate::feature::FeatureKind;
use crate::feature_meshes::{Coat, FeatureSolid, Solid};
use crate::scene_findings::SceneFindings;
use crate::sources::{Sourced, Sources};
use crate::vertical_scale::DrawnGround;
use sandtable_base::message::numbers::fixed;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::features::BuildingTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::BaseRule;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex, FeatureId};
use sandtable_geom::crs::Crs;
use sandtable_mesh::sink::MeshSink;
use sandtable_model::texture_files;
use sandtable_structure::building::Paint;
use sandtable_structure::building_footing::WallFooting;
use sandtable_structure::building_footprint::BuildingFootprint;
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_structure::faces::Faces;
use sandtable_structure::space_polygon;
use sandtable_structure::unit_roof::centroid;
use sandtable_terrain::lattice::Lattice;
use sandtable_vector::cityjson::CityModel;
use sandtable_vector::cityjson::body::{CityBody, CitySurface, SurfaceRole};
use sandtable_vector::feature::Polygon;

/// How far most buildings of a file may lie off the ground and still keep their own heights, meters: more than elevation
/// models and city models differ by, less than vertical datums do.
const OWN_HEIGHTS_M: f64 = 5.0;

/// How far a building at its own height may stand over the ground, or in it, before it is reported, meters.
const OFF_GROUND_M: f64 = 2.5;

/// Objects that lie on the ground, are in it or are no solids: other tables draw them.
const NOT_RAISED: [&str; 14] = [
    "Road",
    "Railway",
    "TransportSquare",
    "Waterway",
    "WaterBody",
    "LandUse",
    "PlantCover",
    "SolitaryVegetationObject",
    "TINRelief",
    "CityObjectGroup",
    "BuildingRoom",
    "BuildingUnit",
    "BuildingStorey",
    "BuildingFurniture",
];

/// The buildings of a table's CityJSON file, not raised yet.
pub(super) struct CityPlots {
    /// The table, by its number among the document's buildings.
    pub table: usize,
    groups: Vec<CityGroup>,
}

/// A building with its parts.
struct CityGroup {
    members: Vec<CityMember>,
    /// Of each member.
    attributes: Vec<Attributes>,
    /// The footprints of all, world X and Y.
    footprints: Vec<BuildingFootprint>,
    /// The lowest height of their surfaces, meters.
    low_m: f64,
    pad_m: Option<f64>,
}

struct CityMember {
    feature: FeatureId,
    /// World X and Y, and heights in meters.
    surfaces: Vec<CitySurface>,
    paint: CityPaint,
}

/// Refuses keys of a building that only CityJSON takes.
///
/// # Errors
/// One of them is stated.
pub(super) fn refuse_keys(document: &Document, building: &BuildingTable) -> Result<(), Diagnostic> {
    let help = "name a CityJSON file, or remove the key";
    if let Some(lod) = &building.lod {
        let message = "`lod` has an effect on CityJSON only, whose objects have levels of detail";
        return Err(document.error(lod, message).with_help(help));
    }
    if building.base == Some(BaseRule::Own) {
        let message =
            "`base = \"own\"` needs a file that states the heights of its surfaces, which is CityJSON";
        return Err(document.error_at(building.source.span(), message).with_help(help));
    }
    Ok(())
}

/// The buildings of a table, and the ground leveled under those whose base is a pad.
///
/// # Errors
/// The file cannot be read.
pub(super) fn lay_out(
    table: usize,
    building: &BuildingTable,
    model: &CityModel,
    sources: &Sources<'_>,
    lattice: &mut Lattice,
    collected: &mut SceneBuilder,
) -> Result<CityPlots, Diagnostic> {
    let span = building.source.span();
    note_unused_keys(building, collected);
    let polygons = sources.polygons(&building.source)?;
    let crs = sources.features(&building.source)?.0;
    let takes_all = building.source.selection.is_none();
    let mut tally = CityTally::default();
    let pictures = load_pictures(building, model, sources, collected);
    // An object has several footprints where its surfaces lie apart.
    let mut objects: BTreeMap<&str, CityFootprints<'_>> = BTreeMap::new();
    let mut order: Vec<&str> = Vec::new();
    for Sourced { attributes, shape, .. } in &polygons {
        let Some(id) = attributes.text("id") else { continue };
        let entry = objects.entry(id).or_insert_with(|| {
            order.push(id);
            CityFootprints { attributes, parts: Vec::new() }
        });
        let Polygon { exterior, holes } = shape;
        entry.parts.extend(BuildingFootprint::parts(exterior, holes));
    }
    let mut groups: Vec<CityGroup> = Vec::new();
    let mut group_of: BTreeMap<&str, usize> = BTreeMap::new();
    for id in order {
        let (Some(object), Some(CityFootprints { attributes, parts })) =
            (model.objects.get(id), objects.remove(id))
        else {
            continue;
        };
        if takes_all && NOT_RAISED.contains(&object.kind.as_str()) {
            tally.add_kind(&object.kind);
            continue;
        }
        if !parts.is_empty() && GroundUnder::parts(lattice, &parts).is_none() {
            tally.off += 1;
            continue;
        }
        let wanted = building.lod.as_ref().map(|lod| lod.as_str());
        let Some(body) = object.body(wanted) else { continue };
        tally.other_lod += usize::from(wanted.is_some_and(|wanted| wanted != body.lod));
        let Some(surfaces) = placed(body, &crs, sources, &pictures) else {
            tally.off += 1;
            continue;
        };
        tally.too_large += surfaces.iter().filter(|surface| is_too_large(surface)).count();
        let low_m = lowest(&surfaces);
        let is_sloped = surfaces.iter().any(is_sloped_roof);
        let place = parts.first().map_or(DVec2::ZERO, |part| centroid(part.exterior()));
        let default = Paint::at(place, is_sloped);
        let paint = CityPaint { stated: stated_colors(building, attributes), default };
        let group = *group_of.entry(&object.root).or_insert_with(|| {
            groups.push(CityGroup::default());
            groups.len() - 1
        });
        let group = &mut groups[group];
        group.members.push(CityMember { feature: FeatureId::NONE, surfaces, paint });
        group.attributes.push(attributes.clone());
        group.footprints.extend(parts);
        group.low_m = group.low_m.min(low_m);
    }
    // A part too small to stand by itself stands with the others.
    let (mut groups, empty): (Vec<CityGroup>, Vec<CityGroup>) =
        groups.into_iter().partition(|group| !group.footprints.is_empty());
    tally.empty += empty.iter().map(|group| group.members.len()).sum::<usize>();
    for (member, attributes) in
        groups.iter_mut().flat_map(|group| group.members.iter_mut().zip(&group.attributes))
    {
        let name = attributes.name(building.name.as_deref());
        member.feature = collected.add(FeatureKind::Building, name, attributes.origin(&building.source));
    }
    if building.base == Some(BaseRule::Pad) {
        for group in &mut groups {
            let Some(ground) = GroundUnder::parts(lattice, &group.footprints) else { continue };
            group.pad_m = pad(lattice, &group.footprints, ground.mean_m, "", collected);
            tally.pads_refused += usize::from(group.pad_m.is_none());
        }
    }
    tally.note(span, &mut collected.findings);
    Ok(CityPlots { table, groups })
}

/// Reports keys of footprints that are raised, which say nothing of surfaces.
fn note_unused_keys(building: &BuildingTable, collected: &mut SceneBuilder) {
    let keys = [
        ("height", building.height.is_some()),
        ("roof", building.roof.is_some()),
        ("roof_height", building.roof_height.is_some()),
        ("roof_direction", building.roof_direction.is_some()),
    ];
    let stated: Vec<String> =
        keys.iter().filter(|(_, is_stated)| *is_stated).map(|(key, _)| format!("`{key}`")).collect();
    if !stated.is_empty() {
        let message =
            format!("without effect on CityJSON, whose own surfaces are drawn: {}", stated.join(", "));
        collected.findings.add(FindingCode::DefaultTaken, building.source.span(), message);
    }
}

/// The footprints of an object.
struct CityFootprints<'a> {
    attributes: &'a Attributes,
    parts: Vec<BuildingFootprint>,
}

impl Default for CityGroup {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            attributes: Vec::new(),
            footprints: Vec::new(),
            low_m: f64::INFINITY,
            pad_m: None,
        }
    }
}

/// The numbers among the scene's pictures of a file's images that could be loaded.
fn load_pictures(
    building: &BuildingTable,
    model: &CityModel,
    sources: &Sources<'_>,
    collected: &mut SceneBuilder,
) -> Vec<Option<usize>> {
    let Some(file) = building.source.file.as_ref().filter(|_| !model.images.is_empty()) else {
        return Vec::new();
    };
    let used: BTreeSet<usize> = model
        .objects
        .values()
        .filter_map(|object| object.body(building.lod.as_ref().map(|lod| lod.as_str())))
        .flat_map(|body| body.surfaces.iter().filter_map(|surface| Some(surface.texture.as_ref()?.image)))
        .collect();
    let companions = match sources.assets.beside(file) {
        Ok(companions) => companions,
        Err(error) => {
            let message = format!("its textures are not drawn: {error}");
            collected.findings.add(FindingCode::TextureMissing, building.source.span(), message);
            return Vec::new();
        }
    };
    let names = |index: usize| used.contains(&index).then(|| model.images[index].as_str());
    let wanted: Vec<Option<&str>> = (0..model.images.len()).map(names).collect();
    let loaded = texture_files::load(&wanted, &companions);
    for note in loaded.notes {
        collected.findings.add(FindingCode::TextureMissing, building.source.span(), note);
    }
    let first = collected.pictures.len();
    collected.pictures.extend(loaded.pictures);
    loaded.numbers.into_iter().map(|number| number.map(|number| first + number)).collect()
}

/// The surfaces of a body in world X and Y, their textures by their numbers among the scene's pictures; `None` where they
/// cannot be brought to the scene's system.
fn placed(
    body: &CityBody,
    crs: &Crs,
    sources: &Sources<'_>,
    pictures: &[Option<usize>],
) -> Option<Vec<CitySurface>> {
    let place = |at: &DVec3| Some(sources.frame.world(crs, at.truncate()).ok()?.extend(at.z));
    let ring = |ring: &Vec<DVec3>| ring.iter().map(place).collect::<Option<Vec<_>>>();
    let surface = |surface: &CitySurface| {
        let rings = surface.rings.iter().map(ring).collect::<Option<Vec<_>>>()?;
        let texture = surface.texture.as_ref().and_then(|texture| {
            let image = pictures.get(texture.image).copied().flatten()?;
            Some(sandtable_vector::cityjson::body::SurfaceTexture { image, places: texture.places.clone() })
        });
        Some(CitySurface { rings, texture, ..surface.clone() })
    };
    body.surfaces.iter().filter(|surface| surface.role != Some(SurfaceRole::Unseen)).map(surface).collect()
}

fn lowest(surfaces: &[CitySurface]) -> f64 {
    surfaces.iter().flat_map(|surface| &surface.rings[0]).map(|at| at.z).fold(f64::INFINITY, f64::min)
}

fn is_too_large(surface: &CitySurface) -> bool {
    surface.rings.iter().map(Vec::len).sum::<usize>() > space_polygon::MOST_VERTICES
}

/// Whether a roof rises at least 5°.
fn is_sloped_roof(surface: &CitySurface) -> bool {
    role(surface) == SurfaceRole::Roof && surface.doubled_area().normalize_or(DVec3::Z).z.abs() < 0.996
}

/// Raises the buildings of a table on the ground as it is now.
pub(super) fn raise(
    building: &BuildingTable,
    plots: &CityPlots,
    ground: DrawnGround<'_>,
    collected: &mut SceneBuilder,
) {
    let under: Vec<Option<GroundUnder>> =
        plots.groups.iter().map(|group| GroundUnder::parts(ground.lattice, &group.footprints)).collect();
    let gaps: Vec<f64> = plots
        .groups
        .iter()
        .zip(&under)
        .filter_map(|(group, under)| Some(gap_m(group.low_m, (*under)?)))
        .collect();
    let Some(middle_m) = median(gaps.clone()) else { return };
    let keeps_own = match building.base {
        Some(rule) => rule == BaseRule::Own,
        None => middle_m.abs() <= OWN_HEIGHTS_M,
    };
    note_heights(building, (keeps_own, middle_m), &gaps, &mut collected.findings);
    for (group, under) in plots.groups.iter().zip(under) {
        let Some(under) = under else { continue };
        let base_m = match (keeps_own, group.pad_m) {
            (true, _) => group.low_m,
            (false, Some(level_m)) => level_m,
            (false, None) => under.level_m(building.base.unwrap_or(BaseRule::Lowest)),
        };
        raise_group(group, base_m, under, ground, collected);
    }
}

/// How far the lowest height of a building lies over the highest ground under it, or, negative, under the lowest.
fn gap_m(low_m: f64, under: GroundUnder) -> f64 {
    (low_m - under.high_m).max(0.0) + (low_m - under.low_m).min(0.0)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

fn note_heights(
    building: &BuildingTable,
    (keeps_own, middle_m): (bool, f64),
    gaps: &[f64],
    findings: &mut SceneFindings,
) {
    let span = building.source.span();
    let count = gaps.len();
    let noun = FeatureKind::Building.noun(count);
    let side = |gap_m: f64| match gap_m {
        gap_m if gap_m.abs() < 0.05 => "on the ground".to_owned(),
        gap_m if gap_m > 0.0 => format!("{} m over the ground", fixed(gap_m, 1)),
        gap_m => format!("{} m under the ground", fixed(-gap_m, 1)),
    };
    if !keeps_own {
        let why = match building.base {
            None => ", because its heights are far off: state `base = \"own\"` to keep them",
            Some(_) => "",
        };
        let message = format!(
            "{count} {noun} set on the ground; at the heights of the file most would stand {}{why}",
            side(middle_m)
        );
        return findings.add(FindingCode::CityHeights, span, message);
    }
    let message = format!(
        "{count} {noun} at the heights of the file, at which most stand {}; state `base = \"lowest\"` to set each on the ground",
        side(middle_m)
    );
    findings.add(FindingCode::CityHeights, span.clone(), message);
    for (is_over, what) in
        [(true, "over the ground on walls that reach down to it"), (false, "in the ground")]
    {
        let off = gaps.iter().filter(|gap| gap.abs() > OFF_GROUND_M && (**gap > 0.0) == is_over);
        let (count, most_m) = off.fold((0, 0.0_f64), |(count, most), gap| (count + 1, most.max(gap.abs())));
        if count > 0 {
            let noun = FeatureKind::Building.noun(count);
            let message = format!(
                "{count} {noun} stand more than {OFF_GROUND_M} m {what}, up to {} m, at the heights of the file",
                fixed(most_m, 1)
            );
            findings.add(FindingCode::CityOffGround, span.clone(), message);
        }
    }
}

/// Raises a building with its parts, whose lowest height comes to lie at `base_m`.
fn raise_group(
    group: &CityGroup,
    base_m: f64,
    under: GroundUnder,
    ground: DrawnGround<'_>,
    collected: &mut SceneBuilder,
) {
    let base_z = ground.scale.world_z(base_m);
    let foot_z = ground.scale.world_z(under.low_m.min(base_m)) - FOUNDATION_M;
    for CityMember { feature, surfaces, paint } in &group.members {
        let lift = |at: DVec3| at.with_z(at.z - group.low_m + base_z);
        let mut meshes: BTreeMap<Option<usize>, DrawMesh> = BTreeMap::new();
        for surface in surfaces {
            let picture = surface.texture.as_ref().map(|texture| texture.image);
            add_surface(surface, paint.color(surface), lift, meshes.entry(picture).or_default());
        }
        for (picture, mesh) in meshes.into_iter().filter(|(_, mesh)| !mesh.triangles.is_empty()) {
            let coat = picture.map_or(Coat::Sheet, |picture| Coat::Picture(picture as u32));
            collected.solids.push(Solid { mesh, coat, feature: *feature });
        }
    }
    let Some(CityMember { feature, paint, .. }) = group.members.first() else { return };
    let color = paint.default.foundation;
    let mut faces = Faces::default();
    for footprint in &group.footprints {
        for ring in footprint.rings() {
            faces.walls(ring, (foot_z as f32, base_z as f32), color);
        }
        let footing = WallFooting { rings: footprint.rings().to_vec(), foot_z: foot_z as f32, color };
        collected.uprights.push(FeatureSolid { upright: DrapedSolid::Footing(footing), feature: *feature });
    }
    collected.solids.push(Solid { mesh: faces.into_mesh(), coat: Coat::Painted, feature: *feature });
}

/// Adds the triangles of a surface, at drawn heights.
fn add_surface(surface: &CitySurface, color: Srgba, lift: impl Fn(DVec3) -> DVec3, mesh: &mut DrawMesh) {
    let triangles = space_polygon::triangles(&surface.rings);
    let Some(normal) = surface.doubled_area().try_normalize().filter(|_| !triangles.is_empty()) else {
        return;
    };
    let places = surface.texture.as_ref().map(|texture| texture.places.concat());
    let vertices: Vec<DVec3> = surface.rings.iter().flatten().map(|&at| lift(at)).collect();
    let ids: Vec<_> = vertices
        .iter()
        .enumerate()
        .map(|(number, at)| {
            // Ours runs downward.
            let place = places.as_ref().and_then(|places| places.get(number));
            let uv = place.map_or(Vec2::ZERO, |&DVec2 { x, y }| DVec2::new(x, 1.0 - y).as_vec2());
            let color = if place.is_some() { Srgba::WHITE } else { color };
            let (position, normal): (Vec3, Vec3) = (at.as_vec3(), normal.as_vec3());
            mesh.vertex(DrawVertex {
                position: position.to_array(),
                normal: normal.to_array(),
                uv: uv.to_array(),
                color,
            })
        })
        .collect();
    triangles.into_iter().for_each(|triangle| mesh.triangle(triangle.map(|number| ids[number])));
}

/// Counts of objects that are not drawn as they are stated.
#[derive(Default)]
struct CityTally {
    off: usize,
    empty: usize,
    other_lod: usize,
    too_large: usize,
    pads_refused: usize,
    kinds: BTreeMap<String, usize>,
}

impl CityTally {
    fn add_kind(&mut self, kind: &str) {
        *self.kinds.entry(kind.to_owned()).or_default() += 1;
    }

    fn note(&self, span: std::ops::Range<usize>, findings: &mut SceneFindings) {
        let sentences = [
            (self.off, FindingCode::LeftOut, "left out: not wholly on the elevation model's data"),
            (self.empty, FindingCode::EmptyShape, "left out: its surfaces cover no area in plan"),
            (
                self.other_lod,
                FindingCode::DefaultTaken,
                "in another level of detail, without one that is wanted",
            ),
            (
                self.pads_refused,
                FindingCode::PadRefused,
                "without its pad: the ground there is shaped for something else already",
            ),
        ];
        for (count, code, sentence) in sentences.into_iter().filter(|(count, ..)| *count > 0) {
            findings.add(
                code,
                span.clone(),
                format!("{count} {} {sentence}", FeatureKind::Building.noun(count)),
            );
        }
        if self.too_large > 0 {
            let message = format!(
                "{} surfaces left out: more than {} vertices around one",
                self.too_large,
                space_polygon::MOST_VERTICES
            );
            findings.add(FindingCode::LeftOut, span.clone(), message);
        }
        if !self.kinds.is_empty() {
            let kinds: Vec<String> =
                self.kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
            let message = format!(
                "left out, because they are no buildings: {}; name the file in tables of their kind, such as [[area]] with where = {{ type = \"WaterBody\" }}",
                kinds.join(", ")
            );
            findings.add(FindingCode::LeftOut, span, message);
        }
    }
}
