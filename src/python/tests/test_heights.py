"""Heights: the bits of `sandtable height`, whatever the array looks like."""

import pickle
import sys
import threading

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO

INTERPOLATIONS = ["bilinear", "planar", "nearest", "cubic", "distance-weighted"]


def scattered(dem, count):
    """Positions over the model and a little beyond it."""
    west, south, east, north = dem.bounds
    random = np.random.default_rng(7)
    across, up = (east - west) * 0.05, (north - south) * 0.05
    return random.uniform((west - across, south - up), (east + across, north + up), (count, 2))


def printed(program, path, xy, *options):
    """The heights that the program prints, NaN where it prints none."""
    points = "".join(f"{x!r},{y!r}\n" for x, y in xy.tolist())
    lines = program("height", path, "--points", "-", *options, input=points).splitlines()[1:]
    return np.array([float(line.split(",")[2] or "nan") for line in lines])


@pytest.mark.parametrize("surface", ["source", "ground"])
@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_heights_have_the_bits_of_the_program(program, interpolation, surface):
    dem = sandtable.Dem.open(JACKSBORO)
    xy = scattered(dem, 500)
    options = ["--interpolation", interpolation, "--surface", surface]
    # The ground lies in the UTM zone; positions are those of the file for both.
    expected = printed(program, JACKSBORO, xy, *options)
    heights = dem.heights(xy, interpolation, surface=surface)
    assert heights.dtype == np.float64 and heights.shape == (500,)
    assert np.isnan(heights).any() and np.isfinite(heights).sum() > 300
    np.testing.assert_array_equal(heights, expected)


def test_positions_may_be_in_another_system(program):
    dem = sandtable.Dem.open(JACKSBORO)
    xy = np.random.default_rng(1).uniform((-84.24, 36.2), (-84.14, 36.3), (200, 2))
    expected = printed(program, JACKSBORO, xy, "--crs", "EPSG:4326")
    assert np.isfinite(expected).any()
    for crs in ["EPSG:4326", 4326]:
        np.testing.assert_array_equal(dem.heights(xy, crs=crs), expected)
    zone = dem.heights([[750_000, 4_018_000]], crs="+proj=utm +zone=16 +datum=WGS84")
    np.testing.assert_array_equal(dem.heights([[750_000, 4_018_000]], crs=32616), zone)


def test_positions_may_be_texts_that_state_their_places(program):
    dem = sandtable.Dem.open(JACKSBORO)
    texts = ["16S GF 50050 18050", "36.28N 84.21W", "16N 750000 4018000", "-84.21, 36.28"]
    printed = [float(program("height", JACKSBORO, "--at", text).splitlines()[1].split(",")[-2]) for text in texts]
    heights = dem.heights(texts)
    np.testing.assert_array_equal(heights, printed)
    # Texts state their system, whatever that of numbers is.
    for given in [texts[:3], np.array(texts[:3]), tuple(texts[:3])]:
        np.testing.assert_allclose(dem.heights(given, crs=4326), heights[:3], atol=1e-4)
    np.testing.assert_array_equal(dem.heights(texts[0]), heights[:1])
    line = dem.profile([texts[0], texts[1]])
    np.testing.assert_allclose(line.xy[[0, -1]], [(-84.2162272, 36.2750374), (-84.21, 36.28)], atol=1e-6)
    ends = [tuple(line.xy[0]), tuple(line.xy[-1])]
    assert dem.line_of_sight(*texts[:2]).visible == dem.line_of_sight(*ends).visible
    seen = [dem.viewshed(observer, range=500).array for observer in [texts[0], ends[0]]]
    np.testing.assert_array_equal(*seen)
    for wrong in ["nowhere", "16S GF 1", "36.28N"]:
        with pytest.raises(ValueError, match="xy: "):
            dem.heights([texts[0], wrong])


def test_systems_of_pyproj_and_rasterio_are_understood():
    pyproj, rasterio = pytest.importorskip("pyproj"), pytest.importorskip("rasterio")
    dem = sandtable.Dem.open(JACKSBORO)
    xy = [[-84.2, 36.3]]
    plain = dem.heights(xy, crs="EPSG:4326")
    for crs in [pyproj.CRS(4326), rasterio.crs.CRS.from_epsg(4326)]:
        np.testing.assert_array_equal(dem.heights(xy, crs=crs), plain)
    zone = pyproj.CRS.from_proj4("+proj=utm +zone=16 +datum=WGS84")
    assert zone.to_epsg(min_confidence=100) != 32616
    assert sandtable.Dem.from_array(np.zeros((2, 2)), (1, 0, 0, 0, -1, 0), zone).crs is not None


@pytest.mark.parametrize("name", ["dem/bigtujunga_utm11_i16_tiled.tif", "dem/zion_srtm_u16_deflate.tif"])
def test_real_files_have_the_bits_of_the_program(program, data, name):
    path = data(name)
    dem = sandtable.Dem.open(path)
    xy = scattered(dem, 300)
    for interpolation in INTERPOLATIONS:
        expected = printed(program, path, xy, "--interpolation", interpolation)
        np.testing.assert_array_equal(dem.heights(xy, interpolation), expected)


