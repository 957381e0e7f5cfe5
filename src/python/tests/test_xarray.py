"""The accessor of xarray keeps the georeference."""

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO

rioxarray = pytest.importorskip("rioxarray")
pytest.importorskip("sandtable.xarray")

OBSERVER = (750_000.0, 4_018_000.0)


@pytest.fixture(scope="module", params=[False, True], ids=["nodata", "masked"])
def array(request):
    return rioxarray.open_rasterio(JACKSBORO, masked=request.param).squeeze("band")


def test_answers_are_those_of_the_file(array):
    dem = sandtable.Dem.open(JACKSBORO)
    xy = np.random.default_rng(3).uniform((-84.24, 36.2), (-84.14, 36.3), (300, 2))
    np.testing.assert_array_equal(array.sandtable.heights(xy, crs=4326), dem.heights(xy, crs=4326))
    assert (array.sandtable.dem.crs, array.sandtable.dem.transform) == (dem.crs, dem.transform)
    line = [[-84.21, 36.25], [-84.16, 36.29]]
    assert array.sandtable.profile(line, crs=4326).ascent > 0
    assert len(array.sandtable.mesh(20).triangles) > 0
    assert not array.sandtable.line_of_sight(*line, crs=4326)


def test_rasters_are_arrays_with_coordinates_system_and_transform(array):
    seen = array.sandtable.viewshed(OBSERVER, range=3000, crs="EPSG:32616")
    plain = array.sandtable.dem.viewshed(OBSERVER, range=3000, crs="EPSG:32616")
    np.testing.assert_array_equal(seen, plain.array)
    assert seen.name == "viewshed" and seen.dims == ("y", "x") and seen.rio.nodata == 255
    assert seen.rio.crs.to_epsg() == 32616 and tuple(seen.rio.transform())[:6] == plain.transform
    # What is in sight at the observer's own post.
    assert int(seen.sel(x=OBSERVER[0], y=OBSERVER[1], method="nearest")) == 1
    shaded = array.sandtable.hillshade(azimuth=300)
    assert shaded.rio.nodata == 0 and shaded.rio.crs == seen.rio.crs
    np.testing.assert_array_equal(shaded.rio.reproject("EPSG:4326").rio.crs.to_epsg(), 4326)


def test_rows_from_the_south_and_axes_swapped_are_the_same_model(array):
    heights = array.sandtable.dem.to_numpy()
    for turned in [array.isel(y=slice(None, None, -1)), array.transpose("x", "y")]:
        np.testing.assert_array_equal(turned.sandtable.dem.to_numpy(), heights)
        np.testing.assert_allclose(turned.sandtable.dem.transform, array.sandtable.dem.transform, rtol=1e-9, atol=1e-12)


def test_a_slice_lies_where_it_was_cut(array):
    part = array.isel(x=slice(40, 300), y=slice(30, 200))
    assert part.sandtable.dem.shape == (170, 260)
    x, y = float(part.x[100]), float(part.y[50])
    assert part.sandtable.heights([[x, y]], "nearest")[0] == float(part[50, 100])


def test_more_than_one_band_is_refused_with_a_remedy():
    bands = rioxarray.open_rasterio(JACKSBORO)
    with pytest.raises(ValueError, match="squeeze"):
        bands.sandtable.hillshade()
