"""Plots: what matplotlib is given are the values of the elevation model."""

import subprocess
import sys

import numpy as np
import pytest
import sandtable as st
from conftest import JACKSBORO

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
plt = pytest.importorskip("matplotlib.pyplot")

LINE = [(-84.23, 36.2), (-84.12, 36.38)]


@pytest.fixture(scope="module")
def dem():
    return st.Dem.open(JACKSBORO)


@pytest.fixture
def ax():
    figure, ax = plt.subplots()
    yield ax
    figure.canvas.draw()
    plt.close(figure)


def test_a_relief_shows_the_hillshade_where_it_lies(dem, ax):
    assert st.plot.relief(dem, ax=ax, azimuth=300, altitude=40) is ax
    shaded = dem.hillshade(300, 40)
    image = ax.images[0]
    np.testing.assert_array_equal(image.get_array(), shaded.array)
    west, east, south, north = image.get_extent()
    a, _, c, _, e, f = shaded.transform
    assert (west, north) == (c, f)
    assert (east, south) == (c + a * shaded.array.shape[1], f + e * shaded.array.shape[0])
    assert ax.get_xlabel() == "x in EPSG:32616 (m)" and ax.get_aspect() == 1.0
    # Light from 1 to 255, gray from black to white.
    assert image.get_clim() == (1, 255) and image.cmap(0.0)[:3] == (0, 0, 0)


def test_a_tint_has_the_heights_of_the_ground(dem, ax):
    st.plot.relief(dem, ax=ax, tint="terrain")
    heights, extent = ax.images[-1].get_array(), ax.images[-1].get_extent()
    rows, columns = heights.shape
    for row, column in [(0, 0), (100, 7), (rows - 1, columns - 1)]:
        x = extent[0] + (extent[1] - extent[0]) * (column + 0.5) / columns
        y = extent[3] + (extent[2] - extent[3]) * (row + 0.5) / rows
        stated = dem.heights([(x, y)], "planar", surface="ground", crs="EPSG:32616")[0]
        assert heights[row, column] == stated or np.isnan(stated)
    assert heights.max() > 1000


def test_no_data_is_transparent(ax):
    array = np.add.outer(np.arange(40.0), np.arange(50.0))
    array[10:20, 10:20] = np.nan
    st.plot.relief(st.Dem.from_array(array, (10, 0, 5000, 0, -10, 9000), "EPSG:32616"), ax=ax, tint="viridis")
    for image in ax.images:
        assert np.ma.getmaskarray(image.get_array())[15, 15] and not np.ma.getmaskarray(image.get_array())[5, 5]


def test_contours_are_those_of_the_analysis_on_the_relief(dem, ax):
    st.plot.relief(dem, ax=ax)
    st.plot.contours(dem, ax=ax, interval=100)
    features = dem.analyze("contours", interval=100).features
    drawn = {collection.get_gid(): collection.get_segments() for collection in ax.collections}
    for name, is_index in [("contours", False), ("index contours", True)]:
        lines = [feature["geometry"]["coordinates"] for feature in features if feature["properties"]["is_index"] == is_index]
        assert len(lines) == len(drawn[name]) > 0
        for line, segment in zip(lines, drawn[name]):
            np.testing.assert_array_equal(np.asarray(line)[:, :2], segment)
    # They lie where their heights are.
    line = drawn["index contours"][0]
    height = next(f["properties"]["height_m"] for f in features if f["properties"]["is_index"])
    on_ground = dem.heights(line, "planar", surface="ground", crs="EPSG:32616")
    np.testing.assert_allclose(on_ground, height, atol=0.01)
    heights = {feature["properties"]["height_m"] for feature in features if feature["properties"]["is_index"]}
    assert {float(text.get_text()) for text in ax.texts} == heights
    # The axes still show the whole relief, and no more.
    assert ax.get_xlim() == ax.images[0].get_extent()[:2] or list(ax.get_xlim()) == list(ax.images[0].get_extent()[:2])


