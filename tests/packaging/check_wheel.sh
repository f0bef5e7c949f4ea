#!/usr/bin/env bash
# Builds the sdist and, from it, the wheel; installs the wheel into a new environment outside the
# checkout, and tries it there. Needs .venv (make setup).
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
python=$root/.venv/bin/python
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH

"$python" -m build --quiet --outdir "$work/dist" "$root"
"$python" -m venv --without-pip "$work/venv"
"$python" -m pip --python "$work/venv/bin/python" install --quiet "$work"/dist/*.whl
"$python" -m pip --python "$work/venv/bin/python" check

mkdir "$work/elsewhere"
cd "$work/elsewhere"
"$work/venv/bin/python" -I "$root/tests/packaging/smoke.py"
