"""Runs tasks: by a client of distributed, or by the scheduler that dask is configured for."""

from __future__ import annotations

import contextlib
import os
import sys
import uuid
from typing import Any, Callable, List, Optional, Sequence, Tuple

from .imported import dask, module
from .watch import Watch


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
    """`client`: of distributed; without one dask's own scheduler runs the tasks. `progress`: show distributed's bar, or dask's. `timeout`: of a
    cluster without workers, in seconds."""

    def __init__(self, client: Optional[Any], progress: bool, timeout: float = 300.0):
        self.client = client if client is not None else default_client()
        self._progress, self._timeout = progress, timeout

    def run(
        self, name: str, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]], ended: Optional[Callable[[int], None]] = None
    ) -> List[Any]:
        """The results of function(*call) for each call. Tasks are named delaunayd-NAME. The first error is raised, and what has not
        begun is cancelled. ended(i) is called when the result of call i is here, so that its task is never run again; beside the bar of
        distributed, when all calls have ended."""
        if len(calls) == 0:
            return []
        if self.client is None:
            return self._by_dask(_tasks(name, function, calls), ended)
        return self._by_client(self.client.map(function, *zip(*calls), key=_keys(name, len(calls)), pure=False), ended)

    def run_blocks(self, name: str, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]]) -> List[Any]:
        """The same for calls some of whose arguments are delayed values of dask."""
        tasks = _tasks(name, function, calls)
        return self._by_dask(tasks, None) if self.client is None else self._by_client(self.client.compute(tasks), None)

    def _by_dask(self, tasks: List[Any], ended: Optional[Callable[[int], None]]) -> List[Any]:
        numbers = {task.key: i for i, task in enumerate(tasks)}

        def after(key: Any, *_: Any) -> None:
            if ended is not None and key in numbers:
                ended(numbers[key])

        bar = module("dask.diagnostics", "the bar").ProgressBar() if self._progress else contextlib.nullcontext()
        with bar, dask.callbacks.Callback(posttask=after):
            return list(dask.compute(*tasks))

    def _by_client(self, futures: List[Any], ended: Optional[Callable[[int], None]]) -> List[Any]:
        assert self.client is not None
        distributed = module("distributed", "tasks")
        found: List[Any] = [None] * len(futures)
        numbers = {future.key: i for i, future in enumerate(futures)}
        try:
            with Watch(self.client, self._timeout, futures):
                if self._progress:
                    distributed.progress(futures, notebook=False)
                for future, result in distributed.as_completed(futures, loop=self.client.loop, with_results=True):
                    if future.cancelled():
                        raise RuntimeError("the tasks were cancelled")
                    found[numbers[future.key]] = result
                    future.release()
                    if ended is not None:
                        ended(numbers[future.key])
            return found
        except distributed.scheduler.KilledWorker as error:
            self.client.cancel(futures)
            raise RuntimeError(
                "workers have died while they ran %s, perhaps because their memory does not suffice: use a smaller tile" % error.task
            ) from error
        except BaseException:
            self.client.cancel(futures)
            raise

    def memory(self) -> Tuple[int, int]:
        """The bytes of memory that each thread of a worker may use, the least of all workers, and the number of threads."""
        if self.client is not None:
            with Watch(self.client, self._timeout) as watch:
                workers = watch.wait()
            limits = [(w["memory_limit"] or _of_machine()) // w["nthreads"] for w in workers]
            return min(limits), sum(w["nthreads"] for w in workers)
        threads = dask.config.get("num_workers", None) or len(os.sched_getaffinity(0))
        return _of_machine() // threads, threads


def _keys(name: str, n: int) -> List[str]:
    """Names of tasks, all different."""
    mark = uuid.uuid4().hex[:8]
    return ["delaunayd-%s-%s-%d" % (name, mark, i) for i in range(n)]


def _tasks(name: str, function: Callable[..., Any], calls: Sequence[Tuple[Any, ...]]) -> List[Any]:
    return [dask.delayed(function)(*call, dask_key_name=key) for call, key in zip(calls, _keys(name, len(calls)))]


def _of_machine() -> int:
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
