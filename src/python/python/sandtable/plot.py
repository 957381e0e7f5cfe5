"""Elevation on axes of matplotlib: relief, contours, profiles and lines of sight.

>>> import matplotlib.pyplot as plt, sandtable as st
>>> fig, ax = plt.subplots()
>>> st.plot.relief("dem.tif", ax=ax)
>>> st.plot.contours("dem.tif", ax=ax, interval=100)

matplotlib, which these functions need, is imported when one is called. All draw on `ax`, by default the current axes, and return
it. A `dem` is a `Dem`, a path or an array of rioxarray. Maps lie on the ground in meters, whose coordinate system the axes name: the
file's, or the UTM zone of a model in degrees.
"""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

from ._sandtable import Dem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from numpy.typing import ArrayLike, NDArray

__all__ = ["contours", "profile", "relief", "sight"]

# The colors of the program's charts.
_INK = "#1e2327"
_EARTH, _RIM = "#c8b896", "#4a3f30"
_LIT, _DARK = "#e2d3a8", "#9c9282"
_LINE, _BLOCK = "#144f7e", "#b03522"

# How strongly a tint covers the light: at more the relief is lost, at less the heights.
_TINT_ALPHA = 0.45
# Numbers along an axis: coordinates of seven digits run into each other where there are more.
_MAP_TICKS = 5
# The room above the highest and below the lowest ground of a chart, as a share of its heights.
_HEADROOM = 0.15


def relief(
    dem: Dem | str | PathLike[str] | Any,
    ax: Axes | None = None,
    *,
    azimuth: float = 315.0,
    altitude: float = 45.0,
    tint: str | Colormap | None = None,
) -> Axes:
    """Draws the ground in the light of ``Dem.hillshade``.

    `azimuth` and `altitude` of the sun are in degrees. `tint` is a colormap of matplotlib for the heights; the image of heights,
    meters, is then the last of ``ax.images``, from which ``plt.colorbar`` makes a scale.
    """
    import numpy as np

    dem = _dem_of(dem)
    ax = _axes(ax)
    shaded = dem.hillshade(azimuth, altitude)
    a, _, c, _, e, f = shaded.transform
    rows, columns = shaded.array.shape
    extent = (c, c + a * columns, f + e * rows, f)
    gray = np.ma.masked_equal(shaded.array, shaded.nodata)
    ax.imshow(gray, cmap="gray", vmin=1, vmax=255, extent=extent, origin="upper")
    if tint is not None:
        x, y = c + a * (np.arange(columns) + 0.5), f + e * (np.arange(rows) + 0.5)
        posts = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        heights = dem.heights(posts, "planar", surface="ground", crs=shaded.crs).reshape(rows, columns)
        tinted = np.ma.masked_invalid(heights)
        ax.imshow(tinted, cmap=tint, alpha=_TINT_ALPHA, extent=extent, origin="upper")
    _name_map_axes(ax, shaded.crs)
    return ax


def contours(
    dem: Dem | str | PathLike[str] | Any,
    ax: Axes | None = None,
    *,
    interval: float | None = None,
    every: int | None = None,
    color: str = "#5b4632",
    labels: bool = True,
) -> Axes:
    """Draws the lines of ``Dem.analyze("contours")``: every `interval` meters, each `every` th stronger and with its height.

    By default the interval is 1, 2 or 5 times a power of ten, for at most 20 of them, and each fifth line is strong.
    """
    from math import atan2, degrees

    import numpy as np

    ax = _axes(ax)
    from matplotlib.collections import LineCollection
    from matplotlib.patheffects import withStroke

    drawn = _dem_of(dem).analyze("contours", interval=interval, every=every)
    longest: dict[float, NDArray[np.float64]] = {}
    for is_index, width in [(False, 0.4), (True, 0.9)]:
        lines = []
        for feature in drawn.features:
            properties, line = feature["properties"], np.asarray(feature["geometry"]["coordinates"], float)[:, :2]
            if properties["is_index"] != is_index:
                continue
            lines.append(line)
            if is_index and len(line) > len(longest.get(properties["height_m"], ())):
                longest[properties["height_m"]] = line
        collection = LineCollection(lines, colors=color, linewidths=width)
        collection.set_gid("index contours" if is_index else "contours")
        ax.add_collection(collection)
    for height, line in longest.items() if labels else ():
        middle = len(line) // 2
        (x0, y0), (x1, y1) = line[max(middle - 3, 0)], line[min(middle + 3, len(line) - 1)]
        angle = degrees(atan2(y1 - y0, x1 - x0))
        upright = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle < -90.0 else angle
        style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 6, "color": color, "clip_on": True}
        x, y = line[middle]
        label = ax.text(x, y, f"{height:g}", rotation=upright, **style)
        label.set_path_effects([withStroke(linewidth=2.0, foreground="#fdfcf9")])
    ax.autoscale_view()
    ax.set_aspect("equal")
    _name_map_axes(ax, drawn.crs)
    return ax


