"""What a Dask cluster of one and of two worker processes makes of a plan, and what it adds to a shard.

usage: python src/python/bench/shards.py PLAN, whose shards are all done anew, by one worker and by two
"""

import os
import shutil
import sys
import time
from pathlib import Path

import sandtable
import sandtable.dask
from distributed import Client, LocalCluster


def timed(plan: Path, workers: int) -> tuple[float, float]:
    """Seconds of a run from nothing, without starting the cluster and without gathering, and of handling a shard that is done."""
    options = {"n_workers": workers, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with LocalCluster(**options) as cluster, Client(cluster) as client:
        # Every worker has imported the package and opened the plan.
        client.run(sandtable.dask._work, os.fspath(plan), 0, 1)
        shutil.rmtree(plan / "shards")
        start = time.perf_counter()
        last = start

        def ended(number, word):
            nonlocal last
            last = time.perf_counter()
            assert word == "done", (number, word)

        status = sandtable.dask.run(plan, client, progress=ended)
        assert not status.failed
        count = status.shards
        begin = time.perf_counter()
        futures = [client.submit(sandtable.dask._work, os.fspath(plan), n % count, 1, pure=False) for n in range(1000)]
        client.gather(futures)
        return last - start, (time.perf_counter() - begin) / 1000


def main():
    plan = Path(sys.argv[1]).absolute()
    seconds = {}
    for workers in (1, 2):
        seconds[workers], overhead = timed(plan, workers)
        print(f"{workers} workers: {seconds[workers]:.2f} s, a shard that is done {overhead * 1e3:.2f} ms")
    print(f"efficiency from 1 to 2 workers: {seconds[1] / (2 * seconds[2]):.2f}")
    print(f"load {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores, {len(sandtable.Plan.open(plan))} shards")


if __name__ == "__main__":
    main()
