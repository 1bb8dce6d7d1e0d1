#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Debian packages that are missing, and does nothing when none is.
#   tools/install_system_packages.sh [--check] [build] [test] [docs]
# --check installs nothing: exit code 0 when all are there, 1 with their names on standard output when not.
set -eu

check_only=no
groups=
for argument in "$@"; do
  case "$argument" in
    --check) check_only=yes ;;
    build | test | docs) groups="$groups $argument" ;;
    *) echo "usage: $0 [--check] [build] [test] [docs]" >&2; exit 2 ;;
  esac
done
[ -n "$groups" ] || groups="build"

wanted=
for group in $groups; do
  case "$group" in
    build)
      wanted="$wanted ca-certificates g++ cmake ninja-build python3-dev python3-venv libboost1.81-dev libssl-dev libtbb-dev"
      # One build tree has the targets of tests and benchmarks too, and CMake looks for these when it is set up.
      wanted="$wanted libgtest-dev libbenchmark-dev"
      ;;
    # Reads the public headers for the site of the documents.
    docs) wanted="$wanted doxygen" ;;
    # A real browser for the browser tests, without the windows of which each page takes most of a second, and Mesa so that it can draw
    # without a graphics card.
    test) wanted="$wanted chromium-headless-shell libgl1-mesa-dri libegl1 libgles2 libgl1 fonts-dejavu-core" ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  # Not a Debian: name what is needed, and go on if the tools are there under whatever package name.
  missing=
  for tool in c++ cmake ninja; do
    command -v "$tool" >/dev/null || missing="$missing $tool"
  done
  [ -n "$missing" ] || exit 0
  echo "missing:$missing"
  echo "This system has no apt-get. Please install the counterparts of these Debian 12 packages by hand:" >&2
  echo " $wanted" >&2
  exit 1
fi

missing=
for package in $wanted; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0
if [ "$check_only" = yes ]; then
  echo "$missing"
  exit 1
fi

as_root=
if [ "$(id -u)" != 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "These packages are missing and neither root nor sudo is at hand:$missing" >&2
    echo "As root: apt-get update && apt-get install -y --no-install-recommends$missing" >&2
    exit 1
  fi
  as_root=sudo
fi

install_missing() {
  # $missing and $as_root are lists of words
  # shellcheck disable=SC2086
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
}

# A fresh machine has no package lists, and old lists name files that are gone: in both cases update, then try again.
if install_missing; then
  exit 0
fi
$as_root apt-get update
install_missing
