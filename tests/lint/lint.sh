#!/usr/bin/env bash
# Checks the rules for the source. Prints each breach as FILE:LINE: what; exits 1 if there is one.
#
#     lint.sh [BUILD_DIR]      with a build directory, object files are checked for variables and calls, too, and generated files
#                              are compared with what its daemon makes of them
#
# LINT_STRICT=1 makes a missing tool (clang-format-14, clang-tidy, cppcheck, mypy) a failure; otherwise it is only mentioned.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
build=${1:-}
found=$(mktemp -d)
trap 'rm -rf "$found"' EXIT

# The rooms of a folder, from the bottom up: a file may include files of its own room and of rooms before it.
declare -A rooms=(
    [core]='exact control memory fields points mesh constraints hints set divide shelling query cells triangle contours surface edit refining thinning arrays tiles'
    [clients]='lib reading points lines grids files meshes surfaces pictures cli commands'
    [server]='system ops sets changes disk jobs bodies rows replies clients command watch follow redis repair session'
)

# ---- which files ----

files() { # REGEX: the repository's files whose path matches, new ones included
    git ls-files -co --exclude-standard | grep -E "$1" | while IFS= read -r f; do [ -f "$f" ] && echo "$f"; done
}

code() { # FOLDER...: with their rooms
    local folder inside
    for folder in "$@"; do
        inside=${rooms[$folder]:-}
        files "^$folder/(${inside:+(${inside// /|})/})?[^/]*\.[ch]\$"
    done
}

all_code() {
    files '\.(c|h|cpp)$'
}

all_text() {
    files '\.(c|h|cpp|py|sh|mk|md|yml|yaml)$|^Makefile$|/run$'
}

# ---- folders are dependency rules ----

may_include() { # FOLDER REGEX: every #include in FOLDER must match
    code "$1" | xargs -r grep -HnE '^[[:space:]]*#[[:space:]]*include' | grep -vE "include ($2)" |
        sed "s|\$|    (not for $1/)|"
}

# A file of a room may include headers of that room, of rooms below it, and those that match REGEX.
room_order() { # FOLDER REGEX
    local room below=''
    may_include "$1" "\"$1/([a-z]+/)?[a-z0-9_]+\.h\"|$2"
    for room in ${rooms[$1]:-}; do
        below+=${below:+|}$room
        may_include "$1/$room" "\"$1/($below)/[a-z0-9_]+\.h\"|$2"
    done
}

include_rules() {
    local pure='assert|cpuid|float|immintrin|limits|math|stdalign|stdarg|stdatomic|stdbool|stddef|stdint|stdlib|string'
    room_order core "\"core/delaunay(_surface|_fields|_constraints|_thinning|_arrays|_tiles)?\.h\"|<($pure|sys/mman|errno|fenv|pthread)\.h>|<atomic>" # the last one for C++ that includes core/delaunay.h
    may_include proto "\"proto/(records/)?[a-z0-9_]+\.h\"|<($pure|ctype|errno|inttypes|stdio|time)\.h>"
    room_order server "\"(core/delaunay(_surface|_fields|_constraints|_thinning)?|proto/(records/)?[a-z0-9_]+)\.h\"|<[a-z0-9_/]+\.h>"
    room_order clients "\"proto/(records/)?[a-z0-9_]+\.h\"|<[a-z0-9_/]+\.h>"
}

# A file's own header comes first, which proves that the header stands on its own.
own_header_first() {
    local f own
    for f in $(code core proto server clients | grep '\.c$'); do
        own=${f%.c}.h
        [ ! -f "$own" ] || grep -m 1 '^#include' "$f" | grep -q "\"$own\"" || echo "$f:1: $own must come first"
    done
}

# A module is a .c file and its header. The modules that it includes are below it.
no_include_cycles() { # FOLDER
    code "$1" | xargs -r grep -HE '^#include "' | sed -E 's|^([^:]*)\.[ch]:#include "(.*)\.h".*|\1 \2|' |
        awk '$1 != $2' | tsort 2>&1 >/dev/null | awk '/loop/ && n++ { exit } 1' |
        sed "s|^tsort: *|$1: includes in a circle: |"
}

core_is_pure() {
    code core | xargs -r grep -HnE '(^|[^a-z_])(v?f?s?n?printf|puts|abort|exit|_Exit|signal|setlocale)[[:space:]]*\(' |
        sed 's|$|    (not in core/)|'
}

