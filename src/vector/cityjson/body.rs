//! The surfaces of a city object, and where they come from: boundaries, templates, semantics, materials and textures.

use glam::{DAffine3, DMat4, DVec2, DVec3};

use crate::cityjson::boundary::Nested;
use crate::cityjson::text::{CityAppearance, GeometryText};
use crate::error::shorten;
use sandtable_base::limits::DESIGN_VERTICES;

/// The surfaces of an object in one level of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct CityBody {
    /// The level of detail as the file writes it, such as `2.2`; empty where it states none.
    pub lod: String,
    /// Its surfaces.
    pub surfaces: Vec<CitySurface>,
}

/// A flat polygon in space, with holes.
#[derive(Clone, Debug, PartialEq)]
pub struct CitySurface {
    /// The outer ring, counter-clockwise seen from outside, then holes; coordinates in the file's system, heights in
    /// meters. No ring repeats its first vertex.
    pub rings: Vec<Vec<DVec3>>,
    /// What it is of its object, where the file states it.
    pub role: Option<SurfaceRole>,
    /// The color of its material, sRGB.
    pub color: Option<[u8; 3]>,
    /// Its picture.
    pub texture: Option<SurfaceTexture>,
}

/// The picture of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceTexture {
    /// Its number among [`CityModel::images`](super::CityModel::images).
    pub image: usize,
    /// The place of every vertex in the picture, ring by ring; (0, 0) is the lower left corner.
    pub places: Vec<Vec<DVec2>>,
}

/// What a surface is of its object: the semantic surfaces of CityJSON that look different.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceRole {
    /// A roof, or a floor outdoors.
    Roof,
    /// A wall, or a ceiling outdoors.
    Wall,
    /// What lies on the ground.
    Ground,
    /// A window.
    Window,
    /// A door.
    Door,
    /// What closes an opening and is not there, or is indoors: it is not drawn.
    Unseen,
    /// Another.
    Other,
}

impl SurfaceRole {
    fn of(kind: &str) -> Self {
        match kind {
            "RoofSurface" | "OuterFloorSurface" => Self::Roof,
            "WallSurface" | "OuterCeilingSurface" => Self::Wall,
            "GroundSurface" => Self::Ground,
            "Window" => Self::Window,
            "Door" => Self::Door,
            "ClosureSurface" | "FloorSurface" | "CeilingSurface" | "InteriorWallSurface" => Self::Unseen,
            _ => Self::Other,
        }
    }
}

impl CitySurface {
    /// Twice its area times its unit normal (Newell 1972).
    pub fn doubled_area(&self) -> DVec3 {
        self.rings.iter().map(|ring| doubled_ring_area(ring)).sum()
    }
}

fn doubled_ring_area(ring: &[DVec3]) -> DVec3 {
    let Some(&first) = ring.first() else { return DVec3::ZERO };
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| (*a - first).cross(*b - first)).sum()
}

/// What geometries refer to.
pub(super) struct Referred<'a> {
    /// The vertices of the text, coordinates.
    pub vertices: &'a [DVec3],
    pub appearance: &'a CityAppearance,
    /// The number of the text's first image among all images.
    pub first_image: usize,
    pub templates: &'a Templates,
}

/// Geometries that are placed again and again.
#[derive(Default)]
pub(super) struct Templates {
    pub geometries: Vec<GeometryText>,
    pub vertices: Vec<DVec3>,
}

/// The shapes of one geometry.
#[derive(Default)]
pub(super) struct CityShapes {
    pub surfaces: Vec<CitySurface>,
    pub lines: Vec<Vec<DVec3>>,
    pub points: Vec<DVec3>,
}

/// What reading a file's geometries costs and leaves out.
pub(super) struct ShapeTally {
    /// How many more vertices they may have: templates multiply them.
    pub vertices_left: u64,
    /// The rings with a texture that is not there.
    pub lost_textures: usize,
}

impl ShapeTally {
    fn take(&mut self, count: usize) -> Result<(), String> {
        self.vertices_left = self.vertices_left.checked_sub(count as u64).ok_or_else(|| {
            format!(
                "the geometries of the file have more than {DESIGN_VERTICES} vertices; {DESIGN_VERTICES:#}"
            )
        })?;
        Ok(())
    }
}

