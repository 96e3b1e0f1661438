"""Worker processes that need nothing of the script which starts them: no file, no guard of its last lines."""

import signal
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from coilspring.errors import require_integer
from coilspring.solver.interrupt import signals_blocked, signals_noted

WORKERS = (0, 1000)  # processes that can be asked for
ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")  # each, for linear algebra


def require_workers(workers: object) -> int | None:
    """A number of worker processes, or None; `InputError` for any other."""
    return workers if workers is None else require_integer("workers", workers, *WORKERS)


@contextmanager
def processes(count: int) -> Iterator[Executor]:
    """A pool of processes of this machine, ended at once where the block is left by an exception.

    Interrupts are for this process, which ends its workers.
    """
    pool = None
    try:
        # while modules are imported an exception may be lost, and a pool that is half started cannot be ended
        with signals_noted():
            pool = _pool(count)
            with signals_blocked([signal.SIGINT]):
                pool.submit(int)  # all workers start
        yield pool
    except BaseException:
        if pool is not None:
            pool.shutdown(kill_workers=True)
        raise
    pool.shutdown()


def _pool(count: int) -> Any:  # untyped
    from multiprocessing import resource_tracker

    from loky import ProcessPoolExecutor  # those of the standard library import the script again

    environment = dict.fromkeys(ONE_THREAD, "1")
    pool = ProcessPoolExecutor(count, initializer=_ignore_interrupts, env=environment)
    resource_tracker.ensure_running()  # up to Python 3.13 it unblocks interrupts as it starts
    return pool


def _ignore_interrupts() -> None:
    """Where they cannot be blocked."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
