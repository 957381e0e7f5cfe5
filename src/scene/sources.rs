//! Lines and polygons of a feature, from inline points or a vector file, in world coordinates.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use crate::assets::Assets;
use crate::attributes::Attributes;
use crate::class_raster::{ClassRaster, ClassRasterError};
use crate::layer_key::{LayerKey, layer_key};
use crate::picked_shapes::PickedShapes;
use crate::read_ahead::SourcesAhead;
use crate::reading_notes::ReadingNotes;
use crate::scene_findings::SceneFindings;
use crate::source_filter::{filter_of, values_of};
use crate::source_reach::{ShapeReach, SourceReach};
use crate::world_frame::WorldFrame;
use sandtable_base::limits::{ASSET_BYTES, RING_CROSSINGS};
use sandtable_base::message::suggest::quoted;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::selection::Selection;
use sandtable_description::stated::Stated;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_geom::self_crossing::count_crossings;
use sandtable_vector::cityjson::CityModel;
use sandtable_vector::error::{VectorError, did_you_mean, list};
use sandtable_vector::feature::{Feature, Geometry, Polygon, VectorLayer};
use sandtable_vector::filter::Filter;
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read::{self, LayeredFile, VectorFile};

/// Reads vector files, each once.
pub struct Sources<'a> {
    /// The document and its place in the world.
    pub frame: &'a WorldFrame<'a>,
    /// The files that the document may name.
    pub assets: &'a Assets,
    layers: RefCell<BTreeMap<LayerKey, Arc<VectorLayer>>>,
    /// Files that take longer to read than a layer of them to make, by name.
    layered: RefCell<BTreeMap<String, LayeredFile>>,
    /// Layers of these that were made before they were needed.
    ahead: RefCell<BTreeMap<LayerKey, VectorLayer>>,
    /// The surfaces of CityJSON files.
    city_models: RefCell<BTreeMap<LayerKey, Arc<CityModel>>>,
    /// The files that are rasters of land cover: what is taken of them is what lies on the ground, which may be nothing.
    class_rasters: RefCell<BTreeSet<String>>,
    /// The systems that files state and the scene overrides.
    overridden: RefCell<BTreeMap<LayerKey, Crs>>,
    /// How many crossings more the scene's polygons may have with themselves.
    crossings_left: Cell<usize>,
    /// Where the sources lie, by the first byte that states them.
    reaches: RefCell<BTreeMap<usize, SourceReach>>,
    /// What reading the files left out or took for something else, in the order of reading.
    reading: RefCell<ReadingNotes>,
}

/// A shape with the properties of its feature.
pub struct Sourced<T> {
    /// The properties of the feature it is, or is a part of; none for inline points.
    pub attributes: Attributes,
    /// The shape, in world coordinates.
    pub shape: T,
    /// How often the rings of a polygon cross themselves and each other; 0 for points and lines.
    pub crossings: usize,
}

/// The features of a file that a thread looks at in one go: enough against a hand-over of a microsecond.
const FEATURES: usize = 256;

/// The shapes that a thread places in one go.
const SHAPES: usize = 32;

/// The crossings up to which polygons are counted side by side; of one that has more, what is left for the scene decides.
const FEW_CROSSINGS: usize = 64;

impl<'a> Sources<'a> {
    /// Sources that read through `assets` and place through `frame`.
    pub fn new(frame: &'a WorldFrame<'a>, assets: &'a Assets) -> Self {
        Self::with(frame, assets, SourcesAhead::default())
    }

    /// As [`Self::new`], with what was read of the document's files before.
    pub fn with(frame: &'a WorldFrame<'a>, assets: &'a Assets, ahead: SourcesAhead) -> Self {
        let crossings_left = Cell::new(RING_CROSSINGS.count());
        Self {
            frame,
            assets,
            layers: RefCell::default(),
            layered: RefCell::new(ahead.files),
            ahead: RefCell::new(ahead.layers),
            city_models: RefCell::default(),
            class_rasters: RefCell::default(),
            overridden: RefCell::default(),
            crossings_left,
            reaches: RefCell::default(),
            reading: RefCell::default(),
        }
    }

    /// What was read of the files, for a thread to drop while others work: a city has millions of allocations.
    pub fn into_read(self) -> impl Send {
        (self.layers.into_inner(), self.layered.into_inner())
    }