objects() { # FOLDER
    code "$1" | sed -n "s|^\(.*\)\.c\$|$build/\1.o|p"
}

# The symbols that an object file defines or uses, as `FILE NAME TYPE`.
symbols() { # FOLDER
    objects "$1" | xargs nm -A --format=posix | sed -E "s|^$build/([^:]*)\.o: ([^ ]+) (.).*|\1.c \2 \3|"
}

# Headers may declare functions of all rooms, so includes alone do not show who calls whom. Calls through pointers are not seen.
calls_no_room_above() { # FOLDER
    symbols "$1" | awk -v order="${rooms[$1]}" '
        function room(file, part) { return split(file, part, "/") > 2 ? part[2] : "" }
        BEGIN { for (n = split(order, name, " "); n > 0; n--) level[name[n]] = n; level[""] = 99 }
        $3 ~ /[TDRB]/ { home[$2] = $1 }
        $3 == "U" { from[++calls] = $1; called[calls] = $2 }
        END { for (i = 1; i <= calls; i++) {
            of = home[called[i]]
            if (of != "" && level[room(of)] > level[room(from[i])]) print from[i] ": calls " called[i] " of " of } }'
}

# A header of a room declares what files of that room define, a header above the rooms what any file defines.
declares_what_its_room_defines() { # FOLDER
    { symbols "$1"; code "$1" | grep '\.h$' | xargs grep -HoE '^[a-z][a-z_0-9 *]*[ *][a-z_0-9]+\(' | grep -vE ':(static|typedef) ' |
        sed -E 's|^([^:]*):.*[ *]([a-z_0-9]+)\($|\1 \2|'; } | awk '
        function room(file, part) { return split(file, part, "/") > 2 ? part[2] : "" }
        NF == 3 && $3 ~ /[TDRB]/ { home[$2] = $1 }
        NF == 2 { header[++n] = $1; declared[n] = $2 }
        END { for (i = 1; i <= n; i++) {
            of = home[declared[i]]; at = room(header[i])
            if (of == "") print header[i] ": declares " declared[i] ", which no file defines"
            else if (at != "" && room(of) != at) print header[i] ": declares " declared[i] " of " of } }'
}

# core/ has no global or static variables. Tables of constants are in read-only sections.
core_has_no_globals() {
    local o
    for o in $(objects core); do
        objdump -t "$o" | awk -v o="$o" '/ O (\.data|\.bss|\.tdata|\.tbss|\*COM\*)/ && !/\.data\.rel\.ro/ {
            print o ": the variable " $NF " outlives a call" }'
    done
}

# ---- files ----

file_rules() {
    local f lines
    files '\.(c|h|cpp|py|js)$' | sed 's|/[^/]*$||' | sort | uniq -c |
        awk '$1 > 25 { print $2 ": " $1 " source files: it needs rooms" }'
    for f in $(files '\.(c|h|cpp|py|sh)$'); do
        lines=$(wc -l <"$f")
        [ "$lines" -le 600 ] || echo "$f:$lines: more than 600 lines: what should leave it?"
    done
    files '\.[ch]$' | grep -v subcommand_rows.h | xargs awk 'length > 140 { print FILENAME ":" FNR ": more than 140 columns" }'
    for f in $(all_code); do
        head -n 1 "$f" | grep -qF "/* $(basename "$f") - " || echo "$f:1: must open with its name and purpose"
    done
    all_text | grep -v '\.md$' | xargs grep -HnE '[[:blank:]]+$' | sed 's|$|    (blank at the end of the line)|'
    all_text | grep -vE '(^Makefile|\.mk)$' | xargs grep -HnP '\t' | sed 's|$|    (tab)|'
    files . | xargs grep -HnIE '(^|[^A-Za-z])/([w]ork|[r]oot|[t]mp/(wt|bash))(/|$)' | sed 's|$|    (path of one machine)|'
}

