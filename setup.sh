#!/usr/bin/env bash
# Installs what building and testing halfstep needs and this machine lacks: a C compiler, make, pkg-config, HDF5's
# headers (1.10.7 or later), and for the tests alone Python's venv module and valgrind. Does nothing where all of it is
# there. Works on Debian and its relatives, as root or with sudo; elsewhere it says what to install. A HDF5 of your own
# is used where HDF5_DIR names its folder.
set -euo pipefail

say() { printf 'setup: %s\n' "$*" >&2; }
have() { command -v "$1" >/dev/null 2>&1; }

# Packages that are missing, by Debian's names, one a line.
missing() {
    have cc || printf '%s\n' gcc libc6-dev
    have make || echo make
    have pkg-config || echo pkg-config
    [ -n "${HDF5_DIR:-}" ] || pkg-config --atleast-version=1.10.7 hdf5 2>/dev/null || echo libhdf5-dev
    have valgrind || echo valgrind
    python3 -c 'import ensurepip, venv' 2>/dev/null || printf '%s\n' python3 python3-venv
}

PATH="$PATH:${HOME:-/root}/.cargo/bin"
if ! have cargo; then
    say "cargo is missing. Install Rust (stable) with rustup, see https://rustup.rs, and open a new shell."
    exit 1
fi

mapfile -t packages < <(missing)
[ "${#packages[@]}" -gt 0 ] || exit 0

if ! have apt-get; then
    say "this system has no apt-get. Install what corresponds to Debian's packages: ${packages[*]}"
    exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    # Without a terminal nobody can type a password: sudo then has to work without one.
    if have sudo && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
        as_root=(sudo)
    else
        say "no right to install packages. As root: apt-get update && apt-get install ${packages[*]}"
        exit 1
    fi
fi
say "installing ${packages[*]}"
# The lists of a fresh image are older than the packages it has: without an update apt finds no versions that fit.
"${as_root[@]}" apt-get -qq update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -qq install --yes --no-install-recommends "${packages[@]}" >/dev/null

mapfile -t packages < <(missing)
if [ "${#packages[@]}" -gt 0 ]; then
    say "still missing after the installation: ${packages[*]}"
    exit 1
fi