    /// The lines of a source.
    ///
    /// # Errors
    /// The file cannot be read, holds no line that matches, or its coordinates cannot be transformed to the scene's
    /// system.
    pub fn lines(&self, source: &FeatureSource) -> Result<Vec<Sourced<Vec<DVec2>>>, Diagnostic> {
        let lines = self.shapes(source, |geometry| match geometry {
            Geometry::Lines(lines) => lines.clone(),
            Geometry::Points(_) | Geometry::Polygons(_) => Vec::new(),
        })?;
        self.place_all(source, lines, |line, place| line.into_iter().map(place).collect())
    }

    /// The lines and polygons of a source, each feature's as they are; inline points are a line.
    ///
    /// # Errors
    /// As for [`Sources::lines`].
    pub fn lines_and_polygons(&self, source: &FeatureSource) -> Result<Vec<Sourced<Geometry>>, Diagnostic> {
        let shapes = self.shapes(source, |geometry| match geometry {
            Geometry::Lines(_) | Geometry::Polygons(_) => vec![geometry.clone()],
            Geometry::Points(_) => Vec::new(),
        })?;
        self.place_all(source, shapes, |shape, place| {
            let course = |line: Vec<DVec2>| line.into_iter().map(place).collect::<Result<Vec<_>, _>>();
            Ok(match shape {
                Geometry::Polygons(polygons) => {
                    let placed = polygons.into_iter().map(|polygon| placed_polygon(polygon, place));
                    Geometry::Polygons(placed.collect::<Result<_, _>>()?)
                }
                Geometry::Lines(lines) => {
                    Geometry::Lines(lines.into_iter().map(course).collect::<Result<_, _>>()?)
                }
                Geometry::Points(points) => Geometry::Points(course(points)?),
            })
        })
    }

    /// The polygons of a source; inline points are an outer ring.
    ///
    /// # Errors
    /// As for [`Sources::lines`].
    pub fn polygons(&self, source: &FeatureSource) -> Result<Vec<Sourced<Polygon>>, Diagnostic> {
        let polygons = self.shapes(source, |geometry| match geometry {
            Geometry::Polygons(polygons) => polygons.clone(),
            Geometry::Lines(lines) => lines.iter().cloned().filter_map(closed).collect(),
            Geometry::Points(_) => Vec::new(),
        })?;
        let placed = self.place_all(source, polygons, placed_polygon)?;
        let few = |polygon: &Sourced<Polygon>| count_crossings(rings(&polygon.shape), FEW_CROSSINGS);
        let few: Vec<Option<usize>> = placed.par_iter().map(few).collect();
        let counted = |(polygon, few): (Sourced<Polygon>, Option<usize>)| {
            let crossings = self.crossings(source, &polygon, few)?;
            Ok(Sourced { crossings, ..polygon })
        };
        placed.into_iter().zip(few).map(counted).collect()
    }

    /// How often a polygon crosses itself: `few` where that is no more than [`FEW_CROSSINGS`]. One that would take too long to
    /// resolve is refused, before anything is spent on it.
    fn crossings(
        &self,
        source: &FeatureSource,
        polygon: &Sourced<Polygon>,
        few: Option<usize>,
    ) -> Result<usize, Diagnostic> {
        let left = self.crossings_left.get();
        let few = few.filter(|_| left >= FEW_CROSSINGS);
        match few.or_else(|| count_crossings(rings(&polygon.shape), left)) {
            Some(crossings) => {
                self.crossings_left.set(left - crossings);
                Ok(crossings)
            }
            None => {
                let name = polygon.attributes.name(None);
                let name = if name.is_empty() {
                    "a polygon".to_owned()
                } else {
                    format!("polygon '{}'", quoted(&name))
                };
                let message = format!(
                    "{name} of {} vertices crosses itself too often: the polygons of a scene are resolved where they cross themselves up to {RING_CROSSINGS} times in all",
                    polygon.shape.exterior.len()
                );
                let help = format!(
                    "mend it, for example with: ogr2ogr -makevalid out.geojson IN; or {RING_CROSSINGS:#}"
                );
                Err(self.frame.document.error_at(source.span(), message).with_help(help))
            }
        }
    }

