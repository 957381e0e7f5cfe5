"""Styles of results: rasters with the classes' colors, lines of sight and heights by what they say."""

import os

from qgis.core import (
    QgsCategorizedSymbolRenderer,
    QgsColorRampShader,
    QgsLineSymbol,
    QgsMarkerSymbol,
    QgsPalettedRasterRenderer,
    QgsRasterLayer,
    QgsRasterBandStats,
    QgsRasterShader,
    QgsRendererCategory,
    QgsSingleBandPseudoColorRenderer,
)
from qgis.PyQt.QtGui import QColor

# The colors of a raster that has no classes, from its least value to its greatest (viridis).
RAMP = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"]

# A viewshed: hidden ground is dark, seen ground green, as in pictures of scenes.
VIEWSHED = [(0, "hidden", QColor(20, 24, 40, 120)), (1, "seen", QColor(60, 180, 60, 120))]


def style_raster(path, classes):
    """Writes the style of a raster beside it, as `.qml`, which QGIS takes when it loads the raster.

    `classes` are those of `analyze --json`: rising, each with its least value `from`, `label`, `color` and `opacity`.
    """
    layer = QgsRasterLayer(path, "result")
    if not layer.isValid():
        return
    statistics = layer.dataProvider().bandStatistics(1, QgsRasterBandStats.Min | QgsRasterBandStats.Max)
    items = _classed(classes) if classes else _ramp(statistics.minimumValue, statistics.maximumValue)
    kind = QgsColorRampShader.Discrete if classes else QgsColorRampShader.Interpolated
    function = QgsColorRampShader(statistics.minimumValue, statistics.maximumValue, None, kind)
    function.setColorRampItemList(items)
    shader = QgsRasterShader()
    shader.setRasterShaderFunction(function)
    layer.setRenderer(QgsSingleBandPseudoColorRenderer(layer.dataProvider(), 1, shader))
    layer.saveNamedStyle(os.path.splitext(path)[0] + ".qml")


def style_viewshed(path):
    """Writes the style of a viewshed beside it."""
    layer = QgsRasterLayer(path, "viewshed")
    classes = [QgsPalettedRasterRenderer.Class(value, color, label) for value, label, color in VIEWSHED]
    layer.setRenderer(QgsPalettedRasterRenderer(layer.dataProvider(), 1, classes))
    layer.saveNamedStyle(os.path.splitext(path)[0] + ".qml")


def style_sight(layer):
    """Parts of lines of sight: green where the line is free, red beyond what blocks it."""
    rows = [("free", "#2e9e3f"), ("blocked", "#d7261e")]
    line = lambda color: QgsLineSymbol.createSimple({"line_color": color, "line_width": "0.8"})  # noqa: E731
    layer.setRenderer(QgsCategorizedSymbolRenderer("part", [QgsRendererCategory(part, line(color), part) for part, color in rows]))


def style_heights(layer):
    """Points with a height dark, those without red."""
    rows = [("Ok", "#23395d"), ("NoData", "#d7261e"), ("Outside", "#f2a33a")]
    point = lambda color: QgsMarkerSymbol.createSimple({"color": color, "size": "1.6", "outline_style": "no"})  # noqa: E731
    layer.setRenderer(QgsCategorizedSymbolRenderer("status", [QgsRendererCategory(word, point(color), word) for word, color in rows]))


def _classed(classes):
    """Items of a discrete shader: each holds up to the value at which the next class begins."""
    nexts = [following["from"] for following in classes[1:]] + [float("inf")]
    items = []
    if classes[0]["from"] is not None:
        items.append(_item(_below(classes[0]["from"]), "#000000", 0, ""))
    for one, end in zip(classes, nexts):
        items.append(_item(_below(end), one["color"], one["opacity"], one["label"]))
    return items


def _below(value):
    """The greatest value below `value`: a shader's item holds up to its value, a class up to below the next."""
    return value if value == float("inf") else value - max(abs(value), 1.0) * 1e-7


def _ramp(least, greatest):
    steps = [(least + (greatest - least) * i / (len(RAMP) - 1), color) for i, color in enumerate(RAMP)]
    return [_item(value, color, 1, f"{value:.4g}") for value, color in steps]


def _item(value, color, opacity, label):
    color = QColor(color)
    color.setAlphaF(opacity)
    return QgsColorRampShader.ColorRampItem(value, color, label)
