"""Algorithms that ask the ground: heights of points, a profile, lines of sight, a viewshed."""

import csv
import io
import json

from qgis.core import (
    QgsFeature,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsLineString,
    QgsPoint,
    QgsPointXY,
    QgsProcessingException,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterPoint,
    QgsProcessingParameterRasterDestination,
    QgsProcessingUtils,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QVariant

from ..styles import style_heights, style_sight, style_viewshed
from .base import VECTOR_LINE, VECTOR_POINT, ProgramAlgorithm, crs_arguments

FAMILY = "Ground"


def fields(*named):
    """Fields of names and types."""
    made = QgsFields()
    for name, kind in named:
        made.append(QgsField(name, kind))
    return made


def meters(name, title, default, optional=False):
    """A parameter of meters, 0 or more."""
    number = QgsProcessingParameterNumber
    return number(name, title, number.Double, default, optional, 0.0)


def png(name, title):
    """The parameter of a chart."""
    return QgsProcessingParameterFileDestination(name, title, "PNG (*.png)", optional=True, createByDefault=False)


class HeightsAlgorithm(ProgramAlgorithm):
    """Heights of points."""

    NAME, TITLE, FAMILY = "heights", "Heights of points", FAMILY
    HELP = "The height of the ground at each point, in meters, and a status that says why a point has none."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.add_ground()
        self.addParameter(QgsProcessingParameterFeatureSource("POINTS", "Points", VECTOR_POINT))
        self.addParameter(QgsProcessingParameterFeatureSink("OUTPUT", "Heights"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        file, crs = self.ground(parameters, context, feedback)
        source = self.parameterAsSource(parameters, "POINTS", context)
        positions = [line[0] for line in self.lines(parameters, "POINTS", crs, context)]
        path = QgsProcessingUtils.generateTempFilename("points.csv")
        with open(path, "w", encoding="ascii") as points:
            points.write("x,y\n" + "\n".join(positions) + "\n")
        printed = self.run_program(["height", file, "--points", path, "--json", *crs_arguments(crs)], feedback)
        answers = json.loads(printed)
        with_shape = [feature for feature in source.getFeatures() if not feature.geometry().isNull()]
        if len(with_shape) != len(answers):
            raise QgsProcessingException(f"{len(with_shape)} points have {len(answers)} heights: some cannot be transformed.")
        made = QgsFields(source.fields())
        for field in fields(("height", QVariant.Double), ("status", QVariant.String)):
            made.append(field)
        sink, result = self.parameterAsSink(parameters, "OUTPUT", context, made, source.wkbType(), source.sourceCrs())
        for feature, answer in zip(with_shape, answers):
            feature.setFields(made, False)
            feature.setAttributes(feature.attributes() + [answer.get("height"), answer["status"]])
            sink.addFeature(feature, QgsFeatureSink.FastInsert)
        self.style_on_load(result, style_heights, context)
        return {"OUTPUT": result}


class ProfileAlgorithm(ProgramAlgorithm):
    """The ground along lines."""

    NAME, TITLE, FAMILY = "profile", "Profile along lines", FAMILY
    HELP = "A point wherever the ground bends along a line, with its station and height in meters; of one line also a chart."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.add_ground()
        self.addParameter(QgsProcessingParameterFeatureSource("LINES", "Lines", VECTOR_LINE))
        self.addParameter(QgsProcessingParameterFeatureSink("OUTPUT", "Stations"))
        self.addParameter(png("CHART", "Chart of the first line"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        file, crs = self.ground(parameters, context, feedback)
        columns = ["station", "height"]
        made = fields(("line", QVariant.Int), *((name, QVariant.Double) for name in columns), ("status", QVariant.String))
        sink, result = self.parameterAsSink(parameters, "OUTPUT", context, made, QgsWkbTypes.PointZ, crs)
        chart = self.parameterAsFileOutput(parameters, "CHART", context)
        for number, line in enumerate(self.lines(parameters, "LINES", crs, context), 1):
            path = QgsProcessingUtils.generateTempFilename("line.csv")
            with open(path, "w", encoding="ascii") as points:
                points.write("\n".join(line) + "\n")
            arguments = ["profile", file, "--points", path, *crs_arguments(crs)]
            arguments += ["-o", chart] if chart and number == 1 else []
            for row in csv.DictReader(io.StringIO(_table(self.run_program(arguments, feedback)))):
                height = float(row["height"]) if row["height"] else None
                feature = QgsFeature(made)
                feature.setGeometry(QgsPoint(float(row["x"]), float(row["y"]), height or 0.0))
                feature.setAttributes([number, float(row["station"]), height, row["status"]])
                sink.addFeature(feature, QgsFeatureSink.FastInsert)
        self.style_on_load(result, style_heights, context)
        return {"OUTPUT": result, **({"CHART": chart} if chart else {})}


class SightAlgorithm(ProgramAlgorithm):
    """Lines of sight."""

    NAME, TITLE, FAMILY = "line_of_sight", "Line of sight", FAMILY
    HELP = "Whether an observer sees a target, and what blocks the view: the free part of the line, and the part beyond the first obstacle."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.add_ground()
        self.addParameter(QgsProcessingParameterPoint("FROM", "Observer"))
        self.addParameter(QgsProcessingParameterPoint("TO", "Target"))
        self.addParameter(meters("OBSERVER_HEIGHT", "Height of the observer's eye above the ground, meters", 2.0))
        self.addParameter(meters("TARGET_HEIGHT", "Height of the target above the ground, meters", 0.0))
        self.addParameter(QgsProcessingParameterFeatureSink("OUTPUT", "Line of sight"))
        self.addParameter(png("CHART", "Chart"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        file, crs = self.ground(parameters, context, feedback)
        arguments = ["los", file, "--json", *crs_arguments(crs)]
        for option, name in [("--from", "FROM"), ("--to", "TO")]:
            # With `=`: a position may begin with a minus sign.
            arguments.append(f"{option}={self.point(parameters, name, crs, context)}")
        for option, name in [("--observer-height", "OBSERVER_HEIGHT"), ("--target-height", "TARGET_HEIGHT")]:
            arguments += [option, self.parameterAsDouble(parameters, name, context)]
        chart = self.parameterAsFileOutput(parameters, "CHART", context)
        answer = json.loads(self.run_program(arguments + (["-o", chart] if chart else []), feedback))
        made = fields(("part", QVariant.String), ("visible", QVariant.Bool), ("clearance", QVariant.Double), ("rise", QVariant.Double))
        sink, result = self.parameterAsSink(parameters, "OUTPUT", context, made, QgsWkbTypes.LineString, crs)
        ends = [QgsPointXY(answer[end]["x"], answer[end]["y"]) for end in ("observer", "target")]
        blocker = answer.get("blocker")
        stops = [ends[0], QgsPointXY(blocker["x"], blocker["y"]), ends[1]] if blocker else ends
        for part, start, end in zip(["free", "blocked"], stops, stops[1:]):
            feature = QgsFeature(made)
            feature.setGeometry(QgsGeometry(QgsLineString([QgsPoint(start), QgsPoint(end)])))
            feature.setAttributes([part, answer["visible"], answer.get("clearance_m"), answer.get("target_rise_m")])
            sink.addFeature(feature, QgsFeatureSink.FastInsert)
        feedback.pushInfo("The target is visible." if answer["visible"] else "The target is hidden.")
        self.style_on_load(result, style_sight, context)
        return {"OUTPUT": result, "VISIBLE": answer["visible"], **({"CHART": chart} if chart else {})}


class ViewshedAlgorithm(ProgramAlgorithm):
    """What is seen from a point."""

    NAME, TITLE, FAMILY = "viewshed", "Viewshed of a point", FAMILY
    HELP = "The ground that is seen from a point: 1 where a target can be seen, 0 where it is hidden."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.add_ground()
        self.addParameter(QgsProcessingParameterPoint("AT", "Observer"))
        self.addParameter(meters("OBSERVER_HEIGHT", "Height of the observer's eye above the ground, meters", 2.0))
        self.addParameter(meters("TARGET_HEIGHT", "Height of the target above the ground, meters", 0.0))
        self.addParameter(meters("RANGE", "Range, meters [without limit]", None, optional=True))
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Viewshed"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        file, crs = self.ground(parameters, context, feedback)
        output = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        arguments = ["viewshed", file, f"--at={self.point(parameters, 'AT', crs, context)}", *crs_arguments(crs), "-o", output]
        for option, name in [("--observer-height", "OBSERVER_HEIGHT"), ("--target-height", "TARGET_HEIGHT"), ("--range", "RANGE")]:
            if parameters.get(name) is not None or name != "RANGE":
                arguments += [option, self.parameterAsDouble(parameters, name, context)]
        feedback.pushInfo(self.run_program(arguments, feedback))
        style_viewshed(output)
        return {"OUTPUT": output}


def _table(printed):
    """The table of a profile, from its heading on."""
    start = printed.find("station,")
    return printed[start:] if start >= 0 else printed
