"""Bring the tables of a document up to date with what was measured.

    python scripts/update_results.py renders docs/reproduction.md
    python scripts/update_results.py renders docs/benchmark.md

By `nomad-mj reproduce`, with its output in the folder that is named first:
A table stands between the lines ``<!-- table EXPERIMENT CONFIG -->`` and ``<!-- end -->``, that of
all verdicts between ``<!-- verdicts CONFIG ... -->`` and ``<!-- end -->``.

By `nomad-mj benchmark`, with its output in that folder or in one FOLDER below: a table stands
between ``<!-- benchmark FOLDER TITLE -->``, FOLDER ``.`` if there is none below, and
``<!-- end -->``.
"""

import re
import sys
from pathlib import Path

_PLACE = re.compile(r"(<!-- table (\S+) (\S+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
_VERDICTS = re.compile(r"(<!-- verdicts ([^>]+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
_VERDICT = re.compile(r"^\*\*(.*)\*\*: ", re.MULTILINE)
_BENCHMARK = re.compile(r"(<!-- benchmark (\S+) ([^>]+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
_TABLE = re.compile(r"^## ([^\n]+)\n\n(.*?)(?=^## |\Z)", re.DOTALL | re.MULTILINE)
_PARTIAL = re.compile(r"\(\d+ of \d+ runs so far\)")
_PART = re.compile(r"^## (\S+): .*?(?=^## |\Z)", re.DOTALL | re.MULTILINE)


def measured(folder: Path, config: str) -> dict[str, str]:
    """Return command, table and verdict of each experiment that a folder of results holds."""
    path = folder / "reproduce" / config / "tables.md"
    if not path.exists():
        return {}
    parts = {match[1]: match[0] for match in _PART.finditer(path.read_text(encoding="utf-8"))}
    for name in [name for name, part in parts.items() if _PARTIAL.search(part)]:
        print(f"{name}, {config}: not all runs are there; its table stays as it was")
        del parts[name]
    # The document has headings and claims of its own.
    return {name: part[part.index("`nomad-mj") :].rstrip() + "\n" for name, part in parts.items()}


def update(text: str, folder: Path) -> str:
    """Return a document with its tables replaced by those that were measured, where there are."""

    def replace(match: re.Match[str]) -> str:
        found = measured(folder, match[3]).get(match[2])
        return f"{match[1]}{found or match[4]}{match[5]}"

    def judge(match: re.Match[str]) -> str:
        found = _verdicts(folder, match[2].split())
        return f"{match[1]}{found or match[3]}{match[4]}"

    def compare(match: re.Match[str]) -> str:
        found = _compared(folder / match[2]).get(match[3])
        return f"{match[1]}{found or match[4]}{match[5]}"

    return _BENCHMARK.sub(compare, _VERDICTS.sub(judge, _PLACE.sub(replace, text)))


def _compared(folder: Path) -> dict[str, str]:
    """Return the tables of a benchmark by their titles."""
    path = folder / "benchmark" / "tables.md"
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return {match[1]: match[2].rstrip() + "\n" for match in _TABLE.finditer(text)}


def _verdicts(folder: Path, configs: list[str]) -> str:
    """Return the table of the verdicts that there are under each configuration."""
    held = {config: measured(folder, config) for config in configs}
    names = dict.fromkeys(name for parts in held.values() for name in parts)
    if not names:
        return ""
    rows = [["", *configs], ["---"] * (len(configs) + 1)]
    for name in names:
        verdicts = (_VERDICT.search(parts.get(name, "")) for parts in held.values())
        rows.append([name, *(verdict[1] if verdict else "" for verdict in verdicts)])
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


if __name__ == "__main__":
    source, document = Path(sys.argv[1]), Path(sys.argv[2])
    document.write_text(update(document.read_text(encoding="utf-8"), source), encoding="utf-8")
