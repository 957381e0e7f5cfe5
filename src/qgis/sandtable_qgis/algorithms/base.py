"""What all algorithms share: the ground they are about, positions, runs of the program, styles of results."""

import os

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingLayerPostProcessorInterface,
    QgsProcessingParameterFile,
    QgsProcessingParameterRasterLayer,
    QgsProcessingUtils,
    QgsRasterFileWriter,
    QgsRasterPipe,
)

from ..program import ProgramCanceled, ProgramError, run_with_feedback
from ..scene import crs_text

GROUND = "GROUND"
SCENE = "SCENE"
WGS84 = QgsCoordinateReferenceSystem("EPSG:4326")


class ProgramAlgorithm(QgsProcessingAlgorithm):
    """An algorithm that runs the program. Subclasses state `NAME`, `TITLE`, `HELP` and `FAMILY`."""

    NAME = TITLE = HELP = FAMILY = ""

    def createInstance(self):  # noqa: N802
        return type(self)()

    def name(self):
        return self.NAME

    def displayName(self):  # noqa: N802
        return self.TITLE

    def shortHelpString(self):  # noqa: N802
        return self.HELP

    def group(self):
        return self.FAMILY

    def groupId(self):  # noqa: N802
        return self.FAMILY.lower().replace(" ", "_")

    def run_program(self, arguments, feedback):
        """Runs the program and returns what it printed; its errors are those of Processing."""
        try:
            return run_with_feedback(arguments, feedback)
        except ProgramError as error:
            raise QgsProcessingException(str(error)) from error
        except ProgramCanceled as error:
            raise QgsProcessingException("Canceled.") from error

    def add_ground(self):
        """Adds the parameters of the ground: a layer with elevations, or a scene file."""
        layer = QgsProcessingParameterRasterLayer(GROUND, "Elevation layer", optional=True)
        self.addParameter(layer)
        self.addParameter(
            QgsProcessingParameterFile(SCENE, "Or a scene file, with its earthworks and features", optional=True, extension="toml")
        )

    def ground(self, parameters, context, feedback):
        """The file of the ground and the system of its positions."""
        scene = self.parameterAsFile(parameters, SCENE, context)
        layer = self.parameterAsRasterLayer(parameters, GROUND, context)
        if scene:
            return scene, WGS84
        if layer is None:
            raise QgsProcessingException("Choose a layer with elevations, or a scene file.")
        crs = layer.crs() if layer.crs().authid().upper().startswith("EPSG:") else WGS84
        return elevation_file(layer, context, feedback), crs

    def lines(self, parameters, name, crs, context):
        """The vertices of each feature of a source of points, lines or polygons, in `crs`, as lists of texts `X,Y`."""
        source = self.parameterAsSource(parameters, name, context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, name))
        transform = QgsCoordinateTransform(source.sourceCrs(), crs, context.transformContext())
        lines = []
        for feature in source.getFeatures():
            geometry = feature.geometry()
            if geometry.isNull() or geometry.transform(transform) != 0:
                continue
            part = geometry.constGet()
            while hasattr(part, "geometryN"):
                part = part.geometryN(0)
            if hasattr(part, "exteriorRing"):
                part = part.exteriorRing()
            lines.append([position(vertex) for vertex in part.vertices()])
        if not lines:
            raise QgsProcessingException(f"{name}: the layer has no feature with a shape.")
        return lines

    def point(self, parameters, name, crs, context):
        """A point parameter in `crs`, as a text `X,Y`."""
        return position(self.parameterAsPoint(parameters, name, context, crs))

    def style_on_load(self, result, style, context):
        """Has a layer that is loaded when the algorithm ends take `style`, a function of the layer."""
        if context.willLoadLayerOnCompletion(result):
            styler = LayerStyler(style)
            STYLERS.append(styler)
            context.layerToLoadOnCompletionDetails(result).setPostProcessor(styler)


# Stylers until they have styled: QGIS holds no reference to them.
STYLERS = []


class LayerStyler(QgsProcessingLayerPostProcessorInterface):
    """Styles a layer when it is loaded."""

    def __init__(self, style):
        super().__init__()
        self.style = style

    def postProcessLayer(self, layer, context, feedback):  # noqa: N802
        self.style(layer)
        layer.triggerRepaint()
        STYLERS.remove(self)


def position(point):
    """A position as the program reads it: shortest digits that give the same number back."""
    return f"{point.x()!r},{point.y()!r}"


def elevation_file(layer, context, feedback):
    """The file of a layer's elevations: its own, or a copy where it has none, as of a service or a virtual raster in memory."""
    path = layer.source().split("|")[0]
    if layer.providerType() == "gdal" and os.path.isfile(path):
        return path
    feedback.pushInfo(f"{layer.name()} is no file: its elevations are copied.")
    path = QgsProcessingUtils.generateTempFilename("elevation.tif")
    pipe = QgsRasterPipe()
    pipe.set(layer.dataProvider().clone())
    size = layer.width(), layer.height()
    error = QgsRasterFileWriter(path).writeRaster(pipe, *size, layer.extent(), layer.crs(), context.transformContext())
    if error:
        raise QgsProcessingException(f"The elevations of {layer.name()} cannot be copied (error {int(error)} of QGIS).")
    return path


def crs_arguments(crs):
    """The option that states the system of positions."""
    return ["--crs", crs_text(crs)]


VECTOR_POINT = [QgsProcessing.TypeVectorPoint]
VECTOR_LINE = [QgsProcessing.TypeVectorLine]
VECTOR_POLYGON = [QgsProcessing.TypeVectorPolygon]
