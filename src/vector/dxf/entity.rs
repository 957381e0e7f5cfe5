//! Entities of DXF as shapes: what each kind states by which codes.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use crate::dxf::colors::DxfColor;
use crate::dxf::curves::{Spline, arc, bulge, ellipse, sweep_deg};
use crate::dxf::groups::DxfGroup;
use crate::dxf::hatch;
use crate::dxf::text;

/// The most corners of a mesh of rows and columns: what the codes of its size can state.
const MOST_MESH_SIDE: i64 = 1 << 15;

/// A record of a file: its kind and its groups.
#[derive(Debug, Default)]
pub(super) struct DxfRecord<'a> {
    pub kind: String,
    pub groups: Vec<DxfGroup<'a>>,
    pub place: String,
}

/// An entity as it is drawn, in the coordinates of its block or of the drawing.
#[derive(Clone, Debug)]
pub(super) struct DxfEntity {
    /// Its kind, such as `LWPOLYLINE`.
    pub kind: String,
    pub layer: String,
    pub handle: String,
    pub line_type: String,
    pub color: DxfColor,
    pub is_on_paper: bool,
    pub is_hidden: bool,
    pub shape: DxfShape,
    pub place: String,
}

#[derive(Clone, Debug)]
pub(super) enum DxfShape {
    Point(DVec3),
    Line(Vec<DVec3>),
    /// Polygons, each its rings; of hatches all rings of one.
    Faces(Vec<Vec<Vec<DVec3>>>),
    /// Rings of which some are holes of others.
    Rings(Vec<Vec<DVec3>>),
    Text(DrawingText),
    Insert(Box<BlockInsert>),
}

/// A text at a point.
#[derive(Clone, Debug)]
pub(super) struct DrawingText {
    pub at: DVec3,
    pub text: String,
    pub height: f64,
    pub rotation_deg: f64,
    /// The name of an attribute.
    pub tag: Option<String>,
}

/// A block drawn at a point, once or in rows and columns.
#[derive(Clone, Debug)]
pub(super) struct BlockInsert {
    pub block: String,
    /// The coordinates of what it is drawn in by those of the block, without the block's base point.
    pub placed: DAffine3,
    pub columns: u32,
    pub rows: u32,
    pub spacing: DVec2,
    pub rotation_deg: f64,
    pub scale: DVec3,
    /// Values by tags.
    pub attributes: Vec<(String, String)>,
}

