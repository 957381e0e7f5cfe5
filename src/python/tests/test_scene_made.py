"""Scenes of data in memory are those of the same data in files."""

import json
import subprocess
import sys
import tomllib
import warnings

import numpy as np
import pytest
import sandtable as st
from conftest import JACKSBORO, ROAD
from PIL import Image

geopandas = pytest.importorskip("geopandas")
rioxarray = pytest.importorskip("rioxarray")
rasterio = pytest.importorskip("rasterio")
shapely = pytest.importorskip("shapely")

SIZE = (320, 200)


@pytest.fixture(scope="module")
def swellendam(data):
    return data("scenes/swellendam_za")


@pytest.fixture(scope="module")
def frames(swellendam):
    """The layers of the map of Swellendam, as geopandas reads them."""
    read = geopandas.read_file
    layers = {layer: read(swellendam / "training_data.gpkg", layer=layer) for layer in ["roads", "buildings"]}
    return layers | {layer: read(swellendam / f"projected/{layer}_33S.shp") for layer in ["water", "places"]}


def made(ground, water, places, *, roads, buildings):
    """A scene of four layers, whatever they come as; `roads` and `buildings` with the names of their layers."""
    scene = st.Scene(ground).roads(roads[0], layer=roads[1], width="lanes * 3.5 ?? 12")
    scene = scene.buildings(buildings[0], layer=buildings[1], height=8).lakes(water)
    return scene.labels(places, text="NAME").camera("overview")


@pytest.mark.filterwarnings("ignore::sandtable.SandtableWarning")
def test_a_picture_of_data_frames_is_that_of_their_files(swellendam, frames, program, tmp_path):
    ground = swellendam / "dem_srtm_wgs84_f32.tif"
    package = swellendam / "training_data.gpkg"
    water, places = (swellendam / f"projected/{layer}_33S.shp" for layer in ["water", "places"])
    of_files = made(ground, water, places, roads=(package, "roads"), buildings=(package, "buildings"))
    array = rioxarray.open_rasterio(ground).squeeze("band")
    roads, buildings = (frames["roads"], None), (frames["buildings"], None)
    of_frames = made(array, frames["water"], frames["places"], roads=roads, buildings=buildings)
    picture = of_frames.render(size=SIZE)
    assert picture.shape == (200, 320, 3) and picture.std() > 10
    np.testing.assert_array_equal(picture, of_files.render(size=SIZE))
    # The scene file that says the same, by the program.
    scene_file, out = tmp_path / "scene.toml", tmp_path / "out.png"
    scene_file.write_text(of_files.toml(), encoding="utf-8")
    program("render", scene_file, "--allow", swellendam, "--size", "320x200", "-o", out)
    np.testing.assert_array_equal(picture, np.asarray(Image.open(out)))


@pytest.mark.filterwarnings("ignore::sandtable.SandtableWarning")
def test_ground_of_every_kind_gives_the_same_picture():
    expected = st.Scene(JACKSBORO).render(size=SIZE)
    with rasterio.open(JACKSBORO) as dataset:
        array, transform, crs, nodata = dataset.read(1), dataset.transform, dataset.crs, dataset.nodata
        grounds = {"dataset": st.Scene(dataset)}
    xarray = rioxarray.open_rasterio(JACKSBORO).squeeze("band")
    grounds |= {
        "array": st.Scene(array, transform=transform, crs=crs, nodata=nodata),
        "xarray": st.Scene(xarray),
        "text": st.Scene(str(JACKSBORO)),
        "opened": st.Scene(st.Dem.open(JACKSBORO)),
        "Dem": st.Scene(st.Dem.from_array(array, transform, crs, nodata=nodata)),
    }
    for kind, scene in grounds.items():
        np.testing.assert_array_equal(scene.render(size=SIZE), expected, err_msg=kind)


@pytest.mark.filterwarnings("ignore::sandtable.SandtableWarning")
def test_lines_of_every_kind_give_the_same_picture(tmp_path):
    at = [(749_000.0, 4_017_000.0), (750_000.0, 4_018_500.0), (751_500.0, 4_018_000.0)]
    line, crs = shapely.LineString(at), "EPSG:32616"
    frame = geopandas.GeoDataFrame({"lanes": [4]}, geometry=[line], crs=crs)
    frame.to_file(tmp_path / "roads.gpkg")
    sources = {
        "points": (at, None),
        "array": (np.array(at), None),
        "frame": (frame, None),
        "series": (frame.geometry, None),
        "shape": (line, crs),
        "shapes": ([line], 32616),
        "wkt": (line.wkt, crs),
        "wkts": ([line.wkt], frame.crs),
        "path": (tmp_path / "roads.gpkg", None),
        "text": (str(tmp_path / "roads.gpkg"), None),
        "interface": (json.loads(frame.to_json(to_wgs84=False)), crs),
    }
    pictures = {
        kind: st.Scene(JACKSBORO).roads(source, width=500, crs=crs).render(size=SIZE)
        for kind, (source, crs) in sources.items()
    }
    bare = st.Scene(JACKSBORO).render(size=SIZE)
    assert (pictures["points"] != bare).mean() > 0.001
    for kind, picture in pictures.items():
        np.testing.assert_array_equal(picture, pictures["points"], err_msg=kind)


