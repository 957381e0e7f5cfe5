//! Surfaces of LandXML 1.0, 1.1 and 1.2 (LandXML.org, 2008): triangles between surveyed points, as samples.
//!
//! ```text
//! Surface name ─┬─ Definition surfType=TIN ─┬─ Pnts ── P id: northing easting elevation
//!               │                           └─ Faces ── F [i=1]: three or four ids
//!               └─ SourceData ─┬─ DataPoints, Contours ── PntList3D
//!                              ├─ Breaklines ── Breakline ── PntList3D
//!                              └─ Boundaries ── Boundary bndType=outer|void ── PntList2D, PntList3D
//! ```
//!
//! Samples lie on the plane of the triangle under them, and there is no data where there is none, or an invisible one. A
//! surface without faces is triangulated from its points and breaklines, inside its outer boundary and outside its voids.
//! Samples are as far apart as `cell` says, else at about half the side of a triangle.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::landxml_tin::{LandTin, TinFault};
use crate::gridding::method::GriddingMethod;
use crate::gridding::{self, BeyondHull};
use crate::points::cloud::PointCloud;
use sandtable_base::limits::XML_DEPTH;
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::length_of_land_xml;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_raster::cell_grid::CellGrid;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "LandXML",
    extensions: &[],
    shared_extensions: &["xml"],
    recognition: Recognition::Content { matches: is_landxml, start: "<LandXML" },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

/// Bytes at the start of a file in which its outermost element is searched.
const HEAD_BYTES: usize = 4096;

/// The most samples that a distance chosen here leads to.
const MOST_CHOSEN: f64 = (1 << 22) as f64;

/// The most vertices of boundaries times samples: seconds.
const MOST_BOUNDARY_STEPS: usize = 1 << 32;

fn is_landxml(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    head.starts_with(b"<") && head.windows(8).any(|window| window == b"<LandXML")
}

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let text = String::from_utf8_lossy(file.bytes);
    let LandSurfaces { surfaces, linear_m, elevation_m, epsg } = LandSurfaces::read(&text)?;
    let names: Vec<String> =
        surfaces.iter().map(|surface| format!("'{}'", shortened(&surface.name))).collect();
    let mut surfaces: Vec<LandSurface> = surfaces.into_iter().filter(|surface| !surface.is_empty()).collect();
    let listed = names.iter().take(12).cloned().collect::<Vec<_>>().join(", ");
    let mut notes = Vec::new();
    let index = match &file.hints.options.surface {
        Some(wanted) => surfaces.iter().position(|surface| surface.name == *wanted).ok_or_else(|| {
            let wanted = shortened(wanted);
            FORMAT.unsupported(
                format!("no surface '{wanted}' with points; its surfaces are {listed}"),
                "name one of them with the key 'surface'",
            )
        })?,
        None => 0,
    };
    if surfaces.is_empty() {
        let what = "no surface with points; lines and points of the file are vector data";
        return Err(FORMAT.unsupported(what, "name it as the `file` of a table of features"));
    }
    let surface = surfaces.swap_remove(index);
    if names.len() > 1 && file.hints.options.surface.is_none() {
        let name = shortened(&surface.name);
        notes.push(format!(
            "of its {} surfaces, {listed}, the first is taken, '{name}'; the key 'surface' names another",
            names.len()
        ));
    }
    let crs = file.crs_or(|| Ok(epsg.map(Crs::from_epsg).transpose()?))?;
    let unit_m = crs.as_ref().filter(|crs| !crs.is_geographic()).map_or(1.0, Crs::meters_per_unit);
    let is_geographic = crs.as_ref().is_some_and(Crs::is_geographic);
    let scale = if is_geographic { 1.0 } else { linear_m / unit_m };
    let surface = surface.scaled(scale);
    let extent = Rect::around(surface.points().map(DVec3::truncate));
    let (cell, is_chosen) = match file.cell()? {
        Some(cell) => (cell, false),
        None => (surface.cell(&extent), true),
    };
    let cells = CellGrid::around(extent, cell).map_err(|error| FORMAT.undecodable(error))?;
    if is_chosen {
        notes.push(format!(
            "samples were put {cell} apart on its triangles; the key 'cell' states another distance"
        ));
    }
    let values = surface.sampled(&cells, &mut notes)?;
    Ok(Raster {
        driver: "LandXML",
        data_type: "Float64",
        crs,
        meters_per_z: elevation_m,
        states_z_unit: true,
        notes,
        ..Raster::new(cells.width(), Samples::F64(values)).placed(cells.map_from_grid())
    })
}

fn shortened(name: &str) -> String {
    name.chars().take(60).collect()
}

