"""An analysis of the ground: one algorithm for each kind of the program's catalog, with the parameters that it has there."""

import json
import os
import sqlite3

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingOutputString,
    QgsProcessingParameterEnum,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterString,
)

from ..styles import style_raster
from .base import VECTOR_LINE, VECTOR_POINT, VECTOR_POLYGON, ProgramAlgorithm, crs_arguments

SOURCES = {"points": VECTOR_POINT, "line": VECTOR_LINE, "area": VECTOR_POLYGON}
FAMILIES = {
    "surface": "Analysis: form of the ground",
    "movement": "Analysis: movement",
    "observation": "Analysis: observation and fire",
    "landing": "Analysis: landing and sites",
    "water": "Analysis: water",
    "earth": "Analysis: earth",
}
RASTER = "RASTER"
FEATURES = "FEATURES"
REPORT = "REPORT"

# What the program says where an analysis has nothing to write as features.
NO_FEATURES = "found no features"


class AnalysisAlgorithm(ProgramAlgorithm):
    """A kind of analysis."""

    def __init__(self, kind):
        super().__init__()
        self.kind = kind
        self.NAME = "analyze_" + kind["name"].replace("-", "_")
        self.TITLE = kind["title"]
        self.FAMILY = FAMILIES.get(kind["family"], "Analysis: " + kind["family"])
        self.HELP = f"{kind['summary']}\n\nSource: {kind['source']}.\n\nLimits: {' '.join(kind['limits'])}"

    def createInstance(self):  # noqa: N802
        return AnalysisAlgorithm(self.kind)

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.add_ground()
        for parameter in self.kind["parameters"]:
            self.addParameter(definition(parameter))
        if "raster" in self.kind["gives"]:
            self.addParameter(QgsProcessingParameterRasterDestination(RASTER, self.kind["title"]))
        if "features" in self.kind["gives"]:
            self.addParameter(QgsProcessingParameterFileDestination(FEATURES, self.kind["title"] + ", features", "GeoPackage (*.gpkg)"))
        self.addOutput(QgsProcessingOutputString(REPORT, "Figures, tables and notes, as JSON"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        file, crs = self.ground(parameters, context, feedback)
        arguments = ["analyze", self.kind["name"], file, "--json", *crs_arguments(crs)]
        for parameter in self.kind["parameters"]:
            text = self.written(parameter, parameters, crs, context)
            if text:
                # With `=`: a value may begin with a minus sign.
                arguments.append(f"--{parameter['name'].replace('_', '-')}={text}")
        results = {}
        if "raster" in self.kind["gives"]:
            results[RASTER] = self.parameterAsOutputLayer(parameters, RASTER, context)
        if "features" in self.kind["gives"]:
            results[FEATURES] = self.parameterAsFileOutput(parameters, FEATURES, context)
        answer = None
        for name, output in list(results.items()):
            try:
                answer = json.loads(self.run_program([*arguments, "-o", output], feedback))
            except QgsProcessingException as error:
                # The raster, which is there, says the same: nothing was found.
                if answer is None or NO_FEATURES not in str(error):
                    raise
                feedback.pushWarning(str(error))
                del results[name]
                continue
            if name == RASTER:
                style_raster(output, answer.get("classes", []))
            else:
                self.load_features(output, context)
        if answer is None:
            answer = json.loads(self.run_program(arguments, feedback))
        say(answer, feedback)
        return {**results, REPORT: json.dumps({key: answer[key] for key in ("figures", "tables", "notes")}, ensure_ascii=False)}

    def written(self, parameter, parameters, crs, context):
        """The value of a parameter as the program reads it; empty where it is not stated."""
        name, form = parameter["name"].upper(), parameter["form"]
        if parameters.get(name) in (None, ""):
            return ""
        if form == "number":
            return repr(self.parameterAsDouble(parameters, name, context))
        if form == "word":
            return self.parameterAsEnumString(parameters, name, context)
        if form == "extent":
            extent = self.parameterAsExtent(parameters, name, context, crs)
            corners = (extent.xMinimum(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum())
            return "" if extent.isEmpty() else ",".join(repr(number) for number in corners)
        if form in SOURCES:
            lines = self.lines(parameters, name, crs, context)
            if form == "points":
                return ";".join(line[0] for line in lines)
            if len(lines) > 1:
                raise QgsProcessingException(f"{parameter['name']}: the layer has {len(lines)} features; select one of them.")
            ring = lines[0]
            return ";".join(ring[:-1] if form == "area" and ring[0] == ring[-1] else ring)
        return self.parameterAsString(parameters, name, context)

    def load_features(self, path, context):
        """Has each layer of a GeoPackage loaded when the algorithm ends, with the styles that are in it."""
        if context.project() is None or not os.path.isfile(path):
            return
        for name in feature_layers(path):
            details = QgsProcessingContext.LayerDetails(f"{self.kind['title']}: {name}", context.project())
            context.addLayerToLoadOnCompletion(f"{path}|layername={name}", details)


def definition(parameter):
    """A parameter of the catalog as one of Processing."""
    name, form = parameter["name"].upper(), parameter["form"]
    is_optional = not parameter["required"]
    unit = f", {parameter['unit']}" if parameter.get("unit") else ""
    otherwise = f" [{parameter['otherwise']}]" if parameter.get("otherwise") else ""
    title = parameter["name"].replace("_", " ").capitalize() + unit + otherwise
    default = parameter.get("default")
    if form == "number":
        number = QgsProcessingParameterNumber
        value = None if default is None else float(default)
        made = number(name, title, number.Double, value, is_optional, parameter["least"], parameter["greatest"])
    elif form == "word":
        made = QgsProcessingParameterEnum(name, title, parameter["words"], False, default, is_optional, True)
    elif form == "extent":
        made = QgsProcessingParameterExtent(name, title, optional=is_optional)
    elif form in SOURCES:
        made = QgsProcessingParameterFeatureSource(name, title, SOURCES[form], optional=is_optional)
    else:
        made = QgsProcessingParameterString(name, title, default, optional=is_optional)
    made.setHelp(parameter["doc"])
    return made


def feature_layers(path):
    """The names of the layers with features of a GeoPackage."""
    connection = sqlite3.connect(path)
    try:
        return [row[0] for row in connection.execute("SELECT table_name FROM gpkg_contents WHERE data_type = 'features'")]
    finally:
        connection.close()


def say(answer, feedback):
    """Writes figures, tables and notes to the log."""
    for figure in answer.get("figures", []):
        feedback.pushInfo(f"{figure['name']}: {figure['value']:g} {figure['unit']}".rstrip())
    for table in answer.get("tables", []):
        feedback.pushInfo(table["title"])
        for row in table["rows"]:
            feedback.pushInfo("  " + ", ".join(f"{name} {value}" for name, value in row.items()))
    for note in answer.get("notes", []):
        feedback.pushWarning(note)
