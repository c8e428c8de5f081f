#!/usr/bin/env bash
# Build the wheel, install it in a clean environment away from the repository, and ask it a few questions there.
set -euo pipefail
builder=$(realpath -s "$1")
repository=$(cd "$(dirname "$0")/.." && pwd)
away=$(mktemp -d)
trap 'rm -rf "$away"' EXIT

"$builder" -m build --wheel --outdir "$away/dist" "$repository" >"$away/build.log" 2>&1 || { cat "$away/build.log"; exit 1; }
"${PYTHON:-python3}" -m venv "$away/venv"
"$away/venv/bin/python" -m pip install --quiet --disable-pip-version-check "$away"/dist/*.whl

cd "$away"
"$away/venv/bin/kinetostat" --version
"$away/venv/bin/kinetostat" jacobian textbook:planar_2r -q 0.3,0.7 -F json | grep -q '"agree": true'
"$away/venv/bin/kinetostat" jacobian example:panda -f panda_hand -q mid | grep -q 'pinocchio and screw agree'
"$away/venv/bin/kinetostat" check example:panda | grep -q 'pinocchio, screw and yourdfpy agree'
"$away/venv/bin/kinetostat" sweep textbook:planar_2r --samples 1000 -F json | grep -q '"agree": true'
"$away/venv/bin/kinetostat" report textbook:planar_2r --samples 1000 -o report >/dev/null && grep -q 'planar_2r' report/index.html
"$away/venv/bin/kinetostat" robots | grep -q 'textbook:puma560'
"$away/venv/bin/python" -c 'import kinetostat, pathlib; assert (pathlib.Path(kinetostat.__file__).parent / "py.typed").is_file()'
echo "wheel-check: the wheel answers away from the repository"
