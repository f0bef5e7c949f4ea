#!/usr/bin/env bash
# Makes .venv, installs the package into it, and OpenGL where that is allowed. Quick when all is
# there. An interrupted, moved or broken .venv is made anew; one that somebody else made is used.
#   PYTHON=...  the interpreter to use      --apt     try apt for OpenGL again
#                                           --extras  install the optional packages too
set -euo pipefail
cd "$(dirname "$0")/.."

venv=.venv
ours=$venv/.made-by-setup # there before anything else: this .venv may be removed
ready=$venv/.ready        # there after everything else; holds the folder .venv was made in
extras=$venv/.extras      # there once the optional packages are
gl=$venv/.gl              # there once apt was tried; holds "works" where OpenGL does
# libegl1 alone lacks a driver, and the library PyOpenGL asks for errors.
torch=2.13.0
gl_packages=(libegl1 libopengl0 libgl1-mesa-dri libosmesa6)
export PIP_USER=0 PIP_DISABLE_PIP_VERSION_CHECK=1

say() { printf 'set-up: %s\n' "$*" >&2; }
die() {
  say "$@"
  exit 1
}

# --- apt ----------------------------------------------------------------------------------------
as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi; }
may_apt() { command -v apt-get >/dev/null && as_root true 2>/dev/null; }
apt_get() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o DPkg::Lock::Timeout=60 \
    -o Acquire::Retries=1 -o Acquire::http::Timeout=15 -o Acquire::https::Timeout=15 \
    --no-install-recommends "$@" </dev/null >/dev/null 2>&1
}
installed() { [ "$(dpkg-query -Wf '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

installable() { apt-get -qq -s install "$@" >/dev/null 2>&1; }

# Each package by itself: one that a release lacks (libosmesa6) must not keep the others out.
apt_install() {
  local package updated=''
  may_apt || return 0
  for package in "$@"; do
    if installed "$package"; then continue; fi
    say "installing $package"
    if apt_get install "$package"; then continue; fi
    if [ -z "$updated" ]; then
      updated=yes
      if apt_get update && apt_get install "$package"; then continue; fi
    fi
    say "apt could not install $package; going on without it"
  done
}

# --- Python -------------------------------------------------------------------------------------
version_of() { "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null; }
has() { "$1" -c "import $2" 2>/dev/null; }
supported() { [[ $1 == 3.1[012] ]]; }
refuse() {
  die "nomad-mj needs Python 3.10, 3.11 or 3.12, and $1 is ${2:-missing, or does not run}" \
    "(dm-control needs labmaze, which has no wheel for 3.13 and later);" \
    "name another: make setup PYTHON=/path/to/python3.12"
}

# The first supported Python, preferring those that bring a pip for the environment.
find_python() {
  local name version names=(python3.12 python3.11 python3.10 python3) usable=()
  if [ -n "${PYTHON:-}" ]; then names=("$PYTHON"); fi
  for name in "${names[@]}"; do
    version=$(version_of "$name") || true
    if supported "$version"; then usable+=("$name"); fi
  done
  if ! ((${#usable[@]})); then refuse "$name" "$version"; fi
  for name in "${usable[@]}"; do
    if has "$name" ensurepip; then echo "$name" && return; fi
  done
  echo "${usable[0]}"
}

add_pip() {
  local pip site
  site=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
  if "$venv/bin/python" -m ensurepip >/dev/null 2>&1; then return; fi
  for pip in "$1 -m pip" pip3 'uv pip'; do
    # shellcheck disable=SC2086  # a command and its argument
    if $pip install --quiet --target "$site" pip >/dev/null 2>&1; then return; fi
  done
  "$venv/bin/python" scripts/get_pip.py ||
    die "this Python has no pip for .venv; type: sudo apt-get install -y python$(version_of "$1")-venv"
}

make_venv() {
  local python
  python=$(find_python)
  say "making .venv with $(command -v "$python")"
  # Moved away first: half removed, it would pass for an environment and be the system's Python.
  rm -rf "$venv.old"
  if [ -e "$venv" ]; then mv "$venv" "$venv.old"; fi
  rm -rf "$venv.old"
  mkdir "$venv" && : >"$ours"
  if ! has "$python" ensurepip; then apt_install "python$(version_of "$python")-venv"; fi
  if has "$python" ensurepip; then
    "$python" -m venv "$venv" || die "$python could not make .venv (see above)"
  else
    "$python" -m venv --without-pip "$venv" || die "$python could not make .venv (see above)"
    add_pip "$python"
  fi
}

# --- the package --------------------------------------------------------------------------------
runs() { "$venv/bin/python" -c 'import sys; sys.exit(sys.prefix == sys.base_prefix)' 2>/dev/null; }
right_python() {
  [ -z "${PYTHON:-}" ] || [ "$(version_of "$PYTHON")" = "$(version_of "$venv/bin/python")" ]
}
usable() { runs && right_python && [ "$(cat "$ready" 2>/dev/null)" = "$PWD" ]; }

install_package() {
  say "installing nomad-mj and what it needs into .venv (a few minutes the first time)"
  # Older ones search for a quarter of an hour for versions that fit together.
  if ! "$venv/bin/python" -m pip install --quiet 'pip>=23.1' ||
    ! "$venv/bin/python" -m pip install --editable '.[dev]'; then
    die "pip could not install nomad-mj (see above): check the network and" \
      "'$venv/bin/python -m pip config list', then type the same make again"
  fi
  echo "$PWD" >"$ready"
}

set_up() {
  local version
  if usable && [ "$ready" -nt pyproject.toml ]; then return; fi
  if [ ! -e "$venv" ] || { [ -e "$ours" ] && ! usable; }; then
    make_venv
  elif ! runs; then
    die "the .venv here does not run and was not made by make: move it away"
  elif ! right_python; then
    die "the .venv here is not of $PYTHON and was not made by make: move it away"
  fi
  version=$(version_of "$venv/bin/python")
  if ! supported "$version"; then refuse "$venv/bin/python" "$version"; fi
  if ! has "$venv/bin/python" pip; then add_pip "$venv/bin/python"; fi
  install_package
}

# The CPU build of PyTorch is a tenth of the usual one. Its own index has it; where that cannot be
# reached, whatever pip finds will do.
install_extras() {
  if [ "$extras" -nt pyproject.toml ]; then return; fi
  say "installing the optional packages: PyTorch, Stable-Baselines3, Ray, Minari, TensorBoard"
  # What is imported of so many files is compiled then; all of it would take half a minute now.
  local pip=("$venv/bin/python" -m pip install --quiet --no-compile)
  if ! has "$venv/bin/python" torch; then
    "${pip[@]}" --retries 0 --timeout 15 \
      --index-url https://download.pytorch.org/whl/cpu "torch==$torch" >/dev/null 2>&1 ||
      "${pip[@]}" "torch==$torch" || true
  fi
  "${pip[@]}" --editable '.[dev,all]' ||
    die "pip could not install the optional packages (see above); type the same make again"
  : >"$extras"
}

# --- OpenGL -------------------------------------------------------------------------------------
gl_works() {
  "$venv/bin/python" -c 'import runpy, sys
problem_with = runpy.run_path("nomad_mj/_gl_probe.py")["problem_with"]
sys.exit(all(problem_with(name) for name in ("egl", "osmesa", "glfw")))' 2>/dev/null
}

set_up_gl() {
  if [ "${1:-}" != --apt ] && [ "$(cat "$gl" 2>/dev/null)" = works ]; then return; fi
  if [ "${1:-}" = --apt ] || [ ! -e "$gl" ]; then apt_install "${gl_packages[@]}"; fi
  : >"$gl"
  if gl_works; then echo works >"$gl"; else say_gl; fi
}

# The one line to type, of packages that can be installed: EGL, or OSMesa, is enough.
say_gl() {
  local package update='' missing=() egl=()
  for package in "${gl_packages[@]}"; do
    if installed "$package"; then continue; fi
    missing+=("$package")
    if [ "$package" != libosmesa6 ]; then egl+=("$package"); fi
  done
  if ! installable "${missing[@]}"; then missing=("${egl[@]}"); fi
  if ! installable "${missing[@]}"; then update='sudo apt-get update && '; fi
  if ((${#missing[@]})); then
    say "no OpenGL works here: all but pictures will. On Debian or Ubuntu type:" \
      "${update}sudo apt-get install -y ${missing[*]}"
  else
    say "no OpenGL works here, though its libraries are installed: all but pictures will"
  fi
}

# Two makes at once take turns.
exec 9<. && { flock 9 2>/dev/null || true; }
set_up
if [ "${1:-}" = --extras ]; then install_extras; fi
set_up_gl "$@"
