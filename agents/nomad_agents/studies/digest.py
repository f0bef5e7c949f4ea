"""What tells the content of a file from any other: of MJCF, with all files that it is made of."""

import hashlib
import re
from pathlib import Path

from nomad_mj.assets import find_robot, find_room
from nomad_mj.robots import find_sheet

_FILE = re.compile(rb"""\bfile\s*=\s*["']([^"']+)["']""")  # of <include>, <mesh>, <texture>, ...
_FOLDER = re.compile(rb"""\b(?:asset|mesh|texture)dir\s*=\s*["']([^"']+)["']""")


def digests(robot: str, room: str, *others: str) -> list[str]:
    """Return digests of the files of a room, of a robot and of other rooms, by name or path."""
    path = find_robot(robot)
    own = digest(path, find_sheet(path))
    return [digest(find_room(room)), own, *(digest(find_room(each)) for each in others)]


def digest(path: Path, beside: Path | None = None) -> str:
    """Return a digest of a file's content, of what it names if it is XML, and of one beside it."""
    told = hashlib.sha256()
    for part in [*_parts(path), *([beside] if beside else [])]:
        content = part.read_bytes()
        told.update(b"%d:" % len(content) + content)
    return told.hexdigest()


def _parts(path: Path) -> list[Path]:
    """Return a file and all that it names, each once, in the order in which they are named."""
    found, folders = [path], [path.parent]
    for part in found:
        content = part.read_bytes()
        if not content.lstrip().startswith(b"<"):
            continue
        # All names are from the folder of the first file, or from one that it names.
        folders += [path.parent / _name(each) for each in _FOLDER.findall(content)]
        for each in _FILE.findall(content):
            places = [folder / _name(each) for folder in folders]
            found += [p for p in places if p.is_file() and p not in found][:1]
    return found


def _name(given: bytes) -> str:
    return given.decode(errors="replace")
