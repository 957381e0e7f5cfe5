"""Symbols of layers as the properties of GeoJSON that scenes draw: `stroke`, `stroke-width`, `fill`, `marker-color`."""

from qgis.core import (
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsRenderContext,
    QgsSimpleFillSymbolLayer,
    QgsSimpleLineSymbolLayer,
    QgsSymbolLayer,
    QgsUnitTypes,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import Qt

# Pixels per inch of the screens that symbols are designed on.
DPI = 96

# The height of the picture that widths in pixels are for.
PICTURE_HEIGHT_PX = 1080

# Pens of these styles have lengths of dashes and gaps, in pixels.
DASHES = {Qt.DashLine: "8,5", Qt.DotLine: "2,4", Qt.DashDotLine: "8,4,2,4", Qt.DashDotDotLine: "8,4,2,4,2,4"}


class FeatureSymbols:
    """The symbols of a vector layer: `properties(feature)` says how each is drawn, or `None` where it is not."""

    def __init__(self, layer, extent):
        self.layer = layer
        self.context = QgsRenderContext()
        self.context.setScaleFactor(DPI / 25.4)
        self.context.setExtent(extent)
        self.context.setRendererScale(0)
        self.context.expressionContext().appendScopes(_scopes(layer))
        self.map_units_px = PICTURE_HEIGHT_PX / max(extent.height(), 1e-9)
        self.renderer = layer.renderer().clone() if layer.renderer() else None
        if self.renderer:
            self.renderer.startRender(self.context, layer.fields())

    def properties(self, feature):
        """How a feature is drawn; `None` where the map does not show it."""
        if self.renderer is None:
            return None
        self.context.expressionContext().setFeature(feature)
        # Rules may give several: what is drawn last is what a reader sees, of symbols as of their layers.
        symbols = self.renderer.symbolsForFeature(feature, self.context)
        if not symbols:
            return None
        symbol = symbols[-1]
        layers = [symbol.symbolLayer(i) for i in range(symbol.symbolLayerCount())]
        layers = [layer for layer in layers if layer.enabled()]
        if not layers:
            return None
        top = layers[-1]
        opacity = symbol.opacity() * self.layer.opacity()
        geometry = self.layer.geometryType()
        if geometry == QgsWkbTypes.LineGeometry:
            return self._line(top, opacity)
        if geometry == QgsWkbTypes.PolygonGeometry:
            return self._polygon(top, opacity)
        color = self._color(top, QgsSymbolLayer.PropertyFillColor, top.color())
        return {"marker-color": color.name()}

    def end(self):
        """Ends what the renderer began."""
        if self.renderer:
            self.renderer.stopRender(self.context)

    def _color(self, layer, key, color):
        return layer.dataDefinedProperties().valueAsColor(key, self.context.expressionContext(), color)[0]

    def _number(self, layer, key, number):
        return layer.dataDefinedProperties().valueAsDouble(key, self.context.expressionContext(), number)[0]

    def _pixels(self, width, unit):
        if unit == QgsUnitTypes.RenderMapUnits:
            return width * self.map_units_px
        if unit == QgsUnitTypes.RenderMetersInMapUnits:
            return self.context.convertMetersToMapUnits(width) * self.map_units_px
        return self.context.convertToPainterUnits(width, unit)

    def _line(self, layer, opacity):
        color = self._color(layer, QgsSymbolLayer.PropertyStrokeColor, layer.color())
        is_simple = isinstance(layer, QgsSimpleLineSymbolLayer)
        width = layer.width() if hasattr(layer, "width") else 0.26
        unit = layer.widthUnit() if hasattr(layer, "widthUnit") else layer.outputUnit()
        width = self._number(layer, QgsSymbolLayer.PropertyStrokeWidth, width)
        pen = layer.penStyle() if is_simple else Qt.SolidLine
        if pen == Qt.NoPen:
            return None
        return _stroke(color, self._pixels(width, unit), pen, opacity)

    def _polygon(self, layer, opacity):
        fill = self._color(layer, QgsSymbolLayer.PropertyFillColor, layer.color())
        if not isinstance(layer, QgsSimpleFillSymbolLayer):
            # An outline as a layer of its own, a pattern, a gradient: its main color.
            if isinstance(layer, QgsSimpleLineSymbolLayer):
                line = self._line(layer, opacity)
                return line and {**line, "fill": "none"}
            return _fill(fill, opacity)
        properties = {"fill": "none"} if layer.brushStyle() == Qt.NoBrush else _fill(fill, opacity)
        if layer.strokeStyle() == Qt.NoPen:
            return None if properties["fill"] == "none" else {**properties, "stroke": "none"}
        color = self._color(layer, QgsSymbolLayer.PropertyStrokeColor, layer.strokeColor())
        width = self._number(layer, QgsSymbolLayer.PropertyStrokeWidth, layer.strokeWidth())
        width = self._pixels(width, layer.strokeWidthUnit())
        return {**_stroke(color, width, layer.strokeStyle(), opacity), **properties}


class FeatureLabels:
    """The labels of a vector layer: texts with their sizes in points."""

    def __init__(self, layer):
        self.settings = []
        labeling = layer.labeling() if layer.labelsEnabled() else None
        providers = labeling.subProviders() if labeling else []
        for provider in providers:
            settings = labeling.settings(provider)
            if settings.drawLabels and settings.fieldName:
                expression = settings.fieldName if settings.isExpression else QgsExpression.quotedColumnRef(settings.fieldName)
                self.settings.append((QgsExpression(expression), settings.format().size()))
        self.context = QgsExpressionContext(_scopes(layer))
        for expression, _ in self.settings:
            expression.prepare(self.context)

    def text(self, feature):
        """The text of a feature and the size of its letters; `None` where it has none."""
        self.context.setFeature(feature)
        for expression, size in self.settings:
            value = expression.evaluate(self.context)
            if value is not None and not expression.hasEvalError() and str(value).strip() not in ("", "NULL"):
                return str(value).strip(), size
        return None


def _scopes(layer):
    return QgsExpressionContextUtils.globalProjectLayerScopes(layer)


def _stroke(color, width, pen, opacity):
    properties = {
        "stroke": color.name(),
        "stroke-width": round(max(width, 0.5), 2),
        "stroke-opacity": round(color.alphaF() * opacity, 3),
    }
    return {**properties, "stroke-dasharray": DASHES[pen]} if pen in DASHES else properties


def _fill(color, opacity):
    return {"fill": color.name(), "fill-opacity": round(color.alphaF() * opacity, 3)}