/// The surfaces of a file.
struct LandSurfaces {
    surfaces: Vec<LandSurface>,
    linear_m: f64,
    elevation_m: f64,
    epsg: Option<u32>,
}

/// A surface: triangles between points, else what it was made of.
#[derive(Default)]
struct LandSurface {
    name: String,
    tin: LandTin,
    /// Points, breaklines and boundaries that it was made of.
    loose: Vec<DVec3>,
    breaklines: Vec<Vec<DVec3>>,
    outer: Vec<Vec<DVec2>>,
    voids: Vec<Vec<DVec2>>,
}

impl LandSurface {
    fn is_empty(&self) -> bool {
        self.points().next().is_none()
    }

    fn has_faces(&self) -> bool {
        !self.tin.faces.is_empty()
    }

    /// The points that it lies between.
    fn points(&self) -> Box<dyn Iterator<Item = DVec3> + '_> {
        match self.has_faces() {
            true => Box::new(self.tin.corners()),
            false => {
                let loose = self.tin.points.iter().chain(&self.loose).chain(self.breaklines.iter().flatten());
                Box::new(loose.copied())
            }
        }
    }

    /// The surface in another unit of length.
    fn scaled(mut self, scale: f64) -> Self {
        let flat = |at: &mut DVec3| *at = DVec3::new(at.x * scale, at.y * scale, at.z);
        self.tin.points.iter_mut().chain(&mut self.loose).for_each(flat);
        self.breaklines.iter_mut().flatten().for_each(flat);
        self.outer.iter_mut().chain(&mut self.voids).flatten().for_each(|at| *at *= scale);
        self
    }

    /// A distance of about half the side of a triangle, 1, 2 or 5 times a power of ten.
    fn cell(&self, extent: &Rect) -> f64 {
        let count =
            if self.has_faces() { self.tin.faces.len() as f64 / 2.0 } else { self.points().count() as f64 };
        let size = extent.max - extent.min;
        let area = (size.x * size.y).max(1e-6);
        let wanted = ((area / count.max(1.0)).sqrt() / 2.0).max((area / MOST_CHOSEN).sqrt());
        let power = libm::pow(10.0, libm::floor(libm::log10(wanted)));
        let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
        steps.into_iter().find(|step| *step >= wanted * 0.999).unwrap_or(wanted)
    }

    /// The elevations at the centers of cells, NaN off the surface.
    fn sampled(&self, cells: &CellGrid, notes: &mut Vec<String>) -> Result<Vec<f64>, DemErrorKind> {
        if self.has_faces() {
            return self.tin.sampled(cells).map_err(|fault| match fault {
                TinFault::TooMuchWork => {
                    FORMAT.unsupported("triangles that overlap too often", "export the surface again")
                }
            });
        }
        notes.push("the surface has no triangles: its points and breaklines are triangulated".to_owned());
        let points = self.tin.points.iter().chain(&self.loose).copied().collect();
        let cloud = PointCloud { breaklines: self.breaklines.clone(), ..PointCloud::new(points) };
        let gridded = gridding::grid(&cloud, cells, GriddingMethod::Tin, BeyondHull::NoData);
        let gridded = gridded.map_err(|error| FORMAT.undecodable(error))?;
        let Samples::F64(mut values) = gridded.raster.samples else { return Ok(Vec::new()) };
        for (rings, is_kept) in [(&self.outer, true), (&self.voids, false)] {
            if rings.is_empty() {
                continue;
            }
            let vertices: usize = rings.iter().map(Vec::len).sum();
            if vertices.saturating_mul(values.len()) > MOST_BOUNDARY_STEPS {
                let what = format!("boundaries of {vertices} vertices around {} samples", values.len());
                return Err(FORMAT
                    .unsupported(what, "state a greater 'cell', or export the surface with its triangles"));
            }
            for (row, values) in values.chunks_mut(cells.width() as usize).enumerate() {
                for (column, value) in values.iter_mut().enumerate() {
                    let at = cells.center(column as u32, row as u32);
                    let is_inside = rings.iter().any(|ring| polygon::contains([ring.as_slice()], at));
                    if is_inside != is_kept {
                        *value = f64::NAN;
                    }
                }
            }
        }
        Ok(values)
    }
}

/// What the text of an open element is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LandText {
    Point,
    Face { is_visible: bool },
    Loose { numbers_each: usize },
    Breakline { numbers_each: usize },
    Boundary { is_void: bool, numbers_each: usize },
}

