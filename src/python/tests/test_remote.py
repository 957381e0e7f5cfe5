"""Elevation by address: from the hosts that are allowed, with the bits of the file on disk."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO, ROOT

XY = np.array([[-84.21, 36.28], [-84.20, 36.30]])


@pytest.fixture
def host(tmp_path, monkeypatch):
    """A web server of the elevation, at a port that no other test has allowed."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    command = [sys.executable, ROOT / "tests/tools/range_server.py", JACKSBORO.parent]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        yield server.stdout.readline().strip()
        server.stdin.close()


def test_an_address_gives_the_bits_of_the_file_on_disk(host):
    there = sandtable.Dem.open(f"http://{host}/dem.tif", allow_remote=[host])
    here = sandtable.Dem.open(JACKSBORO)
    heights = there.heights(XY, crs=4326)
    assert np.isfinite(heights).all()
    assert heights.tobytes() == here.heights(XY, crs=4326).tobytes()
    assert there.to_numpy().tobytes() == here.to_numpy().tobytes()


def test_an_elevation_model_takes_its_hosts_to_another_process(host):
    dem = sandtable.Dem.open(f"http://{host}/dem.tif", allow_remote=[host])
    program = "import pickle, sys; print(pickle.load(sys.stdin.buffer).to_numpy().sum())"
    ended = subprocess.run([sys.executable, "-c", program], input=pickle.dumps(dem), capture_output=True)
    assert ended.returncode == 0, ended.stderr.decode()
    assert ended.stdout.decode().strip() == str(dem.to_numpy().sum())


def test_a_scene_has_elevation_with_an_address(host, tmp_path):
    def picture(dem, **options):
        path = tmp_path / "scene.toml"
        path.write_text(f'title = "Far"\n[terrain]\ndem = "{dem}"\n[[camera]]\nname = "top"\n')
        return sandtable.Scene.open(path, allow=[ROOT], **options).render(size=(160, 90))

    address = f"http://{host}/dem.tif"
    with pytest.raises(sandtable.SandtableError, match="may not read from"):
        picture(address)
    assert picture(address, allow_remote=[host]).tobytes() == picture(JACKSBORO).tobytes()


def test_a_host_that_is_not_allowed_is_refused_with_the_remedy(host):
    with pytest.raises(sandtable.SandtableError) as raised:
        sandtable.Dem.open(f"http://{host}/dem.tif")
    assert f'allow_remote=["{host}"]' in str(raised.value)
    # Of other hosts nothing follows.
    with pytest.raises(sandtable.SandtableError, match="may not read from"):
        sandtable.Dem.open(f"http://{host}/dem.tif", allow_remote=["example.org"])


@pytest.mark.parametrize("hosts, error", [(["https://example.org"], ValueError), ("example.org", TypeError)])
def test_hosts_are_a_list_of_names(hosts, error):
    with pytest.raises(error):
        sandtable.Dem.open(JACKSBORO, allow_remote=hosts)
