#!/usr/bin/env bash
# The WebAssembly module: if the compiler is the recorded one, a fresh build has the bytes of the committed one. It is small, needs
# nothing of its host, and passes the tests of the classes in process.
#
#     check.sh BUILD_DIR COMPILER     prints what failed, and at the end one line: N passed, N failed
set -uo pipefail
cd "$(dirname "$0")/../../.." || exit 1
build=$1
compiler=$2
js=$build/wasm/js
passed=0
failed=0

check() { # NAME COMMAND...
    if "${@:2}" >"$build/wasm/check.log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $1"
        cat "$build/wasm/check.log"
    fi
}

rebuild() {
    rm -rf "$js" && cp -r clients/js "$js" && node "$js/wasm/bundle.mjs" "$build/wasm/core.wasm" "$compiler"
}

has_the_committed_bytes() { cmp clients/js/lib/module.js "$js/lib/module.js"; }

is_small() { [ "$(gzip -9c "$build/wasm/core.wasm" | wc -c)" -le 144000 ]; }

has_no_imports() {
    node -e 'process.exit(WebAssembly.Module.imports(new WebAssembly.Module(require("fs").readFileSync(process.argv[1]))).length)' \
        "$build/wasm/core.wasm"
}

check "the module can be put into the package" rebuild
if grep -qF "$compiler;" clients/js/lib/module.js; then
    check "the committed module is that of this source (make wasm)" has_the_committed_bytes
else
    echo "another compiler, so bytes are not compared: $compiler"
fi
check "the module has at most 144 KB, compressed" is_small
check "the module imports nothing" has_no_imports
check "what runs in process passes its tests with the new module" \
    env DELAUNAYD="$build/delaunayd" node --test "$js"/test/{browser,bundle,constraints,d3,delaunator,live}.test.mjs
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
