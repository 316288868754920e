#!/usr/bin/env bash
# Checks the Dockerfile without an engine to build it. The files that it copies must be enough to build. The files that it takes
# from the build must exist. Its user, entry point and health check must work with the installed daemon.
#
#     image.sh BUILD_DIR          exits with 0 if all is well; otherwise a line says what is wrong
set -eu
cd "$(dirname "$0")/../.."
build=$PWD/$1
scratch=$(mktemp -d)
pid=
trap '[ -z "$pid" ] || kill "$pid" 2>/dev/null || true; rm -rf "$scratch"' EXIT

bad() { echo "Dockerfile: $1" >&2; exit 1; }

line() { # REGEX: the one line that matches, without what matched
    local found
    found=$(grep -E "^$1" Dockerfile) || bad "no line '$1'"
    [ "$(wc -l <<<"$found")" -eq 1 ] || bad "several lines '$1'"
    sed -E "s|^$1||" <<<"$found"
}

words() { # JSON_ARRAY: its strings, a line each
    /usr/bin/python3 -c 'import json, sys; print("\n".join(json.loads(sys.argv[1])))' "$1"
}

# COPY . . takes the files of git except those in .dockerignore; that must be enough for the build.
line 'COPY \. \.$' >/dev/null
line 'WORKDIR /src$' >/dev/null
mkdir "$scratch/src"
git ls-files -co --exclude-standard -z | while IFS= read -r -d '' f; do [ ! -f "$f" ] || printf '%s\0' "$f"; done |
    xargs -0 cp --parents -t "$scratch/src"
while read -r ignored; do rm -rf "${scratch:?}/src/$ignored"; done <.dockerignore
install=$(line 'RUN make install ')
[ "$install" = "PREFIX=/usr DESTDIR=/out" ] || bad "make install $install is not what this test runs"
MAKEFLAGS='' make -s -n -C "$scratch/src" install PREFIX=/usr DESTDIR=/out >"$scratch/plan" || bad "the build lacks something"
grep -q -- '-o build/delaunayd' "$scratch/plan" || bad "make install would not build the daemon"

# The same in this tree, where it is built already; the second stage takes the programs.
MAKEFLAGS='' make -s install O="$build" PREFIX=/usr DESTDIR="$scratch/out" >/dev/null
from=$(line 'COPY --from=build /out')
[ "$from" = "/usr/bin/ /usr/bin/" ] || bad "COPY --from=build /out$from is not what this test copies"
export PATH=$scratch/out/usr/bin:$PATH
for program in delaunayd delaunay; do
    [ "$(command -v "$program")" = "$scratch/out/usr/bin/$program" ] || bad "$program is not installed"
done

# The user, who owns the volume, is created before the image switches to it, by number, and is not root.
user=$(line 'USER ')
volume=$(line 'VOLUME ')
id=${user%%:*}
[ "$user" = "$id:$id" ] && [[ $id =~ ^[1-9][0-9]*$ ]] || bad "USER $user is no number, or root"
line "RUN useradd .*--uid $id --user-group .*delaunayd && install -d -o delaunayd -g delaunayd $volume\$" >/dev/null
[ "$(grep -n '^USER' Dockerfile | cut -d: -f1)" -gt "$(grep -n '^RUN useradd' Dockerfile | cut -d: -f1)" ] || bad "USER too early"

# The entry point, with a directory and a port of the test's; then the health check.
chmod 755 "$scratch"
install -d -m 777 "$scratch/data"
as=()
[ "$(id -u)" -ne 0 ] || as=(setpriv --reuid=65534 --regid=65534 --clear-groups)
mapfile -t entry < <(words "$(line 'ENTRYPOINT ')")
mapfile -t health < <(words "$(line 'HEALTHCHECK .*CMD ')")
[ "${entry[*]:1:2}" = "--data $volume" ] || bad "the daemon does not use the volume"
[ "${entry[*]:3:2}" = "--backup-dir $volume/backups" ] || bad "backups do not go to the volume"
entry[2]=$scratch/data
entry[4]=$scratch/data/backups
: >"$scratch/ready"
"${as[@]}" "${entry[@]}" --port 0 >"$scratch/ready" 2>"$scratch/log" &
pid=$!
for _ in $(seq 100); do
    DELAUNAY_PORT=$(sed -n 's/^ready on .*:\([0-9]*\)$/\1/p' "$scratch/ready")
    [ -z "$DELAUNAY_PORT" ] || break
    sleep 0.1
done
[ -n "$DELAUNAY_PORT" ] || bad "the entry point does not start: $(cat "$scratch/log")"
export DELAUNAY_PORT
[ "$(line 'EXPOSE ')" = 6374 ] || bad "exposes another port than the daemon's"
"${as[@]}" "${health[@]}" >/dev/null || bad "the health check fails beside a healthy daemon"
"${as[@]}" delaunay backup monday >/dev/null && "${as[@]}" delaunayd --check "$scratch/data/backups/monday" >/dev/null ||
    bad "there is no backup"
kill "$pid"
wait "$pid" || bad "the daemon does not end well"
pid=
[ -n "$(ls "$scratch/data")" ] || bad "nothing was stored in the volume"
! "${as[@]}" "${health[@]}" >/dev/null 2>&1 || bad "the health check succeeds without a daemon"