def test_every_layout_of_an_array_gives_the_same_heights():
    dem = sandtable.Dem.open(JACKSBORO)
    xy = scattered(dem, 1000)
    heights = dem.heights(xy)
    wide = np.zeros((1000, 5))
    wide[:, 1:3] = xy
    for same in [np.asfortranarray(xy), wide[:, 1:3], xy[::-1][::-1], xy.tolist(), xy.astype(">f8")]:
        np.testing.assert_array_equal(dem.heights(same), heights)
    np.testing.assert_array_equal(dem.heights(xy[::-3]), heights[::-3])
    np.testing.assert_array_equal(dem.heights(xy[100:200]), heights[100:200])
    assert dem.heights(np.empty((0, 2))).shape == (0,)
    assert np.isnan(dem.heights([[np.nan, 0.0], [np.inf, 1e300]])).all()


def test_a_large_file_on_disk_answers_as_its_array_does(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    rows, columns = np.mgrid[0:1100, 0:1200]
    samples = (500 + 40 * np.sin(rows / 37) + columns % 97).astype("f4")
    samples[300:340, 500:600] = -9999
    transform = rasterio.Affine(30, 0, 700_000, 0, -30, 4_000_000)
    path = tmp_path / "large.tif"
    options = {"crs": "EPSG:32616", "nodata": -9999, "transform": transform, "tiled": True, "compress": "deflate"}
    with rasterio.open(path, "w", "GTiff", 1200, 1100, 1, dtype="float32", **options) as file:
        file.write(samples, 1)
    on_disk = sandtable.Dem.open(path)
    in_memory = sandtable.Dem.from_array(samples, transform, "EPSG:32616", nodata=-9999)
    assert on_disk.shape == in_memory.shape == (1100, 1200)
    assert on_disk.bounds == in_memory.bounds == (700_000, 3_967_000, 736_000, 4_000_000)
    assert on_disk.crs == "EPSG:32616" and on_disk.transform == tuple(transform)[:6]
    xy = scattered(on_disk, 2000)
    for surface in ["source", "ground"]:
        for interpolation in INTERPOLATIONS:
            pair = [dem.heights(xy, interpolation, surface=surface) for dem in (on_disk, in_memory)]
            np.testing.assert_array_equal(*pair)
    np.testing.assert_array_equal(on_disk.to_numpy(), np.where(samples == -9999, np.nan, samples))
    np.testing.assert_array_equal(on_disk.hillshade().array, in_memory.hillshade().array)


def test_arrays_of_all_types_and_masked_ones_are_elevation():
    transform = (10, 0, 1000, 0, -10, 2000)
    grid = np.arange(12).reshape(3, 4)
    for kind in ["i1", "u2", "i4", "u8", "f2", "f4", "f8", ">i2"]:
        dem = sandtable.Dem.from_array(grid.astype(kind), transform)
        assert dem.to_numpy().dtype == ("f8" if kind in ["i4", "u8", "f8"] else "f4")
        np.testing.assert_array_equal(dem.to_numpy(), grid)
        assert dem.heights([[1005, 1995]])[0] == 0 and dem.heights([[1035, 1975]])[0] == 11
    masked = np.ma.masked_equal(grid, 5)
    for dem in [sandtable.Dem.from_array(masked, transform), sandtable.Dem.from_array(grid, transform, nodata=5)]:
        assert np.isnan(dem.to_numpy()).sum() == 1 and np.isnan(dem.heights([[1015, 1985]], "nearest")[0])
    assert dem.crs is None and dem.vertical_datum is None
    with pytest.raises(TypeError, match="give numbers of shape"):
        sandtable.Dem.from_array(np.zeros(5), transform)
    with pytest.raises(TypeError, match="give numbers of shape"):
        sandtable.Dem.from_array(np.array([["a"]]), transform)


def test_models_travel_to_other_processes_by_name_or_by_value():
    opened = sandtable.Dem.open(JACKSBORO, vertical_datum="EGM96")
    sent = pickle.dumps(opened)
    assert len(sent) < 500
    array = sandtable.Dem.from_array(opened.to_numpy(), opened.transform, opened.crs)
    xy = scattered(opened, 100)
    for dem in [pickle.loads(sent), pickle.loads(pickle.dumps(array))]:
        np.testing.assert_array_equal(dem.heights(xy), opened.heights(xy))
    assert pickle.loads(sent).vertical_datum == opened.vertical_datum


def test_a_file_says_what_reading_it_left_out_and_is_read_in_the_unit_that_is_stated(tmp_path):
    path = tmp_path / "a.xyz"
    path.write_text("0 10 1\n5 10 2\n0 0 deep\n5 0 4\n")
    opened = sandtable.Dem.open(path, vertical_unit=0.3048)
    assert len(opened.notes) == 1 and "line 3 is '0 0 deep'" in opened.notes[0]
    for dem in [opened, pickle.loads(pickle.dumps(opened))]:
        np.testing.assert_allclose(dem.heights([[5.0, 0.0]]), [4 * 0.3048])


def test_other_threads_run_while_heights_are_computed():
    dem = sandtable.Dem.open(JACKSBORO)
    xy = np.tile(scattered(dem, 1000), (1000, 1))
    interval = sys.getswitchinterval()
    # Threads change only where one lets go of the interpreter.
    sys.setswitchinterval(1000)
    try:
        ran_meanwhile = False
        for _ in range(20):
            begun, ended = threading.Event(), []

            def work():
                begun.set()
                dem.heights(xy)
                ended.append(True)

            thread = threading.Thread(target=work)
            thread.start()
            begun.wait()
            ran_meanwhile |= not ended
            thread.join()
            if ran_meanwhile:
                break
        assert ran_meanwhile
    finally:
        sys.setswitchinterval(interval)
