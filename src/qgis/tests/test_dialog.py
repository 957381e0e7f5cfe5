"""The dialog: a picture of a map, its settings, and canceling."""

import os
import shutil
import time
from pathlib import Path

from common import APP, ROOT, STREETS, TOWN, QgisTest, Swellendam
from qgis.core import QgsApplication
from qgis.PyQt.QtGui import QImage

from sandtable_qgis.dialog import PictureDialog, notes_of

# What a person waits at most for swellendam's picture with the debug build of the program, on a machine with other work.


class DialogTest(QgisTest):
    def setUp(self):
        super().setUp()
        self.map = Swellendam()

    def dialog(self, extent=STREETS):
        dialog = PictureDialog(self.map.settings(extent))
        dialog.is_opening = False
        dialog.folder.setFilePath(str(self.folder / "scene"))
        dialog.title.setText("Swellendam")
        dialog.width.setValue(1280)
        dialog.height.setValue(720)
        return dialog

    def wait(self, dialog, seconds=60):
        end = time.monotonic() + seconds
        while dialog.task is not None and time.monotonic() < end:
            APP.processEvents()
            time.sleep(0.01)
        self.assertIsNone(dialog.task, "the task ends")

    def test_a_map_becomes_a_picture_and_a_page(self):
        dialog = self.dialog(TOWN)
        self.assertEqual(dialog.dem.currentLayer().id(), self.map.dem.id(), "the layer of one band is the elevation")
        seen = []
        begun = time.monotonic()
        dialog.with_page.setChecked(False)
        dialog.progress.valueChanged.connect(seen.append)
        dialog.make()
        self.wait(dialog)
        took = time.monotonic() - begun
        picture = self.folder / "scene" / "picture.png"
        self.assertTrue(picture.is_file(), dialog.message.text())
        print(f"\nfrom the map to the picture: {took:.1f} s")
        self.assertTrue(any(0 < percent < 100 for percent in seen), "the steps move the bar")
        self.assertIn("cut off along its border", dialog.message.text(), "what the program notes is shown")
        self._look(picture)
        dialog.with_page.setChecked(True)
        dialog.make()
        self.wait(dialog)
        page = (self.folder / "scene" / "page.html").read_text(encoding="utf-8")
        self.assertIn("Swellendam", page)
        if "SANDTABLE_SHOTS" in os.environ:
            self._keep_shots(dialog, picture)

    def _look(self, picture):
        """The picture shows the colors of the map's symbols."""
        image = QImage(str(picture))
        self.assertEqual((image.width(), image.height()), (1280, 720))
        colors = [image.pixelColor(x, y) for x in range(0, 1280, 2) for y in range(0, 720, 2)]
        reds = sum(color.red() > 180 and color.green() < 110 and color.blue() < 90 for color in colors)
        whites = sum(min(color.red(), color.green(), color.blue()) > 240 for color in colors)
        self.assertGreater(reds, 200, "main roads and roofs")
        self.assertGreater(whites, 200, "streets and the margin")

    def _keep_shots(self, dialog, picture):
        shots = Path(os.environ["SANDTABLE_SHOTS"])
        shots.mkdir(parents=True, exist_ok=True)
        shutil.copy(picture, shots / "qgis-picture.png")
        dialog.resize(560, 900)
        dialog.show()
        APP.processEvents()
        dialog.grab().save(str(shots / "qgis-dialog.png"))

    def test_a_canceled_task_leaves_no_picture_and_can_be_made_again(self):
        dialog = self.dialog()
        dialog.width.setValue(7680)
        dialog.height.setValue(4320)
        dialog.make()
        time.sleep(0.5)
        dialog.cancel()
        self.wait(dialog, 10)
        self.assertEqual(dialog.message.text(), "Canceled.")
        left = [path.name for path in (self.folder / "scene").iterdir()]
        self.assertNotIn("picture.png", left)
        self.assertFalse([name for name in left if name.endswith(".part")])
        self.assertTrue(dialog.make_button.isEnabled())

    def test_notes_of_the_program_are_shown_the_first_of_many(self):
        said = "a.png\n  ground   1 post\n" + "".join(f"  note     number {i}\n" for i in range(7))
        self.assertEqual(notes_of(said), [f"number {i}" for i in range(5)] + ["… and 2 more"])

    def test_the_settings_are_kept_from_dialog_to_dialog(self):
        dialog = self.dialog()
        dialog.pitch.setValue(33)
        dialog._keep()
        again = PictureDialog(self.map.settings())
        self.assertEqual((again.pitch.value(), again.width.value(), again.title.text()), (33, 1280, "Swellendam"))
        self.assertEqual(again.folder.filePath(), str(self.folder / "scene"))

    def test_a_program_that_is_not_there_is_named_in_the_dialog(self):
        dialog = self.dialog()
        program = dialog.program.text()
        dialog.program.setText(str(ROOT / "no-such-program"))
        dialog.make()
        self.wait(dialog)
        self.assertIn("does not start", dialog.message.text())
        dialog.program.setText(program)
        dialog._keep()

    def test_what_the_program_says_of_a_wrong_scene_is_shown(self):
        dialog = self.dialog()
        dialog.dem.setLayer(None)
        dialog.make()
        self.assertIn("Choose a layer", dialog.message.text())
        self.assertEqual(QgsApplication.taskManager().countActiveTasks(), 0)
