/* subcommand.c - see subcommand.h. */
#include "clients/cli/subcommand.h"

#include <stdio.h>
#include <strings.h>

#include "clients/meshes/line_formats.h"

#define FILE_OPTIONS                                                                               \
    "columns= fields skip-bad skip-lines= nodata= negate= of= border points split dry-run"
#define EXPORT_OPTIONS                                                                             \
    "colour=:PICTURE numbers:POINTS viewport=:PICTURE geographic!planar planar crs=:GEOJSON "
#define DRAW_OPTIONS                                                                               \
    "format=:FILE input-format= " FILE_OPTIONS                                                     \
    " error= most= angle= area= length= keep:angle,area,length limit=:angle,area,length "          \
    "lines:FILE inside=:MESH,angle,area,length field=:HEIGHTS,error,most " EXPORT_OPTIONS "force"
#define CRS_HELP                                                                                   \
    "      --crs CRS         of geojson: the coordinates' reference system, EPSG:32629 for\n"      \
    "                        instance, as the member crs of GeoJSON 2008; RFC 7946 has\n"          \
    "                        longitudes and latitudes only\n"                                      \
    "      --force           replace any file\n"
#define SHAPES_HELP                                                                                \
    "      --geographic      in a picture x and y are longitude and latitude\n" CRS_HELP