def test_properties_of_every_type_reach_expressions():
    pandas = pytest.importorskip("pandas")
    line = shapely.LineString([(749_000, 4_017_000), (751_500, 4_018_000)])
    columns = {
        "float": np.array([7.5], np.float32),
        "integer": np.array([7], np.uint8),
        "truth": [True],
        "text": ["7.5 m"],
        "category": pandas.Categorical(["primary"]),
        "nullable": pandas.array([7], "Int64"),
        "missing": pandas.array([pandas.NA], "Int64"),
        "time": [pandas.Timestamp("2026-06-21")],
        "none": [None],
    }
    frame = geopandas.GeoDataFrame(columns, geometry=[line], crs=32616)
    wheres = {
        "float = 7.5": True,
        "integer = 7": True,
        "truth = true": True,
        "text = '7.5 m'": True,
        "category = 'primary'": True,
        "nullable = 7": True,
        "(missing ?? 3) = 3": True,
        "time = '2026-06-21 00:00:00'": True,
        "(none ?? 3) = 3": True,
        "float = 8": False,
    }
    for where, holds in wheres.items():
        scene = st.Scene(JACKSBORO).roads(frame, where=where, width=7)
        if holds:
            assert scene.cameras, where
        else:
            with pytest.raises(st.SandtableError, match="no feature of 'memory:road' matches"):
                scene.cameras


def test_symbols_stand_at_the_positions_of_a_table():
    pandas = pytest.importorskip("pandas")
    units = pandas.DataFrame({"code": ["10031000161211000000"] * 2, "mgrs": ["16S GF 50000 18000", "16S GF 51000 17000"]})
    scene = st.Scene(JACKSBORO).symbols(units, sidc="code", at="mgrs")
    assert (scene.render(size=SIZE) != st.Scene(JACKSBORO).render(size=SIZE)).any()
    with pytest.raises(ValueError, match="no column 'grid'; its columns are code, mgrs"):
        st.Scene(JACKSBORO).symbols(units, sidc="code", at="grid")
    with pytest.raises(ValueError, match="lon and lat have no coordinate system: give crs="):
        st.Scene(JACKSBORO).symbols(units, sidc="code", at=("lon", "lat"))


def test_data_without_a_system_ask_for_it(frames):
    bare = frames["roads"].set_crs(None, allow_override=True)
    with pytest.raises(ValueError, match="the GeoDataFrame has no coordinate system: give crs="):
        st.Scene(JACKSBORO).roads(bare)
    with pytest.raises(ValueError, match="WKT has no coordinate system: give crs="):
        st.Scene(JACKSBORO).roads("LINESTRING (0 0, 1 1)")
    with pytest.raises(ValueError, match="give transform="):
        st.Scene(np.zeros((9, 9)))
    with pytest.raises(ValueError, match="the elevation has no coordinate system: give crs="):
        st.Scene(np.zeros((9, 9)), transform=(10, 0, 0, 0, -10, 0))
    assert len(st.Scene(JACKSBORO).roads(bare, crs=4326)._given["memory:road"]) == len(bare)


@pytest.fixture
def square():
    """A hill of 40 by 40 samples as an array with its place."""
    rows, columns = np.mgrid[0:40, 0:40]
    hill = (300 + 3 * columns + 2 * rows).astype("float32")
    return {"array": hill, "transform": (10, 0, 500_000, 0, -10, 4_502_000), "crs": "EPSG:32633"}


def of_square(square, **changed):
    given = {**square, **changed}
    return st.Scene(given.pop("array"), **given)


def test_nodata_of_a_table_makes_voids_of_an_array(square):
    array = square["array"].copy()
    array[10:30, 10:30] = 7.0
    stated = of_square(square, array=array).terrain(nodata=7)
    np.testing.assert_array_equal(stated.render(size=SIZE), of_square(square, array=array, nodata=7).render(size=SIZE))
    assert (stated.render(size=SIZE) != of_square(square, array=array).render(size=SIZE)).any()


