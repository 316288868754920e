/* subcommand.c - see subcommand.h. */
#include "clients/cli/subcommand.h"

#include <stdio.h>
#include <strings.h>

#include "clients/meshes/formats.h"

const struct subcommand subcommands[] = {
    {"draw", command_draw, true, false, "draw FILE [PICTURE] [OPTION ...]",
     "Draws the Delaunay triangulation of a file of points, as PICTURE.svg or PICTURE.png, or in "
     "the\n"
     "terminal. Needs no running server: it starts one for itself and ends it. A PNG is made by\n"
     "rsvg-convert or inkscape.\n\n"
     "  -f, --format F           svg or png; else the picture's ending decides\n"
     "      --input-format F     of the points; as load's --format\n"
     "  -c, --columns X,Y[,Z], --fields, --skip-bad, --skip-lines N, --nodata V, --negate FIELD,\n"
     "      --dry-run            as load's; --dry-run needs no PICTURE\n"
     "      --colour C, --field F, --numbers, --viewport X0,Y0,X1,Y1, --force   as export's\n"
     "      --geographic         as export's; usual where the headings are those of degrees\n"
     "      --planar             x and y alike, whatever the headings are\n",
     "--format --input-format --columns --fields --skip-bad --skip-lines --nodata --negate "
     "--dry-run "
     "--colour --field --numbers --viewport --geographic --planar --force --help",
     true},
    {"run", command_draw, true, false, "run FILE MESH [OPTION ...]",
     "Writes the Delaunay triangulation of a file of points, in any format of export. Needs no\n"
     "running server, as draw, and has its options.\n\n"
     "  -f, --format F           of the mesh; else its ending decides\n"
     "      --input-format F, --columns X,Y[,Z], --fields, --skip-bad, --skip-lines N, --nodata "
     "V,\n"
     "      --negate FIELD, --dry-run, --force\n",
     "--format --input-format --columns --fields --skip-bad --skip-lines --nodata --negate "
     "--dry-run "
     "--colour --field --numbers --viewport --geographic --planar --force --help",
     true},
    {"load", command_load, false, true,
     "load SET FILE [--format F] [--columns X,Y[,Z]] [--fields] [--skip-bad] [--dry-run] ...",
     "Loads the points of a file (- for the standard input) into the set, in binary form. A bad "
     "line\n"
     "loads nothing and is named.\n\n"
     "  -f, --format csv      a table: values between commas, semicolons, tabs, bars or blanks\n"
     "  -f, --format xyz      the same; what follows x, y and z does not count\n"
     "  -f, --format xy       lines `x y` and nothing else; # begins a comment\n"
     "  -f, --format geojson  every Point and MultiPoint\n"
     "  -f, --format node     Triangle's .node file\n"
     "  -f, --format gpx      waypoints, routes and tracks, with elevations\n"
     "  -f, --format las      LAS, and LAZ through pdal or las2txt\n"
     "  -c, --columns X,Y[,Z] columns of a table, by name or by number from 1\n"
     "      --fields          every other column of numbers becomes a field\n"
     "      --skip-bad        leave bad lines out; shows the first ones and counts them\n"
     "      --skip-lines N    leave out the first N lines\n"
     "      --nodata V        the value V of a field means that it is missing\n"
     "      --negate FIELD    change the sign of x, y or a field\n"
     "      --dry-run         show how the file is read, and load nothing; needs no server\n\n"
     "Without --format the file's ending decides: .xy .xyz .geojson .json .ndjson .node .gpx .las "
     ".laz;\n"
     "else the first bytes: { is GeoJSON, < GPX, LASF LAS, anything else a table. The headings of "
     "a table choose the "
     "columns,\n"
     "among them x,y  lon,lat  easting,northing  POINT_X,POINT_Y  Longitude (deg),...; others are\n"
     "refused. Heights (z, height, elevation, ele, ...; the third of three columns) become the "
     "field "
     "z.\n"
     "A column of WKT points is read, too. What is not used, missing or doubtful is named.\n"
     "Compressed files (.gz .bz2 .xz .zst)\n"
     "and UTF-16 are read through gzip, bzip2, xz, zstd, iconv; of a zip archive its only file of "
     "points.\n",
     "--format --columns --fields --skip-bad --skip-lines --nodata --negate --dry-run --help",
     true},
    {"export", command_export, false, true,
     "export SET FILE [--format F] [--colour quality|degree|relief] [--field F] [--numbers] "
     "[--viewport X0,Y0,X1,Y1]",
     "Writes the triangulated set to a file (- for the standard output). An "
     "existing\n"
     "file that delaunay did not write, or that was changed since, is replaced only with "
     "--force.\n\n"
     "  -f, --format svg      a drawing (as FILE.svg); png with rsvg-convert or inkscape\n",
     "--format --colour --field --numbers --viewport --geographic --planar --force --help", true},
    {"raster", command_raster, false, true,
     "raster SET FIELD FILE [--format F] [--cell SIDE | --width COLUMNS] [--viewport X0,Y0,X1,Y1] "
     "...",
     "Writes the surface of a field as a raster of square cells (- for the standard output). "
     "Without a\n"
     "file the words are sent as the request RASTER.\n\n"
     "  -f, --format F        asc, an ESRI ASCII grid; bil, 32-bit floats with a .hdr beside; png, "
     "a\n"
     "                        picture of shaded relief with a .pgw beside; tif, a GeoTIFF, by "
     "GDAL's gdal_translate\n"
     "      --cell SIDE       the side of a cell\n"
     "      --width COLUMNS   or how many cells there are across; else 1000 along the longer side\n"
     "      --viewport BOX    only this part of the plane: X0,Y0,X1,Y1\n"
     "      --method M        linear, natural, laplace or nearest\n"
     "      --max-edge E      nothing in triangles that have a longer edge\n"
     "      --colour C        of a picture: relief (colours by height, and light), light, height\n"
     "      --force           replace any file\n",
     "--format --cell --width --viewport --method --max-edge --colour --force --help", true},
    {"contour", command_contour, false, true,
     "contour SET FIELD FILE [--format F] [--every STEP [--base B] | --levels L,L,...] ...",
     "Writes contour lines of a field (- for the standard output), about ten levels unless the "
     "options\n"
     "say which. Without a file the words are sent as the request CONTOUR.\n\n"
     "  -f, --format F        geojson, a LineString each; wkt; svg, a picture on shaded relief\n"
     "      --every STEP      levels at B (0) and at all multiples of STEP from it\n"
     "      --levels L,L,...  these levels\n"
     "      --max-edge E      none in triangles that have a longer edge\n"
     "      --viewport BOX    of a picture, only this part of the plane: X0,Y0,X1,Y1\n"
     "      --geographic      in a picture x and y are longitude and latitude\n"
     "      --force           replace any file\n",
     "--format --every --base --levels --max-edge --viewport --geographic --force --help", true},
    {"voronoi", command_voronoi, false, true,
     "voronoi SET FILE [--format F] [--viewport X0,Y0,X1,Y1] [--field F] [--force]",
     "Writes the Voronoi cells of the triangulated set (- for the standard output). Without a file "
     "the\n"
     "words are sent as the request VORONOI.\n\n"
     "  -f, --format F        geojson, a Polygon each; wkt; svg, a picture. Else the file's "
     "ending\n"
     "      --viewport BOX    clips the cells: X0,Y0,X1,Y1; else the box around all points, grown "
     "by half;\n"
     "                        in a picture by a twentieth\n"
     "      --geographic      in a picture x and y are longitude and latitude\n"
     "      --field F         colours the cells of the picture by a field; without it by z, if "
     "there is one\n"
     "      --force           replace any file\n",
     "--format --viewport --field --geographic --force --help", true},
    {"alpha", command_alpha, false, true,
     "alpha SET RADIUS FILE [--format F] [--viewport X0,Y0,X1,Y1] [--force]",
     "Writes the alpha shape of the triangulated set: the union of the triangles whose "
     "circumradius is "
     "at\n"
     "most RADIUS (- for the standard output). Without a file the words are sent as the request "
     "ALPHA.\n\n"
     "  -f, --format F        geojson, a Polygon with its holes each; wkt; svg, a picture\n"
     "      --viewport BOX    of a picture, only this part of the plane: X0,Y0,X1,Y1\n"
     "      --geographic      in a picture x and y are longitude and latitude\n"
     "      --force           replace any file\n",
     "--format --viewport --geographic --force --help", true},
    {"show", command_show, false, true,
     "show SET [--width COLUMNS] [--height LINES] [--field F | --mesh] [--plain]",
     "Draws the triangulated set in the terminal, in braille characters; the hull in red. A set "
     "with\n"
     "heights, in the field F or z, is drawn as shaded relief, unless --mesh is given. Without\n"
     "--width and --height it fills the terminal; --plain leaves colours out, as\n"
     "$NO_COLOR does. With --geographic x and y are longitude and latitude.\n",
     "--width --height --field --mesh --plain --geographic --help", false},
    {"trace", command_trace, false, true, "trace SET [FILE] [--seconds S] [--numbers] [--force]",
     "Writes an SVG that plays in a browser (- for the standard output): how the shelling "
     "algorithm\n"
     "triangulates the set, which has at most 1000 points; some 30 are good to follow.\n"
     "Without a file the steps are printed as the server sends them.\n\n"
     "      --seconds S       how long the film is, from 1; else each step takes about a third\n"
     "      --numbers         ids beside the points\n"
     "      --force           replace any file, not only one that delaunay has written\n\n"
     "Orange: the front, and where the third point of an edge (the arrow) is looked for. A "
     "triangle\n"
     "is green where it takes in a new point, yellow for a right touch, blue for a left touch; an\n"
     "edge is purple while it waits before a cave, brown once it is known to be on the hull. A "
     "point\n"
     "turns red when it is enclosed and leaves the grid, then pale.\n",
     "--seconds --numbers --force --help", true},
    {"top", command_top, false, false, "top [--once]",
     "Shows what the server is doing, every second, until q is pressed; p pauses, s sorts the "
     "commands\n"
     "by calls or by time. With --once, or where there is no terminal, it prints lines.\n",
     "--once --help", false},
    {"watch", command_watch, false, true,
     "watch SET [SINCE VERSION] [WITHIN X0 Y0 X1 Y1] [FIELDS F,F]",
     "Prints what changes in a set as it changes, first everything, until the set is dropped or "
     "^C is\n"
     "pressed: places and rings of points, after a line EVENT or, with --json, an object for each\n"
     "event. SINCE continues at a version, WITHIN shows a box, FIELDS adds values to the points.\n",
     "SINCE WITHIN FIELDS --help", false},
    {"metrics", command_metrics, false, false, "metrics",
     "Prints INFO in the text format of Prometheus.\n", "--help", false},
    {"copy", command_copy, true, false, "copy SET URL URL",
     "Copies a set, its tolerance, ids and fields from the first daemon to the second, where there "
     "must be\n"
     "none of that name, and triangulates it there if it is triangulated here. A URL is\n"
     "delaunay://[:TOKEN@]HOST[:PORT][/NAME]; a NAME in the second one is the copy's.\n",
     "--help", false},
    {"completion", command_completion, true, false, "completion [bash|zsh|fish]",
     "Prints a script that completes commands, options, sets and files in that shell, bash if none "
     "is\n"
     "named: source <(delaunay completion bash), or in fish: delaunay completion fish | source\n",
     "--help", false},
    {"triangulate", NULL, false, true, "triangulate SET [METHOD auto|shelling|divide]",
     "Computes the Delaunay triangulation; shows progress while it takes long.\n", "--help", false},
    {"lists", NULL, false, true, "lists SET [ID ...] [CW]",
     "Each point with the ring of its neighbours, interior points first, then along the hull.\n",
     "--help", false},
    {"triangles", NULL, false, true, "triangles SET [A [B [C]]] [CW]",
     "Every triangle, or those at a point, at an edge, next to a triangle.\n", "--help", false},
    {"edges", NULL, false, true, "edges SET [A] [CW]", "Every edge, or those at a point.\n",
     "--help", false},
    {"hull", NULL, false, true, "hull SET [CW]", "The points of the convex hull.\n", "--help",
     false},
    {"nearest", NULL, false, true, "nearest SET X Y [K]", "The K nearest points, nearest first.\n",
     "--help", false},
    {"within", NULL, false, true, "within SET X0 Y0 X1 Y1 | within SET X Y R",
     "The points in a closed box or disc.\n", "--help", false},
    {"locate", NULL, false, true, "locate SET X Y", "The triangle, edge or point where X Y lies.\n",
     "--help", false},
    {"create", NULL, false, true, "create SET [TOL T]",
     "A new, empty set with coincidence tolerance T.\n", "--help", false},
    {"add", NULL, false, true, "add SET X Y [X Y ...]", "Adds points.\n", "--help", false},
    {"move", NULL, false, true, "move SET ID X Y", "Moves a point, which keeps its id.\n", "--help",
     false},
    {"del", NULL, false, true, "del SET ID [ID ...]", "Deletes points.\n", "--help", false},
    {"get", NULL, false, true, "get SET ID [ID ...]", "The coordinates of points.\n", "--help",
     false},
    {"coincident", NULL, false, true, "coincident SET", "Every alias and its representative.\n",
     "--help", false},
    {"points", NULL, false, true, "points SET", "Every point: id, x, y.\n", "--help", false},
    {"stat", NULL, false, true, "stat SET", "Counts and memory of a set.\n", "--help", false},
    {"digest", NULL, false, true, "digest SET",
     "A number of everything in a set, with its version: equal sets have the same.\n", "--help",
     false},
    {"check", NULL, false, true, "check SET", "Proves the triangulation exactly.\n", "--help",
     false},
    {"drop", NULL, false, true, "drop SET", "Deletes a set.\n", "--help", false},
    {"expire", NULL, false, true, "expire SET SECONDS",
     "Drops the set after this number of seconds.\n", "--help", false},
    {"ttl", NULL, false, true, "ttl SET", "In how many seconds a set is dropped.\n", "--help",
     false},
    {"persist", NULL, false, true, "persist SET", "Takes expire back: the set stays.\n", "--help",
     false},
    {"sets", NULL, false, false, "sets", "The sets, with their number of points.\n", "--help",
     false},
    {"info", NULL, false, false, "info [SECTION ...]",
     "Facts about the server; with sections (server, clients, memory, stats, sets, durability,\n"
     "replication, commands) those of these only.\n",
     "server clients memory stats sets durability replication commands --help", false},
    {"follow", NULL, false, false, "follow ADDRESS PORT [confirm] | follow none",
     "Lets the server follow another one, its leader; none makes it a leader. With confirm its "
     "own\n"
     "changes are discarded where the leader does not have them.\n",
     "none confirm --help", false},
    {"wait", NULL, false, false, "wait FOLLOWERS SECONDS",
     "Waits until this number of followers is connected and receives the log.\n", "--help", false},
    {"backup", NULL, false, false, "backup NAME",
     "Writes a backup of the data directory, in use, below the server's --backup-dir.\n", "--help",
     false},
    {"client", NULL, false, false, "client LIST | client KILL ID | client KILL ADDRESS",
     "Who is connected to the server; ends connections.\n", "LIST KILL --help", false},
    {"slowlog", NULL, false, false, "slowlog GET [N] | slowlog LEN | slowlog RESET",
     "The last requests that took long.\n", "GET LEN RESET --help", false},
};

