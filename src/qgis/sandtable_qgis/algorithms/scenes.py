"""Algorithms of scene files: draw one, make one of layers, export one."""

import os

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputFile,
    QgsProcessingParameterCrs,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFile,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterFolderDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterLayer,
    QgsProcessingParameterString,
)

from ..scene import SceneCanceled, SceneError, SceneOptions, write_scene
from .base import ProgramAlgorithm

FAMILY = "Scenes"
EXPORTS = "Page for browsers (*.html);;glTF (*.glb);;Wavefront (*.obj);;3MF to print (*.3mf);;STL to print (*.stl);;GeoPackage (*.gpkg);;GeoJSON (*.geojson);;KMZ (*.kmz)"


class RenderAlgorithm(ProgramAlgorithm):
    """Draws a scene file."""

    NAME, TITLE, FAMILY = "render", "Render a scene file", FAMILY
    HELP = "Draws a scene file as an annotated picture: PNG, PDF or SVG. Without a camera, its first one."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.addParameter(QgsProcessingParameterFile("SCENE", "Scene file", extension="toml"))
        self.addParameter(QgsProcessingParameterString("CAMERA", "Camera", optional=True))
        number = QgsProcessingParameterNumber
        self.addParameter(number("WIDTH", "Width, pixels", number.Integer, 1920, False, 16, 16384))
        self.addParameter(number("HEIGHT", "Height, pixels", number.Integer, 1080, False, 16, 16384))
        self.addParameter(QgsProcessingParameterFileDestination("OUTPUT", "Picture", "PNG (*.png);;PDF (*.pdf);;SVG (*.svg)"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        output = self.parameterAsFileOutput(parameters, "OUTPUT", context)
        size = "x".join(str(self.parameterAsInt(parameters, name, context)) for name in ("WIDTH", "HEIGHT"))
        camera = self.parameterAsString(parameters, "CAMERA", context)
        arguments = ["render", self.parameterAsFile(parameters, "SCENE", context), "-o", output, "--size", size]
        feedback.pushInfo(self.run_program(arguments + (["--camera", camera] if camera else []), feedback))
        return {"OUTPUT": output}


class NewSceneAlgorithm(ProgramAlgorithm):
    """Makes a scene of layers."""

    NAME, TITLE, FAMILY = "new_scene", "New scene from layers", FAMILY
    HELP = (
        "Writes a folder with a scene file: the elevation in the extent, the layers' features as their symbols draw them, their "
        "labels, and rasters as a picture of the ground. Polygons of a layer named buildings, or with a field `building`, become "
        "buildings. The first layer lies on top."
    )

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.addParameter(QgsProcessingParameterRasterLayer("DEM", "Elevation layer"))
        kind = QgsProcessing.TypeMapLayer
        self.addParameter(QgsProcessingParameterMultipleLayers("LAYERS", "Layers, the topmost first", kind, optional=True))
        self.addParameter(QgsProcessingParameterExtent("EXTENT", "Extent [the elevation layer's]", optional=True))
        self.addParameter(QgsProcessingParameterString("TITLE", "Title", optional=True))
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", "Folder of the scene"))
        self.addOutput(QgsProcessingOutputFile("SCENE", "Scene file"))

    def flags(self):
        # Layers and their symbols belong to the main thread.
        return super().flags() | ProgramAlgorithm.FlagNoThreading

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        dem = self.parameterAsRasterLayer(parameters, "DEM", context)
        crs = context.project().crs() if context.project() and context.project().crs().isValid() else dem.crs()
        extent = self.parameterAsExtent(parameters, "EXTENT", context, crs)
        if extent.isEmpty():
            crs, extent = dem.crs(), dem.extent()
        options = SceneOptions(
            dem=dem,
            layers=self.parameterAsLayerList(parameters, "LAYERS", context),
            extent=extent,
            crs=crs,
            title=self.parameterAsString(parameters, "TITLE", context),
        )
        folder = self.parameterAsString(parameters, "OUTPUT", context)
        try:
            scene = write_scene(folder, options, feedback.setProgressText, feedback.isCanceled)
        except (SceneError, SceneCanceled) as error:
            raise QgsProcessingException(str(error) or "Canceled.") from error
        feedback.pushInfo(self.run_program(["check", scene], feedback))
        return {"OUTPUT": folder, "SCENE": scene}


class ExportAlgorithm(ProgramAlgorithm):
    """Writes a scene for other programs."""

    NAME, TITLE, FAMILY = "export", "Export a scene", FAMILY
    HELP = "Writes a scene as a page for browsers, for modeling programs, to print, or its features as a GeoPackage with styles."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.addParameter(QgsProcessingParameterFile("SCENE", "Scene file", extension="toml"))
        self.addParameter(
            QgsProcessingParameterCrs("CRS", "Coordinate system of a GeoPackage [the scene's]", optional=True)
        )
        self.addParameter(QgsProcessingParameterFileDestination("OUTPUT", "File", EXPORTS))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        output = self.parameterAsFileOutput(parameters, "OUTPUT", context)
        arguments = ["export", self.parameterAsFile(parameters, "SCENE", context), "-o", output]
        crs = self.parameterAsCrs(parameters, "CRS", context)
        if crs.isValid() and os.path.splitext(output)[1].lower() == ".gpkg":
            arguments += ["--crs", crs.authid()]
        feedback.pushInfo(self.run_program(arguments, feedback))
        return {"OUTPUT": output}
