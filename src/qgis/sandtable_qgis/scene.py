"""A scene of a map: visible layers with their symbols on an elevation layer, as a folder that stands alone.

    folder/scene.toml     what the program draws
    folder/dem.tif        the elevation in the map's extent
    folder/imagery.png    the map's rasters as they are styled, with their world file
    folder/1-roads.geojson, …    each vector layer: its features in the extent, with how they are drawn
"""

import json
import os
import re
from dataclasses import dataclass, field

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsCsException,
    QgsFeatureRequest,
    QgsGeometry,
    QgsMapRendererSequentialJob,
    QgsMapSettings,
    QgsProject,
    QgsRasterFileWriter,
    QgsRasterPipe,
    QgsRectangle,
    QgsVectorLayer,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QSize, Qt
from qgis.PyQt.QtGui import QColor

from .symbols import FeatureLabels, FeatureSymbols

# How a vector layer stands in the scene.
AS_DRAWN = "as drawn"
BUILDINGS = "buildings"
ROLES = [AS_DRAWN, BUILDINGS]

# Samples of the copy of the elevation: what a picture can show, with some to spare; coarser ones are written of larger maps.
MOST_SAMPLES = 16_000_000

# Pixels of the longer side of the copy of the rasters.
MOST_IMAGERY_PX = 4096

# Of a PNG, which loses nothing: how fast it is written rather than small. The copy is read once or twice.
IMAGERY_QUALITY = 75

# Renderers of a raster that shows more than the heights of the elevation in gray.
COLORED_RENDERERS = {"singlebandpseudocolor", "paletted", "hillshade", "multibandcolor", "singlebandcolordata"}

WGS84 = "EPSG:4326"


@dataclass
class SceneOptions:
    """What a scene is made of."""

    dem: object
    """The raster layer of the elevation."""
    layers: list
    """The visible layers, the topmost first, as in the map's settings."""
    extent: QgsRectangle
    """The part of the map, in `crs`."""
    crs: QgsCoordinateReferenceSystem
    """The map's coordinate system."""
    title: str = ""
    roles: dict = field(default_factory=dict)
    """How vector layers stand in the scene, by their ids; the others as `guessed_role` has it."""
    azimuth: float = 0.0
    """Where the camera looks, degrees clockwise from the top of the map's grid."""
    pitch: float = 0.0
    """How far it looks down from the horizon, degrees; 0 for what fills the picture best."""


class SceneError(Exception):
    """Why no scene can be made, for the user."""


class SceneCanceled(Exception):
    """The writing was canceled."""


def guessed_role(layer):
    """How a vector layer stands in a scene if nobody says: polygons of buildings as buildings, the rest as it is drawn."""
    if layer.geometryType() != QgsWkbTypes.PolygonGeometry:
        return AS_DRAWN
    fields = {name.lower() for name in layer.fields().names()}
    words = re.split(r"[^a-z]+", layer.name().lower())
    is_buildings = fields & {"building", "building:levels", "building_levels"} or {"building", "buildings"} & set(words)
    return BUILDINGS if is_buildings else AS_DRAWN


def write_scene(folder, options, on_progress=lambda text: None, is_canceled=lambda: False):
    """Writes the scene into a folder, which is made, and returns the path of its `scene.toml`."""
    if options.dem is None or not options.dem.isValid():
        raise SceneError("Choose a layer with elevations.")
    os.makedirs(folder, exist_ok=True)
    tables = [("", {"title": options.title})] if options.title else []
    on_progress("elevation")
    write_dem(options, os.path.join(folder, "dem.tif"))
    tables.append(("[terrain]", {"dem": "dem.tif", **_dem_crs(options.dem)}))
    on_progress("rasters")
    if write_imagery(options, os.path.join(folder, "imagery.png")):
        tables.append(("[style]", {"preset": "satellite"}))
        tables.append(("[style.imagery]", {"file": "imagery.png", "crs": crs_text(options.crs)}))
    labels = []
    vectors = [layer for layer in options.layers if isinstance(layer, QgsVectorLayer) and layer.isSpatial()]
    for number, layer in enumerate(reversed(vectors), 1):
        if is_canceled():
            raise SceneCanceled
        on_progress(layer.name())
        of_layer, of_labels = _write_layer(folder, number, layer, options, is_canceled)
        tables += of_layer
        labels += of_labels
    camera = {"name": "map", "azimuth": round(options.azimuth, 3)}
    if options.pitch:
        camera["pitch"] = round(options.pitch, 3)
    tables += labels + [("[[camera]]", camera)]
    path = os.path.join(folder, "scene.toml")
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(scene_text(tables))
    return path