# Comments and documents name files of the repository, by path or by name, and documents link to them. A header of the system is
# known by the line that includes it.
named_files_exist() {
    {
        files . | sed 's|^|file |'
        echo 'file delaunay_core.h' # made by make lib
        code core proto server clients tests | xargs grep -hoE '^# *include <[^>]*' | sed 's|.*<|file |'
        all_code | xargs grep -HnE '^ \*|/\*' | sed -E 's|^([^:]*:[0-9]*):|\1 |; s|^([^ ]*) .*/\*|\1 |'
        files '\.md$' | grep -v CHANGELOG | xargs grep -Hn . | sed -E 's|^([^:]*:[0-9]*):|\1 |'
    } | awk '
        $1 == "file" { do known[$2] = 1; while (sub(/^[^\/]*\//, "", $2)); next }
        { where = $1
          while (match($0, /[A-Za-z0-9_.\/>\[-]+\.[ch]($|[^A-Za-z0-9_(.\[-])/)) {
              name = substr($0, RSTART, RLENGTH); sub(/[^ch]$/, "", name); sub(/^(\.\.\/)+/, "", name)
              if (name ~ /^([a-z0-9_-]+\/)*[a-z][a-z0-9_][a-z0-9_]+\.[ch]$/ && !(name in known)) print where ": names " name ", which is no file"
              $0 = substr($0, RSTART + RLENGTH) } }'
    local link to
    files '\.md$' | xargs grep -HnoE '\]\([^) :#]+[)#]' | while IFS= read -r link; do
        to=${link##*(}
        [ -e "$(dirname "${link%%:*}")/${to%?}" ] || echo "${link%%]*} links to ${to%?}, which is no file"
    done
}

# All packages have the version of proto/version.h.
versions() {
    local f first version='[0-9]+\.[0-9]+\.[0-9]+'
    local released=$(grep -oE "$version" proto/version.h)
    for f in debian/changelog man/delaunay.1 man/delaunayd.8 clients/python/{pyproject.toml,delaunayd/__init__.py} clients/js/package.json; do
        first=$(head -n 25 "$f" | grep -oE "$version" | head -n 1)
        [ "$first" = "$released" ] || echo "$f: version $first, not $released"
    done
}

# Parts of the clients follow from the table of commands.
generated() {
    have python3 || return
    clients/generate/generate.py "$build/delaunayd" --check
}

# ---- tools ----

have() { # NAME
    command -v "$1" >/dev/null && return
    if [ -n "${LINT_STRICT:-}" ]; then
        echo "lint: $1 is missing"
    else
        echo "lint: no $1, its checks are left out" >&2
    fi
    return 1
}

format() {
    have clang-format-14 || return
    all_code | xargs -r -n 50 clang-format-14 --dry-run --ferror-limit=1 2>&1 | sed -n 's/^\([^:]*:[0-9]*\):.*warning: .*/\1: not formatted (make fmt)/p'  ||
        echo "clang-format-14 failed"
}

tidy() {
    have clang-tidy || return
    code core proto server clients | grep '\.c$' |
        xargs -r -P 2 -n 3 sh -c 'clang-tidy --quiet "$@" -- -std=c11 -D_GNU_SOURCE -I. 2>/dev/null' sh |
        grep -E ' (error|warning): ' | sed "s|^$PWD/||" | sort -u
}

check() {
    have cppcheck || return
    code core proto server clients tests/bench | grep '\.c$' |
        xargs -r cppcheck -q -j 2 --std=c11 -D_GNU_SOURCE -D__SIZEOF_INT128__=16 -I. --enable=warning,portability --inline-suppr \
            --suppress=internalAstError \
            --template='{file}:{line}: {message} [cppcheck {id}]' --template-location='' 2>&1 | grep .
}

# The types of the Python package, which type checkers of its users read.
types() {
    have mypy || return
    (cd clients/python && mypy --strict --no-incremental --cache-dir=/dev/null delaunayd build_backend.py) | grep error | sed 's|^|clients/python/|'
}

rules() {
    include_rules
    own_header_first
    for folder in core proto server clients; do no_include_cycles "$folder"; done
    core_is_pure
    [ -z "$build" ] || core_has_no_globals
    [ -z "$build" ] || for folder in core server; do calls_no_room_above "$folder"; done
    [ -z "$build" ] || for folder in core proto server; do declares_what_its_room_defines "$folder"; done
    file_rules
    named_files_exist
    versions
    [ -z "$build" ] || generated
}

# Checks that use one processor run beside those that use two; the latter leave a processor free at their end.
{ rules; format; types; } >"$found/rules" &
{ check; tidy; } >"$found/tools"
wait

cat "$found"/*
lines=$(cat "$found"/* | wc -l)
echo "lint: $lines breaches"
[ "$lines" -eq 0 ]