/// Returns the shapes of a geometry.
///
/// # Errors
/// A sentence without the place.
pub(super) fn shapes(
    geometry: &GeometryText,
    referred: &Referred<'_>,
    tally: &mut ShapeTally,
) -> Result<CityShapes, String> {
    if geometry.kind != "GeometryInstance" {
        return GeometryReader { geometry, referred, vertices: referred.vertices, place: None, tally }.read();
    }
    let missing = |what: &str| format!("a geometry instance has no {what}");
    let number = geometry.template.ok_or_else(|| missing("template"))?;
    let templates = referred.templates;
    let template = templates.geometries.get(number).ok_or_else(|| {
        format!("a geometry instance names template {number} of {}", templates.geometries.len())
    })?;
    if template.kind == "GeometryInstance" {
        return Err("a template is a geometry instance itself".to_owned());
    }
    let anchor = geometry.boundaries.at(0).and_then(Nested::index).ok_or_else(|| missing("point"))?;
    let anchor = vertex(referred.vertices, anchor)?;
    // Row after row, as it is written.
    let matrix = DMat4::from_cols_array(&geometry.matrix.ok_or_else(|| missing("matrix"))?).transpose();
    if !matrix.is_finite() || matrix.row(3) != glam::DVec4::W {
        return Err("the matrix of a geometry instance is not affine".to_owned());
    }
    let place = DAffine3::from_translation(anchor) * DAffine3::from_mat4(matrix);
    let vertices = &templates.vertices[..];
    GeometryReader { geometry: template, referred, vertices, place: Some(place), tally }.read()
}

struct GeometryReader<'a> {
    geometry: &'a GeometryText,
    referred: &'a Referred<'a>,
    vertices: &'a [DVec3],
    place: Option<DAffine3>,
    tally: &'a mut ShapeTally,
}

/// What is stated of a surface, at one level of the nested lists.
#[derive(Clone, Copy)]
struct StatedSurface<'a> {
    role: Option<&'a Nested>,
    material: Option<&'a Nested>,
    texture: Option<&'a Nested>,
}

impl<'a> StatedSurface<'a> {
    fn at(&self, index: usize) -> Self {
        let Self { role, material, texture } = *self;
        let at = |nested: Option<&'a Nested>| nested.and_then(|nested| nested.at(index));
        Self { role: at(role), material: at(material), texture: at(texture) }
    }
}

