"""The dialog “3D picture of this map”: the map's visible layers on an elevation layer, as a picture and a page."""

import os
import re
import tempfile

from qgis.core import QgsApplication, QgsMapLayerProxyModel, QgsProject, QgsSettings, QgsVectorLayer
from qgis.gui import QgsFileWidget, QgsMapLayerComboBox
from qgis.PyQt.QtCore import Qt, QUrl, pyqtSignal
from qgis.PyQt.QtGui import QDesktopServices, QPixmap
from qgis.PyQt.QtWidgets import (
    QApplication,
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QProgressBar,
    QSpinBox,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
)

from .program import SETTING, ProgramError, find_program
from .scene import ROLES, SceneCanceled, SceneError, SceneOptions, guessed_role, write_scene
from .task import PictureTask

PREFIX = "sandtable/dialog/"
LEFT_OUT = "left out"

# Notes on a picture that the dialog shows: more would hide the buttons on small screens.
MOST_NOTES = 5


class PictureDialog(QDialog):
    """Makes a scene of the map as `settings` (QgsMapSettings) show it, then its picture and its page."""

    program_changed = pyqtSignal()
    """The path of the program was changed."""

    def __init__(self, settings, parent=None):
        super().__init__(parent)
        self.setWindowTitle("3D picture of this map")
        self.map = settings
        self.task = None
        self.is_canceled = False
        self.is_opening = True
        """Whether the picture and the page are opened when they are made."""
        self._build()
        self._restore()

    def _build(self):
        self.dem = QgsMapLayerComboBox()
        self.dem.setFilters(QgsMapLayerProxyModel.RasterLayer)
        self.title = QLineEdit()
        self.folder = QgsFileWidget()
        self.folder.setStorageMode(QgsFileWidget.GetDirectory)
        self.width, self.height = (QSpinBox() for _ in range(2))
        for box in (self.width, self.height):
            box.setRange(64, 16384)
        self.pitch = QDoubleSpinBox()
        self.pitch.setRange(0, 89)
        self.pitch.setSuffix("°")
        self.pitch.setSpecialValueText("what fills the picture best")
        self.with_page = QCheckBox("Also a page for browsers")
        self.program = QLineEdit()
        self.program.setPlaceholderText("found on the path, or where pip has put it")
        self.layers = self._layer_table()
        size = QHBoxLayout()
        for widget in (self.width, QLabel("×"), self.height, QLabel("px")):
            size.addWidget(widget)
        size.addStretch()
        form = QFormLayout()
        form.addRow("Elevation", self.dem)
        form.addRow("Title", self.title)
        form.addRow("Layers", self.layers)
        form.addRow("Folder of the scene", self.folder)
        form.addRow("Picture", size)
        form.addRow("Looks down by", self.pitch)
        form.addRow("", self.with_page)
        form.addRow("Program", self.program)
        self.progress = QProgressBar()
        self.progress.hide()
        self.message = QLabel()
        self.message.setWordWrap(True)
        self.message.setTextInteractionFlags(Qt.TextSelectableByMouse)
        self.preview = QLabel()
        self.preview.setAlignment(Qt.AlignCenter)
        buttons = QDialogButtonBox(QDialogButtonBox.Close)
        self.make_button = buttons.addButton("Make the picture", QDialogButtonBox.ActionRole)
        self.cancel_button = buttons.addButton("Cancel", QDialogButtonBox.ActionRole)
        self.cancel_button.setEnabled(False)
        self.make_button.clicked.connect(self.make)
        self.cancel_button.clicked.connect(self.cancel)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(form)
        for widget in (self.preview, self.progress, self.message, buttons):
            column.addWidget(widget)

    def _layer_table(self):
        vectors = [layer for layer in self.map.layers() if isinstance(layer, QgsVectorLayer) and layer.isSpatial()]
        table = QTableWidget(len(vectors), 2)
        table.setHorizontalHeaderLabels(["layer", "in the picture"])
        table.verticalHeader().hide()
        table.horizontalHeader().setStretchLastSection(True)
        for row, layer in enumerate(vectors):
            item = QTableWidgetItem(layer.name())
            item.setData(Qt.UserRole, layer.id())
            item.setFlags(Qt.ItemIsEnabled)
            table.setItem(row, 0, item)
            roles = QComboBox()
            roles.addItems([*ROLES, LEFT_OUT])
            roles.setCurrentText(guessed_role(layer))
            table.setCellWidget(row, 1, roles)
        table.resizeColumnToContents(0)
        return table

    def _restore(self):
        settings, project = QgsSettings(), QgsProject.instance()
        # The elevation layer and the title belong to the project, the rest to the user.
        layer = project.mapLayer(project.readEntry("sandtable", "dem", "")[0])
        guessed = next((layer for layer in self.map.layers() if _is_elevation(layer)), None)
        self.dem.setLayer(layer or guessed or self.dem.currentLayer())
        self.title.setText(project.readEntry("sandtable", "title", project.title())[0])
        name = re.sub(r"[^A-Za-z0-9]+", "-", project.baseName() or "map").strip("-").lower()
        home = settings.value(PREFIX + "folder", project.homePath() or tempfile.gettempdir(), type=str)
        self.folder.setFilePath(project.readEntry("sandtable", "folder", os.path.join(home, f"{name}-3d"))[0])
        self.width.setValue(settings.value(PREFIX + "width", 1920, type=int))
        self.height.setValue(settings.value(PREFIX + "height", 1080, type=int))
        self.pitch.setValue(settings.value(PREFIX + "pitch", 0.0, type=float))
        self.with_page.setChecked(settings.value(PREFIX + "page", True, type=bool))
        self.program.setText(settings.value(SETTING, "", type=str))

    def _keep(self):
        settings, project = QgsSettings(), QgsProject.instance()
        if self.dem.currentLayer() is not None:
            project.writeEntry("sandtable", "dem", self.dem.currentLayer().id())
        project.writeEntry("sandtable", "title", self.title.text())
        project.writeEntry("sandtable", "folder", self.folder.filePath())
        settings.setValue(PREFIX + "folder", os.path.dirname(self.folder.filePath()))
        settings.setValue(PREFIX + "width", self.width.value())
        settings.setValue(PREFIX + "height", self.height.value())
        settings.setValue(PREFIX + "pitch", self.pitch.value())
        settings.setValue(PREFIX + "page", self.with_page.isChecked())
        if self.program.text() != settings.value(SETTING, "", type=str):
            settings.setValue(SETTING, self.program.text())
            self.program_changed.emit()

    def options(self):
        """The scene of what the dialog says."""
        rows = range(self.layers.rowCount())
        roles = {self.layers.item(row, 0).data(Qt.UserRole): self.layers.cellWidget(row, 1).currentText() for row in rows}
        return SceneOptions(
            dem=self.dem.currentLayer(),
            layers=[layer for layer in self.map.layers() if roles.get(layer.id()) != LEFT_OUT],
            extent=self.map.visibleExtent(),
            crs=self.map.destinationCrs(),
            title=self.title.text(),
            roles=roles,
            azimuth=-self.map.rotation() % 360,
            pitch=0 if self.pitch.value() == 0 else max(5, self.pitch.value()),
        )

    def make(self):
        """Writes the scene, then draws it in the background."""
        self._keep()
        self.is_canceled = False
        self._set_busy(True)
        try:
            find_program()
            # Layers and their symbols belong to the main thread: the scene is written here, the rest in the background.
            scene = write_scene(self.folder.filePath(), self.options(), self._writing, lambda: self.is_canceled)
        except (SceneError, ProgramError, OSError) as error:
            self._end(str(error))
            return
        except SceneCanceled:
            self._end("Canceled.")
            return
        self.task = PictureTask(scene, (self.width.value(), self.height.value()), self.with_page.isChecked(), self._finished)
        self.task.progressChanged.connect(lambda percent: self.progress.setValue(int(percent)))
        self.progress.setRange(0, 100)
        self.message.setText("The picture is drawn.")
        QgsApplication.taskManager().addTask(self.task)

    def cancel(self):
        """Ends the work; files that are whole stay."""
        self.is_canceled = True
        if self.task is not None:
            self.task.cancel()

    def _writing(self, what):
        self.message.setText(f"The scene is written: {what}.")
        QApplication.processEvents()

    def _finished(self, task, is_done):
        if not is_done:
            self._end(task.problem or "Canceled.")
            return
        self._end("\n".join(task.made + notes_of(task.said[0])))
        self.preview.setPixmap(QPixmap(task.made[0]).scaledToWidth(480, Qt.SmoothTransformation))
        for path in task.made if self.is_opening else []:
            QDesktopServices.openUrl(QUrl.fromLocalFile(path))

    def _set_busy(self, is_busy):
        self.make_button.setEnabled(not is_busy)
        self.cancel_button.setEnabled(is_busy)
        self.progress.setVisible(is_busy)
        self.progress.setRange(0, 0)

    def _end(self, message):
        self.task = None
        self._set_busy(False)
        self.message.setText(message)

    def reject(self):
        """Ends the work and closes the dialog."""
        self.cancel()
        super().reject()


def notes_of(said):
    """What `render` notes of the scene: what it left out, guessed or finds odd."""
    rows = [line.split(maxsplit=1) for line in said.splitlines()]
    notes = [row[1] for row in rows if len(row) == 2 and row[0] == "note"]
    left = [f"… and {len(notes) - MOST_NOTES} more"] if len(notes) > MOST_NOTES else []
    return notes[:MOST_NOTES] + left


def _is_elevation(layer):
    """Whether a layer looks like elevations: one band of numbers."""
    return getattr(layer, "bandCount", lambda: 0)() == 1
