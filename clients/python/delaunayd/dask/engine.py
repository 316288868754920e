"""Runs tasks: by a client of distributed, or by the scheduler that dask is configured for."""

from __future__ import annotations

import os
import sys
import uuid
from typing import Any, Callable, List, Optional, Sequence, Tuple

from .imported import dask, module


def default_client() -> Optional[Any]:
    """The client of distributed that this process uses, if any."""
    distributed = sys.modules.get("distributed")
    if distributed is None:
        return None
    try:
        return distributed.default_client()
    except ValueError:
        return None


class Engine:
    """`client`: of distributed; without one dask's own scheduler runs the tasks. `progress`: show distributed's bar, or dask's."""

    def __init__(self, client: Optional[Any], progress: bool):
        self.client = client if client is not None else default_client()
        self._progress = progress

    def run(
        self, name: str, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]], ended: Optional[Callable[[int], None]] = None
    ) -> List[Any]:
        """The results of function(*call) for each call. Tasks are named delaunayd-NAME. The first error is raised, and what has not
        begun is cancelled. ended(i) is called when the result of call i is here, so that its task is never run again.
        Without a client of distributed, and beside its bar, this is when all calls have ended."""
        if len(calls) == 0:
            return []
        mark = uuid.uuid4().hex[:8]
        keys = ["delaunayd-%s-%s-%d" % (name, mark, i) for i in range(len(calls))]
        if self.client is not None:
            return self._by_client(function, calls, keys, ended)
        results = self._by_dask(function, calls, keys)
        if ended is not None:
            for i in range(len(calls)):
                ended(i)
        return results

    def _by_client(
        self, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]], keys: List[str], ended: Optional[Callable[[int], None]]
    ) -> List[Any]:
        assert self.client is not None
        futures = self.client.map(function, *zip(*calls), key=keys, pure=False)
        try:
            if self._progress:
                module("distributed", "the bar").progress(futures, notebook=False)
            if ended is None:
                results: List[Any] = self.client.gather(futures)
                return results
            found: List[Any] = [None] * len(calls)
            numbers = {key: i for i, key in enumerate(keys)}
            for future, result in module("distributed", "tasks").as_completed(futures, loop=self.client.loop, with_results=True):
                found[numbers[future.key]] = result
                future.release()
                ended(numbers[future.key])
            return found
        except BaseException:
            self.client.cancel(futures)
            raise

    def _by_dask(self, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]], keys: List[str]) -> List[Any]:
        tasks = [dask.delayed(function)(*call, dask_key_name=key) for call, key in zip(calls, keys)]
        if not self._progress:
            return list(dask.compute(*tasks))
        with module("dask.diagnostics", "the bar").ProgressBar():
            return list(dask.compute(*tasks))

    def run_blocks(self, name: str, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]]) -> List[Any]:
        """The same for calls some of whose arguments are delayed values of dask."""
        tasks = [dask.delayed(function)(*call, dask_key_name="delaunayd-%s-%s" % (name, uuid.uuid4().hex)) for call in calls]
        if self.client is not None:
            results: List[Any] = self.client.gather(self.client.compute(tasks))
            return results
        return list(dask.compute(*tasks))

    def memory(self) -> Tuple[int, int]:
        """The bytes of memory that each thread of a worker may use, the least of all workers, and the number of threads."""
        if self.client is not None:
            workers = list(self.client.scheduler_info()["workers"].values())
            if len(workers) == 0:
                raise RuntimeError("the cluster has no workers")
            limits = [(w["memory_limit"] or _of_machine()) // w["nthreads"] for w in workers]
            return min(limits), sum(w["nthreads"] for w in workers)
        threads = dask.config.get("num_workers", None) or len(os.sched_getaffinity(0))
        return _of_machine() // threads, threads


def _of_machine() -> int:
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
