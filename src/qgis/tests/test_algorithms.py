"""The provider: its algorithms are those of the program, each runs, and results have styles."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from unittest import mock

from common import PROGRAM, PROVIDER, ROOT, QgisTest, Swellendam, processing
from osgeo import gdal
from qgis.core import (
    QgsFeature,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProject,
    QgsRasterLayer,
    QgsSettings,
    QgsVectorLayer,
)
from qgis.gui import QgisInterface, QgsMapCanvas
from qgis.PyQt.QtWidgets import QMainWindow

import sandtable_qgis
from sandtable_qgis.program import ProgramCanceled, catalog, run
from sandtable_qgis.provider import SandtableProvider
from sandtable_qgis.styles import style_raster

# Debian's wrapper of the program passes an option that it does not know.
QGIS_PROCESS = shutil.which("qgis_process.bin") or "qgis_process"

OBSERVER = "20.44,-34.02 [EPSG:4326]"
TARGET = "20.46,-33.99 [EPSG:4326]"


def layer(*shapes):
    """A layer in memory."""
    kind = shapes[0].split(" ")[0].title().replace("string", "String")
    made = QgsVectorLayer(f"{kind}?crs=EPSG:4326", "shapes", "memory")
    for shape in shapes:
        feature = QgsFeature()
        feature.setGeometry(QgsGeometry.fromWkt(shape))
        made.dataProvider().addFeature(feature)
    return made


POINTS = ["POINT (20.44 -34.02)", "POINT (20.46 -34.01)"]
SHAPES = {
    "points": POINTS,
    "line": ["LINESTRING (20.42 -34.03, 20.45 -34.01)"],
    "area": ["POLYGON ((20.43 -34.03, 20.45 -34.03, 20.45 -34.01, 20.43 -34.03))"],
}


class GroundTest(QgisTest):
    def setUp(self):
        super().setUp()
        self.map = Swellendam()

    def test_heights_are_those_of_the_elevation_and_other_points_have_a_status(self):
        points = layer(*POINTS, "POINT (0 0)")
        made = self.run_algorithm("heights", GROUND=self.map.dem, POINTS=points, OUTPUT="memory:")["OUTPUT"]
        rows = list(made.getFeatures())
        self.assertEqual([row["status"] for row in rows], ["Ok", "Ok", "Outside"])
        least, greatest = 50, 1200
        self.assertTrue(all(least < row["height"] < greatest for row in rows[:2]))

    def test_a_profile_has_stations_from_end_to_end_and_a_chart(self):
        chart = str(self.folder / "chart.png")
        made = self.run_algorithm("profile", GROUND=self.map.dem, LINES=layer(*SHAPES["line"]), OUTPUT="memory:", CHART=chart)
        rows = list(made["OUTPUT"].getFeatures())
        stations = [row["station"] for row in rows]
        self.assertEqual(stations, sorted(stations))
        # 0.03° of longitude and 0.02° of latitude at 34° south.
        self.assertAlmostEqual(stations[-1], 3550, delta=50)
        self.assertTrue(Path(chart).is_file())

    def test_a_line_of_sight_is_cut_where_the_view_is_blocked(self):
        made = self.run_algorithm("line_of_sight", GROUND=self.map.dem, FROM=OBSERVER, TO=TARGET, OBSERVER_HEIGHT=2, OUTPUT="memory:")
        parts = [row["part"] for row in made["OUTPUT"].getFeatures()]
        self.assertEqual(parts, ["free"] if made["VISIBLE"] else ["free", "blocked"])

    def test_a_viewshed_loads_with_the_colors_of_seen_and_hidden(self):
        path = str(self.folder / "seen.tif")
        self.run_algorithm("viewshed", GROUND=self.map.dem, AT=OBSERVER, RANGE=3000, OUTPUT=path)
        raster = QgsRasterLayer(path, "seen")
        labels = [one.label for one in raster.renderer().classes()]
        self.assertEqual(labels, ["hidden", "seen"])

    def test_layers_that_are_loaded_take_their_styles(self):
        for name, parameters in [
            ("heights", {"POINTS": layer(*POINTS)}),
            ("line_of_sight", {"FROM": OBSERVER, "TO": TARGET}),
        ]:
            made = processing.runAndLoadResults(f"sandtable:{name}", {"GROUND": self.map.dem, "OUTPUT": "TEMPORARY_OUTPUT", **parameters})
            loaded = QgsProject.instance().mapLayer(made["OUTPUT"])
            self.assertEqual(loaded.renderer().type(), "categorizedSymbol", name)

    def test_a_question_without_a_ground_says_what_to_choose(self):
        with self.assertRaisesRegex(Exception, "Choose a layer with elevations"):
            self.run_algorithm("viewshed", AT=OBSERVER, OUTPUT=str(self.folder / "seen.tif"))


class SceneAlgorithmsTest(QgisTest):
    def test_layers_become_a_scene_a_picture_and_a_page(self):
        self.map = Swellendam()
        made = self.run_algorithm(
            "new_scene",
            DEM=self.map.dem,
            LAYERS=[self.map.roads, self.map.water],
            EXTENT="20.40,20.46,-34.05,-34.00 [EPSG:4326]",
            TITLE="Roads",
            OUTPUT=str(self.folder / "scene"),
        )
        self.assertIn("[[overlay]]", Path(made["SCENE"]).read_text(encoding="utf-8"))
        picture, page = (str(self.folder / name) for name in ("a.png", "a.html"))
        self.run_algorithm("render", SCENE=made["SCENE"], WIDTH=320, HEIGHT=180, OUTPUT=picture)
        self.run_algorithm("export", SCENE=made["SCENE"], OUTPUT=page)
        self.assertEqual(Path(picture).read_bytes()[:4], b"\x89PNG")
        self.assertIn("<html", Path(page).read_text(encoding="utf-8")[:500])
        glb = str(self.folder / "a.glb")
        self.run_algorithm("export", SCENE=made["SCENE"], OUTPUT=glb)
        self.assertEqual(Path(glb).read_bytes()[:4], b"glTF")

    def test_errors_of_the_program_have_the_place_in_the_scene(self):
        scene = self.folder / "scene.toml"
        scene.write_text("[terrain]\nden = 1\n")
        with self.assertRaisesRegex(Exception, "scene.toml:2"):
            self.run_algorithm("render", SCENE=str(scene), OUTPUT=str(self.folder / "a.png"))


class AnalysesTest(QgisTest):
    def setUp(self):
        super().setUp()
        self.map = Swellendam()
        # A small part: every kind runs, and none takes long.
        self.dem = str(self.folder / "part.tif")
        processing.run("gdal:cliprasterbyextent", {"INPUT": self.map.dem, "PROJWIN": "20.42,20.47,-34.04,-34.0 [EPSG:4326]", "OUTPUT": self.dem})
        # The ground after a fill of five meters in its middle.
        self.other = str(self.folder / "other.tif")
        copy = gdal.GetDriverByName("GTiff").CreateCopy(self.other, gdal.Open(self.dem))
        band = copy.GetRasterBand(1)
        values = band.ReadAsArray(20, 15, 20, 20)
        band.WriteArray(values + 5, 20, 15)
        del band, copy

    def test_every_kind_of_the_catalog_is_an_algorithm_that_runs(self):
        wrong = {}
        for kind in catalog():
            name = "analyze_" + kind["name"].replace("-", "_")
            parameters = {"GROUND": self.dem}
            for one in kind["parameters"]:
                if one["required"]:
                    parameters[one["name"].upper()] = self.value(one)
            if kind["name"] == "dam-break":
                parameters.update(GROUND=self.valley(), LEVEL_M=350)
            outputs = {key: str(self.folder / f"{name}.{end}") for key, end in [("RASTER", "tif"), ("FEATURES", "gpkg")]}
            parameters.update({key: path for key, path in outputs.items() if key.lower() in kind["gives"]})
            try:
                made = self.run_algorithm(name, **parameters)
            except Exception as error:  # noqa: BLE001 (all kinds are tried before the test fails)
                wrong[kind["name"]] = str(error)
                continue
            json.loads(made["REPORT"])
            if "raster" in kind["gives"]:
                raster = QgsRasterLayer(made["RASTER"], name)
                self.assertEqual(raster.renderer().type(), "singlebandpseudocolor", name)
        self.assertEqual(wrong, {}, str(wrong))

    def valley(self):
        """A valley across which the line of `SHAPES` is a dam; it rises toward the south-east."""
        path = str(self.folder / "valley.tif")
        copy = gdal.GetDriverByName("GTiff").CreateCopy(path, gdal.Open(self.dem))
        west, cell, _, north, _, step = copy.GetGeoTransform()
        band = copy.GetRasterBand(1)
        values = band.ReadAsArray()
        for row in range(values.shape[0]):
            for column in range(values.shape[1]):
                east, up = west + (column + 0.5) * cell - 20.435, north + (row + 0.5) * step + 34.02
                across, onward = 0.832 * east + 0.555 * up, 0.555 * east - 0.832 * up
                values[row, column] = 300 + 5000 * abs(across) + 4000 * onward
        band.WriteArray(values)
        del band, copy
        return path

    def value(self, parameter):
        """A value of a parameter that must be stated."""
        form = parameter["form"]
        if form in SHAPES:
            return layer(*SHAPES[form])
        # Above the lowest ground of the part, and far enough to see.
        numbers = {"level_m": 500, "max_range": 2000}
        return {"number": numbers.get(parameter["name"], 10), "vehicle": "tank", "ground": self.other}[form]

    def test_a_raster_has_the_colors_and_the_names_of_the_classes(self):
        path = str(self.folder / "slope.tif")
        self.run_algorithm("analyze_slope", GROUND=self.dem, UNIT="degrees", RASTER=path)
        classes = json.loads(run(["analyze", "slope", self.dem, "--unit=degrees", "--json", "-o", self.folder / "again.tif"]))["classes"]
        raster = QgsRasterLayer(path, "slope")
        items = raster.renderer().shader().rasterShaderFunction().colorRampItemList()
        self.assertEqual([item.label for item in items if item.label], [one["label"] for one in classes])
        self.assertEqual([item.color.name() for item in items if item.label], [one["color"] for one in classes])

    def test_the_classes_of_a_style_begin_where_those_of_the_program_do(self):
        path = str(self.folder / "slope.tif")
        self.run_algorithm("analyze_slope", GROUND=self.dem, RASTER=path)
        rows = [{"from": at, "label": str(at), "color": color, "opacity": 1} for at, color in [(0, "#000001"), (10, "#000002")]]
        style_raster(path, rows)
        raster = QgsRasterLayer(path, "slope")
        shader = raster.renderer().shader()
        blue = lambda value: shader.shade(value)[3]  # noqa: E731
        self.assertEqual([blue(value) for value in (0.0, 9.99, 10.0, 400.0)], [1, 1, 2, 2])

    def test_features_load_with_the_styles_of_their_geopackage(self):
        path = str(self.folder / "lines.gpkg")
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        processing.run("sandtable:analyze_contours", {"GROUND": self.dem, "INTERVAL": 20, "FEATURES": path}, context=context)
        sources = list(context.layersToLoadOnCompletion())
        self.assertEqual(sources, [f"{path}|layername=isolines"])
        lines = QgsVectorLayer(sources[0], "lines", "ogr")
        self.assertEqual(lines.renderer().symbol().color().name(), "#8c5a28")

    def test_a_canceled_run_ends_the_program_and_leaves_no_file(self):
        path = self.folder / "seen.tif"
        line = ["viewshed", self.map.dem.source(), "--at", "20.44,-34.02", "--crs", "EPSG:4326", "-o", path]
        with self.assertRaises(ProgramCanceled):
            run(line, is_canceled=lambda: True)
        self.assertFalse(path.exists())
        feedback = QgsProcessingFeedback()
        feedback.cancel()
        with self.assertRaises(Exception):
            processing.run("sandtable:analyze_fill", {"GROUND": self.map.dem, "RASTER": str(path)}, feedback=feedback)
        self.assertFalse(path.exists())


class PluginTest(QgisTest):
    def test_the_algorithms_of_the_provider_are_those_of_the_program(self):
        names = {algorithm.name() for algorithm in PROVIDER.algorithms()}
        for kind in catalog():
            self.assertIn("analyze_" + kind["name"].replace("-", "_"), names)
        self.assertLessEqual({"render", "new_scene", "export", "heights", "profile", "line_of_sight", "viewshed"}, names)

    def test_the_plugin_adds_an_action_that_opens_the_dialog_and_unloads(self):
        window = QMainWindow()
        canvas = QgsMapCanvas(window)
        iface = mock.Mock(spec=QgisInterface)
        iface.mainWindow.return_value, iface.mapCanvas.return_value = window, canvas
        plugin = sandtable_qgis.classFactory(iface)
        # The tests' own provider has the name that the plugin's takes.
        plugin.initProcessing = lambda: setattr(plugin, "provider", SandtableProvider())
        plugin.initGui()
        iface.addToolBarIcon.assert_called_once_with(plugin.action)
        plugin.action.trigger()
        self.assertTrue(plugin.dialog.isVisible())
        plugin.dialog.reject()
        self.assertFalse(plugin.dialog.isVisible())
        plugin.provider = None
        plugin.unload()
        iface.removeToolBarIcon.assert_called_once_with(plugin.action)

    def test_the_installed_zip_is_listed_by_qgis_process_and_runs(self):
        archive = self.folder / "plugin.zip"
        subprocess.run([sys.executable, str(ROOT / "src" / "qgis" / "package.py"), str(archive)], check=True, capture_output=True)
        again = self.folder / "again.zip"
        subprocess.run([sys.executable, str(ROOT / "src" / "qgis" / "package.py"), str(again)], check=True, capture_output=True)
        self.assertEqual(archive.read_bytes(), again.read_bytes())
        plugins = self.folder / "plugins"
        with zipfile.ZipFile(archive) as file:
            self.assertIn("sandtable_qgis/metadata.txt", file.namelist())
            file.extractall(plugins)
        # QGIS takes the first Python on the path for its own: it must not be one of an environment that is active.
        path = os.pathsep.join([os.path.dirname(PROGRAM), os.path.dirname(sys.executable), os.environ["PATH"]])
        config = str(self.folder / "config")
        environment = dict(os.environ, QGIS_PLUGINPATH=str(plugins), QGIS_CUSTOM_CONFIG_PATH=config, PATH=path)

        def process(*arguments):
            ran = subprocess.run([QGIS_PROCESS, *arguments], env=environment, capture_output=True, text=True)
            self.assertEqual(ran.returncode, 0, ran.stderr + ran.stdout)
            return ran.stdout

        process("plugins", "enable", "sandtable_qgis")
        self.assertIn("sandtable:analyze_slope", process("list"))
        path = self.folder / "slope.tif"
        dem = self.map_dem()
        process("run", "sandtable:analyze_slope", "--", f"GROUND={dem}", f"RASTER={path}")
        self.assertTrue(path.with_suffix(".qml").is_file())

    @staticmethod
    def map_dem():
        return Swellendam().dem.source()
