"""A law's energy rewritten for jets, so that one evaluation gives its derivatives too.

The syntax tree of the function is walked once. An expression that depends on l, v or dtheta is *active*: its
operations become calls of `equivbeam.laws.jets`. All others stay plain arithmetic. Functions of the law's own
file that are called are rewritten likewise, once for each pattern of active arguments.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import math
import textwrap
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.errors import InputError
from equivbeam.laws import jets

JETS = "_jets_"  # before the names of their functions in rewritten code
OPERATORS = {ast.Add: "add", ast.Sub: "subtract", ast.Mult: "multiply", ast.Div: "divide"}
SIMPLE = (ast.Pass, ast.Break, ast.Continue)
PASSIVE = (
    np.sign,
    round,
    int,
    float,
    bool,
    range,
    len,
    np.floor,
    math.floor,
    np.ceil,
    math.ceil,
    np.isfinite,
)
ALLOWED = "a law is plain arithmetic, elementary functions of numpy and math, branches and loops over a range"


def differentiated(function: Callable, law: str, digest: str, active: tuple[bool, ...]) -> Callable:
    """The function for jets in place of the numbers marked active, a part of kernels.

    Parameters
    ----------
    function : plain Python.
    law : its name for messages.
    digest : of its content, a part of the names of what is compiled: compiled code of two laws that came from
        the disk must not be mistaken for each other.
    active : of each argument, whether it is a jet.

    Raises
    ------
    InputError : what cannot be differentiated, with its line.
    """
    return _Family(law, digest).member(function, active)


class _Family:
    """The rewritten functions of a law, by function and pattern of active arguments."""

    def __init__(self, law: str, digest: str) -> None:
        self.law, self.digest = law, digest
        self._made: dict[tuple[Callable, tuple[bool, ...]], Callable] = {}
        self._open: list[tuple[Callable, tuple[bool, ...]]] = []

    def member(self, function: Callable, active: tuple[bool, ...]) -> Callable:
        """A function for a pattern, rewritten when it is first asked for."""
        place = (function, active)
        if place in self._open:
            raise InputError(f"law {self.law}: {function.__name__} must not call itself")
        if place not in self._made:
            self._open.append(place)
            self._made[place] = self._rewritten(function, active)
            self._open.pop()
        return self._made[place]

    def _rewritten(self, function: Callable, active: tuple[bool, ...]) -> Callable:
        tree = self._definition(function)
        known = dict(function.__globals__)
        for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
            known[name] = cell.cell_contents
        known |= {JETS + name: getattr(jets, name) for name in vars(jets) if not name.startswith("_")}
        arguments = [argument.arg for argument in tree.args.args]
        if len(arguments) != len(active):
            raise InputError(
                f"law {self.law}: {function.__name__} must be called with all its {len(arguments)} "
                f"arguments, in their order, got {len(active)}"
            )
        begun = {name for name, is_active in zip(arguments, active, strict=True) if is_active}
        name = f"{tree.name}_{''.join('x' if is_active else '_' for is_active in active)}_{self.digest}"
        body = _Rewriter(self, known, begun).body(tree.body)
        made = ast.FunctionDef(name, tree.args, body, decorator_list=[], returns=None, type_params=[])
        for argument in made.args.args:
            argument.annotation = None
        module = ast.fix_missing_locations(ast.Module([made], []))
        exec(compile(module, function.__code__.co_filename, "exec"), known)
        known[name].__module__ = __name__  # numba wants one that can be imported
        return part(known[name])

    def _definition(self, function: Callable) -> ast.FunctionDef:
        """Syntax tree of a function, with the line numbers of its file."""
        if not isinstance(function, FunctionType) or function.__name__ == "<lambda>":
            raise InputError(f"law {self.law}: {function!r} must be a function defined by def")
        try:
            lines, first = inspect.getsourcelines(function)
            tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
        except (OSError, SyntaxError):
            tree, first = None, 0
        if not isinstance(tree, ast.FunctionDef) or tree.name != function.__name__:
            raise InputError(f"law {self.law}: the source of {function.__name__} must be in a file")
        ast.increment_lineno(tree, first - 1)
        others = (tree.args.vararg, tree.args.kwarg, *tree.args.kwonlyargs, *tree.args.posonlyargs)
        if any(others) or tree.args.defaults:
            raise InputError(
                f"law {self.law}: {function.__name__} must have plain arguments without defaults"
            )
        return tree


class _Rewriter:
    """Rewrites the body of one function."""

    def __init__(self, family: _Family, known: dict[str, Any], begun: set[str]) -> None:
        self._family = family
        self._known = known
        self._active = begun
        self._lifts = bool(begun)

    def body(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        """The statements rewritten, once it is settled which names are active."""
        before = -1
        while len(self._active) > before:
            before = len(self._active)
            for node in statements:
                self._spread(node)
        return [made for node in statements for made in self._statement(node)]

    def _spread(self, node: ast.stmt) -> None:
        """Mark the names as active to which something active is assigned."""
        for each in ast.walk(node):
            if isinstance(each, ast.Assign) and len(each.targets) == 1:
                self._assign(each.targets[0], each.value)
            elif isinstance(each, ast.AugAssign | ast.AnnAssign) and each.value is not None:
                self._assign(each.target, each.value)

    def _assign(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for one, other in zip(target.elts, value.elts, strict=False):
                self._assign(one, other)
        elif self._is_active(value):
            self._active |= {each.id for each in ast.walk(target) if isinstance(each, ast.Name)}

    def _is_active(self, node: ast.AST) -> bool:
        """Whether a value depends on the variables."""
        if isinstance(node, ast.Name):
            return node.id in self._active
        if isinstance(node, ast.Compare | ast.BoolOp) or (
            isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
        ):
            return False
        if isinstance(node, ast.IfExp):
            return self._is_active(node.body) or self._is_active(node.orelse)
        if isinstance(node, ast.Call):
            called = self._called(node.func)
            if called is np.where:
                return any(map(self._is_active, node.args[1:]))
            return called not in PASSIVE and any(map(self._is_active, node.args))
        return any(map(self._is_active, ast.iter_child_nodes(node)))

    def _refuse(self, node: ast.AST, what: str) -> InputError:
        line = getattr(node, "lineno", 0)
        return InputError(f"law {self._family.law}: line {line}: {what}: {ALLOWED}")

    def _statement(self, node: ast.stmt) -> list[ast.stmt]:
        """A statement rewritten; a docstring goes."""
        if isinstance(node, SIMPLE):
            return [node]
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            return []
        made: ast.stmt | None = None
        if isinstance(node, ast.Return) and node.value is not None:
            made = ast.Return(self._result(node.value))
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            made = self._assignment(node, node.target, node.value)
        elif isinstance(node, ast.Assign) and len(node.targets) == 1:
            made = self._assignment(node, node.targets[0], node.value)
        elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
            read = ast.copy_location(ast.Name(node.target.id, ast.Load()), node)
            value = ast.copy_location(ast.BinOp(read, node.op, node.value), node)
            made = self._assignment(node, node.target, value)
        elif isinstance(node, ast.If | ast.While):
            made = type(node)(self._plain(node.test), self._block(node.body), self._block(node.orelse))
        elif isinstance(node, ast.For) and isinstance(node.target, ast.Name) and not node.orelse:
            made = ast.For(node.target, self._plain(node.iter), self._block(node.body), [])
        if made is None:
            raise self._refuse(node, f"a statement {type(node).__name__!r} cannot be differentiated")
        return [ast.copy_location(made, node)]

    def _block(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        return [made for node in statements for made in self._statement(node)]

    def _assignment(self, node: ast.stmt, target: ast.expr, value: ast.expr) -> ast.stmt:
        """An assignment to names; to an active one a number is assigned as a jet."""
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        if not all(isinstance(name, ast.Name) for name in names):
            raise self._refuse(node, "only names can be assigned to")
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            pairs = zip(target.elts, value.elts, strict=False)
            elements = [self._as(self._is_active(one), other) for one, other in pairs]
            return ast.Assign([target], ast.copy_location(ast.Tuple(elements, ast.Load()), value))
        return ast.Assign([target], self._as(self._is_active(target), value))

    def _result(self, value: ast.expr) -> ast.expr:
        if isinstance(value, ast.Tuple):
            elements = [self._as(self._lifts, each) for each in value.elts]
            return ast.copy_location(ast.Tuple(elements, ast.Load()), value)
        return self._as(self._lifts, value)

    def _as(self, active: bool, node: ast.expr) -> ast.expr:
        """An expression as a jet, or as it is."""
        made = self._expression(node)
        return self._jets("constant", made) if active and not self._is_active(node) else made

    def _jets(self, name: str, *arguments: ast.expr) -> ast.expr:
        made = ast.Call(ast.Name(JETS + name, ast.Load()), list(arguments), [])
        return ast.copy_location(made, arguments[0])

    def _plain(self, node: ast.expr) -> ast.expr:
        """The value alone of an expression."""
        made = self._expression(node)
        return (
            ast.copy_location(ast.Attribute(made, "value", ast.Load()), node)
            if self._is_active(node)
            else made
        )

    def _expression(self, node: ast.expr) -> ast.expr:
        """An expression rewritten: where it is active it gives a jet."""
        made: ast.expr | None = None
        match node:
            case ast.Constant() | ast.Name():
                return node
            case ast.Compare():
                compared = [self._plain(each) for each in node.comparators]
                made = ast.Compare(self._plain(node.left), node.ops, compared)
            case ast.BoolOp():
                made = ast.BoolOp(node.op, [self._plain(each) for each in node.values])
            case ast.IfExp():
                made = self._choice(self._is_active(node), node.test, node.body, node.orelse)
            case ast.UnaryOp():
                made = self._unary(node)
            case ast.BinOp():
                made = self._binary(node)
            case ast.Call():
                made = self._call(node)
            case ast.Subscript():
                made = ast.Subscript(self._expression(node.value), self._plain_index(node.slice), node.ctx)
            case ast.Attribute() if not self._is_active(node):
                return node
            case ast.Tuple():
                made = ast.Tuple([self._expression(each) for each in node.elts], ast.Load())
        if made is None:
            raise self._refuse(node, f"an expression {type(node).__name__!r} cannot be differentiated")
        return ast.copy_location(made, node)

    def _plain_index(self, node: ast.expr) -> ast.expr:
        return node if isinstance(node, ast.Slice) else self._plain(node)

    def _choice(self, active: bool, test: ast.expr, one: ast.expr, other: ast.expr) -> ast.expr:
        return ast.IfExp(self._plain(test), self._as(active, one), self._as(active, other))

    def _unary(self, node: ast.UnaryOp) -> ast.expr:
        if isinstance(node.op, ast.USub) and self._is_active(node):
            return self._jets("negative", self._expression(node.operand))
        made = self._plain(node.operand) if isinstance(node.op, ast.Not) else self._expression(node.operand)
        return made if isinstance(node.op, ast.UAdd) else ast.UnaryOp(node.op, made)

    def _binary(self, node: ast.BinOp) -> ast.expr:
        if not self._is_active(node):
            return ast.BinOp(self._expression(node.left), node.op, self._expression(node.right))
        one, other = self._expression(node.left), self._expression(node.right)
        is_jet = self._is_active(node.left), self._is_active(node.right)
        if isinstance(node.op, ast.Pow):
            return self._power(node.left, node.right)
        if type(node.op) not in OPERATORS:
            raise self._refuse(node, f"operator {type(node.op).__name__!r} cannot be differentiated")
        if all(is_jet):
            return self._jets(OPERATORS[type(node.op)], one, other)
        jet, number = (one, other) if is_jet[0] else (other, one)
        match node.op:
            case ast.Add():
                return self._jets("shifted", jet, number)
            case ast.Sub():
                minus = ast.copy_location(ast.UnaryOp(ast.USub(), number), node)
                return self._jets(
                    "shifted", *((jet, minus) if is_jet[0] else (self._jets("negative", jet), number))
                )
            case ast.Div() if is_jet[0]:
                inverse = ast.BinOp(ast.copy_location(ast.Constant(1.0), node), ast.Div(), number)
                return self._jets("scaled", jet, ast.copy_location(inverse, node))
            case ast.Div():
                return self._jets("scaled", self._jets("reciprocal", jet), number)
        return self._jets("scaled", jet, number)

    def _power(self, base: ast.expr, exponent: ast.expr) -> ast.expr:
        """base ** exponent, of which one at least is active."""
        one = self._as(True, base)
        if self._is_active(exponent):
            return self._jets("raised", one, self._expression(exponent))
        if isinstance(exponent, ast.Constant) and exponent.value == 2:
            return self._jets("square", one)
        return self._jets("power", one, self._expression(exponent))

    def _call(self, node: ast.Call) -> ast.expr:
        called, active = self._called(node.func), tuple(map(self._is_active, node.args))
        if node.keywords or any(isinstance(each, ast.Starred) for each in node.args):
            raise self._refuse(node, "arguments must be given in their order")
        if called is np.where and len(node.args) == 3:
            return self._choice(any(active[1:]), *node.args)
        if isinstance(called, FunctionType) and not _is_foreign(called):
            made = self._family.member(called, active)
            self._known[made.__name__] = made
            function = ast.copy_location(ast.Name(made.__name__, ast.Load()), node)
            return ast.Call(function, [self._expression(each) for each in node.args], [])
        if not any(active) or called in PASSIVE:
            return ast.Call(node.func, [self._plain(each) for each in node.args], [])
        if called not in jets.FUNCTIONS:
            raise self._refuse(node, f"{ast.unparse(node.func)} has no derivative here")
        if called in (np.power, math.pow) and len(node.args) == 2:
            return self._power(*node.args)
        name, given = jets.FUNCTIONS[called].__name__, [self._as(True, each) for each in node.args]
        if called in (min, max) and len(given) > 2:
            for each in given[2:]:
                given[:2] = [self._jets(name, *given[:2]), each]
            given = given[:2]
        return self._jets(name, *given)

    def _called(self, node: ast.expr) -> Any:
        """The function that an expression names, as the law's file knows it."""
        if isinstance(node, ast.Name):
            if node.id in self._known:
                return self._known[node.id]
            if hasattr(builtins, node.id):
                return getattr(builtins, node.id)
        if isinstance(node, ast.Attribute):
            owner = self._called(node.value)
            if hasattr(owner, node.attr):
                return getattr(owner, node.attr)
        raise self._refuse(node, f"{ast.unparse(node)} is not known")


def _is_foreign(function: FunctionType) -> bool:
    """Whether a function is one of numpy's or Python's."""
    return (function.__module__ or "").partition(".")[0] in ("numpy", "math", "builtins")
