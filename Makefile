# Every target makes .venv and what goes in it first, if need be: see scripts/setup.sh.
# PYTHON=python3.11 names the interpreter to make .venv with; ARGS="..." is passed on.

bin := .venv/bin

.PHONY: help setup extras demo test bench lint clean
.DEFAULT_GOAL := help

help: ## list the targets
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 16

setup: ## make .venv, install the package and, where allowed, OpenGL
	@scripts/setup.sh $(if $(filter setup,$(MAKECMDGOALS)),--apt)

extras: ## add what deep learners, sweeps and datasets need (PyTorch, Ray, Minari)
	@scripts/setup.sh --extras

demo: setup ## learn the paper's room, then print the table and draw the figures
	@$(bin)/nomad-mj demo $(ARGS)

test: extras ## run the tests (ARGS="tests/test_gl.py -k egl" for some of them)
	@$(bin)/python -m pytest -n auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder $(ARGS)

bench: extras ## measure the speed, as ratios to bare MuJoCo
	@$(bin)/nomad-mj bench $(ARGS)

lint: extras ## check style and types
	$(bin)/python -m ruff check .
	$(bin)/python -m ruff format --check .
	$(bin)/python -m pyright --pythonpath $(bin)/python

clean: ## remove .venv and everything built; renders/ stays
	rm -rf .venv build dist .pytest_cache .ruff_cache .hypothesis
	find nomad_mj agents tests -name __pycache__ -prune -exec rm -rf {} +
