"""Plans on a Dask cluster: the shards of ``sandtable plan``, done by the workers of a client.

>>> from dask.distributed import Client
>>> import sandtable.dask
>>> status = sandtable.dask.run("plan/", Client())
>>> status.output, status.failed

The workers share the folder of the plan and its inputs with each other and with the client, and have the package installed.
Dask decides where a shard runs and does it again where a worker is lost; what a shard is, when it is done and what belongs
together is the plan's, so that a run may be stopped, started again and mixed with workers that were started otherwise.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from distributed import Client, as_completed

from . import Plan

__all__ = ["PlanStatus", "run"]


@dataclass
class PlanStatus:
    """How far a plan is, as ``sandtable gather --json`` says it, and which shards failed in this run.

    Attributes
    ----------
    product : str
        What is made: "heights", "viewsheds", "atlas" or "tiles".
    shards, done : int
        How many there are, and how many are done.
    missing, stale : list of int
        The numbers of those without a record, and of those whose record is of another plan or other results.
    output : list of str
        The files of the product; empty where not all shards are done.
    failed : dict of int to str
        Why a shard failed in this run, by its number.
    """

    product: str
    shards: int
    done: int
    missing: list[int]
    stale: list[int]
    output: list[str]
    failed: dict[int, str] = field(default_factory=dict)


def run(
    plan: str | PathLike[str],
    client: Client,
    *,
    output: str | PathLike[str] | None = None,
    retries: int = 2,
    threads: int = 1,
    progress: Callable[[int, str], Any] | None = None,
) -> PlanStatus:
    """Does the shards of a plan that are not done, and gathers the product where all are.

    The largest shards start first. One that fails is tried ``retries`` times more, and so is one whose worker was lost; then it
    is named in ``failed`` while the others go on.

    Parameters
    ----------
    plan : path
        The folder that ``sandtable plan`` wrote; workers reach it by the same path.
    client : distributed.Client
        Whose workers do the shards.
    output : path, optional
        Where the product is written, as by ``gather -o``; by default in the folder of the plan.
    retries : int
        How often a shard is tried again.
    threads : int
        How many threads compute a shard. A worker of Dask does as many shards at once as it has threads, so 1 uses all.
    progress : callable, optional
        Called with the number of each shard as it ends, and "done", "skipped" or "failed".

    Returns
    -------
    PlanStatus

    Raises
    ------
    SandtableError
        The plan cannot be read, an input has changed since, or the product cannot be written.
    """
    folder = fspath(Path(plan).absolute())
    opened = Plan.open(folder)
    # What does not fit is said here once, not by every worker.
    opened.check_inputs()
    waiting = [shard for shard in _shards(folder) if not opened.is_done(shard["id"])]
    waiting.sort(key=lambda shard: (-shard["cost"], shard["id"]))
    numbers = {
        client.submit(_work, folder, shard["id"], threads, pure=False, retries=retries, priority=-rank): shard["id"]
        for rank, shard in enumerate(waiting)
    }
    failed = {}
    # distributed states no types of it.
    completed: Any = as_completed
    for future in completed(numbers):
        number = numbers.pop(future)
        if future.status == "finished":
            ended = future.result()
        else:
            ended, failed[number] = "failed", _reason(future)
        if progress is not None:
            progress(number, ended)
        future.release()
    return PlanStatus(**opened.gather(None if output is None else fspath(output)), failed=dict(sorted(failed.items())))


def _shards(folder: str) -> list[dict[str, Any]]:
    with (Path(folder) / "shards.jsonl").open(encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


def _reason(future: Any) -> str:
    error = future.exception()
    return str(error) or type(error).__name__


# The plans that this process has opened, with what their shards share; the latest last.
_OPENED: dict[tuple[str, int, int], Plan] = {}
_MOST_OPENED = 4


def _opened(folder: str) -> Plan:
    """The plan in a folder as this process has opened it; anew where it was planned again."""
    state = (Path(folder) / "plan.json").stat()
    key = (folder, state.st_mtime_ns, state.st_size)
    plan = _OPENED.get(key)
    if plan is None:
        for oldest in list(_OPENED)[: 1 - _MOST_OPENED]:
            _OPENED.pop(oldest, None)
        plan = _OPENED.setdefault(key, Plan.open(folder))
    return plan


def _work(folder: str, number: int, threads: int) -> str:
    """Does a shard, on a worker."""
    return _opened(folder).work(number, threads)