def test_crs_of_a_table_takes_the_place_of_an_array_s(square):
    here = (500_200.0, 4_501_800.0)
    moved = of_square(square).terrain(crs="EPSG:32634").labels(at=here, text="Here")
    with pytest.warns(st.SandtableWarning, match="crs-overridden"):
        picture = moved.render(size=SIZE)
    np.testing.assert_array_equal(picture, of_square(square, crs="EPSG:32634").labels(at=here, text="Here").render(size=SIZE))


def test_vertical_unit_of_a_table_says_what_an_array_counts_in(square):
    feet = of_square(square, array=square["array"] / np.float32(0.3048)).terrain(vertical_unit="ft")
    meters = of_square(square).render(size=SIZE).astype(float)
    assert abs(feet.render(size=SIZE) - meters).mean() < 0.5
    assert abs(of_square(square, array=square["array"] / np.float32(0.3048)).render(size=SIZE) - meters).mean() > 0.5


def test_vertical_datum_of_a_table_is_that_of_an_array(square):
    said = of_square(square).terrain(vertical_datum="NAVD88")
    assert 'vertical_datum = "NAVD88"' in said.toml() and said.cameras


@pytest.mark.parametrize(
    "key",
    [
        {"cell": 5},
        {"height_encoding": "terrarium"},
        {"height_offset": 3},
        {"height_scale": 0.5},
        {"raw": "40x40:f32le"},
        {"surface": "ground"},
    ],
    ids=lambda key: next(iter(key)),
)
def test_keys_of_elevation_files_are_refused_on_an_array(square, key):
    with pytest.raises(st.SandtableError, match=f"(?s)`{next(iter(key))}` has no effect on 'memory:terrain'.*leave it out"):
        of_square(square).terrain(**key).render(size=SIZE)


@pytest.mark.parametrize("key", [{"layer": "roads"}, {"columns": {"width": "w"}}], ids=lambda key: next(iter(key)))
def test_keys_of_feature_files_are_refused_on_a_data_frame(square, key):
    frame = geopandas.GeoDataFrame({"w": [4]}, geometry=[shapely.LineString([(500_100, 4_501_700), (500_300, 4_501_900)])], crs=32633)
    with pytest.raises(st.SandtableError, match=f"(?s)`{next(iter(key))}` has no effect on 'memory:road'.*leave it out"):
        of_square(square).roads(frame, **key).render(size=SIZE)


def test_findings_are_warnings_with_their_places():
    river = [(750_000.0, 4_018_000.0), (751_000.0, 4_018_000.0)]
    scene = st.Scene(JACKSBORO).style(ramp="atlas").rivers(river, name="Ay", mouth_width="wide")
    with pytest.warns(st.SandtableWarning) as warned:
        scene.render(size=SIZE)
    found = next(warning for warning in warned if "mouth_width" in str(warning.message) or "wide" in str(warning.message))
    finding = found.message.finding
    assert finding.file == "<scene>" and found.filename == __file__
    line = scene.toml().splitlines()[finding.line - 1]
    assert "river" in line or "points" in line or "mouth_width" in line
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene.render(size=SIZE)


def test_errors_name_the_line_of_the_scene_file():
    scene = st.Scene(JACKSBORO).settings(title="Wrong").roads([(0, 0), (1, 1)], width=-3)
    with pytest.raises(st.SandtableError) as raised:
        scene.render()
    error = raised.value
    assert error.file == "<scene>" and scene.toml().splitlines()[error.line - 1] == "width = -3"
    with pytest.raises(st.SandtableError, match="roads.gpkg"):
        st.Scene(JACKSBORO).roads("roads.gpkg").render()
    with pytest.raises(TypeError, match="widht"):
        st.Scene(JACKSBORO).roads("roads.gpkg", widht=3)


def test_a_method_leaves_its_scene_as_it_is():
    scene = st.Scene(JACKSBORO)
    line = [(749_000.0, 4_017_000.0), (751_500.0, 4_018_000.0)]
    first, second = scene.roads(line), scene.rivers(line)
    assert "[[road]]" not in scene.toml() and "[[river]]" not in first.toml() and "[[road]]" not in second.toml()
    styled = scene.style(ramp="atlas").style(contours={"interval": 20})
    assert tomllib.loads(styled.toml())["style"] == {"ramp": "atlas", "contours": {"interval": 20}}
    assert repr(first.roads(line)) == "<Scene of terrain, 2 road>"


@pytest.mark.filterwarnings("ignore::sandtable.SandtableWarning")
def test_a_scene_file_is_added_to():
    scene = st.Scene(ROAD)
    np.testing.assert_array_equal(scene.render(size=SIZE), st.Scene.open(ROAD).render(size=SIZE))
    more = scene.labels(at=(750_000, 4_018_000), text="Here")
    assert more.cameras == scene.cameras
    assert (more.render(size=SIZE) != scene.render(size=SIZE)).any()


