"""What QGIS loads: the provider of Processing, and the action that opens the dialog."""

import os

from qgis.core import QgsApplication
from qgis.PyQt.QtGui import QIcon
from qgis.PyQt.QtWidgets import QAction

from .provider import SandtableProvider

ICON = os.path.join(os.path.dirname(__file__), "icon.svg")


class SandtablePlugin:
    """Adds the provider and the dialog to QGIS, and removes them."""

    def __init__(self, iface):
        self.iface = iface
        self.provider = None
        self.action = None
        self.dialog = None

    def initProcessing(self):  # noqa: N802
        """Adds the provider; all that `qgis_process` calls."""
        self.provider = SandtableProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):  # noqa: N802
        """Adds the provider and the action."""
        self.initProcessing()
        self.action = QAction(QIcon(ICON), "3D picture of this map…", self.iface.mainWindow())
        self.action.triggered.connect(self.open)
        self.iface.addPluginToMenu("sandtable", self.action)
        self.iface.addToolBarIcon(self.action)

    def open(self):
        """Shows the dialog for the map as it is now."""
        from .dialog import PictureDialog

        canvas = self.iface.mapCanvas()
        self.dialog = PictureDialog(canvas.mapSettings(), self.iface.mainWindow())
        self.dialog.program_changed.connect(self.provider.refreshAlgorithms)
        self.dialog.show()

    def unload(self):
        """Removes what was added."""
        if self.action is not None:
            self.iface.removePluginMenu("sandtable", self.action)
            self.iface.removeToolBarIcon(self.action)
        if self.provider is not None:
            QgsApplication.processingRegistry().removeProvider(self.provider)