/// Reads the elements of surfaces and skips all others.
struct SurfaceReader {
    found: LandSurfaces,
    depth: usize,
    /// Whether the reader is within `Surfaces`, `SourceData` and `Boundaries` of a void.
    is_in_surfaces: bool,
    is_in_breakline: bool,
    is_void: Option<bool>,
    text: String,
    reads: Option<LandText>,
    id: String,
    /// The numbers of the surface's points by their ids.
    numbers: HashMap<String, u32>,
}

impl LandSurfaces {
    fn read(text: &str) -> Result<Self, DemErrorKind> {
        let found = Self { surfaces: Vec::new(), linear_m: 1.0, elevation_m: 1.0, epsg: None };
        let mut reader = SurfaceReader {
            found,
            depth: 0,
            is_in_surfaces: false,
            is_in_breakline: false,
            is_void: None,
            text: String::new(),
            reads: None,
            id: String::new(),
            numbers: HashMap::new(),
        };
        let mut xml = Reader::from_str(text);
        xml.config_mut().expand_empty_elements = true;
        let line = |at: u64| {
            1 + text.as_bytes()[..text.len().min(at as usize)].iter().filter(|&&byte| byte == b'\n').count()
        };
        loop {
            let event = xml.read_event();
            let at = xml.buffer_position();
            let place = |reason: String| FORMAT.broken(format!("line {}: {reason}", line(at)));
            match event.map_err(|error| place(error.to_string()))? {
                Event::Start(start) => reader.open(&start).map_err(place)?,
                Event::End(end) => reader.close(end.local_name().into_inner()).map_err(place)?,
                Event::Text(part) if reader.reads.is_some() => reader.text.push_str(&part.xml10_content()),
                Event::CData(part) if reader.reads.is_some() => reader.text.push_str(&part.xml10_content()),
                Event::Eof if reader.depth > 0 => {
                    return Err(place("the file ends within an element".to_owned()));
                }
                Event::Eof => return Ok(reader.found),
                _ => {}
            }
        }
    }
}

fn attribute(start: &BytesStart<'_>, name: &str) -> Option<String> {
    let mut attributes = start.attributes();
    let found = attributes.with_checks(false).flatten().find(|found| found.key.into_inner() == name)?;
    Some(found.normalized_value(XmlVersion::Implicit1_0).ok()?.trim().to_owned())
}

impl SurfaceReader {
    fn open(&mut self, start: &BytesStart<'_>) -> Result<(), String> {
        self.depth += 1;
        if self.depth > XML_DEPTH.count() {
            return Err(format!("elements lie more than {XML_DEPTH} deep; {XML_DEPTH:#}"));
        }
        let name = start.local_name().into_inner();
        match name {
            "Metric" | "Imperial" => return self.units(start, name == "Imperial"),
            "CoordinateSystem" => {
                let code = attribute(start, "epsgCode");
                self.found.epsg = code.and_then(|code| code.trim_start_matches("EPSG:").parse().ok());
            }
            "Surfaces" => self.is_in_surfaces = true,
            _ => {}
        }
        if !self.is_in_surfaces {
            return Ok(());
        }
        if name == "Surface" {
            let name = attribute(start, "name").unwrap_or_default();
            self.found.surfaces.push(LandSurface { name, ..LandSurface::default() });
            self.numbers.clear();
        }
        if self.found.surfaces.is_empty() {
            return Ok(());
        }
        let numbers_each = if name == "PntList2D" { 2 } else { 3 };
        self.reads = match name {
            "P" => {
                self.id = attribute(start, "id").unwrap_or_default();
                Some(LandText::Point)
            }
            "F" => Some(LandText::Face { is_visible: attribute(start, "i").is_none_or(|i| i != "1") }),
            "Breakline" => {
                self.is_in_breakline = true;
                None
            }
            "Boundary" => {
                self.is_void = Some(attribute(start, "bndType").is_some_and(|kind| kind == "void"));
                None
            }
            "PntList2D" | "PntList3D" => match (self.is_void, self.is_in_breakline) {
                (Some(is_void), _) => Some(LandText::Boundary { is_void, numbers_each }),
                (None, true) => Some(LandText::Breakline { numbers_each }),
                (None, false) => Some(LandText::Loose { numbers_each }),
            },
            _ => None,
        };
        self.text.clear();
        Ok(())
    }

    fn units(&mut self, start: &BytesStart<'_>, is_imperial: bool) -> Result<(), String> {
        let stated = attribute(start, "linearUnit");
        let default = if is_imperial { "foot" } else { "meter" };
        let unit = |name: &str| {
            length_of_land_xml(name).ok_or_else(|| format!("the unit '{}' is unknown", shortened(name)))
        };
        let linear_m = unit(stated.as_deref().unwrap_or(default))?;
        self.found.linear_m = linear_m;
        self.found.elevation_m = match attribute(start, "elevationUnit") {
            // Written beside survey feet by programs that mean these.
            Some(name) if is_imperial && matches!(&*name, "foot" | "feet") => linear_m,
            Some(name) => unit(&name)?,
            None => linear_m,
        };
        Ok(())
    }

