"""Worker processes that need nothing of the script which starts them: no file, no guard of its last lines."""

import signal
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from coilspring.solver.interrupt import signals_noted

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")  # each, for linear algebra


@contextmanager
def processes(count: int) -> Iterator[Executor]:
    """A pool of processes of this machine, ended at once where the block is left by an exception."""
    from loky import ProcessPoolExecutor  # those of the standard library import the script again

    pool = ProcessPoolExecutor(count, initializer=_leave_interrupts, env=dict.fromkeys(ONE_THREAD, "1"))
    try:
        with signals_noted():  # a pool whose first task is broken off while it starts cannot be ended
            pool.submit(int)
        yield pool
    except BaseException:
        pool.shutdown(kill_workers=True)
        raise
    pool.shutdown()


def _leave_interrupts() -> None:
    """Ctrl-C is for the parent, which ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
