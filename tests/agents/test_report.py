"""The report: one page that holds everything, is well formed, and the same every time."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import pytest
from known_report import Picture, make_section, three
from nomad_agents.experiments.experiment import Study, Verdict
from nomad_agents.experiments.report import NoVideo, Section, provenance, write_report
from nomad_agents.studies.runs import Result, Run
from nomad_agents.studies.tables import TextTable

import nomad_mj
from nomad_mj.errors import OutputError

ODD = """<script>alert("1 & 'x'")</script> é 大 {{ 7 * 7 }} """
VOID = {"meta", "link", "img", "br", "rect", "path", "circle"}


class Page(HTMLParser):
    """A page taken apart: elements with their attributes, and the text of headings."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.open: list[str] = []
        self.words: dict[str, list[str]] = {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and data.strip():
            self.words.setdefault(self.open[-1], []).append(data)

    def all(self, tag: str) -> list[dict[str, str]]:
        return [attributes for name, attributes in self.elements if name == tag]


@pytest.fixture(scope="module")
def section(tmp_path_factory: pytest.TempPathFactory) -> Section:
    return make_section(tmp_path_factory.mktemp("figures"))


def parse(path: Path) -> Page:
    return Page(path.read_text(encoding="utf-8"))


def test_the_page_is_whole_and_for_everybody(section: Section, tmp_path: Path) -> None:
    path = tmp_path / "new" / "report.html"
    write_report(path, three(section), [("Seeds", "0 to 19")], seeds=20)
    page = parse(path)
    assert not page.open and page.all("html") == [{"lang": "en"}]
    assert len(page.all("img")) == 6 and all(image["alt"] for image in page.all("img"))
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    pointed = [link["href"] for link in page.all("a")]
    assert pointed == ["#fig6", "#fig9", "#fig13"] and {link[1:] for link in pointed} <= set(ids)
    labels = [a["aria-labelledby"] for _, a in page.elements if "aria-labelledby" in a]
    assert {name for label in labels for name in label.split()} <= set(ids)
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    assert list(tmp_path.rglob(".*")) == []


def test_the_page_needs_nothing_but_itself(section: Section, tmp_path: Path) -> None:
    write_report(tmp_path / "r.html", three(section))
    page = parse(tmp_path / "r.html")
    pointing = ("src", "href", "poster", "srcset", "data", "action", "xlink:href")
    targets = [a[name] for _, a in page.elements for name in pointing if name in a]
    assert targets and all(target.startswith(("data:", "#")) for target in targets)
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert (
        "@import" not in text and "url(" not in text and "//" not in re.sub(r"base64,\S*", "", text)
    )
    assert not page.all("script")
    policy = next(meta for meta in page.all("meta") if "http-equiv" in meta)
    assert policy["content"].startswith("default-src 'none'")


def test_the_same_sections_give_the_same_bits(section: Section, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        write_report(tmp_path / name, three(section), [("Python", "3.11")], seeds=2)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_verdicts_claims_tables_and_commands_are_told(section: Section, tmp_path: Path) -> None:
    write_report(tmp_path / "r.html", three(section), [("Seeds", "0 to 19")])
    page = parse(tmp_path / "r.html")
    chips = [
        a["class"].split("-")[1] for a in page.all("span") if a.get("class", "")[:5] == "chip "
    ]
    assert sorted(chips) == sorted(["holds", "part", "fails"] * 3)
    assert {"All do.", "Some do.", "None does."} <= set(page.words["span"])
    heads = [word for word in page.words["th"] if word in section.table.headings]
    # A column in which nobody says anything is left out.
    assert "ours: median [quartiles]" in heads and "ours: IQM (95 %)" not in heads
    assert page.words["td"].count("760 [723, 786]") == 3
    assert page.words["code"] == [section.command] * 3 and page.words["dd"][-1] == "0 to 19"
    assert sum("no OpenGL works here" in word for word in page.words["p"]) == 3
    assert page.words["p"].count("It learns.") == 3 and page.words["cite"].count("Section 4") == 3


def test_names_are_text_whatever_they_are(section: Section, tmp_path: Path) -> None:
    odd = Section(
        ODD,
        ODD,
        ODD,
        ODD,
        Verdict("holds", ODD),
        TextTable(ODD, ("", ODD), ((ODD, ODD),)),
        [Picture(section.illustrations[0].path, ODD)],
        NoVideo(ODD),
        ODD,
    )
    write_report(tmp_path / "r.html", [odd, odd, replace(odd, name="大")], [(ODD, ODD)])
    page = parse(tmp_path / "r.html")
    assert not page.all("script") and page.words["code"] == [ODD] * 3
    assert page.all("img")[0]["alt"].startswith(ODD)
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids)) and all(re.fullmatch(r"[\w-]+", each) for each in ids)


def test_no_experiment_gives_a_page_too(tmp_path: Path) -> None:
    write_report(tmp_path / "r.html", [])
    assert "No experiment was run." in parse(tmp_path / "r.html").words["p"]


def test_what_cannot_be_shown_is_told_in_one_line(section: Section, tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"no picture")
    for name in ("missing.png", "broken.png", "notes.txt"):
        part = replace(section, illustrations=[Picture(tmp_path / name, "")])
        with pytest.raises(OutputError, match=name) as raised:
            write_report(tmp_path / "r.html", [part])
        assert "\n" not in str(raised.value)
    assert not (tmp_path / "r.html").exists()


def test_provenance_is_that_of_all_machines() -> None:
    study = Study("faithful", "paper_room", "nomad200", 2)
    machines = (
        {"python": "3.12.1", "system": "B", "wall_s": 9000, "cpu_s": 1800},
        {"system": "A", "wall_s": 1800, "cpu_s": 1800},
    )
    results = [
        Result(Run("fig6", "", agent, "faithful", "paper_room", "nomad200", 0), {}, machine=machine)
        for agent, machine in zip(("reactive_planner", "straight"), machines, strict=True)
    ]
    facts = dict(provenance(study, results, 2))
    assert facts == dict(provenance(study, results[::-1], 2))
    assert facts["Machine"] == "A; B" and facts["Seeds"] == "0 to 1" and facts["Python"] == "3.12.1"
    assert facts["Runs"] == "1 of the learner, 1 of the baselines; 1.0 hours of computing"
    assert f"nomad-mj {nomad_mj.__version__}" in facts["Versions"]
    assert "1 of the baselines, of 80 that" in dict(provenance(study, results, 80))["Runs"]