    /// The points of a source.
    ///
    /// # Errors
    /// As for [`Sources::lines`].
    pub fn points(&self, source: &FeatureSource) -> Result<Vec<Sourced<DVec2>>, Diagnostic> {
        let points = self.shapes(source, |geometry| match geometry {
            Geometry::Points(points) => points.clone(),
            // Inline points are handed in as a line.
            Geometry::Lines(lines) if source.points.is_some() => lines.concat(),
            Geometry::Lines(_) | Geometry::Polygons(_) => Vec::new(),
        })?;
        self.place_all(source, points, |point, place| place(point))
    }

    /// The features of a file, each once, and the system of their shapes.
    ///
    /// # Errors
    /// The file cannot be read or holds no feature that matches.
    pub fn features(&self, source: &FeatureSource) -> Result<(Crs, Vec<Attributes>), Diagnostic> {
        let (crs, features) = self.shapes(source, |_| vec![()])?;
        Ok((crs, features.into_iter().map(|feature| feature.attributes).collect()))
    }

    /// The shapes of a source, and their system.
    ///
    /// # Errors
    /// The file cannot be read or holds no feature that matches.
    pub fn geometries(&self, source: &FeatureSource) -> Result<(Crs, Vec<Geometry>), Diagnostic> {
        let (crs, shapes) = self.shapes(source, |geometry| vec![geometry.clone()])?;
        Ok((crs, shapes.into_iter().map(|sourced| sourced.shape).collect()))
    }

