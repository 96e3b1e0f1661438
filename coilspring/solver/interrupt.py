"""Compiled work that Ctrl-C can stop."""

import mmap
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from multiprocessing import parent_process
from typing import Any

import numpy as np


@cache
def _mailbox(process: int) -> tuple[int, np.ndarray]:
    """A file that Python writes a byte to when a signal comes, and the same bytes as an integer in memory.

    One for each process: a child would share its parent's. Where it cannot be made, as on a full disk, there
    is no file, and signals wait for the end of the compiled work.
    """
    descriptor = -1
    try:
        descriptor, name = tempfile.mkstemp()
        with suppress(OSError):  # where open files cannot be removed, it stays
            os.unlink(name)
        os.write(descriptor, bytes(8))  # not a hole, for which there may be no room later
        memory = mmap.mmap(descriptor, 8)
    except (OSError, ValueError):  # the latter where a part of it was written
        if descriptor >= 0:
            os.close(descriptor)
        return -1, np.zeros(1, dtype=np.int64)
    os.set_blocking(descriptor, False)
    return descriptor, np.frombuffer(memory, dtype=np.int64)


SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGALRM") if hasattr(signal, name))


def interruptible(function: Callable, *arguments: object) -> Any:
    """Call a compiled function whose last argument is a flag (one integer) that ends it early where not 0.

    While compiled code runs, Python only notes a signal: the flag is the note. Its handler, as that of
    Ctrl-C, is called when the function has returned: one that raised amid the conversion of the results
    would be more than numba survives. After a handler that does not raise the call is made again.
    """
    if parent_process() is not None or not _gets_signals():
        return function(*arguments, np.zeros(1, dtype=np.int64))  # signals go elsewhere
    descriptor, flag = _mailbox(os.getpid())
    while True:
        if descriptor >= 0:
            os.lseek(descriptor, 0, os.SEEK_SET)
        flag[0] = 0
        with signals_noted(descriptor):
            result = function(*arguments, flag)
        if flag[0] == 0:
            return result


def _gets_signals() -> bool:
    return threading.current_thread() is threading.main_thread()


@contextmanager
def signals_noted(descriptor: int = -1) -> Iterator[None]:
    """Handlers of signals are called at the end; a signal writes to the file, if one is given."""
    if not _gets_signals():
        yield
        return
    came: list[int] = []
    handlers: dict[int, Callable] = {}
    before = signal.set_wakeup_fd(descriptor)
    try:
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if callable(handler):
                handlers[number] = handler
                signal.signal(number, lambda number, _: came.append(number))
        yield
    finally:
        with signals_blocked(SIGNALS):  # a handler that raises may not leave others as they are now
            for number, handler in handlers.items():
                signal.signal(number, handler)
            signal.set_wakeup_fd(before)
        for number in came:
            handlers[number](number, sys._getframe())


@contextmanager
def signals_blocked(numbers: Iterable[int]) -> Iterator[None]:
    """Signals come at the end, for this thread; those that start meanwhile, and processes, have them blocked.
    Not where a system knows nothing of it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