    fn close(&mut self, name: &str) -> Result<(), String> {
        self.depth = self.depth.saturating_sub(1);
        match name {
            "Surfaces" => self.is_in_surfaces = false,
            "Breakline" => self.is_in_breakline = false,
            "Boundary" => self.is_void = None,
            _ => {}
        }
        let Some(reads) = self.reads.take() else { return Ok(()) };
        let Some(surface) = self.found.surfaces.last_mut() else { return Ok(()) };
        match reads {
            LandText::Point => {
                let [northing, easting, elevation] = numbers(&self.text)?[..] else {
                    return Err(format!(
                        "point '{}' is not a northing, an easting and an elevation",
                        shortened(&self.id)
                    ));
                };
                let number = surface.tin.points.len() as u32;
                surface.tin.points.push(DVec3::new(easting, northing, elevation));
                // The first of one id counts.
                self.numbers.entry(std::mem::take(&mut self.id)).or_insert(number);
            }
            LandText::Face { is_visible: false } => {}
            LandText::Face { is_visible: true } => {
                let id = |id: &str| {
                    self.numbers
                        .get(id)
                        .copied()
                        .ok_or_else(|| format!("a face names point '{}', which is not there", shortened(id)))
                };
                match self.text.split_whitespace().map(id).collect::<Result<Vec<u32>, _>>()?[..] {
                    [a, b, c] => surface.tin.faces.push([a, b, c]),
                    [a, b, c, d] => surface.tin.faces.extend([[a, b, c], [a, c, d]]),
                    ref others => {
                        return Err(format!("a face has {} points, not three or four", others.len()));
                    }
                }
            }
            LandText::Loose { numbers_each: 3 } => surface.loose.extend(points(&self.text, 3)?),
            LandText::Breakline { numbers_each: 3 } => {
                let line = points(&self.text, 3)?;
                match line.len() {
                    0 | 1 => surface.loose.extend(line),
                    _ => surface.breaklines.push(line),
                }
            }
            // Without elevations they say nothing of the ground.
            LandText::Loose { .. } | LandText::Breakline { .. } => {}
            LandText::Boundary { is_void, numbers_each } => {
                let ring = points(&self.text, numbers_each)?.into_iter().map(DVec3::truncate).collect();
                if is_void { surface.voids.push(ring) } else { surface.outer.push(ring) }
            }
        }
        Ok(())
    }
}

/// The numbers of a text.
fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |word: &str| {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| format!("'{}' is no number", shortened(word)))
    };
    text.split_whitespace().map(number).collect()
}

