"""Where a campaign's cases are judged: processes of this machine, or the workers of a Dask cluster."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context

from coilspring import InputError

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
PATIENCE = "10s"  # for a scheduler to answer


@contextmanager
def processes(workers: int) -> Iterator[tuple[Executor, int]]:
    """Processes of this machine, ended at once where the block is left by an exception."""
    others = set(active_children())
    # started afresh: a forked child of a process with threads may hang
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_leave_interrupts)
    with _single_threaded(), pool:
        try:
            yield pool, workers
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in set(active_children()) - others:
                child.terminate()
            raise


@contextmanager
def cluster(scheduler: str) -> Iterator[tuple[Executor, int]]:
    """Workers of the Dask cluster at an address, and how many threads they have.

    Raises
    ------
    InputError : Dask is not installed, nothing answers at the address, or the cluster has no workers.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise InputError(
            f"scheduler {scheduler!r} needs the package distributed: pip install 'coilcheck[dask]'"
        ) from None
    try:
        client = Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        words = f"scheduler must be the address of a Dask scheduler, as tcp://HOST:8786, got {scheduler!r}"
        raise InputError(f"{words}: {error or type(error).__name__}") from None
    with client:
        size = sum(client.nthreads().values())
        if size == 0:
            raise InputError(f"scheduler {scheduler!r} has no workers")
        pool = client.get_executor(pure=False)
        try:
            yield pool, size
        finally:  # after an exception there are cases left, which are cancelled
            pool.shutdown(wait=False)


def _leave_interrupts() -> None:
    """Ctrl-C is for the parent, which ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def _single_threaded() -> Iterator[None]:
    """Children that start meanwhile use one thread each for linear algebra."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name)
            else:
                os.environ[name] = value
