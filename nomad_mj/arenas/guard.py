"""Look into an MJCF file before the engine does, which could take minutes or all memory."""

import math
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from nomad_mj.errors import ModelError

LARGEST = 20_000_000
"""Bytes of a file."""

MOST = 5_000
"""Copies that `replicate`, `composite` or `flexcomp` may make, also of each other's."""

_MOST_POINTS = 4096 * 4096  # of a height field or a texture


def check_file(kind: str, path: Path) -> None:
    """Make sure that the engine can read a file and what it includes without taking for ever.

    Anything else that is wrong with it is left to the engine, which says it better.

    Parameters
    ----------
    kind : str
        "room" or "robot", for errors.
    path : Path
        The file.

    Raises
    ------
    ModelError
        A file that is too large or includes what is no file, or an element that asks for too much.
    """
    what = f"{kind} file {str(path)!r}"
    todo, seen = [path], {path}
    while todo:
        file = todo.pop()
        if not file.is_file():  # the engine would wait for a pipe
            raise ModelError(f"{what} includes {str(file)!r}, where there is no file")
        if file.stat().st_size > LARGEST:
            raise ModelError(f"{what}: more than {LARGEST // 1_000_000} MB in {str(file)!r}")
        text = file.read_bytes()
        try:
            text.decode()
            root = ElementTree.fromstring(text)
        except UnicodeDecodeError:
            raise ModelError(f"{what}: {str(file)!r} is not UTF-8 text") from None
        except (ElementTree.ParseError, ValueError):
            continue
        for name in _check(root, what):
            included = path.parent / name  # all are relative to the first file
            if included not in seen:
                seen.add(included)
                todo.append(included)


def _check(root: ElementTree.Element, what: str) -> Iterator[str]:
    """Check an element and all in it, and yield the files that are included in them."""
    todo = [(root, 1)]
    while todo:
        element, copies = todo.pop()
        kind = element.tag
        if kind == "include":
            yield element.get("file", "")
        if kind in ("replicate", "composite", "flexcomp"):
            copies *= _product(element.get("count", "1"))
            if copies > MOST:
                raise ModelError(f"{what}: <{kind}> makes {copies} copies; at most {MOST}")
        for given, sides in (("hfield", ("nrow", "ncol")), ("texture", ("width", "height"))):
            if kind == given:
                points = _product(" ".join(element.get(side, "1") for side in sides))
                if points > _MOST_POINTS:
                    raise ModelError(f"{what}: <{kind}> has {points} points; at most 16 million")
        todo += [(child, copies) for child in element]


def _product(numbers: str) -> int:
    """Return the product of whole numbers in a text; 1 if it holds anything else."""
    try:
        return math.prod(max(1, int(number)) for number in numbers.split())
    except ValueError:
        return 1
