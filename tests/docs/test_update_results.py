"""Tables of documents are those that were measured."""

import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "update_results.py"
TABLES = """## fig6: Learning

It learns. (section 4)

`nomad-mj reproduce fig6 --seeds 2 --config faithful`

|  | paper |
|---|---:|
| reactions | 1424 |

**holds**: it does.

## fig7: Actions

Claim.

`nomad-mj reproduce fig7`

| x |
|---|

**does not hold**: no.
"""
PAGE = """# A page
<!-- table fig6 faithful -->
stale
<!-- end -->
between
<!-- table fig6 tuned -->
kept
<!-- end -->
<!-- table fig99 faithful -->
kept too
<!-- end -->
<!-- verdicts faithful tuned -->
<!-- end -->
"""


def test_tables_are_put_in_their_places_and_the_rest_is_kept(tmp_path: Path) -> None:
    folder = tmp_path / "reproduce" / "faithful"
    folder.mkdir(parents=True)
    (folder / "tables.md").write_text(TABLES)
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    for _ in range(2):  # doing it again changes nothing
        subprocess.run([sys.executable, str(SCRIPT), str(tmp_path), str(page)], check=True)
        text = page.read_text()
        assert "| reactions | 1424 |\n\n**holds**: it does.\n<!-- end -->\nbetween" in text
        assert "stale" not in text and "It learns" not in text
        assert text.count("kept") == 2 and text.count("<!-- end -->") == 4
        verdicts = "|  | faithful | tuned |\n| --- | --- | --- |\n| fig6 | holds |  |\n"
        verdicts += "| fig7 | does not hold |  |\n"
        assert verdicts in text


def test_tables_of_a_benchmark_too(tmp_path: Path) -> None:
    for folder, number in ((".", 1), ("deep", 2)):
        (tmp_path / folder / "benchmark").mkdir(parents=True)
        text = f"`nomad-mj`\n\n## SPL, all\n\n| {number} |\n\n## wide: driving\n\n| 3 |\n"
        (tmp_path / folder / "benchmark" / "tables.md").write_text(text)
    page = tmp_path / "page.md"
    marks = ("<!-- benchmark . SPL, all -->", "<!-- benchmark deep SPL, all -->")
    kept = "<!-- benchmark . maze: driving -->\nkept\n<!-- end -->\n"
    page.write_text(f"{marks[0]}\nstale\n<!-- end -->\n{marks[1]}\n<!-- end -->\n{kept}")
    for _ in range(2):
        subprocess.run([sys.executable, str(SCRIPT), str(tmp_path), str(page)], check=True)
        assert page.read_text() == (
            f"{marks[0]}\n| 1 |\n<!-- end -->\n{marks[1]}\n| 2 |\n<!-- end -->\n{kept}"
        )