const struct subcommand subcommands[] = {
    {"draw", command_draw, true, false, "draw FILE [PICTURE] [OPTION ...]",
     "Draws the Delaunay triangulation of a file of points, as PICTURE.svg or PICTURE.png, or in\n"
     "the terminal. Needs no running server: it starts one for itself and ends it. A PNG is made\n"
     "by rsvg-convert or inkscape.\n\n"
     "  -f, --format F           svg or png; else the picture's ending decides\n"
     "      --input-format F     of the points; as load's --format\n"
     "  -c, --columns X,Y[,Z], --fields, --skip-bad, --skip-lines N, --nodata V, --negate FIELD,\n"
     "      --of K, --border, --points, --split, --dry-run\n"
     "                           as load's; --dry-run needs no PICTURE\n"
     "      --colour C, --field F, --numbers, --viewport X0,Y0,X1,Y1, --inside K, --force\n"
     "                           as export's\n"
     "      --geographic         as export's; usual where the headings are those of degrees\n"
     "      --planar             x and y alike, whatever the headings are\n"
     "      --error E, --most N, --angle D, --area A, --length L, --keep, --limit N\n"
     "                           as run's\n",
     DRAW_OPTIONS, true, NULL},
    {"run", command_draw, true, false, "run FILE MESH [OPTION ...]",
     "Writes the Delaunay triangulation of a file of points, in any format of export. Needs no\n"
     "running server, as draw, and has its options.\n\n"
     "  -f, --format F           of the mesh; else its ending decides\n"
     "      --input-format F, --columns X,Y[,Z], --fields, --skip-bad, --skip-lines N,\n"
     "      --nodata V, --negate FIELD, --of K, --border, --points, --split, --dry-run, --force,\n"
     "      --inside K, --crs CRS\n"
     "                           as export's\n"
     "      --error E            a light mesh: only as many points are kept as its surface needs\n"
     "                           to be within E of every height (z, or --field F)\n"
     "      --most N             at most N points are kept\n"
     "      --angle D            points are added inside borders, or inside the hull, until no\n"
     "                           angle is below D degrees (25 or so),\n"
     "      --area A, --length L no area above A, no edge longer than L\n"
     "      --keep               lines and borders are not divided\n"
     "      --limit N            points that may be added (16 for each one)\n",
     DRAW_OPTIONS, true, NULL},
    {"load", command_load, false, true,
     "load SET FILE [--format F] [--columns X,Y[,Z]] [--fields] [--skip-bad] [--dry-run] ...",
     "Loads the points and lines of a file (- for the standard input) into the set, in binary\n"
     "form. A bad line loads nothing and is named.\n\n"
     "  -f, --format csv      a table: values between commas, semicolons, tabs, bars or blanks\n"
     "  -f, --format xyz      the same; what follows x, y and z does not count\n"
     "  -f, --format xy       lines `x y` and nothing else; # begins a comment\n"
     "  -f, --format geojson  every point, line and polygon\n"
     "  -f, --format node     Triangle's .node file\n"
     "  -f, --format gpx      waypoints, routes and tracks, with elevations\n"
     "  -f, --format las      LAS, and LAZ through pdal or las2txt\n"
     "  -f, --format poly     Triangle's points, segments, holes and regions\n"
     "  -f, --format obj      points and lines of Wavefront OBJ\n"
     "  -f, --format asc      an ESRI ASCII grid: the centres of its cells, with their heights\n"
     "  -c, --columns X,Y[,Z] columns of a table, by name or by number from 1\n"
     "      --fields          every other column of numbers becomes a field\n"
     "      --skip-bad        leave bad lines out; shows the first ones and counts them\n"
     "      --skip-lines N    leave out the first N lines\n"
     "      --nodata V        the value V of a field means that it is missing\n"
     "      --negate FIELD    change the sign of x, y or a field\n"
     "      --of K            the number of the first line or polygon (0)\n"
     "      --border          lines are borders, as polygons are\n"
     "      --points          only points; the lines of the file do not count\n"
     "      --split           lines may cross: they get points where they do\n"
     "      --dry-run         show how the file is read, and load nothing; needs no server\n\n"
     "Without --format the file's ending decides: .xy .xyz .geojson .json .ndjson .node .gpx .las\n"
     ".laz .poly .obj .gmt; else the first bytes: { is GeoJSON, < GPX, LASF LAS, ncols an ASCII\n"
     "grid, anything else a table. GDAL's programs read rasters of one band (.tif .dem .hgt .img\n"
     ".vrt .bil .flt .grd: gdal_translate) and lines and polygons (.shp .gpkg .fgb: ogr2ogr).\n\n"
     "The headings of a table choose the columns, among them x,y  lon,lat  easting,northing\n"
     "POINT_X,POINT_Y  Longitude (deg),...; others are refused. Heights (z, height, elevation,\n"
     "ele, ...; the third of three columns) become the field z. A column of WKT is read, too.\n"
     "Lines and polygons become constraints, and the set is triangulated. What is not used,\n"
     "missing or doubtful is named.\n\n"
     "Compressed files (.gz .bz2 .xz .zst) and UTF-16 are read through gzip, bzip2, xz, zstd,\n"
     "iconv; of a zip archive its only file of points.\n",
     "format= " FILE_OPTIONS, true, NULL},
    {"export", command_export, false, true,
     "export SET FILE [--format F] [--lines] [--colour angle|quality|degree|relief] [--field F] "
     "[--numbers] [--viewport X0,Y0,X1,Y1]",
     "Writes the triangulated set to a file (- for the standard output). An existing\n"
     "file that delaunay did not write, or that was changed since, is replaced only with "
     "--force.\n\n"
     "  -f, --format svg      a drawing (as FILE.svg); png with rsvg-convert or inkscape\n",
     "format= lines inside=:MESH field=:HEIGHTS " EXPORT_OPTIONS "force", true, NULL},
    {"raster", command_raster, false, true,
     "raster SET FIELD FILE [--format F] [--cell SIDE | --width COLUMNS] [--viewport X0,Y0,X1,Y1] "
     "...",
     "Writes the surface of a field as a raster of square cells (- for the standard output).\n"
     "Without a file the words are sent as the request RASTER.\n\n"
     "  -f, --format F        asc, an ESRI ASCII grid; bil, 32-bit floats with a .hdr beside;\n"
     "                        png, a picture of shaded relief with a .pgw beside; tif, a GeoTIFF,\n"
     "                        by GDAL's gdal_translate\n"
     "      --cell SIDE       the side of a cell\n"
     "      --width COLUMNS   or how many cells there are across; else 1000 along the longer side\n"
     "      --viewport BOX    only this part of the plane: X0,Y0,X1,Y1\n"
     "      --method M        linear, natural, laplace, nearest or smooth\n"
     "      --max-edge E      nothing in triangles that have a longer edge\n"
     "      --inside K        only inside the border of number K, or inside any: --inside any\n"
     "      --missing skip    as if points without a value had been deleted\n"
     "      --outside nearest beyond the hull the values at its nearest place\n"
     "      --clip SET        only inside the borders of another set\n"
     "      --crs CRS         the coordinates' reference system, EPSG:32629 for instance: in a\n"
     "                        GeoTIFF, in a .prj beside asc and bil, in a .png.aux.xml beside png\n"
     "      --as QUANTITY     slope, or aspect, the direction downhill: degrees instead of values\n"
     "      --colour C        of a picture: relief (colours by height, and light), light, height\n"
     "      --force           replace any file\n",
     "format= cell=!width width= viewport= method= max-edge= inside= missing= outside= clip= as= "
     "colour=:PICTURE crs=:FILE force",
     true, NULL},
    {"contour", command_contour, false, true,
     "contour SET FIELD FILE [--bands] [--format F] [--every STEP [--base B] | --levels L,L,...] "
     "...",
     "Writes contour lines of a field (- for the standard output), about ten levels unless the\n"
     "options say which. Without a file the words are sent as the request CONTOUR.\n\n"
     "      --bands           the polygons between the levels, with their holes; a filled picture\n"
     "  -f, --format F        geojson, a LineString or Polygon each; wkt; svg, a picture: lines\n"
     "                        on shaded relief\n"
     "      --every STEP      levels at B (0) and at all multiples of STEP from it\n"
     "      --levels L,L,...  these levels; of bands also -inf and inf\n"
     "      --max-edge E      none in triangles that have a longer edge\n"
     "      --inside K        only inside the border of number K, or inside any: --inside any\n"
     "      --missing skip    as if points without a value had been deleted\n"
     "      --viewport BOX    of a picture, only this part of the plane: X0,Y0,X1,Y1\n"
     "      --no-labels       no levels along the lines of a picture\n" SHAPES_HELP,
     "bands format= every= base= levels=!every,base max-edge= inside= missing= viewport=:PICTURE "
     "no-labels:PICTURE geographic crs=:GEOJSON force",
     true, NULL},
    {"voronoi", command_voronoi, false, true,
     "voronoi SET FILE [--format F] [--viewport X0,Y0,X1,Y1] [--field F] [--force]",
     "Writes the Voronoi cells of the triangulated set (- for the standard output). Without a\n"
     "file the words are sent as the request VORONOI.\n\n"
     "  -f, --format F        geojson, a Polygon each; wkt; svg, a picture. Else the file's\n"
     "                        ending\n"
     "      --viewport BOX    clips the cells: X0,Y0,X1,Y1; else the box around all points, grown\n"
     "                        by half; in a picture by a twentieth\n"
     "      --field F         colours the cells of the picture by a field; without it by z, if\n"
     "                        there is one\n" SHAPES_HELP,
     "format= viewport= field=:PICTURE geographic crs=:GEOJSON force", true, NULL},
    {"alpha", command_alpha, false, true,
     "alpha SET RADIUS FILE [--format F] [--viewport X0,Y0,X1,Y1] [--force]",
     "Writes the alpha shape of the triangulated set: the union of the triangles whose\n"
     "circumradius is at most RADIUS (- for the standard output); auto: the least radius that\n"
     "gives one piece with all points. Without a file the words are sent as the request ALPHA.\n\n"
     "  -f, --format F        geojson, a Polygon with its holes each; wkt; svg, a picture\n"
     "      --viewport BOX    of a picture, only this part of the plane: X0,Y0,X1,Y1\n" SHAPES_HELP,
     "format= viewport=:PICTURE geographic crs=:GEOJSON force", true, NULL},
    {"show", command_show, false, true,
     "show SET [--width COLUMNS] [--height LINES] [--field F | --mesh] [--plain]",
     "Draws the triangulated set in the terminal, in braille characters; the hull in red, lines\n"
     "in cyan, borders in magenta. A set with heights, in the field F or z, is drawn as shaded\n"
     "relief, unless --mesh is given. Without --width and --height it fills the terminal;\n"
     "--plain leaves colours out, as $NO_COLOR does. With --geographic x and y are longitude and\n"
     "latitude.\n",
     "width= height= field=!mesh mesh plain geographic", false, NULL},
    {"trace", command_trace, false, true, "trace SET [FILE] [--seconds S] [--numbers] [--force]",
     "Writes an SVG that plays in a browser (- for the standard output): how the shelling\n"
     "algorithm triangulates the set, which has at most 1000 points; some 30 are good to follow.\n"
     "Without a file the steps are printed as the server sends them.\n\n"
     "      --seconds S       how long the film is, from 1; else each step takes about a third\n"
     "      --numbers         ids beside the points\n"
     "      --force           replace any file, not only one that delaunay has written\n\n"
     "Orange: the front, and where the third point of an edge (the arrow) is looked for. A\n"
     "triangle is green where it takes in a new point, yellow for a right touch, blue for a left\n"
     "touch; an edge is purple while it waits before a cave, brown once it is known to be on the\n"
     "hull. A point turns red when it is enclosed and leaves the grid, then pale.\n",
     "seconds= numbers force", true, NULL},
    {"top", command_top, false, false, "top [--once]",
     "Shows what the server is doing, every second, until q is pressed; p pauses, s sorts the\n"
     "commands by calls or by time. With --once, or where there is no terminal, it prints lines.\n",
     "once", false, NULL},
    {"watch", command_watch, false, true,
     "watch SET [SINCE VERSION] [WITHIN X0 Y0 X1 Y1] [FIELDS F,F] [CONSTRAINTS]",
     "Prints what changes in a set as it changes, first everything, until the set is dropped or\n"
     "^C is pressed: places and rings of points, after a line EVENT or, with --json, an object\n"
     "for each event. SINCE continues at a version, WITHIN shows a box, FIELDS adds values to the\n"
     "points.\n",
     NULL, false, "SINCE WITHIN FIELDS"},
    {"metrics", command_metrics, false, false, "metrics",
     "Prints INFO in the text format of Prometheus.\n", NULL, false, NULL},
    {"copy", command_copy, true, false, "copy SET URL URL",
     "Copies a set, its tolerance, ids and fields from the first daemon to the second, where\n"
     "there must be none of that name, and triangulates it there if it is triangulated here. A\n"
     "URL is delaunay://[:TOKEN@]HOST[:PORT][/NAME]; a NAME in the second one is the copy's.\n",
     NULL, false, NULL},
    {"completion", command_completion, true, false, "completion [bash|zsh|fish]",
     "Prints a script that completes commands, options, sets and files in that shell, bash if\n"
     "none is named: source <(delaunay completion bash), or in fish: delaunay completion fish |\n"
     "source\n",
     NULL, false, "bash zsh fish"},
    {"info", NULL, false, false, "info [SECTION ...]",
     "Facts about the server; with sections (server, clients, memory, stats, sets, durability,\n"
     "replication, commands) those of these only.\n",
     NULL, false, "server clients memory stats sets durability replication commands"},
    {"follow", NULL, false, false, "follow ADDRESS PORT [confirm] | follow none",
     "Lets the server follow another one, its leader; none makes it a leader. With confirm its\n"
     "own changes are discarded where the leader does not have them.\n",
     NULL, false, "none confirm"},
#include "clients/cli/subcommand_rows.h"
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
    for (size_t i = 0; i < line_format_count; i++)
        printf("%s-f, --format %-8s %s\n",
               format_find(line_formats[i].name) != NULL ? "  --lines " : "  ",
               line_formats[i].name, line_formats[i].what);
    fputs(
        "      --colour angle    by the least angle, from dark red by yellow to blue-green\n"
        "      --colour quality  dark red: flat triangles; dark blue: equilateral ones\n"
        "      --colour degree   by the mean number of triangles at the corners\n"
        "      --colour relief   by height, with light and shadow, without edges and points\n"
        "      --field F         the field of heights; else z, if there is one\n"
        "      --numbers         ids beside the points, however many there are\n"
        "      --inside K        only inside the border of number K, or inside any: --inside any\n"
        "      --viewport BOX    only this part of the plane: X0,Y0,X1,Y1\n"
        "      --geographic      x and y are longitude and latitude: a map in km\n" CRS_HELP "\n"
        "Without --format the file's ending decides. Points are numbered 0, 1, 2, ... by id\n"
        "(OBJ and 2DM: from 1), which is the id itself unless points have been deleted.\n",
        stdout);
}
