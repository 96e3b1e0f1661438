"""An equilibrium path in one npz file: its scene as TOML, numbers as JSON, arrays as they are."""

import io
import json
import zipfile
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from coilspring.errors import InputError
from coilspring.scene.toml import scene_from_text, scene_text
from coilspring.words import shown

MODELS = ("equivbeam", "wirefe")  # packages with a function `path_shape`
OTHER_VERSION = "file must be a path saved by this version, got {!r}: solve it again"
READ_AGAIN = ("scene", "shape")  # what is kept as something else


def write_fields(fields: Mapping[str, Any], file: str | Path | BinaryIO) -> None:
    """Write the fields of a path to a file or a binary stream."""
    arrays = {name: value for name, value in fields.items() if isinstance(value, np.ndarray)}
    numbers = {name: value for name, value in fields.items() if name not in READ_AGAIN and name not in arrays}
    found = fields["options"].get("pairs_found", 0)  # the last pairs of a model that looks for more
    pairs = fields["shape"].pair_law.pairs
    kept = {
        "scene": _bytes(scene_text(fields["scene"])),
        "numbers": _bytes(json.dumps(numbers, default=np.generic.item)),
        "pairs_found": np.asarray(pairs, dtype=np.int64)[len(pairs) - found :],
    }
    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, **kept, **arrays)
    if isinstance(file, str | Path):
        Path(file).write_bytes(stream.getvalue())
    else:
        file.write(stream.getvalue())


def read_fields(file: str | Path | BinaryIO) -> dict[str, Any]:
    """Fields of a path from what `write_fields` has written; nothing is unpickled.

    Raises `InputError`: no such file, or one that is no path.
    """
    if not (isinstance(file, str | Path) or hasattr(file, "read")):
        raise InputError(f"file must be a path of the disk or a binary stream, got {shown(file)}")
    try:
        stream = io.BytesIO(Path(file).read_bytes() if isinstance(file, str | Path) else file.read())
        if not zipfile.is_zipfile(stream):  # numpy would speak of pickled objects
            raise zipfile.BadZipFile("it is no archive")
        with np.load(stream, allow_pickle=False) as entries:
            arrays = {name: _aligned(entries[name]) for name in entries.files}
        scene = scene_from_text(arrays.pop("scene").tobytes().decode())
        numbers = json.loads(arrays.pop("numbers").tobytes(), object_hook=_with_tuples)
        found = arrays.pop("pairs_found")
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(f"file must be a saved path, got {str(file)!r} ({error})") from None
    if not numbers.keys() >= {"model", "options"}:
        raise InputError(OTHER_VERSION.format(str(file)))
    if numbers["model"] not in MODELS:
        raise InputError(f"the model of a path must be one of {', '.join(MODELS)}, got {numbers['model']!r}")
    shape = import_module(numbers["model"]).path_shape(scene, numbers["options"], found)
    known = shape.histories(None, arrays["states"])  # of this version's pairs, in its words
    histories = arrays.get("histories", known)  # of traced paths none
    other_pairs = histories.dtype != known.dtype or histories.shape != known.shape
    if other_pairs or "least_gaps" not in arrays:
        raise InputError(OTHER_VERSION.format(str(file)))
    return {"scene": scene, "shape": shape, **numbers, **arrays}


def _bytes(text: str) -> np.ndarray:
    return np.frombuffer(text.encode(), dtype=np.uint8)


def _aligned(array: np.ndarray) -> np.ndarray:
    """An array as it was written: of records, the file does not tell that they are aligned."""
    if array.dtype.names is None:
        return array
    return array.view(np.dtype([(name, array.dtype[name]) for name in array.dtype.names], align=True))


def _with_tuples(table: dict[str, Any]) -> dict[str, Any]:
    """JSON knows lists alone; a path has tuples."""
    return {key: tuple(value) if isinstance(value, list) else value for key, value in table.items()}
