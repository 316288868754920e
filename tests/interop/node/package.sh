#!/usr/bin/env bash
# The npm package: built, installed from its tarball into an empty folder, imported and required there, its types checked;
# compared with the published delaunator, d3-delaunay, earcut and Constrainautor where npm can fetch them.
#
#     package.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/../common.sh" "$1"
here=$PWD/tests/interop/node
node_tests=$PWD/tests/node.sh
tests=$PWD/clients/js/test
peers=$build/interop/npm
export npm_config_update_notifier=false npm_config_fund=false npm_config_audit=false npm_config_loglevel=error

# The published packages, of fixed versions, kept in the build folder.
fetch_peers() {
    [ -e "$peers/node_modules/earcut_fixtures" ] ||
        timeout 120 npm install --prefix "$peers" --no-save --no-package-lock --ignore-scripts \
            delaunator@5.1.0 d3-delaunay@6.0.6 earcut@3.2.4 earcut_fixtures@npm:earcut@1.4.2 @kninnug/constrainautor@4.1.0 \
            esbuild@0.28.2 typescript@5.9.3 @types/node@20.19.0 >"$scratch/npm" 2>&1
}

installs_offline() {
    local tarball
    tarball=$(ls "$build"/npm/delaunayd-*.tgz) && [ "$(wc -l <<<"$tarball")" -eq 1 ] &&
        mkdir "$scratch/app" && cd "$scratch/app" && npm init -y >/dev/null &&
        npm install --offline --ignore-scripts "$tarball" && [ "$(ls node_modules)" = delaunayd ]
}

# Without $DELAUNAYD and $PATH: the package has a daemon of its own.
runs() { (cd "$scratch/app" && cp "$here/$1" . && env -u DELAUNAYD DELAUNAY_URL=private: node "$1"); }

# `npm install clients/js` makes a link, and the daemon is the one that make has built.
runs_from_checkout() {
    mkdir "$scratch/linked" && cp "$here/required.cjs" "$scratch/linked" && cd "$scratch/linked" && npm init -y >/dev/null &&
        npm install --offline --ignore-scripts --install-links=false "$OLDPWD/clients/js" &&
        env -u DELAUNAYD PATH="$(dirname "$(command -v node)"):/usr/bin:/bin" DELAUNAY_URL=private: node required.cjs
}

has_version_of_daemon() {
    local version
    version=$("$build/delaunayd" --version) && [ "delaunayd $(node -p 'require("./clients/js/package.json").version')" = "$version" ]
}

holds_no_tests() { ! tar -tzf "$build"/npm/delaunayd-*.tgz | grep -v '^package/\(bin/delaunayd\|lib/[a-z0-9]*\.m\?js\|[a-zA-Z0-9-]*\.\(js\|mjs\|d\.ts\|d\.mts\|json\|html\|md\)\|LICENSE\)$'; }

# As an ES module and as CommonJS.
types_are_right() {
    cp "$here/types.mts" "$scratch/app/types.mts" && cp "$here/types.mts" "$scratch/app/types.cts" && cd "$scratch/app" &&
        "$peers/node_modules/.bin/tsc" --noEmit --strict --target es2022 --module node16 --typeRoots "$peers/node_modules/@types" \
            --types node types.mts types.cts
}

# For browsers; Node runs the result, which contains nothing of Node.
runs_bundled() { # FILE
    cp "$here/$1" "$scratch/app" && cd "$scratch/app" &&
        "$peers/node_modules/.bin/esbuild" "$1" --bundle --log-level=warning --outfile=bundled.js && node bundled.js
}

beside_peers() { # TEST
    (cd "$peers" && DELAUNAYD="$build/delaunayd" "$node_tests" "$1") >"$scratch/$(basename "$1")" 2>&1
    collect "$scratch/$(basename "$1")"
}

count "the npm package has the version of the daemon" has_version_of_daemon
count "the npm package holds what it should" holds_no_tests
count "the npm package installs from its tarball into an empty folder" installs_offline
count "the installed package can be imported" runs imported.mjs
count "the installed package can be required" runs required.cjs
[ ! -x build/delaunayd ] || count "the package of the checkout finds the daemon that make has built" runs_from_checkout
if fetch_peers; then
    count "the types are right in ES modules and in CommonJS" types_are_right
    count "the installed package can be bundled with import" runs_bundled bundled.mjs
    count "the installed package can be bundled with require" runs_bundled bundled.cjs
    beside_peers "$tests/d3.test.mjs"
    beside_peers "$here/published.test.mjs"
    beside_peers "$here/polygons.test.mjs"
else
    cat "$scratch/npm"
    for test in "the types are right in ES modules and in CommonJS" "the installed package can be bundled" "d3-delaunay beside ours" "published scripts run with another import" \
        "earcut and Constrainautor beside ours"; do
        skip "$test" "npm cannot fetch packages here"
    done
fi
result
