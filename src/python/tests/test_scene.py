"""Scenes: the pixels of `sandtable render`, and the findings of `sandtable check`."""

import json

import numpy as np
import pytest
import sandtable
from conftest import ROAD, ROOT
from PIL import Image


@pytest.fixture(scope="module")
def scene():
    return sandtable.Scene.open(ROAD)


def test_a_picture_has_the_pixels_of_the_program(program, scene, tmp_path):
    assert len(scene.cameras) > 0
    for camera in scene.cameras[:2]:
        out = tmp_path / f"{camera}.png"
        program("render", ROAD, "--camera", camera, "--size", "240x160", "-o", out)
        picture = scene.render(camera, size=(240, 160))
        assert picture.shape == (160, 240, 3) and picture.dtype == np.uint8
        np.testing.assert_array_equal(picture, np.asarray(Image.open(out)))
    np.testing.assert_array_equal(scene.render(size=(64, 48)), scene.render(scene.cameras[0], (64, 48)))


def test_findings_are_those_of_a_check(program):
    path = ROOT / "scenes/jacksboro.toml"
    said = json.loads(program("check", path, "--json"))["findings"]
    found = sandtable.Scene.open(path).findings
    keys = ["code", "severity", "message", "help", "file", "line", "column"]
    assert [{key: getattr(finding, key) for key in keys} for finding in found] == [
        {key: finding[key] for key in keys} for finding in said
    ]
    assert len(found) > 0


def test_the_ground_of_a_scene_is_queried_as_the_program_does(program):
    dem, at = sandtable.Dem.open(ROAD), "750000,4018000"
    line = program("height", ROAD, "--at", at).splitlines()[1]
    assert repr(float(dem.heights([[750_000, 4_018_000]])[0])) == repr(float(line.split(",")[2]))
