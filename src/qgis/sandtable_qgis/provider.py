"""The provider of Processing: scenes, questions about the ground, and the analyses of the program's catalog."""

import os

from qgis.core import Qgis, QgsMessageLog, QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .algorithms.analysis import AnalysisAlgorithm
from .algorithms.ground import HeightsAlgorithm, ProfileAlgorithm, SightAlgorithm, ViewshedAlgorithm
from .algorithms.scenes import ExportAlgorithm, NewSceneAlgorithm, RenderAlgorithm
from .program import ProgramError, catalog

ALGORITHMS = [
    RenderAlgorithm,
    NewSceneAlgorithm,
    ExportAlgorithm,
    HeightsAlgorithm,
    ProfileAlgorithm,
    SightAlgorithm,
    ViewshedAlgorithm,
]


class SandtableProvider(QgsProcessingProvider):
    """The algorithms of the program."""

    def id(self):
        return "sandtable"

    def name(self):
        return "sandtable"

    def icon(self):
        return QIcon(os.path.join(os.path.dirname(__file__), "icon.svg"))

    def loadAlgorithms(self):  # noqa: N802
        for algorithm in ALGORITHMS:
            self.addAlgorithm(algorithm())
        try:
            for kind in catalog():
                self.addAlgorithm(AnalysisAlgorithm(kind))
        except (ProgramError, ValueError) as error:
            # The other algorithms say the same when they run.
            QgsMessageLog.logMessage(f"The analyses are missing. {error}", "sandtable", Qgis.Warning)
