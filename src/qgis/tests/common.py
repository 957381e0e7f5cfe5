"""QGIS without a window, the program under test, and a project of swellendam's layers."""

import atexit
import os
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
# QGIS keeps statistics of rasters beside them, and changes GeoPackages that it only reads: tests open copies of their data.
SCRATCH = Path(tempfile.mkdtemp(prefix="sandtable-qgis-"))
atexit.register(shutil.rmtree, SCRATCH, ignore_errors=True)
# Settings of a person are neither read nor changed.
os.environ["QGIS_CUSTOM_CONFIG_PATH"] = str(SCRATCH / "config")
ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "src" / "qgis"), "/usr/share/qgis/python/plugins"]

from qgis.core import (  # noqa: E402
    QgsApplication,
    QgsCategorizedSymbolRenderer,
    QgsCoordinateReferenceSystem,
    QgsFillSymbol,
    QgsLineSymbol,
    QgsMapSettings,
    QgsMarkerSymbol,
    QgsPalLayerSettings,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsRendererCategory,
    QgsSettings,
    QgsTextFormat,
    QgsVectorLayer,
    QgsVectorLayerSimpleLabeling,
)
from qgis.PyQt.QtCore import QSize  # noqa: E402

PROGRAM = os.environ.get("SANDTABLE_PROGRAM", str(ROOT / "target" / "debug" / "sandtable"))
SHARED = Path(os.environ.get("SANDTABLE_DATA", ROOT.parent / "shared" / "data")) / "scenes" / "swellendam_za"
# The town, the mountains north of it, and the west of what the photo shows.
TOWN = QgsRectangle(20.40, -34.06, 20.52, -33.98)
# Some streets in the middle, without the photo: enough for most tests.
STREETS = QgsRectangle(20.43, -34.035, 20.455, -34.01)

APP = QgsApplication([], True)
APP.initQgis()
QgsSettings().setValue("sandtable/program", PROGRAM)

import processing  # noqa: E402
from processing.core.Processing import Processing  # noqa: E402

from sandtable_qgis.provider import SandtableProvider  # noqa: E402

Processing.initialize()
PROVIDER = SandtableProvider()
QgsApplication.processingRegistry().addProvider(PROVIDER)


def copied(folder):
    """A copy of a folder of data, which QGIS may change; made once."""
    copy = SCRATCH / folder.name
    if not copy.exists():
        shutil.copytree(folder, copy, copy_function=shutil.copyfile)
        for part in [copy, *(path for path in copy.rglob("*") if path.is_dir())]:
            part.chmod(0o755)
    return copy


def swellendam():
    """A copy of swellendam's data; skips the test loudly where they are missing, unless they are required."""
    if not SHARED.is_dir() and "SANDTABLE_REQUIRE_DATA" not in os.environ:
        print(f"SKIPPED: no data in {SHARED}", file=sys.stderr)
        raise unittest.SkipTest("no data")
    return copied(SHARED)


class Swellendam:
    """A project as a person makes it: elevation, an aerial photo, water, roads by class, buildings, places with names."""

    def __init__(self):
        data = swellendam()
        self.project = QgsProject.instance()
        self.project.clear()
        self.project.setCrs(QgsCoordinateReferenceSystem("EPSG:4326"))
        self.dem = self._add(QgsRasterLayer(str(data / "dem_srtm_wgs84_f32.tif"), "elevation"))
        self.photo = self._add(QgsRasterLayer(str(data / "imagery_3420B.tif"), "photo"))
        package = data / "training_data.gpkg"
        self.water = self._vector(data / "water.shp", "water")
        self.rivers = self._vector(data / "rivers.shp", "rivers")
        self.roads = self._vector(f"{package}|layername=roads", "roads")
        self.buildings = self._vector(f"{package}|layername=buildings", "buildings")
        self.places = self._vector(data / "places.shp", "places")
        fill = {"color": "#7fb7e8", "outline_color": "#2a6fb0", "outline_width": "0.3"}
        self.water.renderer().setSymbol(QgsFillSymbol.createSimple(fill))
        self.rivers.renderer().setSymbol(QgsLineSymbol.createSimple({"line_color": "#2a6fb0", "line_width": "0.5"}))
        self.roads.setRenderer(QgsCategorizedSymbolRenderer("highway", self._road_classes()))
        self.buildings.renderer().setSymbol(QgsFillSymbol.createSimple({"color": "#c0562f"}))
        self.places.renderer().setSymbol(QgsMarkerSymbol.createSimple({"color": "#202020"}))
        self._label(self.places, "name", 11)
        self._label(self.roads, "name", 8)

    def settings(self, extent=STREETS):
        """The map as a canvas of 800 × 600 pixels shows it."""
        settings = QgsMapSettings()
        names = ["places", "buildings", "roads", "rivers", "water", "photo", "elevation"]
        settings.setLayers([self.project.mapLayersByName(name)[0] for name in names])
        settings.setDestinationCrs(self.project.crs())
        settings.setOutputSize(QSize(800, 600))
        settings.setExtent(extent)
        return settings

    def _vector(self, source, name):
        return self._add(QgsVectorLayer(str(source), name, "ogr"))

    def _add(self, layer):
        assert layer.isValid(), layer.source()
        self.project.addMapLayer(layer)
        return layer

    def _road_classes(self):
        rows = [("primary", "#d7261e", "1.2"), ("trunk", "#d7261e", "1.2"), ("secondary", "#f2a33a", "0.9"), ("", "#ffffff", "0.4")]
        line = lambda color, width: QgsLineSymbol.createSimple({"line_color": color, "line_width": width})  # noqa: E731
        return [QgsRendererCategory(word, line(color, width), word or "others") for word, color, width in rows]

    @staticmethod
    def _label(layer, field, size):
        settings, text = QgsPalLayerSettings(), QgsTextFormat()
        text.setSize(size)
        settings.fieldName = field
        settings.setFormat(text)
        layer.setLabeling(QgsVectorLayerSimpleLabeling(settings))
        layer.setLabelsEnabled(True)


class QgisTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="sandtable-qgis-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_algorithm(self, name, **parameters):
        """Runs an algorithm of the provider."""
        return processing.run(f"sandtable:{name}", parameters)
