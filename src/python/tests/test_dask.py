"""Plans on a Dask cluster of processes: the files of the program, whatever fails meanwhile."""

import json
import os
import signal

import numpy as np
import pytest
import sandtable
from conftest import JACKSBORO

distributed = pytest.importorskip("distributed")
dask = pytest.importorskip("sandtable.dask")

SHARDS = 12


@pytest.fixture(scope="module")
def client():
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.fixture
def plan(program, tmp_path):
    """The folder of a plan for heights, and the bytes that the program prints for its points."""
    west, south, east, north = sandtable.Dem.open(JACKSBORO).bounds
    xy = np.random.default_rng(5).uniform((west, south), (east, north), (6000, 2))
    points = "".join(f"{x!r},{y!r}\n" for x, y in xy.tolist())
    (tmp_path / "points.csv").write_text(points)
    folder, given = tmp_path / "plan", ("--points", tmp_path / "points.csv")
    program("plan", "heights", JACKSBORO, *given, "--shards", SHARDS, "-o", folder)
    return folder, program("height", JACKSBORO, *given)


def shards(folder):
    return [json.loads(line) for line in (folder / "shards.jsonl").read_text().splitlines()]


def test_a_plan_is_done_once_and_its_product_has_the_bytes_of_the_program(client, plan):
    folder, expected = plan
    ended = []
    status = dask.run(folder, client, progress=lambda number, word: ended.append((number, word)))
    count = len(shards(folder))
    assert count > 1 and sorted(ended) == [(number, "done") for number in range(count)]
    assert (status.product, status.shards, status.done) == ("heights", count, count)
    assert status.missing == status.stale == [] and status.failed == {}
    assert [open(path).read() for path in status.output] == [expected]
    ended.clear()
    again = dask.run(folder, client, output=folder / "again.csv", progress=lambda *done: ended.append(done))
    assert ended == [] and again.done == count
    assert (folder / "again.csv").read_text() == expected


def test_a_poison_shard_is_named_while_the_others_are_done(client, plan):
    folder, expected = plan
    poison = shards(folder)[1]["points"]
    whole = (folder / "points.bin").read_bytes()
    at = 16 * poison["first"]
    (folder / "points.bin").write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
    status = dask.run(folder, client, retries=1)
    assert list(status.failed) == status.missing == [1] and status.output == []
    assert "points.bin" in status.failed[1]
    assert status.done == status.shards - 1
    (folder / "points.bin").write_bytes(whole)
    mended = dask.run(folder, client)
    assert mended.failed == {} and open(mended.output[0]).read() == expected


def test_a_worker_that_is_killed_costs_nothing_but_its_shards(client, program, tmp_path):
    (tmp_path / "observers.csv").write_text("".join(f"{749_000 + 200 * n},4018000\n" for n in range(24)))
    given = ("--points", tmp_path / "observers.csv", "--crs", "EPSG:32616", "--shards", 12)
    folders = [tmp_path / "by-program", tmp_path / "by-dask"]
    for folder in folders:
        program("plan", "viewsheds", JACKSBORO, *given, "-o", folder)
    count = len(shards(folders[0]))
    assert count >= 6
    program("work", folders[0], "--shards", f"0..{count}")
    program("gather", folders[0])
    pids, ended = client.run(os.getpid), []

    def kill_at_the_second(number, word):
        ended.append(number)
        if len(ended) == 2:
            os.kill(next(iter(pids.values())), signal.SIGKILL)

    status = dask.run(folders[1], client, progress=kill_at_the_second)
    assert status.failed == {} and status.done == count and sorted(ended) == list(range(count))
    assert [(folder / "viewsheds.tif").read_bytes() for folder in folders][0] == open(status.output[0], "rb").read()
    client.wait_for_workers(2)


def test_a_plan_whose_input_has_changed_is_refused(client, program, tmp_path):
    grid = tmp_path / "grid.asc"
    text = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5 6\n7 8 9\n"
    grid.write_text(text)
    (tmp_path / "points.csv").write_text("15,15\n5,5\n")
    folder = tmp_path / "plan"
    program("plan", "heights", grid, "--points", tmp_path / "points.csv", "-o", folder)
    grid.write_text(text.replace("5 6", "7 6"))
    with pytest.raises(sandtable.SandtableError, match="plan again") as raised:
        dask.run(folder, client)
    assert "grid.asc" in raised.value.file
    with pytest.raises(sandtable.SandtableError, match="no such file"):
        dask.run(tmp_path / "nothing", client)