    /// The surfaces of a CityJSON file; `None` of a source of another format. The property `id` of its features names their
    /// objects.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn city_model(&self, source: &FeatureSource) -> Result<Option<Arc<CityModel>>, Diagnostic> {
        let Some(file) = &source.file else { return Ok(None) };
        let key = layer_key(file, source);
        self.layer(file, source)?;
        Ok(self.city_models.borrow().get(&key).cloned())
    }

    /// Whether the polygons of a source that was read are those of a raster of land cover, which adjoin each other.
    pub fn is_class_raster(&self, source: &FeatureSource) -> bool {
        source.file.as_ref().is_some_and(|file| self.class_rasters.borrow().contains(file.as_str()))
    }

    /// The shapes that `pick` takes from every feature that matches, unplaced.
    fn shapes<T>(
        &self,
        source: &FeatureSource,
        pick: impl Fn(&Geometry) -> Vec<T> + Sync,
    ) -> Result<(Crs, Vec<Sourced<T>>), Diagnostic>
    where
        T: Send,
    {
        if let Some(points) = &source.points {
            let crs = source.crs.as_ref().unwrap_or(&self.frame.points_crs);
            let line: Result<Vec<DVec2>, _> = points.iter().map(|point| point.in_system(crs)).collect();
            let line = line.map_err(|error| self.frame.document.error(points, error))?;
            let shape = pick(&Geometry::Lines(vec![line]));
            let sourced = |shape| Sourced { attributes: Attributes::default(), shape, crossings: 0 };
            return Ok((crs.clone(), shape.into_iter().map(sourced).collect()));
        }
        let Some(file) = &source.file else {
            return Ok((self.frame.crs.clone(), Vec::new()));
        };
        let layer = self.layer(file, source)?;
        let filter = filter_of(source);
        let holds = |attributes: &Attributes| match source.selection.as_deref() {
            Some(Selection::Holding(condition)) => attributes.holds(condition),
            _ => true,
        };
        let picked_of = |(portion, features): (usize, &[Feature])| {
            let mut picked = PickedShapes::default();
            let matching = features.iter().enumerate().filter(|(_, feature)| filter.matches(feature));
            for (index, feature) in matching {
                let attributes = Attributes::new(Arc::clone(&layer), portion * FEATURES + index);
                if holds(&attributes) {
                    picked.add(&attributes, feature.geometry.kind(), pick(&feature.geometry));
                }
            }
            picked
        };
        let portions: Vec<PickedShapes<T>> =
            layer.features.par_chunks(FEATURES).enumerate().map(picked_of).collect();
        let mut all = PickedShapes::default();
        portions.into_iter().for_each(|picked| all.append(picked));
        let PickedShapes { shapes, of_other_shape } = all;
        if shapes.is_empty() && !self.class_rasters.borrow().contains(file.as_str()) {
            return Err(self.nothing_found(source, file, &filter, &layer));
        }
        self.reading.borrow_mut().add_other_shapes(file, &of_other_shape);
        Ok((layer.crs.clone(), shapes))
    }

    fn nothing_found(
        &self,
        source: &FeatureSource,
        file: &Stated<String>,
        filter: &Filter,
        layer: &Arc<VectorLayer>,
    ) -> Diagnostic {
        let name = file.as_str();
        if layer.features.is_empty() {
            return self.no_features(source, file, layer);
        }
        let unmatched =
            |selection| self.frame.document.error(selection, format!("no feature of '{name}' matches"));
        if let Some(selection) = &source.selection
            && let Selection::Holding(condition) = &**selection
            && !(0..layer.features.len())
                .any(|index| Attributes::new(Arc::clone(layer), index).holds(condition))
        {
            return match values_of(condition).explain_no_match(layer) {
                Some(reason) => unmatched(selection).with_help(reason),
                None => unmatched(selection),
            };
        }
        match (filter.explain_no_match(layer), &source.selection) {
            (Some(reason), Some(selection)) => unmatched(selection).with_help(reason),
            _ => {
                let message = format!("no feature of '{name}' that matches has the shape needed here");
                let kinds: BTreeSet<_> =
                    layer.features.iter().map(|feature| feature.geometry.kind()).collect();
                let kinds: Vec<_> = kinds.into_iter().collect();
                let help = match layer.features.len() {
                    1 => format!("the file's only feature is of {}", kinds.join(", ")),
                    count => format!("the file's {count} features are {}", kinds.join(" and ")),
                };
                self.frame.document.error(file, message).with_help(help)
            }
        }
    }

    /// The error of a file or a layer without features, with what reading it left out.
    fn no_features(&self, source: &FeatureSource, file: &Stated<String>, layer: &VectorLayer) -> Diagnostic {
        let name = file.as_str();
        let message = match &source.layer {
            Some(wanted) => format!("the layer '{}' of '{name}' holds no features", wanted.as_str()),
            None => format!("'{name}' holds no features"),
        };
        let reasons: Vec<&str> = layer.reading_notes().map(String::as_str).collect();
        let help = match reasons.is_empty() {
            true => "name another file or layer, or remove the table".to_owned(),
            false => reasons.join("; "),
        };
        self.frame.document.error(file, message).with_help(help)
    }

    fn layer(&self, file: &Stated<String>, source: &FeatureSource) -> Result<Arc<VectorLayer>, Diagnostic> {
        let stated = source.crs.as_ref();
        let name = source.layer.as_ref().map(|wanted| wanted.as_str());
        let key = layer_key(file, source);
        if let Some(layer) = self.layers.borrow().get(&key) {
            return Ok(Arc::clone(layer));
        }
        if let Some(given) = self.assets.given().layer(file) {
            self.check_only_layer(file, source, "features in memory")?;
            let layer = self.given_layer(given, &key, stated);
            self.reading.borrow_mut().add_of_layer(file, &layer);
            self.layers.borrow_mut().insert(key, Arc::clone(&layer));
            return Ok(layer);
        }
        if let Some(layer) = self.class_layer(file, source, &key)? {
            let layer = Arc::new(layer);
            self.reading.borrow_mut().add_of_layer(file, &layer);
            self.layers.borrow_mut().insert(key, Arc::clone(&layer));
            return Ok(layer);
        }
        // A table of attributes may be as large as the file itself.
        let companions = self.assets.companions(ASSET_BYTES.get());
        let overridden = |own: &Crs| drop(self.overridden.borrow_mut().insert(key.clone(), own.clone()));
        let found = |name: &str| companions.get(name);
        let columns = &key.3;
        let hints =
            VectorHints { crs: stated, overridden: &overridden, layer: name, columns, companions: &found };
        let read = match self.ahead.borrow_mut().remove(&key) {
            Some(layer) => Ok(VectorFile { layer, model: None }),
            None => self.read(file, &hints)?,
        };
        companions.check().map_err(|error| self.frame.document.error(file, error))?;
        let VectorFile { layer, model } = read.map_err(|error| self.unread(file, source, error))?;
        if let Some(model) = model {
            self.city_models.borrow_mut().insert(key.clone(), Arc::new(model));
        }
        let layer = Arc::new(layer);
        self.reading.borrow_mut().add_of_layer(file, &layer);
        self.layers.borrow_mut().insert(key, Arc::clone(&layer));
        Ok(layer)
    }

    /// The polygons of a raster of land cover over the ground; `None` of another file.
    fn class_layer(
        &self,
        file: &Stated<String>,
        source: &FeatureSource,
        key: &LayerKey,
    ) -> Result<Option<VectorLayer>, Diagnostic> {
        let overridden = |own: &Crs| drop(self.overridden.borrow_mut().insert(key.clone(), own.clone()));
        let failed = |error: ClassRasterError| self.frame.document.error(file, error);
        let opened = ClassRaster::open(file, self.assets, source.crs.as_ref(), &overridden);
        let Some(raster) = opened.map_err(failed)? else { return Ok(None) };
        self.check_only_layer(file, source, "a raster of land cover")?;
        self.class_rasters.borrow_mut().insert(file.to_string());
        raster.layer(&self.frame.extent, self.frame.crs).map(Some).map_err(failed)
    }

    /// Refuses keys that say where features are in a file, of what holds one layer and no columns.
    fn check_only_layer(
        &self,
        file: &Stated<String>,
        source: &FeatureSource,
        what: &str,
    ) -> Result<(), Diagnostic> {
        let key = source.layer.as_ref().map(|_| "layer").or(source.columns.as_ref().map(|_| "columns"));
        let Some(key) = key else { return Ok(()) };
        let message = format!("`{key}` has no effect on '{}', which is {what}", quoted(file));
        let error = self.frame.document.error(file, message).with_code(FindingCode::NoEffect);
        Err(error.with_help("leave it out: it says what is read of a file"))
    }

    /// Reads a layer of a file, and the file once for all of its layers where they are made of what is kept of it.
    fn read(
        &self,
        file: &Stated<String>,
        hints: &VectorHints<'_>,
    ) -> Result<Result<VectorFile, VectorError>, Diagnostic> {
        let of_layer =
            |layered: &LayeredFile| layered.layer(hints).map(|layer| VectorFile { layer, model: None });
        if let Some(layered) = self.layered.borrow().get(file.as_str()) {
            return Ok(of_layer(layered));
        }
        let bytes = self.assets.read(file).map_err(|error| self.frame.document.error(file, error))?;
        Ok(match LayeredFile::read(file, &bytes, hints) {
            None => read::read_file(file, &bytes, hints),
            Some(read) => read.and_then(|layered| {
                let layer = of_layer(&layered);
                self.layered.borrow_mut().insert(file.to_string(), layered);
                layer
            }),
        })
    }

    /// Features in memory, in the system that the scene file states for them, where it states one.
    fn given_layer(
        &self,
        given: &Arc<VectorLayer>,
        key: &LayerKey,
        stated: Option<&Crs>,
    ) -> Arc<VectorLayer> {
        match stated {
            Some(crs) if *crs != given.crs => {
                self.overridden.borrow_mut().insert(key.clone(), given.crs.clone());
                Arc::new(VectorLayer { crs: crs.clone(), ..VectorLayer::clone(given) })
            }
            _ => Arc::clone(given),
        }
    }

    /// Reports what reading the files left out, or took for something else, once.
    pub fn report_reading(&self, findings: &mut SceneFindings) {
        self.reading.take().report(findings);
    }

    /// The system that the file of a source states and that its `crs` takes the place of; `None` of a source that was not
    /// read.
    pub fn overridden_crs(&self, source: &FeatureSource) -> Option<Crs> {
        let key = layer_key(source.file.as_ref()?, source);
        self.overridden.borrow().get(&key).cloned()
    }

    /// The error of a file that cannot be read, at the key that caused it.
    fn unread(&self, file: &Stated<String>, source: &FeatureSource, error: VectorError) -> Diagnostic {
        let document = self.frame.document;
        match (&error, &source.layer) {
            (VectorError::NoSuchLayer { wanted, suggestion, names }, Some(key)) => {
                let message =
                    format!("'{}' has no layer '{wanted}'{}", file.as_str(), did_you_mean(suggestion));
                document.error(key, message).with_help(format!("its layers are {}", list(names)))
            }
            (VectorError::WhichLayer { names }, _) => {
                let message = format!("'{}' holds {} layers", file.as_str(), names.len());
                let help = format!("add `layer = \"...\"` with one of {}", list(names));
                document.error(file, message).with_help(help)
            }
            (VectorError::NoSuchColumn { .. }, _) if source.columns.is_some() => {
                let span = source.columns.as_ref().and_then(Stated::span).unwrap_or_default();
                document.error_at(span, format!("'{}': {error}", file.as_str()))
            }
            _ => document.error(file, error),
        }
    }

    /// Transforms every shape to world coordinates.
    fn place_all<T: Send, U: Send>(
        &self,
        source: &FeatureSource,
        (from, shapes): (Crs, Vec<Sourced<T>>),
        transform: impl Fn(T, &dyn Fn(DVec2) -> Result<DVec2, CrsError>) -> Result<U, CrsError> + Sync,
    ) -> Result<Vec<Sourced<U>>, Diagnostic> {
        let (frame, file) = (self.frame, source.file.as_ref().map(|file| file.to_string()));
        let placed = |Sourced { attributes, shape, crossings }: Sourced<T>| {
            let reach = RefCell::new(ShapeReach::default());
            let place = |at: DVec2| {
                let world = frame.world(&from, at)?;
                reach.borrow_mut().add(at, world);
                Ok(world)
            };
            let shape = transform(shape, &place)?;
            Ok((Sourced { attributes, shape, crossings }, reach.into_inner()))
        };
        // Of several errors the first is reported: all shapes are placed before one is looked for.
        let placed: Vec<Result<_, CrsError>> =
            shapes.into_par_iter().with_min_len(SHAPES).map(placed).collect();
        let mut reach = SourceReach::new(source.span(), file, from.clone());
        let mut sourced = Vec::with_capacity(placed.len());
        for placed in placed {
            let (shape, of_shape) = placed.map_err(|error| frame.document.error_at(source.span(), error))?;
            reach.add_shape(&of_shape);
            sourced.push(shape);
        }
        // Of a raster the part around the ground is read: that it reaches beyond says nothing.
        if !self.is_class_raster(source) {
            self.reaches.borrow_mut().insert(source.span().start, reach);
        }
        Ok(sourced)
    }

    /// Measures the places of those features of a file that were not placed as lines, polygons or points, which are not
    /// measured otherwise. What cannot be transformed is left out.
    ///
    /// # Errors
    /// The file cannot be read or holds no feature that matches.
    pub fn measure(&self, source: &FeatureSource) -> Result<(), Diagnostic> {
        let (crs, shapes) = self.geometries(source)?;
        let file = source.file.as_ref().map(|file| file.to_string());
        let mut reach = SourceReach::new(source.span(), file, crs.clone());
        for shape in &shapes {
            let mut of_shape = ShapeReach::default();
            for &at in shape.vertices() {
                if let Ok(world) = self.frame.world(&crs, at) {
                    of_shape.add(at, world);
                }
            }
            reach.add_shape(&of_shape);
        }
        self.reaches.borrow_mut().insert(source.span().start, reach);
        Ok(())
    }

    /// The reach of the sources that were read, in the order of the scene file.
    pub fn reaches(&self) -> Vec<SourceReach> {
        self.reaches.borrow().values().cloned().collect()
    }
}

/// A polygon whose vertices are transformed by `place`.
fn placed_polygon(
    polygon: Polygon,
    place: &dyn Fn(DVec2) -> Result<DVec2, CrsError>,
) -> Result<Polygon, CrsError> {
    let ring = |ring: Vec<DVec2>| ring.into_iter().map(place).collect::<Result<Vec<_>, _>>();
    let holes = polygon.holes.into_iter().map(ring).collect::<Result<_, _>>()?;
    Ok(Polygon { exterior: ring(polygon.exterior)?, holes })
}

/// The outer ring and the holes of a polygon.
fn rings(polygon: &Polygon) -> impl Iterator<Item = &[DVec2]> {
    polygon.rings().map(Vec::as_slice)
}

/// A line as an outer ring, without repeating its first vertex; `None` where fewer than three remain.
fn closed(mut ring: Vec<DVec2>) -> Option<Polygon> {
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    (ring.len() >= 3).then_some(Polygon { exterior: ring, holes: Vec::new() })
}