def test_a_profile_has_the_stations_and_the_extremes(dem, ax):
    st.plot.profile(dem, LINE, ax=ax, crs=4326)
    ground = dem.profile(LINE, crs=4326)
    x, y = ax.lines[0].get_data()
    np.testing.assert_array_equal(x, ground.stations)
    np.testing.assert_array_equal(y, ground.heights)
    said = [text.get_text() for text in ax.texts]
    assert said == [f"{ground.heights.min():.1f} m", f"{ground.heights.max():.1f} m"]
    assert ax.get_xlim() == (0, ground.length)


def test_a_sight_is_blocked_where_the_elevation_says(dem, ax):
    st.plot.sight(dem, *LINE, ax=ax, observer_height=10, crs=4326)
    sight = dem.line_of_sight(*LINE, observer_height=10, crs=4326)
    drop = (1 - 1 / 7) / (2 * 6_371_008.8)
    _, _, station, height = sight.blocker
    blocker = next(line for line in ax.lines if line.get_color() == st.plot._BLOCK)
    (x,), (y,) = blocker.get_data()
    assert x == station and y == pytest.approx(height - drop * station**2, abs=1e-9)
    # The line is straight from the eye to the target, and passes the obstacle beneath its top.
    seen = [line for line in ax.lines if line.get_color() == st.plot._LINE and line.get_linestyle() in ["-", "--"]]
    (x0, x1), (y0, y1) = seen[0].get_data()
    assert (x0, y0) == (0, sight.heights[0]) and x1 == station and y1 < y
    (_, x2), (_, y2) = seen[1].get_data()
    assert x2 == sight.distance and y2 == pytest.approx(sight.heights[1] - drop * sight.distance**2, abs=1e-9)
    assert "hidden" in ax.get_title(loc="left")
    low, high = ax.get_ylim()
    assert low < y2 < high and low < y0 < high


def test_what_is_seen_is_light_up_to_the_obstacle(dem):
    chart = dem._sight_chart(*LINE, observer_height=10, crs=4326)
    station, _ = chart["blocker"]
    starts, ends = chart["visible"].T
    assert (starts < ends).all() and starts[0] == 0 and (ends[:-1] <= starts[1:]).all()
    # The first obstacle is the edge of what is seen, and the target is not seen.
    assert any(abs(ends - station) < 1.0) or station < ends[-1]
    assert ends[-1] < chart["stations"][-1]
    # Heights of the chart are those of the profile, less the drop.
    ground = dem.profile(LINE, crs=4326)
    np.testing.assert_allclose(chart["stations"], ground.stations, atol=1e-9)
    drop = (1 - 1 / 7) / (2 * 6_371_008.8)
    np.testing.assert_allclose(chart["ground"] + drop * ground.stations**2, ground.heights, atol=1e-6)


def test_a_clear_sight_has_one_line_and_no_obstacle(dem, ax):
    st.plot.sight(dem, LINE[0], (-84.231, 36.201), ax=ax, observer_height=500, target_height=500, crs=4326)
    assert all(line.get_color() != st.plot._BLOCK for line in ax.lines)
    assert "visible" in ax.get_title(loc="left")
    assert ax.get_ylim()[1] > 1500


def test_paths_and_arrays_are_elevation_too(dem):
    rioxarray = pytest.importorskip("rioxarray")
    array = rioxarray.open_rasterio(JACKSBORO).squeeze("band")
    images = []
    for source in [dem, str(JACKSBORO), JACKSBORO, array]:
        figure, ax = plt.subplots()
        # The current axes, where none are stated.
        assert st.plot.relief(source) is ax
        images.append(np.asarray(ax.images[0].get_array()))
        plt.close(figure)
    assert all((image == images[0]).all() for image in images)
    with pytest.raises(TypeError, match="dem is a int"):
        st.plot.relief(5)


def test_without_matplotlib_the_error_says_what_to_install(tmp_path):
    (tmp_path / "matplotlib.py").write_text("raise ImportError('not here')")
    script = f"import sandtable as st\ntry:\n    st.plot.relief({str(JACKSBORO)!r})\nexcept ImportError as error:\n    print(error)"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env={"PYTHONPATH": str(tmp_path)})
    assert ended.stdout.strip() == "sandtable.plot draws on axes of matplotlib: pip install matplotlib", ended.stderr
