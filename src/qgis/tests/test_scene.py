"""The scene that is made of a map: what it holds, and that the program finds nothing wrong with its keys."""

import json
import struct
from pathlib import Path

from common import STREETS, TOWN, QgisTest, Swellendam
from qgis.core import QgsFeatureRequest, QgsFillSymbol, QgsLineSymbol, QgsRasterLayer, QgsRuleBasedRenderer

from sandtable_qgis.program import run
from sandtable_qgis.scene import BUILDINGS, SceneError, SceneOptions, guessed_role, scene_text, write_scene


def features(path):
    return json.loads(path.read_text(encoding="utf-8"))["features"]


class SceneTest(QgisTest):
    def setUp(self):
        super().setUp()
        self.map = Swellendam()

    def options(self, extent=STREETS, **changed):
        settings = self.map.settings(extent)
        stated = {"dem": self.map.dem, "layers": settings.layers(), "extent": settings.visibleExtent(), "crs": settings.destinationCrs()}
        return SceneOptions(**{**stated, "title": 'A "quoted" title', **changed})

    def test_the_program_finds_no_error_in_the_scene_of_a_map(self):
        scene = write_scene(str(self.folder), self.options())
        answer = json.loads(run(["check", scene, "--json"]))
        self.assertEqual([one for one in answer["findings"] if one["severity"] == "error"], [])

    def test_lines_have_the_color_and_the_width_of_their_class(self):
        write_scene(str(self.folder), self.options())
        roads = features(next(self.folder.glob("*-roads.geojson")))
        looks = {(one["properties"]["stroke"], one["properties"]["stroke-width"]) for one in roads}
        # 1.2 and 0.4 mm at 96 pixels per inch.
        self.assertIn(("#d7261e", 4.54), looks)
        self.assertIn(("#ffffff", 1.51), looks)
        self.assertGreater(len(roads), 100)

    def test_rules_give_features_their_symbols_and_leave_out_those_of_none(self):
        root = QgsRuleBasedRenderer.Rule(None)
        symbol = QgsLineSymbol.createSimple({"line_color": "#00aa55", "line_width": "20", "line_width_unit": "RenderMetersInMapUnits"})
        root.appendChild(QgsRuleBasedRenderer.Rule(symbol, filterExp="highway = 'residential'"))
        self.map.roads.setRenderer(QgsRuleBasedRenderer(root))
        write_scene(str(self.folder), self.options())
        roads = features(next(self.folder.glob("*-roads.geojson")))
        request = QgsFeatureRequest().setFilterRect(self.options().extent).setFilterExpression("highway = 'residential'")
        self.assertEqual(len(roads), len(list(self.map.roads.getFeatures(request))))
        self.assertEqual({one["properties"]["stroke"] for one in roads}, {"#00aa55"})
        # 0.025° of latitude are 2.8 km and 1080 pixels.
        self.assertTrue(all(7 < one["properties"]["stroke-width"] < 10 for one in roads), roads[0]["properties"])

    def test_a_dashed_line_and_an_area_without_fill_stay_so(self):
        self.map.rivers.renderer().setSymbol(QgsLineSymbol.createSimple({"line_style": "dash"}))
        self.map.water.renderer().setSymbol(QgsFillSymbol.createSimple({"style": "no", "outline_color": "#112233"}))
        write_scene(str(self.folder), self.options())
        self.assertTrue(all("stroke-dasharray" in one["properties"] for one in features(next(self.folder.glob("*-rivers.geojson")))))
        water = features(next(self.folder.glob("*-water.geojson")))[0]["properties"]
        self.assertEqual((water["fill"], water["stroke"]), ("none", "#112233"))

    def test_labels_have_the_texts_of_their_field_and_the_rank_of_their_size(self):
        write_scene(str(self.folder), self.options())
        places = features(next(self.folder.glob("*-places-labels.geojson")))
        self.assertIn({"text": "Swellendam", "rank": -11.0}, [one["properties"] for one in places])

    def test_buildings_stand_with_the_color_of_their_symbol(self):
        self.assertEqual(guessed_role(self.map.buildings), BUILDINGS)
        scene = write_scene(str(self.folder), self.options())
        self.assertIn("[[building]]", Path(scene).read_text(encoding="utf-8"))
        buildings = features(next(self.folder.glob("*-buildings.geojson")))
        self.assertEqual({one["properties"]["roof:colour"] for one in buildings}, {"#c0562f"})

    def test_the_elevation_keeps_the_values_of_its_posts(self):
        write_scene(str(self.folder), self.options())
        copy = QgsRasterLayer(str(self.folder / "dem.tif"), "copy")
        self.assertLess(copy.width(), self.map.dem.width() / 2)
        point = self.map.settings().visibleExtent().center()
        values = [layer.dataProvider().sample(point, 1) for layer in (self.map.dem, copy)]
        self.assertTrue(values[0][1])
        self.assertEqual(values[0], values[1])

    def test_rasters_are_a_picture_with_a_world_file(self):
        scene = write_scene(str(self.folder), self.options(TOWN))
        self.assertIn("[style.imagery]", Path(scene).read_text(encoding="utf-8"))
        width, height = struct.unpack(">II", (self.folder / "imagery.png").read_bytes()[16:24])
        step = float((self.folder / "imagery.pgw").read_text().split()[0])
        self.assertAlmostEqual(step * width, self.map.settings(TOWN).visibleExtent().width(), places=6)
        self.assertGreater(height, 100)

    def test_an_extent_beyond_the_elevation_is_refused_with_a_remedy(self):
        options = self.options()
        options.extent.set(0, 0, 1, 1)
        with self.assertRaisesRegex(SceneError, "no data in the map's extent"):
            write_scene(str(self.folder), options)

    def test_texts_are_written_as_toml_reads_them(self):
        text = scene_text([("", {"title": 'a "b" \\ ü\n'}), ("[[camera]]", {"azimuth": 0.5})])
        self.assertIn('title = "a \\"b\\" \\\\ ü\\n"\n\n[[camera]]\nazimuth = 0.5\n', text)
