"""Pages as Markdown templates (Jinja) beside their modules: the prose is there, its numbers come from facts.

A template computes what it says from the facts ``f`` and from the functions that its module hands over. Lines
of a paragraph may be broken anywhere: `unwrapped` joins them. A sentence that holds a number or a verdict
stands in a block or a macro, by whose name it can be said alone, of other facts.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template

Facts = Mapping[Any, Any]  # by name: numbers, words, tuples of numbers; None where there is none


def percent(share: float, digits: int = 2) -> str:
    """A share in per cent."""
    return f"{100.0 * share:.{digits}f} %"


def significant(value: float) -> str:
    """Two significant digits, all digits of larger numbers; nothing where there is no value."""
    return "" if math.isnan(value) else f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"


FILTERS = {
    "format": format,  # x|format(".2f") is Python's format(x, ".2f")
    "percent": percent,
    "significant": significant,
}
FUNCTIONS: tuple[Callable[..., Any], ...] = (abs, max, min, zip)


def template(file: Path, functions: Iterable[Callable[..., Any]] = ()) -> Template:
    """The template of a file, with functions by their names; what it names and nobody gives is an error."""
    environment = Environment(
        loader=FileSystemLoader(file.parent), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= FILTERS
    environment.globals |= {each.__name__: each for each in (*FUNCTIONS, *functions)}
    return environment.get_template(file.name)


def page(source: Template, **values: Any) -> str:
    """The page of a template as Markdown."""
    return unwrapped(source.render(values)) + "\n"


def statement(source: Template, name: str, facts: Facts) -> str:
    """What one block of a page says of the facts."""
    return unwrapped("".join(source.blocks[name](source.new_context({"f": facts}))))


def unwrapped(text: str) -> str:
    """Markdown with each paragraph and each item of a list in one line."""
    text = re.sub(r"\n{3,}", "\n\n", text.strip())
    return re.sub(r"(?<![\n|])\n *(?![\n|#]|- |\d+\. )", " ", text)
