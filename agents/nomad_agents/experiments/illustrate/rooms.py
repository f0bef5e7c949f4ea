"""Figures that show rooms: paths, actions, categories, films."""

from typing import Any

from nomad_agents.experiments.experiment import LEARNER, PLANNER
from nomad_agents.experiments.figures.actions import draw_actions
from nomad_agents.experiments.figures.categories import draw_categories
from nomad_agents.experiments.figures.film_strip import draw_film
from nomad_agents.experiments.figures.paths import draw_paths
from nomad_agents.experiments.figures.room import Panel
from nomad_agents.experiments.illustrate.material import (
    Illustration,
    Material,
    holding,
    make_panel,
)


def _panels(material: Material, picture: str) -> tuple[list[Panel[Any]], int]:
    """Return the pictures of all cases, each beside what was before it; and how many in a row."""
    before = holding(material.before, picture)
    panels: list[Panel[Any]] = []
    for key, result in holding(material.results, picture).items():
        case = key[0]
        if key in before:
            panels.append(make_panel(before[key], picture, f"{case}: before"))
        title = f"{case}: after" if before else case or material.experiment.title
        panels.append(make_panel(result, picture, title))
    return panels, 2 if before else 0


def paths(material: Material) -> list[Illustration]:
    """Draw where the robot went."""
    panels, columns = _panels(material, "ways")
    if not panels:
        return []
    path = material.path("paths")
    draw_paths(panels, path, columns)
    return [Illustration(path, "Where the robot went: from the circles to the square.")]


def fleet(material: Material) -> list[Illustration]:
    """Draw where each robot went in each room, a robot a row."""
    panels, _ = _panels(material, "ways")
    if not panels:
        return []
    path = material.path("paths")
    draw_paths(panels, path, len({panel.scene.arena.name for panel in panels}))
    return [Illustration(path, "Where each robot went in each room, from the circles.")]


def actions(material: Material) -> list[Illustration]:
    """Draw the action at every place."""
    panels, columns = _panels(material, "actions")
    if not panels:
        return []
    path = material.path("actions")
    draw_actions(panels, path, columns)
    return [Illustration(path, "The action taken at each place, 0.4 of its length.")]


def compare_planner(material: Material) -> list[Illustration]:
    """Draw the learnt actions, what the planner does instead, and which category acts where."""
    titles = {LEARNER: "Learnt", PLANNER: "Planner at every decision"}
    held = holding(material.results, "actions", tuple(titles))
    results = {agent: result for (_, agent), result in held.items()}
    panels = {
        agent: make_panel(results[agent], "actions", title)
        for agent, title in titles.items()
        if agent in results
    }
    drawn: list[Illustration] = []
    if panels:
        path = material.path("actions")
        draw_actions(list(panels.values()), path)
        caption = "The action taken at each place, 0.4 of its length."
        drawn.append(Illustration(path, caption))
    if LEARNER in panels:
        path = material.path("categories")
        learnt = panels[LEARNER]
        draw_categories(Panel("Which category acts where", learnt.scene, learnt.content), path)
        caption = "Regions in which one category acts, coloured by where it leads."
        drawn.append(Illustration(path, caption))
    return drawn


def films(material: Material) -> list[Illustration]:
    """Draw the same episode in each case, one that is neither long nor short among them."""
    held = holding(material.results, "films")
    films = {key[0]: result.pictures["films"] for key, result in held.items()}
    count = min(map(len, films.values()), default=0)
    lasts = [min(max(f[n]["times"], default=0.0) for f in films.values()) for n in range(count)]
    there = sorted((n for n in range(count) if lasts[n] > 0), key=lasts.__getitem__)
    if not there:
        return []
    number = there[len(there) // 2]
    drawn: list[Illustration] = []
    for (case, _), result in held.items():
        path = material.path("film" + (f"_{case.replace(' ', '_')}" if case else ""))
        scene = make_panel(result, "films", "").scene
        title = material.experiment.title + (f", {case}" if case else "")
        draw_film(scene, films[case][number], path, title)
        drawn.append(Illustration(path, f"An episode at six times{case and f', {case}'}."))
    return drawn
