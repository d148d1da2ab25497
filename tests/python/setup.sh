#!/bin/sh
# Makes target/python, a Python environment with what the Python tests need and with python/halfstep as it stands, and
# prints its interpreter. Does nothing when it is already as the requirements want it; may run several times at once.
# `setup.sh EXAMPLE` makes target/python-EXAMPLE for a folder of python/examples that the tests do not need.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
package=$(cd "$here/../../python" && pwd)
examples=$package/examples
if [ $# -gt 0 ]; then
    wanted=$examples/$1/requirements.txt
else
    wanted="$here/requirements.txt $examples/scikit-fem/requirements.txt $examples/mujoco/requirements.txt"
fi
target=${CARGO_TARGET_DIR:-$here/../../target}
mkdir -p "$target"
venv=$(cd "$target" && pwd)/python${1:+-$1}
exec 9>"$venv.lock"
flock 9
# shellcheck disable=SC2086
told=$(cat $wanted; echo "$package")
if [ "$told" != "$(cat "$venv/installed.txt" 2>/dev/null)" ]; then
    python3 -m venv --clear "$venv" >&2
    # shellcheck disable=SC2086
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check $(printf -- '-r %s ' $wanted) >&2
    # The package itself, so that a change of it needs no installation.
    echo "$package" > "$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/halfstep.pth"
    echo "$told" > "$venv/installed.txt"
fi
echo "$venv/bin/python"
