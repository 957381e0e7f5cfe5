"""Analyses: the bits of `sandtable analyze`, as arrays of xarray, features and tables."""

import json
import re
import sys

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO, ROAD

pytest.importorskip("xarray")
rioxarray = pytest.importorskip("rioxarray")

EXTENT = (745_000, 4_015_000, 750_000, 4_020_000)


@pytest.fixture(scope="module")
def dem():
    return sandtable.Dem.open(JACKSBORO)


def test_every_kind_is_listed_with_its_parameters():
    kinds = {kind["name"]: kind for kind in sandtable.kinds()}
    assert kinds["slope"]["gives"] == "raster" and "Horn" in kinds["slope"]["source"]
    units = {parameter["name"]: parameter for parameter in kinds["slope"]["parameters"]}
    assert units["unit"]["words"] == ["percent", "degrees"] and "extent" in units


def test_a_raster_has_the_values_and_the_place_of_the_programs(program, dem, tmp_path):
    out = tmp_path / "slope.tif"
    program("analyze", "slope", JACKSBORO, "--unit", "degrees", "--crs", "EPSG:32616",
            "--extent", ",".join(map(str, EXTENT)), "-o", out)
    slope = dem.analyze("slope", unit="degrees", extent=EXTENT, crs="EPSG:32616")
    written = rioxarray.open_rasterio(out, masked=True).squeeze("band")
    np.testing.assert_array_equal(slope.to_numpy(), written.to_numpy())
    np.testing.assert_allclose(slope.x, written.x, rtol=0, atol=1e-6)
    np.testing.assert_allclose(slope.y, written.y, rtol=0, atol=1e-6)
    assert slope.dims == ("y", "x") and slope.name == "slope" and slope.rio.crs.to_epsg() == 32616
    assert slope.attrs["crs"] == "EPSG:32616" and slope.attrs["units"] == "°"
    assert len(slope.attrs["classes"]) == len(slope.attrs["class_from"])
    assert "Horn" in slope.attrs["source"] and slope.attrs["limits"]


def test_an_extent_has_the_bits_of_the_whole(dem):
    whole = dem.analyze("geomorphons", radius=10)
    part = dem.analyze("geomorphons", radius=10, extent=EXTENT, crs="EPSG:32616")
    assert part.dtype == np.uint8 and part.shape < whole.shape
    same = whole.sel(x=part.x, y=part.y, method="nearest")
    np.testing.assert_array_equal(same.to_numpy(), part.to_numpy())


def test_the_accessor_analyzes_an_array(dem):
    pytest.importorskip("sandtable.xarray")
    array = rioxarray.open_rasterio(JACKSBORO).squeeze("band")
    slope = array.sandtable.analyze("slope", extent=EXTENT, crs="EPSG:32616")
    np.testing.assert_array_equal(slope, dem.analyze("slope", extent=EXTENT, crs="EPSG:32616"))


def test_codes_are_bytes_and_figures_are_attributes(dem):
    overlay = dem.analyze("obstacles", extent=EXTENT, crs="EPSG:32616")
    assert overlay.dtype == np.uint8 and set(np.unique(overlay)) <= {0, 1, 2, 255}
    assert any("nothing is known of" in note for note in overlay.attrs["notes"])
    assert overlay.attrs["figure_units"][:2] == ["km²", "%"]
    assert sum(overlay.attrs["figure_values"][1::2]) == pytest.approx(100)


def test_features_tables_and_figures_are_those_of_the_program(program, dem):
    posts = [(-84.2, 36.3), (-84.15, 36.35), (-84.18, 36.28)]
    said = json.loads(program("analyze", "intervisibility", JACKSBORO, "--crs", "EPSG:4326", "--json",
                              "--posts", ";".join(f"{x},{y}" for x, y in posts)))
    for given in (posts, np.array(posts)):
        graph = dem.analyze("intervisibility", posts=given, crs=4326)
        assert (graph.figures, graph.tables, graph.notes) == (said["figures"], said["tables"], said["notes"])
        assert len(graph.features) == said["features"] > 0
        assert graph.raster is None and graph.crs == "EPSG:32616"
    x, y = graph.features[0]["geometry"]["coordinates"][0][:2]
    assert 700_000 < x < 800_000 and 4_000_000 < y < 4_050_000


def test_features_are_a_frame_of_geopandas(dem):
    pytest.importorskip("geopandas")
    peaks = dem.analyze("peaks", extent=EXTENT, crs="EPSG:32616").to_geopandas()
    assert peaks.crs.to_epsg() == 32616 and len(peaks) > 0


