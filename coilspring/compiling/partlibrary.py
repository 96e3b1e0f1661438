"""Parts of kernels are kept as they are lowered; only a kernel is optimised and turned into machine code.

numba optimises and emits each function that another one calls, although the caller inlines it and is
optimised as a whole: half the time of compiling. numba has no option for that; what follows overrides its
code library.
"""

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


class _NoEnvironment:
    """Stands for the code generator where a part's environment would be set, which is for Python objects."""

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing to set: the part is not in memory."""


class _PartLibrary(JITCodeLibrary):
    codegen = _NoEnvironment()  # type: ignore[assignment]

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Address zero, numba's "not defined": nobody calls a part from outside."""
        self._ensure_finalized()
        return 0


class PartCompiler(Compiler):
    """numba's compiler, with a library that is only linked into others."""

    def __init__(self, typingctx: Any, targetctx: Any, library: Any, *rest: Any) -> None:
        super().__init__(typingctx, targetctx, _PartLibrary(targetctx.codegen(), "part"), *rest)