impl GeometryReader<'_> {
    fn read(mut self) -> Result<CityShapes, String> {
        let mut shapes = CityShapes::default();
        let boundaries = &self.geometry.boundaries;
        // The lists around the list of surfaces.
        let levels = match self.geometry.kind.as_str() {
            "MultiPoint" => {
                shapes.points = self.ring(boundaries)?;
                return Ok(shapes);
            }
            "MultiLineString" => {
                for line in boundaries.items() {
                    shapes.lines.push(self.ring(line)?);
                }
                return Ok(shapes);
            }
            "MultiSurface" | "CompositeSurface" => 0,
            "Solid" => 1,
            "MultiSolid" | "CompositeSolid" => 2,
            other => return Err(format!("the geometry type '{}' is unknown", shorten(other))),
        };
        let appearance = self.referred.appearance;
        let themed = themed(&self.geometry.material, appearance.material_theme.as_deref());
        let whole = themed.and_then(|theme| theme.value).map(Nested::Index);
        let texture = themed_texture(self.geometry, appearance);
        let stated = StatedSurface {
            role: self.geometry.semantics.as_ref().and_then(|semantics| semantics.values.as_ref()),
            material: whole.as_ref().or_else(|| themed.and_then(|theme| theme.values.as_ref())),
            texture,
        };
        self.nested(boundaries, levels, stated, &mut shapes.surfaces)?;
        Ok(shapes)
    }

    /// Reads the surfaces below `levels` lists. Of the shells of a solid the first is the outer one; what lies in it is not seen.
    fn nested(
        &mut self,
        boundaries: &Nested,
        levels: usize,
        stated: StatedSurface<'_>,
        surfaces: &mut Vec<CitySurface>,
    ) -> Result<(), String> {
        let shells = if levels == 1 { 1 } else { usize::MAX };
        for (index, item) in boundaries.items().iter().enumerate().take(shells) {
            match levels {
                0 => surfaces.extend(self.surface(item, stated.at(index))?),
                _ => self.nested(item, levels - 1, stated.at(index), surfaces)?,
            }
        }
        Ok(())
    }

    /// Reads a surface; `None` of one without an outer ring of three vertices.
    fn surface(&mut self, rings: &Nested, stated: StatedSurface<'_>) -> Result<Option<CitySurface>, String> {
        let mut read: Vec<Vec<DVec3>> = Vec::with_capacity(rings.items().len());
        let mut places: Vec<Vec<DVec2>> = Vec::new();
        let mut image = None;
        for (number, ring) in rings.items().iter().enumerate() {
            let mut vertices = self.ring(ring)?;
            let (ring_image, mut ring_places) = match stated.texture.and_then(|texture| texture.at(number)) {
                Some(texture) => self.texture(texture, vertices.len()),
                None => (None, Vec::new()),
            };
            // Some writers repeat the first vertex.
            while vertices.len() > 1 && vertices.first() == vertices.last() {
                vertices.pop();
                ring_places.truncate(vertices.len());
            }
            if vertices.len() < 3 {
                match number {
                    0 => return Ok(None),
                    _ => continue,
                }
            }
            if number == 0 {
                image = ring_image;
            }
            read.push(vertices);
            places.push(ring_places);
        }
        let semantics = self.geometry.semantics.as_ref();
        let role = semantics
            .zip(stated.role.and_then(Nested::index))
            .and_then(|(semantics, index)| semantics.surfaces.get(index))
            .map(|surface| SurfaceRole::of(&surface.kind));
        let materials = &self.referred.appearance.materials;
        let material = stated.material.and_then(Nested::index).and_then(|index| materials.get(index));
        let color = material.and_then(|material| material.diffuse);
        let color = color.map(|color| color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8));
        let fits = read.iter().zip(&places).all(|(ring, places)| ring.len() == places.len());
        let texture = image.filter(|_| fits).map(|image| SurfaceTexture { image, places });
        Ok((!read.is_empty()).then_some(CitySurface { rings: read, role, color, texture }))
    }

    /// Reads the image of a ring and the place in it of each of its `count` vertices; nothing where the ring has none.
    fn texture(&mut self, values: &Nested, count: usize) -> (Option<usize>, Vec<DVec2>) {
        let appearance = self.referred.appearance;
        let stated = values.items().split_first().and_then(|(image, places)| Some((image.index()?, places)));
        let Some((image, places)) = stated else { return (None, Vec::new()) };
        let place =
            |place: &Nested| appearance.texture_vertices.get(place.index()?).map(|at| DVec2::from_array(*at));
        let found: Option<Vec<DVec2>> = places.iter().map(place).collect();
        match found.filter(|places| image < appearance.textures.len() && places.len() == count) {
            Some(places) => (Some(self.referred.first_image + image), places),
            None => {
                self.tally.lost_textures += 1;
                (None, Vec::new())
            }
        }
    }

    fn ring(&mut self, ring: &Nested) -> Result<Vec<DVec3>, String> {
        self.tally.take(ring.items().len())?;
        let position = |index: &Nested| {
            let index = index.index().ok_or("a boundary holds what is no vertex")?;
            let at = vertex(self.vertices, index)?;
            let placed = self.place.map_or(at, |place| place.transform_point3(at));
            if placed.is_finite() { Ok(placed) } else { Err(format!("vertex {index} is not finite")) }
        };
        ring.items().iter().map(position).collect()
    }
}

fn vertex(vertices: &[DVec3], index: usize) -> Result<DVec3, String> {
    let found = vertices.get(index).copied();
    found.ok_or_else(|| format!("a boundary names vertex {index}, and there are {}", vertices.len()))
}

/// The theme that is wanted, else the first.
fn themed<'a, T>(themes: &'a std::collections::BTreeMap<String, T>, wanted: Option<&str>) -> Option<&'a T> {
    wanted.and_then(|name| themes.get(name)).or_else(|| themes.values().next())
}

fn themed_texture<'a>(geometry: &'a GeometryText, appearance: &CityAppearance) -> Option<&'a Nested> {
    themed(&geometry.texture, appearance.texture_theme.as_deref())?.values.as_ref()
}
