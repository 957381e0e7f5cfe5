"""The pictures of the book's chapter "In QGIS", of the demo's elevation: `SANDTABLE_SHOTS=src/book/qgis` writes them there."""

import os
import shutil
import time
from pathlib import Path

from common import APP, ROOT, QgisTest, copied
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFillSymbol,
    QgsLineSymbol,
    QgsMapRendererSequentialJob,
    QgsMapSettings,
    QgsPalLayerSettings,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsVectorLayer,
    QgsVectorLayerSimpleLabeling,
)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor, QImage

from sandtable_qgis.dialog import PictureDialog

ASSETS = copied(ROOT / "assets" / "jacksboro")
VALLEY = QgsRectangle(746_500, 4_017_500, 754_500, 4_025_500)


class BookTest(QgisTest):
    def setUp(self):
        super().setUp()
        project = QgsProject.instance()
        project.clear()
        project.setCrs(QgsCoordinateReferenceSystem("EPSG:32616"))
        self.dem = self.add(QgsRasterLayer(str(ASSETS / "dem.tif"), "elevation"))
        self.vectors = []
        line, fill = QgsLineSymbol.createSimple, QgsFillSymbol.createSimple
        for name, symbol in [
            ("woods", fill({"color": "60,120,60,120", "outline_style": "no"})),
            ("lake", fill({"color": "#7fb7e8", "outline_color": "#2a6fb0", "outline_width": "0.3"})),
            ("streams", line({"line_color": "#2a6fb0", "line_width": "0.5"})),
            ("roads", line({"line_color": "#d7261e", "line_width": "0.9"})),
        ]:
            layer = self.add(QgsVectorLayer(str(ASSETS / f"{name}.geojson"), name, "ogr"))
            layer.renderer().setSymbol(symbol)
            self.vectors.insert(0, layer)
        labels = QgsPalLayerSettings()
        labels.fieldName = "name"
        for layer in self.vectors:
            if "name" in layer.fields().names():
                layer.setLabeling(QgsVectorLayerSimpleLabeling(labels))
                layer.setLabelsEnabled(True)
        self.shots = Path(os.environ["SANDTABLE_SHOTS"]) if "SANDTABLE_SHOTS" in os.environ else self.folder / "shots"
        self.shots.mkdir(parents=True, exist_ok=True)

    @staticmethod
    def add(layer):
        assert layer.isValid(), layer.source()
        QgsProject.instance().addMapLayer(layer)
        return layer

    def settings(self, layers):
        settings = QgsMapSettings()
        settings.setLayers(layers)
        settings.setDestinationCrs(QgsProject.instance().crs())
        settings.setOutputSize(QSize(560, 560))
        settings.setExtent(VALLEY)
        settings.setBackgroundColor(QColor("white"))
        return settings

    def test_the_dialog_makes_the_picture_of_the_chapter(self):
        dialog = PictureDialog(self.settings([*self.vectors, self.dem]))
        dialog.is_opening = False
        dialog.title.setText("Powell Valley")
        dialog.folder.setFilePath(str(self.folder / "scene"))
        dialog.width.setValue(960)
        dialog.height.setValue(540)
        dialog.program.setText("")
        dialog._keep = lambda: None
        dialog.make()
        end = time.monotonic() + 60
        while dialog.task is not None and time.monotonic() < end:
            APP.processEvents()
            time.sleep(0.01)
        picture = self.folder / "scene" / "picture.png"
        self.assertTrue(picture.is_file(), dialog.message.text())
        shutil.copy(picture, self.shots / "picture.png")
        dialog.folder.setFilePath("maps/powell-valley-3d")
        dialog.message.setText("maps/powell-valley-3d/picture.png\nmaps/powell-valley-3d/page.html")
        dialog.resize(540, 800)
        dialog.show()
        APP.processEvents()
        self.save(dialog.grab().toImage(), "dialog.png")

    def test_the_slope_loads_with_the_colors_of_the_chapter(self):
        path = str(self.folder / "slope.tif")
        self.run_algorithm("analyze_slope", GROUND=self.dem, RASTER=path)
        slope = self.add(QgsRasterLayer(path, "slope"))
        job = QgsMapRendererSequentialJob(self.settings([*self.vectors, slope]))
        job.start()
        job.waitForFinished()
        image = job.renderedImage().convertToFormat(QImage.Format_RGB888)
        colors = {image.pixelColor(x, y).name() for x in range(0, 560, 4) for y in range(0, 560, 4)}
        self.assertGreater(len(colors), 5, "classes of several colors")
        self.save(image, "slope.png")

    def save(self, image, name):
        self.assertTrue(image.convertToFormat(QImage.Format_RGB888).save(str(self.shots / name)))