def scene_text(tables):
    """A scene file of tables: their headings, with keys and values."""
    parts = ["# Made by QGIS of the map's visible layers."]
    for heading, keys in tables:
        lines = [heading] if heading else []
        parts.append("\n".join(lines + [f"{key} = {_toml(value)}" for key, value in keys.items()]))
    return "\n\n".join(parts) + "\n"


def crs_text(crs):
    """A coordinate system as scenes name it: `EPSG:n`, or a proj string."""
    return crs.authid() if crs.authid().upper().startswith("EPSG:") else crs.toProj()


def transformed(extent, source, target):
    """The bounding box of an extent in another system."""
    if source == target:
        return QgsRectangle(extent)
    transform = QgsCoordinateTransform(source, target, QgsProject.instance())
    try:
        return transform.transformBoundingBox(extent)
    except QgsCsException as error:
        raise SceneError(f"The map's extent cannot be stated in {target.authid()}: {error}") from error


def write_dem(options, path):
    """Writes the elevation in the extent as a GeoTIFF, with the layer's own posts where they are not too many."""
    layer = options.dem
    whole = layer.extent()
    extent = transformed(options.extent, options.crs, layer.crs()).intersect(whole)
    cell_x, cell_y = whole.width() / max(layer.width(), 1), whole.height() / max(layer.height(), 1)
    if extent.isEmpty() or extent.width() < 2 * cell_x or extent.height() < 2 * cell_y:
        raise SceneError(f"The elevation layer “{layer.name()}” has no data in the map's extent. Move the map, or choose another.")
    # On the layer's own cells, so that posts keep their values.
    column = int((extent.xMinimum() - whole.xMinimum()) / cell_x + 1e-6)
    row = int((whole.yMaximum() - extent.yMaximum()) / cell_y + 1e-6)
    columns = min(round(extent.width() / cell_x) + 1, layer.width() - column)
    rows = min(round(extent.height() / cell_y) + 1, layer.height() - row)
    west, north = whole.xMinimum() + column * cell_x, whole.yMaximum() - row * cell_y
    extent = QgsRectangle(west, north - rows * cell_y, west + columns * cell_x, north)
    factor = max(1.0, (columns * rows / MOST_SAMPLES) ** 0.5)
    pipe = QgsRasterPipe()
    pipe.set(layer.dataProvider().clone())
    writer = QgsRasterFileWriter(path)
    writer.setCreateOptions(["COMPRESS=DEFLATE"])
    size = max(2, int(columns / factor)), max(2, int(rows / factor))
    error = writer.writeRaster(pipe, *size, extent, layer.crs(), QgsProject.instance().transformContext())
    if error:
        raise SceneError(f"The elevation cannot be written to {path} (error {int(error)} of QGIS).")


def write_imagery(options, path):
    """Draws the rasters of the map, as they are styled, into a PNG with its world file; whether there are any."""
    rasters = [layer for layer in options.layers if not isinstance(layer, QgsVectorLayer) and _is_imagery(layer, options.dem)]
    if not rasters:
        return False
    extent = options.extent
    side = max(extent.width(), extent.height())
    finest = min([_cell(layer, options) for layer in rasters] + [side / 1024])
    pixel = max(finest, side / MOST_IMAGERY_PX)
    size = QSize(max(1, round(extent.width() / pixel)), max(1, round(extent.height() / pixel)))
    settings = QgsMapSettings()
    settings.setLayers(rasters)
    settings.setDestinationCrs(options.crs)
    settings.setTransformContext(QgsProject.instance().transformContext())
    settings.setOutputSize(size)
    settings.setExtent(extent)
    settings.setBackgroundColor(QColor(Qt.transparent))
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    if not job.renderedImage().save(path, "PNG", IMAGERY_QUALITY):
        raise SceneError(f"The picture {path} cannot be written.")
    shown = settings.visibleExtent()
    step = settings.mapUnitsPerPixel()
    world = [step, 0, 0, -step, shown.xMinimum() + step / 2, shown.yMaximum() - step / 2]
    with open(os.path.splitext(path)[0] + ".pgw", "w", encoding="ascii") as file:
        file.write("".join(f"{number!r}\n" for number in world))
    return True