/// Points of as many numbers each, northing first.
fn points(text: &str, numbers_each: usize) -> Result<Vec<DVec3>, String> {
    let numbers = numbers(text)?;
    if !numbers.len().is_multiple_of(numbers_each) {
        return Err(format!("a list of {} numbers is not one of points of {numbers_each}", numbers.len()));
    }
    let point = |at: &[f64]| DVec3::new(at[1], at[0], at.get(2).copied().unwrap_or(f64::NAN));
    Ok(numbers.chunks_exact(numbers_each).map(point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::{DemHints, DemOptions};

    fn land(units: &str, surfaces: &str) -> String {
        format!(
            "<?xml version=\"1.0\"?><LandXML version=\"1.2\"><Units>{units}</Units>\
             <CoordinateSystem epsgCode=\"32616\"/><Surfaces>{surfaces}</Surfaces></LandXML>"
        )
    }

    const METRIC: &str = "<Metric linearUnit=\"meter\" elevationUnit=\"meter\"/>";

    /// Two triangles of a slope of 1 in 10 to the east over 40 × 20 m, and the rest of the square invisible.
    const SLOPE: &str = "<Surface name=\"EG\"><Definition surfType=\"TIN\"><Pnts>\
        <P id=\"1\">4000000 500000 100</P><P id=\"2\">4000000 500040 104</P><P id=\"7\">4000020 500040 104</P>\
        <P id=\"9\">4000020 500000 100</P></Pnts><Faces><F>1 2 7</F><F i=\"1\">1 7 9</F></Faces></Definition></Surface>";

    fn options(cell: Option<f64>, surface: Option<&str>) -> DemOptions {
        DemOptions { cell, surface: surface.map(str::to_owned), ..DemOptions::default() }
    }

    fn read_text(text: &str, options: DemOptions) -> Result<Raster, String> {
        crate::read::read("a.xml", text.as_bytes(), &DemHints::from(options))
            .map_err(|error| error.to_string())
    }

    fn height(raster: &Raster, easting: f64, northing: f64) -> f64 {
        let grid = raster.map_from_grid.inverse().transform_point2(DVec2::new(easting, northing));
        let index = grid.y as usize * raster.width as usize + grid.x as usize;
        match &raster.samples {
            Samples::F64(values) => values[index],
            Samples::F32(values) => f64::from(values[index]),
        }
    }

    #[test]
    fn samples_lie_on_visible_triangles_and_nowhere_else() {
        let raster = read_text(&land(METRIC, SLOPE), options(Some(1.0), None)).expect("a surface");
        assert_eq!((raster.width, raster.height), (40, 20));
        assert_eq!(raster.crs.as_ref().and_then(Crs::epsg), Some(32_616));
        assert!((height(&raster, 500_030.5, 4_000_002.5) - 103.05).abs() < 1e-9);
        assert!(height(&raster, 500_002.5, 4_000_018.5).is_nan(), "on the invisible triangle");
        let chosen = read_text(&land(METRIC, SLOPE), options(None, None)).expect("a surface");
        assert!(chosen.notes[0].contains("samples were put 20 apart"), "{:?}", chosen.notes);
    }

    #[test]
    fn feet_are_brought_to_the_system_and_heights_state_their_unit() {
        let feet = "<Imperial linearUnit=\"USSurveyFoot\" elevationUnit=\"feet\"/>";
        let raster = read_text(&land(feet, SLOPE), options(Some(1.0), None)).expect("a surface");
        assert_eq!((raster.width, raster.height), (13, 7));
        assert!((raster.meters_per_z - 1200.0 / 3937.0).abs() < 1e-12 && raster.states_z_unit);
    }

    #[test]
    fn a_surface_without_faces_is_triangulated_within_its_boundaries() {
        let surface = "<Surface name=\"S\"><SourceData><DataPoints><PntList3D>0 0 10 0 40 14 40 0 10 40 40 14</PntList3D>\
            </DataPoints><Boundaries><Boundary bndType=\"outer\"><PntList2D>0 0 0 40 40 40 40 0</PntList2D></Boundary>\
            <Boundary bndType=\"void\"><PntList2D>10 10 10 20 20 20 20 10</PntList2D></Boundary></Boundaries>\
            <Breaklines><Breakline><PntList3D>20 0 10 20 40 14</PntList3D></Breakline></Breaklines></SourceData></Surface>";
        let raster = read_text(&land(METRIC, surface), options(Some(2.0), None)).expect("points");
        assert!((height(&raster, 31.0, 31.0) - 13.1).abs() < 1e-9);
        assert!(height(&raster, 15.0, 15.0).is_nan(), "in the void");
        assert!(raster.notes[0].contains("triangulated"), "{:?}", raster.notes);
    }

    #[test]
    fn of_several_surfaces_the_first_is_taken_and_told_or_one_is_named() {
        let both =
            land(METRIC, &(SLOPE.to_owned() + &SLOPE.replace("\"EG\"", "\"FG\"").replace("104<", "114<")));
        let first = read_text(&both, options(Some(1.0), None)).expect("a surface");
        assert!(first.notes[0].contains("'EG', 'FG', the first is taken"), "{:?}", first.notes);
        let named = read_text(&both, options(Some(1.0), Some("FG"))).expect("a surface");
        assert!((height(&named, 500_030.5, 4_000_002.5) - 110.675).abs() < 1e-9);
        let missing = read_text(&both, options(None, Some("XG"))).expect_err("missing");
        assert!(missing.contains("'EG', 'FG'"), "{missing}");
    }

    #[test]
    fn what_is_broken_is_told_with_its_line() {
        for (wrong, reason) in
            [("<F>1 2 8</F>", "names point '8'"), ("<F>1 2</F>", "2 points"), ("<F>1 2 7", "line 1")]
        {
            let error = read_text(&land(METRIC, &SLOPE.replace("<F>1 2 7</F>", wrong)), options(None, None));
            let error = error.expect_err(reason);
            assert!(error.contains(reason), "{error}");
        }
        let none = read_text(&land(METRIC, ""), options(None, None)).expect_err("no surface");
        assert!(none.contains("no surface with points"), "{none}");
        let far = SLOPE.replace("4000020 500040 104", "9e300 9e300 1");
        assert!(read_text(&land(METRIC, &far), options(None, None)).is_err());
    }
}