const size_t subcommand_count = sizeof subcommands / sizeof subcommands[0];

const struct subcommand *subcommand_find(const char *name)
{
    for (size_t i = 0; i < subcommand_count; i++)
        if (strcasecmp(subcommands[i].name, name) == 0)
            return &subcommands[i];
    return NULL;
}

void subcommand_print_help(const struct subcommand *s)
{
    printf("usage: delaunay [-h HOST] [-p PORT] [-u URL] %s\n\n%s", s->usage, s->help);
    if (s->run != command_export)
        return;
    for (size_t i = 0; i < format_count; i++)
        printf("  -f, --format %-8s %s\n", formats[i].name, formats[i].what);
    fputs("      --colour quality  dark red: flat triangles; dark blue: equilateral ones\n"
          "      --colour degree   by the mean number of triangles at the corners\n"
          "      --colour relief   by height, with light and shadow, without edges and points\n"
          "      --field F         the field of heights; else z, if there is one\n"
          "      --numbers         ids beside the points, however many there are\n"
          "      --viewport BOX    only this part of the plane: X0,Y0,X1,Y1\n"
          "      --geographic      x and y are longitude and latitude: a map with a scale in km\n"
          "      --force           replace any file\n\n"
          "Without --format the file's ending decides. Points are numbered 0, 1, 2, ... by id (OBJ "
          "and\n"
          "2DM: from 1), which is the id itself unless points have been deleted.\n",
          stdout);
}
