#!/bin/sh
# demo.sh DAEMON CLIENT PLACES SVG [CONTOURS.svg [CELLS.svg]] - the whole service once, on real places: starts a daemon on a free port, loads,
# triangulates, asks, proves, draws, stops. Exit status 0 only if every step worked. For `make demo`.
set -eu
daemon=$1 client=$2 places=$3 svg=$4 contours=${5:-} cells=${6:-}
names=$(dirname "$places")/names.tsv # `id TAB name TAB country`, of the places below; without it there are ids
[ -f "$names" ] || names=/dev/null
tmp=$(mktemp -d)
pid=

stop()
{
    status=$?
    trap - EXIT
    if [ -n "$pid" ]; then
        kill "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    fi
    rm -rf "$tmp"
    [ "$status" = 0 ] || echo "demo: failed" >&2
    exit "$status"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

if [ -t 1 ]; then
    bold=$(printf '\033[1m') plain=$(printf '\033[0m')
else
    bold= plain=
fi

say()
{
    printf '\n# %s\n' "$1"
}

# show LINES COMMAND...: prints the client's command and the first lines of its reply.
show()
{
    lines=$1
    shift
    printf '%s$ delaunay %s%s\n' "$bold" "$*" "$plain"
    if ! "$client" -h "$host" -p "$port" "$@" >"$tmp/reply"; then
        cat "$tmp/reply"
        return 1
    fi
    sed "${lines}q" "$tmp/reply"
    more=$(($(wc -l <"$tmp/reply") - lines))
    [ "$more" -le 0 ] || echo "... $more more lines"
}

# show_named LINES COMMAND...: the same with names in place of ids; of NEAREST's rows the distance, of HULL's the coordinates.
show_named()
{
    lines=$1
    shift
    printf '%s$ delaunay %s%s\n' "$bold" "$*" "$plain"
    "$client" -h "$host" -p "$port" "$@" >"$tmp/reply"
    awk -v "command=$1" -v "lines=$lines" -v "names=$names" '
        BEGIN { FS = "\t"; while ((getline <names) > 0) name[$1] = $2 " (" $3 ")"; FS = " " }
        function named(id) { return id in name ? name[id] : id }
        NR == 1 { print; next }
        NR > lines { more++; next }
        { $0 = $0 }
        command == "NEAREST" { printf "%-34s %6.2f km\n", named($1), $4; next }
        command == "HULL" { printf "%-34s %10.4f %9.4f\n", named($1), $2, $3; next }
        { line = named($1); for (i = 2; i <= NF; i++) line = line (i == 2 && command == "LISTS" ? ": " : ", ") named($i); print line }
        END { if (more) print "... " more " more lines" }' "$tmp/reply"
}

# start_daemon: on a free port; sets $pid, $host and $port when it is ready.
start_daemon()
{
    printf '%s$ delaunayd --port 0 --data DIR &%s\n' "$bold" "$plain"
    rm -f "$tmp/ready"
    "$daemon" --port 0 --data "$tmp/data" >"$tmp/ready" &
    pid=$!
    tries=0
    until grep -q '^ready on ' "$tmp/ready" 2>/dev/null; do
        tries=$((tries + 1))
        if [ $tries -gt 100 ] || ! kill -0 "$pid" 2>/dev/null; then
            echo "demo: the daemon did not start" >&2
            exit 1
        fi
        sleep 0.1
    done
    cat "$tmp/ready"
    address=$(sed -n 's/^ready on //p' "$tmp/ready")
    port=${address##*:}
    host=${address%:*}
}

say "A daemon on a free port of this machine, with a directory for its data"
start_daemon

say "Cities and towns of the world, \`longitude latitude\` a line (GeoNames, CC-BY 4.0): the line number is the id"
show 1 load cities "$places"

say "The Delaunay triangulation of them all"
show 1 TRIANGULATE cities
show 1 STAT cities

say "The map of it, in the terminal"
show 40 show cities --width 78 --height 22

say "Point lists: who surrounds Paris (56987), Rome (87257), Tokyo (95017), each ring counterclockwise"
show_named 9 LISTS cities 56987 87257 95017

say "The convex hull, from its smallest id"
show_named 8 HULL cities

say "The Eiffel Tower: the triangle that contains it"
show_named 9 LOCATE cities 2.2945 48.8584

say "The places nearest to it. Degrees are not distances, so all are projected to a plane around the tower, in kilometres, with the same ids"
printf '%s$ awk "{ ... }" cities.xy | delaunay load around -%s\n' "$bold" "$plain"
awk -v lon=2.2945 -v lat=48.8584 'BEGIN { r = 6371.0088 * atan2(0, -1) / 180; c = cos(lat * atan2(0, -1) / 180) }
    { printf "%.9g %.9g\n", r * c * ($1 - lon), r * ($2 - lat) }' "$places" |
    "$client" -h "$host" -p "$port" load around -
show 1 TRIANGULATE around
show_named 9 NEAREST around 0 0 5

say "Proof: every edge locally Delaunay, in exact arithmetic"
show 1 CHECK cities

say "A picture of it"
show 1 export cities "$svg"

terrain=$(dirname "$places")/terrain.xyz
if [ -n "$contours" ]; then
    say "A surface: heights around the Jacksboro Fault (SRTM, public domain), the third column, become the field z"
    show 1 load terrain "$terrain"
    show 1 TRIANGULATE terrain
    show 30 show terrain --width 76 --height 20
    show 2 INTERPOLATE terrain z 500 -12000 METHOD natural
    show 1 contour terrain z "$contours" --every 50
fi
examples=$(dirname "$0")/examples
if [ -d "$examples" ]; then
    say "A country's outline, GeoJSON (Natural Earth, public domain): its polygons are borders; Dublin is inside, London is not"
    show 1 load ireland "$examples/ireland.geojson"
    show 2 REGIONS ireland
    show 3 REGIONS ireland AT -6.26 53.35 -0.13 51.51
    show 30 show ireland --geographic --width 60 --height 24
    show 1 export ireland "${svg%.svg}-ireland.svg" --geographic
    say "A terrain with breaklines, a table with WKT: two ridges and the stream between them are edges, so there are bends, not steps"
    show 1 load valley "$examples/valley.csv"
    show 22 show valley --width 76 --height 18
    show 1 VOLUME valley z LEVEL 20
    show 1 contour valley z "${svg%.svg}-valley.svg" --bands --every 4
fi
if [ -n "$cells" ]; then
    say "Voronoi cells: what is nearer to a point than to any other, as \`id corners x y ...\`; and all of them as a picture"
    show 2 VORONOI terrain 12706
    show 1 voronoi terrain "$cells" --viewport=-14955,-15892,14955,15892
fi

say "A crash: what was acknowledged is there again"
printf '%s$ kill -KILL %s%s\n' "$bold" "$pid" "$plain"
kill -KILL "$pid"
wait "$pid" 2>/dev/null || true
start_daemon
until show_named 9 LISTS cities 56987 87257 95017 2>/dev/null >"$tmp/again"; do
    grep -q LOADING "$tmp/reply" || exit 1
    sleep 0.1
done
cat "$tmp/again"

say "Done: the daemon finishes what it has received and leaves"
printf '%s$ kill -TERM %s%s\n' "$bold" "$pid" "$plain"
kill -TERM "$pid"
wait "$pid"
pid=
