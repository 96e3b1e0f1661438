"""Worker processes that need nothing of the script which starts them: no file, no guard of its last lines."""

import signal
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any

from coilspring.solver.interrupt import signals_noted

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")  # each, for linear algebra


@contextmanager
def processes(count: int) -> Iterator[Executor]:
    """A pool of processes of this machine, ended at once where the block is left by an exception.

    Interrupts are for this process, which ends its workers.
    """
    pool = None
    try:
        # while modules are imported an exception may be lost, and a pool that is half started cannot be ended
        with signals_noted(), _interrupts_blocked():
            pool = _started(count)
        yield pool
    except BaseException:
        if pool is not None:
            pool.shutdown(kill_workers=True)
        raise
    pool.shutdown()


def _started(count: int) -> Any:  # untyped
    from loky import ProcessPoolExecutor  # those of the standard library import the script again

    environment = dict.fromkeys(ONE_THREAD, "1")
    pool = ProcessPoolExecutor(count, initializer=_ignore_interrupts, env=environment)
    pool.submit(int)  # all workers start
    return pool


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Processes that start meanwhile have interrupts blocked from their first moment, where a system can."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # it starts with the first process, and unblocks
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _ignore_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