def _is_imagery(layer, dem):
    """Whether a layer that is no vector layer shows more than the heights in gray."""
    renderer = layer.renderer() if hasattr(layer, "renderer") else None
    return layer.id() != dem.id() or getattr(renderer, "type", lambda: "")() in COLORED_RENDERERS


def _cell(layer, options):
    """The side of a raster's pixel in units of the map."""
    if not hasattr(layer, "width") or layer.width() < 1:
        return float("inf")
    return transformed(layer.extent(), layer.crs(), options.crs).width() / layer.width()


def _dem_crs(layer):
    # A GeoTIFF without an EPSG code states its system in words that not every reader knows.
    return {} if layer.crs().authid().upper().startswith("EPSG:") else {"crs": crs_text(layer.crs())}


def _write_layer(folder, number, layer, options, is_canceled):
    """Writes the features of a vector layer; the tables of the features, and those of the labels."""
    role = options.roles.get(layer.id(), guessed_role(layer))
    extent = transformed(options.extent, options.crs, layer.crs())
    to_wgs84 = QgsCoordinateTransform(layer.crs(), QgsCoordinateReferenceSystem(WGS84), QgsProject.instance())
    symbols, labels = FeatureSymbols(layer, extent), FeatureLabels(layer)
    names = layer.fields().names()
    drawn, named = [], []
    for feature in layer.getFeatures(QgsFeatureRequest().setFilterRect(extent)):
        if is_canceled():
            raise SceneCanceled
        properties = symbols.properties(feature)
        if properties is None:
            continue
        geometry = _in_extent(feature.geometry(), extent, role)
        if geometry.isEmpty() or geometry.transform(to_wgs84) != 0:
            continue
        shape = json.loads(geometry.asJson(9))
        text = labels.text(feature)
        if text:
            named.append(_feature(shape, {"text": text[0], "rank": -text[1]}))
        drawn.append(_feature(shape, _building(names, feature, properties) if role == BUILDINGS else properties))
    symbols.end()
    stem = f"{number}-{re.sub(r'[^A-Za-z0-9]+', '-', layer.name()).strip('-').lower() or 'layer'}"
    tables, of_labels = [], []
    if drawn:
        file = _write_features(folder, f"{stem}.geojson", drawn)
        heading = "[[building]]" if role == BUILDINGS else "[[overlay]]"
        tables.append((heading, {"name": layer.name(), "file": file}))
    if named:
        kind = {QgsWkbTypes.LineGeometry: "road", QgsWkbTypes.PolygonGeometry: "area"}.get(layer.geometryType(), "place")
        file = _write_features(folder, f"{stem}-labels.geojson", named)
        of_labels.append(("[[label]]", {"file": file, "text": "text", "rank": "rank", "kind": kind}))
    return tables, of_labels


def _in_extent(geometry, extent, role):
    """The part of a feature in the extent; a building stands as a whole."""
    geometry = QgsGeometry(geometry)
    if geometry.isNull():
        return geometry
    geometry.get().dropZValue()
    geometry.get().dropMValue()
    if geometry.type() == QgsWkbTypes.PointGeometry or role == BUILDINGS or extent.contains(geometry.boundingBox()):
        return geometry
    return geometry.clipped(extent)


def _building(names, feature, symbol):
    """The properties of a building: its own numbers and texts, and the colors of its symbol."""
    own = {name: value for name, value in zip(names, feature.attributes()) if _is_plain(value)}
    if symbol.get("fill", "none") != "none":
        own["roof:colour"] = symbol["fill"]
        own["building:colour"] = QColor(symbol["fill"]).lighter(125).name()
    return own


def _is_plain(value):
    return isinstance(value, (bool, int, float, str)) and value != ""


def _feature(shape, properties):
    return {"type": "Feature", "properties": properties, "geometry": shape}


def _write_features(folder, name, features):
    with open(os.path.join(folder, name), "w", encoding="utf-8", newline="\n") as file:
        file.write('{"type": "FeatureCollection", "features": [\n')
        file.write(",\n".join(json.dumps(feature, ensure_ascii=False) for feature in features))
        file.write("\n]}\n")
    return name


def _toml(value):
    """A value of a scene file; texts as JSON has them, whose escapes TOML shares."""
    return json.dumps(value, ensure_ascii=False)
