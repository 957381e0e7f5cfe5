"""What is refused, and how that is said."""

import pickle
import shutil

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO, ROAD, ROOT


def test_a_file_that_is_not_there_or_is_no_elevation_is_named(tmp_path):
    (tmp_path / "broken.tif").write_bytes(b"II*\0broken")
    for name in ["missing.tif", "broken.tif"]:
        with pytest.raises(sandtable.SandtableError) as raised:
            sandtable.Dem.open(tmp_path / name)
        assert raised.value.file == str(tmp_path / name) and raised.value.line is None
        assert str(raised.value).startswith(str(tmp_path / name))


def test_a_wrong_scene_is_refused_with_all_of_its_errors(tmp_path):
    shutil.copytree(ROOT / "assets", tmp_path / "assets")
    (tmp_path / "scenes").mkdir()
    path = tmp_path / "scenes/wrong.toml"
    path.write_text(ROAD.read_text().replace("[terrain]", "[terrain]\nnonsense = 1\ndetale = 2", 1))
    with pytest.raises(sandtable.SandtableError, match="nonsense") as raised:
        sandtable.Scene.open(path)
    error = pickle.loads(pickle.dumps(str(raised.value))), raised.value
    line = path.read_text().splitlines().index("nonsense = 1") + 1
    assert (error[1].file, error[1].line, error[1].column) == (str(path), line, 1)
    assert error[0].startswith(f"{path}:{line}:1: error[unknown-key]")
    assert [finding.line for finding in error[1].findings] == [line, line + 1]
    assert {finding.severity for finding in error[1].findings} == {"error"}


def test_errors_travel_between_processes():
    with pytest.raises(sandtable.SandtableError) as raised:
        sandtable.Dem.open("missing.tif")
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.file) == (str(raised.value), "missing.tif")


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda dem: dem.heights(np.zeros((4, 3))), r"xy has shape \(4, 3\); give \(N, 2\)"),
        (lambda dem: dem.heights([[0, 0]], "bilinaer"), "did you mean `bilinear`"),
        (lambda dem: dem.heights([[0, 0]], surface="groud"), "did you mean `ground`"),
        (lambda dem: dem.heights([[0, 0]], crs="EPSG:1"), "EPSG:1"),
        (lambda dem: dem.profile([[0, 0]]), "at least two"),
        (lambda dem: dem.viewshed((0, np.nan)), "two finite numbers"),
        (lambda dem: dem.viewshed((0, 0), range=-1), "meters above 0"),
        (lambda dem: dem.viewshed((0, 0), refraction=1), "below 1"),
        (lambda dem: dem.viewshed((0, 0), refraction=0.1, flat=True), "no effect"),
        (lambda dem: dem.viewshed((0, 0), observer_height=np.inf), "observer_height"),
        (lambda dem: dem.mesh(np.nan), "max_error"),
        (lambda dem: dem.hillshade(altitude=91), "from 0 to 90"),
        (lambda dem: sandtable.Dem.from_array(np.zeros((2, 2)), (1, 2, 3)), "transform has 3 numbers"),
        (lambda dem: sandtable.Scene.open(ROAD).render(size=(5, 5)), "16 to 16384"),
        (lambda dem: sandtable.set_limit("nonsense", 1), "nonsense"),
    ],
)
def test_wrong_arguments_are_values_with_a_remedy(call, said):
    with pytest.raises(ValueError, match=said):
        call(sandtable.Dem.open(JACKSBORO))


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda dem: dem.viewshed((0, 0)), "the observer at 0,0"),
        (lambda dem: dem.viewshed((9e5, 4e6), crs=32616), "outside the elevation model"),
        (lambda dem: dem.line_of_sight((9e5, 4e6), (9e5, 4e6), crs=32616), "the observer at 900000,4000000"),
        (lambda dem: dem.profile([[-84.2, 36.3], [-84.2, 36.2]], step=0), "meters above 0"),
        (lambda dem: sandtable.Dem.from_array(np.zeros((2, 2)), (0, 0, 0, 0, 0, 0)), "no area"),
        (lambda dem: sandtable.Dem.from_array(np.zeros((0, 2)), (1, 0, 0, 0, -1, 0)), "at least one row"),
        (lambda dem: sandtable.Dem.from_array(np.full((3, 3), np.nan), (1, 0, 0, 0, -1, 0)).mesh(1), "no data at all"),
        (lambda dem: sandtable.Scene.open(ROAD).render("nobody"), "no view 'nobody'"),
    ],
)
def test_what_the_library_refuses_is_an_error_of_its_own(call, said):
    with pytest.raises(sandtable.SandtableError, match=said):
        call(sandtable.Dem.open(JACKSBORO))