impl DxfRecord<'_> {
    pub fn number(&self, code: i32) -> Option<f64> {
        self.groups.iter().filter(|group| group.code == code).find_map(DxfGroup::number)
    }

    pub fn integer(&self, code: i32) -> Option<i64> {
        self.groups.iter().filter(|group| group.code == code).find_map(DxfGroup::integer)
    }

    pub fn text(&self, code: i32) -> Option<&str> {
        self.groups.iter().find(|group| group.code == code).map(DxfGroup::text)
    }

    fn numbers(&self, code: i32) -> Vec<f64> {
        self.groups.iter().filter(|group| group.code == code).filter_map(DxfGroup::number).collect()
    }

    /// The point whose x has a code; `None` without x and y.
    pub fn point(&self, code: i32) -> Option<DVec3> {
        let [x, y] = [code, code + 10].map(|code| self.number(code));
        Some(DVec3::new(x?, y?, self.number(code + 20).unwrap_or(0.0)))
    }

    /// The points whose x have a code, in order.
    fn points(&self, code: i32) -> Vec<DVec3> {
        let mut points: Vec<DVec3> = Vec::new();
        for group in &self.groups {
            let Some(number) = group.number() else { continue };
            match (group.code - code, points.last_mut()) {
                (0, _) => points.push(DVec3::new(number, 0.0, 0.0)),
                (10, Some(point)) => point.y = number,
                (20, Some(point)) => point.z = number,
                _ => {}
            }
        }
        points
    }

    /// The coordinates of the drawing by those of the entity's own plane (the arbitrary axis algorithm).
    fn plane(&self) -> DMat3 {
        let normal = self.point(210).and_then(DVec3::try_normalize).unwrap_or(DVec3::Z);
        if normal == DVec3::Z {
            return DMat3::IDENTITY;
        }
        let is_near_z = normal.x.abs() < 1.0 / 64.0 && normal.y.abs() < 1.0 / 64.0;
        let right = if is_near_z { DVec3::Y.cross(normal) } else { DVec3::Z.cross(normal) };
        let right = right.normalize_or(DVec3::X);
        DMat3::from_cols(right, normal.cross(right), normal)
    }

    /// The entity of a record, with the records that follow one up to its `SEQEND`; `None` of a kind that is not read or
    /// an entity without its points.
    pub fn entity(&self, parts: &[DxfRecord<'_>]) -> Option<DxfEntity> {
        let shape = self.shape(parts)?;
        let color = match (self.integer(420), self.integer(62)) {
            (Some(color), _) => DxfColor::of_true_color(color),
            (None, Some(index)) => DxfColor::of_index(index),
            (None, None) => DxfColor::ByLayer,
        };
        Some(DxfEntity {
            kind: self.kind.clone(),
            layer: text::plain(self.text(8).unwrap_or("0")),
            handle: self.text(5).unwrap_or_default().to_owned(),
            line_type: self.text(6).unwrap_or_default().to_owned(),
            color,
            is_on_paper: self.integer(67) == Some(1),
            is_hidden: self.integer(60) == Some(1),
            shape,
            place: self.place.clone(),
        })
    }

    fn shape(&self, parts: &[DxfRecord<'_>]) -> Option<DxfShape> {
        let plane = self.plane();
        let in_drawing = |points: Vec<DVec3>| points.into_iter().map(|at| plane * at).collect::<Vec<_>>();
        Some(match self.kind.as_str() {
            "LINE" => DxfShape::Line(vec![self.point(10)?, self.point(11)?]),
            "POINT" => DxfShape::Point(self.point(10)?),
            "LWPOLYLINE" => DxfShape::Line(in_drawing(self.light_polyline()?)),
            "POLYLINE" => self.polyline(parts)?,
            "CIRCLE" => {
                let (center, radius) = (self.point(10)?, self.number(40)?);
                DxfShape::Line(in_drawing(closed(arc(center, radius, 0.0, std::f64::consts::TAU).collect())))
            }
            "ARC" => {
                let (center, radius) = (self.point(10)?, self.number(40)?);
                let (from, to) = (self.number(50)?, self.number(51)?);
                let vertices = arc(center, radius, from.to_radians(), sweep_deg(from, to));
                DxfShape::Line(in_drawing(vertices.collect()))
            }
            "ELLIPSE" => {
                let (center, major) = (self.point(10)?, self.point(11)?);
                let normal = self.point(210).and_then(DVec3::try_normalize).unwrap_or(DVec3::Z);
                let minor = normal.cross(major) * self.number(40)?;
                let to = self.number(42).unwrap_or(std::f64::consts::TAU);
                DxfShape::Line(ellipse(center, major, minor, self.number(41).unwrap_or(0.0), to))
            }
            "SPLINE" => {
                let spline = Spline {
                    degree: usize::try_from(self.integer(71)?).ok()?,
                    knots: self.numbers(40),
                    weights: self.numbers(41),
                    control: self.points(10),
                    fit: self.points(11),
                };
                DxfShape::Line(spline.vertices())
            }
            "LEADER" => DxfShape::Line(self.points(10)),
            "3DFACE" => DxfShape::Faces(vec![vec![self.corners([10, 11, 12, 13])?]]),
            "SOLID" | "TRACE" => DxfShape::Faces(vec![vec![in_drawing(self.corners([10, 11, 13, 12])?)]]),
            "HATCH" => {
                let rings = hatch::rings(&self.groups);
                let elevation = self.number(30).unwrap_or(0.0);
                let lifted =
                    |ring: Vec<DVec3>| in_drawing(ring.into_iter().map(|at| at.with_z(elevation)).collect());
                DxfShape::Rings(rings.into_iter().map(lifted).collect())
            }
            "TEXT" | "ATTRIB" => {
                // Aligned in any other way than at its left, it stands at its second point.
                let is_aligned = self.integer(72).unwrap_or(0) != 0 || self.integer(73).unwrap_or(0) != 0;
                let at = self.point(11).filter(|_| is_aligned).or_else(|| self.point(10))?;
                DxfShape::Text(DrawingText {
                    at: plane * at,
                    text: text::plain(self.text(1)?),
                    height: self.number(40).unwrap_or(0.0),
                    rotation_deg: self.number(50).unwrap_or(0.0),
                    tag: (self.kind == "ATTRIB").then(|| self.text(2).unwrap_or_default().to_owned()),
                })
            }
            "MTEXT" => {
                let pieces =
                    self.groups.iter().filter(|group| matches!(group.code, 1 | 3)).map(DxfGroup::text);
                let direction = self.point(11).filter(|way| way.truncate() != DVec2::ZERO);
                let rotation =
                    direction.map(|way| libm::atan2(way.y, way.x).to_degrees()).or(self.number(50));
                DxfShape::Text(DrawingText {
                    at: self.point(10)?,
                    text: text::without_formats(&pieces.collect::<String>()),
                    height: self.number(40).unwrap_or(0.0),
                    rotation_deg: rotation.unwrap_or(0.0),
                    tag: None,
                })
            }
            "INSERT" => DxfShape::Insert(Box::new(self.insert(parts)?)),
            // Its picture is a block of its own, in the drawing's coordinates.
            "DIMENSION" => DxfShape::Insert(Box::new(BlockInsert {
                block: self.text(2)?.to_owned(),
                placed: DAffine3::IDENTITY,
                columns: 1,
                rows: 1,
                spacing: DVec2::ZERO,
                rotation_deg: 0.0,
                scale: DVec3::ONE,
                attributes: Vec::new(),
            })),
            _ => return None,
        })
    }

    /// Corners at codes; of four the last may repeat the one before.
    fn corners(&self, codes: [i32; 4]) -> Option<Vec<DVec3>> {
        let mut corners = vec![self.point(codes[0])?, self.point(codes[1])?];
        corners.extend(codes[2..].iter().filter_map(|&code| self.point(code)));
        corners.dedup();
        Some(corners)
    }

    fn light_polyline(&self) -> Option<Vec<DVec3>> {
        let elevation = self.number(38).unwrap_or(0.0);
        let mut vertices: Vec<(DVec3, f64)> = Vec::new();
        for group in &self.groups {
            let Some(number) = group.number() else { continue };
            match (group.code, vertices.last_mut()) {
                (10, _) => vertices.push((DVec3::new(number, 0.0, elevation), 0.0)),
                (20, Some((at, _))) => at.y = number,
                (42, Some((_, bulge))) => *bulge = number,
                _ => {}
            }
        }
        bent(&vertices, self.integer(70).unwrap_or(0) & 1 != 0)
    }

    fn polyline(&self, parts: &[DxfRecord<'_>]) -> Option<DxfShape> {
        let flags = self.integer(70).unwrap_or(0);
        let is_closed = flags & 1 != 0;
        let vertices: Vec<&DxfRecord<'_>> = parts.iter().filter(|part| part.kind == "VERTEX").collect();
        if flags & 64 != 0 {
            return polyface(&vertices);
        }
        // The frame of a spline is not drawn.
        let drawn = vertices.iter().filter(|vertex| vertex.integer(70).unwrap_or(0) & 16 == 0);
        if flags & 16 != 0 {
            let points: Vec<DVec3> = drawn.filter_map(|vertex| vertex.point(10)).collect();
            return self.mesh(&points, [is_closed, flags & 32 != 0]);
        }
        if flags & 8 != 0 {
            let mut line: Vec<DVec3> = drawn.filter_map(|vertex| vertex.point(10)).collect();
            if is_closed {
                line = closed(line);
            }
            return Some(DxfShape::Line(line));
        }
        let elevation = self.number(30).unwrap_or(0.0);
        let bulges: Vec<(DVec3, f64)> = drawn
            .filter_map(|vertex| {
                Some((vertex.point(10)?.with_z(elevation), vertex.number(42).unwrap_or(0.0)))
            })
            .collect();
        let plane = self.plane();
        Some(DxfShape::Line(bent(&bulges, is_closed)?.into_iter().map(|at| plane * at).collect()))
    }

    /// The faces of a mesh of rows and columns of points.
    fn mesh(&self, points: &[DVec3], is_closed: [bool; 2]) -> Option<DxfShape> {
        let side = |code: i32| self.integer(code).filter(|side| (2..=MOST_MESH_SIDE).contains(side));
        let (rows, columns) = (side(71)? as usize, side(72)? as usize);
        if points.len() < rows * columns {
            return None;
        }
        let steps = |count: usize, is_closed: bool| if is_closed { count } else { count - 1 };
        let at = |row: usize, column: usize| points[row % rows * columns + column % columns];
        let face = |row: usize, column: usize| {
            vec![vec![at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)]]
        };
        let all = (0..steps(rows, is_closed[0]))
            .flat_map(|row| (0..steps(columns, is_closed[1])).map(move |column| (row, column)));
        Some(DxfShape::Faces(all.map(|(row, column)| face(row, column)).collect()))
    }

    fn insert(&self, parts: &[DxfRecord<'_>]) -> Option<BlockInsert> {
        let scale = [41, 42, 43].map(|code| self.number(code).unwrap_or(1.0));
        let rotation_deg = self.number(50).unwrap_or(0.0);
        let count = |code: i32| u32::try_from(self.integer(code).unwrap_or(1)).unwrap_or(1).max(1);
        let plane = DAffine3::from_mat3(self.plane());
        let placed = plane
            * DAffine3::from_translation(self.point(10)?)
            * DAffine3::from_rotation_z(rotation_deg.to_radians())
            * DAffine3::from_scale(DVec3::from_array(scale));
        let attribute = |part: &DxfRecord<'_>| Some((part.text(2)?.to_owned(), text::plain(part.text(1)?)));
        let [wide, high] = [44, 45].map(|code| self.number(code).unwrap_or(0.0));
        Some(BlockInsert {
            block: self.text(2)?.to_owned(),
            placed,
            columns: count(70),
            rows: count(71),
            spacing: DVec2::new(wide, high),
            rotation_deg,
            scale: DVec3::from_array(scale),
            attributes: parts.iter().filter(|part| part.kind == "ATTRIB").filter_map(attribute).collect(),
        })
    }
}

/// A line whose legs are bent by their bulges; `None` of no vertex.
pub(super) fn bent(vertices: &[(DVec3, f64)], is_closed: bool) -> Option<Vec<DVec3>> {
    let mut line = vec![vertices.first()?.0];
    let ends = vertices.iter().skip(1).map(|(at, _)| *at).chain(is_closed.then_some(vertices[0].0));
    for ((from, part), to) in vertices.iter().zip(ends) {
        bulge(*from, to, *part, &mut line);
        line.push(to);
    }
    Some(line)
}

/// A line that ends where it begins.
fn closed(mut line: Vec<DVec3>) -> Vec<DVec3> {
    if let Some(first) = line.first().copied() {
        if line.last().is_some_and(|last| last.distance(first) < 1e-9 * (1.0 + first.length())) {
            line.pop();
        }
        line.push(first);
    }
    line
}

/// The faces of a polyface mesh: vertices, then faces that name up to four of them, negative where an edge is invisible.
fn polyface(vertices: &[&DxfRecord<'_>]) -> Option<DxfShape> {
    let flags = |vertex: &&&DxfRecord<'_>| vertex.integer(70).unwrap_or(0);
    let points: Vec<DVec3> = vertices
        .iter()
        .filter(|vertex| flags(vertex) & 64 != 0)
        .filter_map(|vertex| vertex.point(10))
        .collect();
    let faces = vertices.iter().filter(|vertex| flags(vertex) & 192 == 128);
    let face = |face: &&DxfRecord<'_>| {
        let corner = |code: i32| {
            let number = face.integer(code)?.unsigned_abs();
            points.get(usize::try_from(number).ok()?.checked_sub(1)?).copied()
        };
        let ring: Vec<DVec3> = [71, 72, 73, 74].into_iter().filter_map(corner).collect();
        (ring.len() >= 3).then_some(vec![ring])
    };
    let faces: Vec<_> = faces.filter_map(face).collect();
    (!faces.is_empty()).then_some(DxfShape::Faces(faces))
}
