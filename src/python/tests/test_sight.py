"""Profiles, lines of sight, viewsheds, meshes and shades: those of the program."""

import json

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO, ROOT

VALLEY = ROOT / "assets/jacksboro/valley.asc"
OBSERVER = (750_000.0, 4_018_000.0)


def test_a_profile_has_the_stations_of_the_program(program):
    line = [[-84.21, 36.25], [-84.20, 36.28], [-84.16, 36.29]]
    text = " ".join(f"{x!r},{y!r}" for x, y in line)
    options = ["--crs", "EPSG:4326", "--step", "250"]
    rows = program("profile", JACKSBORO, "--line", text, *options).splitlines()[1:]
    said = json.loads(program("profile", JACKSBORO, "--line", text, *options, "--json"))
    profile = sandtable.Dem.open(JACKSBORO).profile(line, crs="EPSG:4326", step=250)
    numbers = np.array([[float(number or "nan") for number in row.split(",")[:4]] for row in rows])
    np.testing.assert_array_equal(profile.stations, numbers[:, 0])
    np.testing.assert_array_equal(profile.xy, numbers[:, 1:3])
    np.testing.assert_array_equal(profile.heights, numbers[:, 3])
    for ours, theirs in [("length", "length_m"), ("ascent", "ascent_m"), ("ground_length", "ground_length_m")]:
        assert getattr(profile, ours) == said[theirs] > 0


@pytest.mark.parametrize("above", [0.0, 3000.0])
def test_a_line_of_sight_is_that_of_the_program(program, above):
    observer, target = (-84.24, 36.22), (-84.15, 36.29)
    ends = ["--from", "-84.24,36.22,10", "--to", f"-84.15,36.29,{above}"]
    said = json.loads(program("los", JACKSBORO, *ends, "--crs", "EPSG:4326", "--json"))
    dem = sandtable.Dem.open(JACKSBORO)
    sight = dem.line_of_sight(observer, target, observer_height=10, target_height=above, crs=4326)
    assert bool(sight) == sight.visible == said["visible"] == (above > 0)
    assert sight.distance == said["distance_m"]
    assert sight.heights == (said["observer"]["height_m"], said["target"]["height_m"])
    assert (sight.clearance, sight.target_rise) == (said["clearance_m"], said["target_rise_m"])
    blocker = said["blocker"]
    assert sight.blocker == (blocker and tuple(blocker[key] for key in ["x", "y", "distance_m", "height_m"]))


@pytest.mark.parametrize("path", [JACKSBORO, VALLEY])
@pytest.mark.parametrize("limits", [{}, {"range": 4000.0, "sector": (300.0, 80.0), "target_height": 3.0}])
def test_a_viewshed_is_the_file_that_the_program_writes(program, tmp_path, path, limits):
    rasterio = pytest.importorskip("rasterio")
    words = {"range": "--range", "sector": "--sector", "target_height": "--target-height"}
    text = lambda value: ",".join(map(str, value)) if isinstance(value, tuple) else str(value)
    options = [word for key, value in limits.items() for word in (words[key], text(value))]
    at = [] if path == VALLEY else ["--crs", "EPSG:32616"]
    program("viewshed", path, "--at", "750000,4018000", *at, *options, "-o", tmp_path / "seen.tif")
    dem = sandtable.Dem.open(path)
    seen = dem.viewshed(OBSERVER, crs=None if path == VALLEY else "EPSG:32616", **limits)
    with rasterio.open(tmp_path / "seen.tif") as file:
        np.testing.assert_array_equal(seen.array, file.read(1))
        assert seen.transform == tuple(file.transform)[:6]
        assert seen.crs == (None if path == VALLEY else "EPSG:32616")
        assert path == VALLEY or file.crs.to_epsg() == 32616
        assert seen.nodata == file.nodata == 255
    assert seen.array.dtype == np.uint8 and {0, 1} <= set(np.unique(seen.array)) <= {0, 1, 255}


def test_a_viewshed_of_a_real_file_is_that_of_the_program(program, data, tmp_path):
    rasterio = pytest.importorskip("rasterio")
    path = data("dem/bigtujunga_utm11_i16_tiled.tif")
    dem = sandtable.Dem.open(path)
    west, south, east, north = dem.bounds
    at = ((west + east) / 2, (south + north) / 2)
    program("viewshed", path, "--at", f"{at[0]!r},{at[1]!r}", "--range", "3000", "-o", tmp_path / "seen.tif")
    seen = dem.viewshed(at, range=3000)
    with rasterio.open(tmp_path / "seen.tif") as file:
        np.testing.assert_array_equal(seen.array, file.read(1))
        assert seen.transform == tuple(file.transform)[:6]


def test_a_mesh_is_the_one_that_the_program_writes(program, tmp_path):
    program("mesh", JACKSBORO, "--max-error", "5", "-o", tmp_path / "ground.ply")
    head, body = (tmp_path / "ground.ply").read_bytes().split(b"end_header\n", 1)
    count = {words[1]: int(words[2]) for words in map(bytes.split, head.splitlines()) if words[0] == b"element"}
    vertices = np.frombuffer(body, "<f4", 3 * count[b"vertex"]).reshape(-1, 3)
    faces = np.frombuffer(body, [("n", "u1"), ("corners", "<u4", 3)], offset=vertices.nbytes)
    mesh = sandtable.Dem.open(JACKSBORO).mesh(5)
    np.testing.assert_array_equal(mesh.vertices, vertices)
    np.testing.assert_array_equal(mesh.triangles, faces["corners"])
    assert len(faces) == count[b"face"] > 100 and mesh.crs == "EPSG:32616"
    assert f"easting {mesh.origin[0]:.6f}"[:14] in head.decode()


def test_shades_are_those_of_the_definition():
    transform = (10, 0, 0, 0, -10, 0)
    flat = sandtable.Dem.from_array(np.full((5, 6), 3.0), transform)
    assert (flat.hillshade().array == 181).all(), "sin 45° of 254, and one"
    slope = np.add.outer(np.zeros(7), np.arange(7) * -10.0)
    east = sandtable.Dem.from_array(slope, transform)
    assert (east.hillshade(azimuth=90).array == 255).all(), "a slope of 45° that faces the sun"
    holed = slope.copy()
    holed[3, 3] = np.nan
    shaded = sandtable.Dem.from_array(holed, transform, "EPSG:32616").hillshade(azimuth=270)
    assert shaded.array[3, 3] == shaded.nodata == 0 and (shaded.array == 0).sum() == 1
    assert shaded.array.shape == (7, 7) and shaded.crs == "EPSG:32616" and shaded.transform == transform
