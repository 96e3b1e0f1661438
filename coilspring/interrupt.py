"""Compiled work that Ctrl-C can stop."""

from __future__ import annotations

from collections.abc import Callable
from multiprocessing import parent_process
from threading import Thread
from typing import Any

import numpy as np


def interruptible(function: Callable, *arguments: object) -> Any:
    """Call a compiled function that releases the interpreter, in a thread, and wait for it.

    Its last argument is a flag (one integer) which it looks at between substeps. A signal that came
    while compiled code ran in the main thread would be raised inside the conversion of its results,
    which numba does not survive; in the waiting main thread it sets the flag and is raised in order.
    """
    flag = np.zeros(1, dtype=np.int64)
    if parent_process() is not None:
        return function(*arguments, flag)  # a worker: its parent is interrupted
    results: list[Any] = []
    errors: list[BaseException] = []

    def work() -> None:
        try:
            results.append(function(*arguments, flag))
        except BaseException as error:
            errors.append(error)

    thread = Thread(target=work, name="coilspring")
    thread.start()
    try:
        thread.join()
    except BaseException:
        flag[0] = 1
        thread.join()
        raise
    if errors:
        raise errors[0]
    return results[0]