def profile(
    dem: Dem | str | PathLike[str] | Any,
    line: ArrayLike | Sequence[str],
    ax: Axes | None = None,
    *,
    step: float | None = None,
    crs: Any | None = None,
) -> Axes:
    """Draws the ground along a line, with its lowest and highest point. `line`, `step` and `crs` are those of ``Dem.profile``."""
    import numpy as np

    ax = _axes(ax)
    ground = _dem_of(dem).profile(line, step=step, crs=crs)
    _section(ax, ground.stations, ground.heights, _EARTH)
    if not np.isnan(ground.heights).all():
        for at, offset in [(np.nanargmin(ground.heights), -14), (np.nanargmax(ground.heights), 6)]:
            height = ground.heights[at]
            ax.plot(ground.stations[at], height, "o", color=_INK, markersize=4)
            ax.annotate(f"{height:.1f} m", (ground.stations[at], height), (0, offset), textcoords="offset points", ha="center", fontsize=8)
    _name_chart_axes(ax, "Distance (m)", "Height (m)", ground.length)
    return ax


def sight(
    dem: Dem | str | PathLike[str] | Any,
    observer: Sequence[float] | str,
    target: Sequence[float] | str,
    ax: Axes | None = None,
    *,
    observer_height: float = 2.0,
    target_height: float = 0.0,
    refraction: float | None = None,
    flat: bool = False,
    crs: Any | None = None,
) -> Axes:
    """Draws a line of sight over the ground, as ``sandtable los -o`` does: what the observer sees is light, and the first obstacle
    is marked.

    The arguments are those of ``Dem.line_of_sight``. Heights are less the drop of the curved Earth, so that the line is straight.
    """
    ax = _axes(ax)
    chart = _dem_of(dem)._sight_chart(
        observer,
        target,
        observer_height=observer_height,
        target_height=target_height,
        refraction=refraction,
        flat=flat,
        crs=crs,
    )
    stations, ground = chart["stations"], chart["ground"]
    _section(ax, stations, ground, _DARK, chart["eye"], chart["target"])
    for start, end in chart["visible"]:
        part, heights = _between(stations, ground, start, end)
        ax.fill_between(part, heights, ax.get_ylim()[0], color=_LIT, linewidth=0.0)
    length, eye, target_at = stations[-1], chart["eye"], chart["target"]
    ends = [0.0, length], [eye, target_at]
    if chart["blocker"] is None:
        ax.plot(*ends, color=_LINE)
    else:
        station, height = chart["blocker"]
        on_line = eye + (target_at - eye) * (station / length)
        ax.plot([0.0, station], [eye, on_line], color=_LINE)
        ax.plot([station, length], [on_line, target_at], color=_LINE, linestyle="--")
        ax.plot(station, height, "o", color=_BLOCK)
        ax.annotate("blocked", (station, height), (0, 6), textcoords="offset points", ha="center", fontsize=8, color=_BLOCK)
    ax.plot(*ends, "o", color=_LINE, linestyle="none", markersize=4)
    ax.set_title(chart["title"], fontsize=8, loc="left")
    _name_chart_axes(ax, "Distance from the observer (m)", chart["axis"], length)
    return ax


def _dem_of(dem: Any) -> Dem:
    if isinstance(dem, Dem):
        return dem
    if isinstance(dem, (str, PathLike)):
        return Dem.open(dem)
    if hasattr(dem, "rio"):
        from . import xarray  # noqa: F401  (the accessor .sandtable)

        opened: Dem = dem.sandtable.dem
        return opened
    raise TypeError(f"dem is a {type(dem).__name__}; give a Dem, a path or an array of rioxarray")


def _axes(ax: Axes | None) -> Axes:
    """The axes to draw on: those that are given, or matplotlib's current ones."""
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("sandtable.plot draws on axes of matplotlib: pip install matplotlib") from error
    return plt.gca() if ax is None else ax


def _section(ax: Axes, stations: NDArray[Any], heights: NDArray[Any], color: str, *above: float) -> None:
    """The ground from its line down to the lower edge of the axes, which hold the heights `above` it, too; nothing where there is
    none."""
    import numpy as np

    known = np.append(heights[~np.isnan(heights)], above)
    low, high = (known.min(), known.max()) if len(known) else (0.0, 1.0)
    room = max(high - low, 1.0) * _HEADROOM
    ax.fill_between(stations, heights, low - room, where=~np.isnan(heights), color=color, linewidth=0.0)
    ax.plot(stations, heights, color=_RIM, linewidth=1.2)
    ax.set_ylim(low - room, high + room)


def _between(stations: NDArray[Any], heights: NDArray[Any], start: float, end: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """The ground from `start` to `end`, cut exactly there."""
    import numpy as np

    inside = (stations > start) & (stations < end)
    part = np.concatenate([[start], stations[inside], [end]])
    return part, np.interp(part, stations, heights)


def _name_map_axes(ax: Axes, crs: str | None) -> None:
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    for axis, name in [(ax.xaxis, "x"), (ax.yaxis, "y")]:
        if not axis.get_label_text():
            axis.set_label_text(f"{name} (m)" if crs is None else f"{name} in {crs} (m)")
        # Coordinates in full: an offset beside the axis is overlooked.
        if isinstance(axis.get_major_formatter(), ScalarFormatter):
            plain = ScalarFormatter(useOffset=False)
            plain.set_scientific(False)
            axis.set_major_formatter(plain)
            axis.set_major_locator(MaxNLocator(_MAP_TICKS))


def _name_chart_axes(ax: Axes, x: str, y: str, length: float) -> None:
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    ax.set_xlim(0.0, length)