def test_positions_are_texts_tuples_or_shapes(dem):
    one = dem.analyze("viewsheds", posts=["16S GF 50000 18000"], range=2000)
    same = dem.analyze("viewsheds", posts=(750_000, 4_018_000), range=2000, crs="EPSG:32616")
    kind = next(kind for kind in sandtable.kinds() if kind["name"] == "viewsheds")
    assert kind["gives"] != "table"
    arrays = [made if kind["gives"] == "raster" else made.raster for made in (one, same)]
    # A grid reference is the middle of its square, half a meter off.
    assert arrays[0].shape == arrays[1].shape
    shapely = pytest.importorskip("shapely")
    shaped = dem.analyze("viewsheds", posts=shapely.Point(750_000, 4_018_000), range=2000, crs="EPSG:32616")
    shaped = shaped if kind["gives"] == "raster" else shaped.raster
    np.testing.assert_array_equal(shaped.to_numpy(), arrays[1].to_numpy())


def test_a_scene_knows_what_lies_on_its_ground(program):
    said = json.loads(program("analyze", "obstacles", ROAD, "--json"))
    overlay = sandtable.Scene.open(ROAD).analyze("obstacles")
    assert overlay.attrs["figure_values"] == [figure["value"] for figure in said["figures"]]
    assert overlay.attrs["notes"] == said["notes"]
    bare = sandtable.Dem.open(ROAD).analyze("obstacles")
    assert len(bare.attrs["notes"][0]) > len("".join(overlay.attrs["notes"][:1]))


def test_an_exaggerated_scene_is_analyzed_true_to_scale(program, tmp_path):
    (tmp_path / JACKSBORO.name).write_bytes(JACKSBORO.read_bytes())
    scenes = []
    for times in (1, 3):
        path = tmp_path / f"times{times}.toml"
        path.write_text(f'[terrain]\ndem = "{JACKSBORO.name}"\nvertical_exaggeration = {times}\n')
        scenes.append(sandtable.Scene.open(path))
    np.testing.assert_array_equal(scenes[1].analyze("slope"), scenes[0].analyze("slope"))
    said = json.loads(program("analyze", "obstacles", tmp_path / "times3.toml", "--json"))
    for _ in range(2):
        values = scenes[1].analyze("obstacles").attrs["figure_values"]
        assert values == [figure["value"] for figure in said["figures"]]


POSTS = {"posts": [(-84.2, 36.3), (-84.13, 36.34), (-84.29, 36.21)], "crs": "EPSG:4326"}


def test_progress_is_called_with_rising_shares_and_changes_no_bit(dem):
    shares = []
    tried = {"kind": "best-posts", "count": 3, "spacing": 2000}
    told = dem.analyze(**tried, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0 and all(0.0 <= share <= 1.0 for share in shares)
    np.testing.assert_array_equal(told.raster, dem.analyze(**tried).raster)


def test_progress_true_prints_on_standard_error_alone(dem, capfd):
    dem.analyze("viewsheds", progress=True, posts=POSTS["posts"] * 30, crs=POSTS["crs"])
    out, err = capfd.readouterr()
    assert out == "" and re.search(r"\ranalyzing \d+ %", err) and err.endswith("\r")
    dem.analyze("viewsheds", progress=False, **POSTS)
    assert capfd.readouterr() == ("", "")


def test_an_exception_of_progress_ends_the_analysis(dem):
    def fail(share):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        dem.analyze("viewsheds", progress=fail, **POSTS)
    with pytest.raises(TypeError, match="progress is a str"):
        dem.analyze("slope", progress="bar")


def test_what_is_wrong_is_named(dem):
    with pytest.raises(sandtable.SandtableError, match="`unit`.*degrees"):
        dem.analyze("slope", unit="degree")
    with pytest.raises(sandtable.SandtableError, match="slope"):
        dem.analyze("slopes")
    with pytest.raises(sandtable.SandtableError, match="`extent`.*off the land"):
        dem.analyze("slope", extent=(0, 0, 1, 1), crs="EPSG:32616")
    with pytest.raises(TypeError, match="unit"):
        dem.analyze("slope", unit=True)


def test_without_xarray_the_error_says_what_to_install(dem, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match="pip install xarray"):
        dem.analyze("slope", extent=EXTENT, crs="EPSG:32616")