def test_what_is_read_needs_no_permission_and_nothing_else_is(tmp_path):
    secret = tmp_path / "secret"
    secret.mkdir()
    (secret / "a.geojson").write_text('{"type": "Point", "coordinates": [1, 2]}')
    inner = tmp_path / "x/y/z"
    inner.mkdir(parents=True)
    (inner / "scene.toml").write_text(
        f'[terrain]\ndem = "{JACKSBORO.as_posix()}"\n[[label]]\ntext = "name"\nfile = "{(secret / "a.geojson").as_posix()}"\n'
    )
    with pytest.raises(st.SandtableError, match="--allow"):
        st.Scene(inner / "scene.toml").style(ramp="atlas").render()


def test_notebooks_show_a_picture():
    png = st.Scene(ROAD)._repr_png_()
    assert png.startswith(b"\x89PNG\r\n")
    assert max(int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == 1280


def test_files_are_those_of_the_program(program, tmp_path):
    scene = st.Scene(ROAD)
    for name in ["a.png", "a.pdf", "a.svg"]:
        program("render", ROAD, "--camera", scene.cameras[0], "--size", "320x200", "-o", tmp_path / f"program-{name}")
        scene.save(tmp_path / name, camera=scene.cameras[0], size=SIZE)
        assert (tmp_path / name).read_bytes() == (tmp_path / f"program-{name}").read_bytes(), name
    for name in ["a.glb", "a.html"]:
        program("export", ROAD, "-o", tmp_path / f"program-{name}")
        scene.save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == (tmp_path / f"program-{name}").read_bytes(), name
    with pytest.raises(st.SandtableError, match=r"a scene is saved as .png, .pdf"):
        scene.save(tmp_path / "a.gif")


@pytest.mark.filterwarnings("ignore::sandtable.SandtableWarning")
def test_a_saved_scene_file_with_its_data_gives_the_same_picture(frames, program, tmp_path):
    pandas = pytest.importorskip("pandas")
    with rasterio.open(JACKSBORO) as dataset:
        array, transform, crs, nodata = dataset.read(1), dataset.transform, dataset.crs, dataset.nodata
    line = shapely.LineString([(749_000.1, 4_017_000.2, 300), (751_500.3, 4_018_000.4, 400)])
    roads = geopandas.GeoDataFrame({"lanes": [4]}, geometry=[line], crs=32616)
    units = pandas.DataFrame({"code": ["10031000161211000000"], "mgrs": ["16S GF 50000 18000"]})
    scene = st.Scene(array, transform=transform, crs=crs, nodata=nodata).roads(roads, width="lanes * 50")
    scene = scene.symbols(units, sidc="code", at="mgrs").labels(at=(750_000, 4_018_000), text="Here")
    folder = tmp_path / "scene"
    folder.mkdir()
    scene.save(folder / "hill.toml")
    names = {"hill.toml", "hill-terrain.tif", "hill-road.geojson", "hill-symbol.csv"}
    assert {path.name for path in folder.iterdir()} == names and "memory:" not in (folder / "hill.toml").read_text()
    program("render", folder / "hill.toml", "--size", "320x200", "-o", tmp_path / "out.png")
    np.testing.assert_array_equal(scene.render(size=SIZE), np.asarray(Image.open(tmp_path / "out.png")))


def test_a_page_is_shown_in_a_frame_and_too_large_a_one_is_not(monkeypatch):
    page = st.Scene(ROAD).show()
    shown = page._repr_html_()
    assert page.html.startswith("<!") and shown.startswith("<iframe srcdoc=") and "<script" not in shown
    monkeypatch.setattr("sandtable._saved._MOST_PAGE_BYTES", 1000)
    assert "scene.save('scene.html')" in page._repr_html_()


def test_keys_that_python_reserves_end_in_an_underscore():
    scene = st.Scene(JACKSBORO).graphics([(750_000, 4_018_000)], kind="target", from_="010600Z", style="red 1")
    scene = scene.styles("red 1", side="hostile").vehicle("car", built_up_kmh=20)
    said = tomllib.loads(scene.toml())
    assert said["graphic"] == [{"points": [[750_000, 4_018_000]], "kind": "target", "from": "010600Z", "style": "red 1"}]
    assert said["styles"] == {"red 1": {"side": "hostile"}} and said["vehicle"] == {"car": {"built_up_kmh": 20}}


def test_the_package_is_imported_without_numpy():
    command = "import sys, sandtable; assert 'numpy' not in sys.modules"
    subprocess.run([sys.executable, "-c", command], check=True)
