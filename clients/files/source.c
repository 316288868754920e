/* source.c - see source.h. */
#include "clients/files/source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "clients/files/geojson_file.h"
#include "clients/files/gpx_file.h"
#include "clients/files/input.h"
#include "clients/files/las_file.h"
#include "clients/files/laz_file.h"
#include "clients/files/progress.h"
#include "clients/grids/asc_grid.h"
#include "clients/grids/raster_file.h"
#include "clients/lines/obj_file.h"
#include "clients/lines/poly_file.h"
#include "clients/points/clean_paths.h"

static const struct {
    const char *name;
    enum source_form form;
    bool xyz;
} endings[] = {{"xy", SOURCE_XY, false},           {"csv", SOURCE_TABLE, false},
               {"geojson", SOURCE_GEOJSON, false}, {"node", SOURCE_NODE, false},
               {"xyz", SOURCE_TABLE, true},        {"gpx", SOURCE_GPX, false},
               {"las", SOURCE_LAS, false},         {"poly", SOURCE_POLY, false},
               {"obj", SOURCE_OBJ, false},         {"asc", SOURCE_GRID, false},
               {"ndjson", SOURCE_GEOJSON, false},  {"geojsonl", SOURCE_GEOJSON, false},
               {"jsonl", SOURCE_GEOJSON, false},   {"pts", SOURCE_TABLE, true},
               {"gmt", SOURCE_TABLE, false},       {"wkt", SOURCE_TABLE, false},
               {"json", SOURCE_GEOJSON, false},    {"laz", SOURCE_LAS, false}};

bool source_read_form(const char *name, struct source *s)
{
    for (size_t i = 0; i < 10; i++) /* the names of formats come first */
        if (strcmp(endings[i].name, name) == 0) {
            s->form = endings[i].form;
            s->table.wish.xyz = endings[i].xyz;
            return true;
        }
    return false;
}

/* The ending's length and place, before that of a compressed file. */
static size_t find_ending(const char *path, const char **ending)
{
    static const char *const packed[] = {".gz", ".bz2", ".xz", ".zst"};
    size_t n = strlen(path), dot;
    for (size_t i = 0; i < sizeof packed / sizeof packed[0]; i++) {
        size_t len = strlen(packed[i]);
        if (n > len && strcasecmp(path + n - len, packed[i]) == 0) {
            n -= len;
            break;
        }
    }
    for (dot = n; dot > 0 && path[dot - 1] != '.' && path[dot - 1] != '/';)
        dot--;
    *ending = path + dot;
    return dot > 0 && path[dot - 1] == '.' ? n - dot : 0;
}

static void guess_form(struct source *s, const struct input *in)
{
    const char *ending;
    size_t len = find_ending(in->member[0] != '\0' ? in->member : s->path, &ending);
    s->form = in->las ? SOURCE_LAS : in->grid || in->raster ? SOURCE_GRID : SOURCE_TABLE;
    if (s->table.wish.chosen || s->form != SOURCE_TABLE)
        return;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (len == strlen(endings[i].name) && strncasecmp(ending, endings[i].name, len) == 0 &&
            endings[i].form != SOURCE_GRID) { /* tables have this ending, too */
            s->form = endings[i].form;
            s->table.wish.xyz = endings[i].xyz;
            return;
        }
    if (in->first == '{' || in->first == '[' || in->first == 0x1E)
        s->form = SOURCE_GEOJSON;
    else if (in->first == '<')
        s->form = SOURCE_GPX;
}

const char *source_name(const struct source *s)
{
    return strcmp(s->path, "-") == 0 ? "standard input" : s->path;
}

struct reading {
    struct progress bar;
    uint64_t size; /* bytes of the file, 0 if unknown */
};

static void show_reading(void *ctx, uint64_t bytes, size_t points)
{
    struct reading *r = ctx;
    progress_update(&r->bar, bytes, r->size, points);
}

/* Says which coordinates and properties are used, and what is not. */
static void show_geojson(struct source *s, struct report *r, const struct geojson_notes *notes)
{
    const struct table_fields *t = &s->table.fields;
    size_t room = sizeof s->table.using, n = 0;
    if (t->n > 0)
        n = (size_t)snprintf(s->table.using, room, "x y%s of the coordinates",
                             notes->heights ? " z" : "");
    for (size_t i = notes->heights; i < t->n && n + 2 * FIELDS_NAME < room; i++) {
        bool height = notes->property[0] != '\0' && strcmp(t->name[i], "z") == 0;
        n += (size_t)snprintf(s->table.using + n, room - n, "%s %s%s%s",
                              i == notes->heights ? ", of the properties" : "", t->name[i],
                              height ? "=" : "", height ? notes->property : "");
    }
    if (notes->unused[0] != '\0')
        report_add(r, NOTE_UNUSED, "properties not used: %s%s", notes->unused,
                   t->all ? "" : " (--fields keeps those of numbers)");
    if (notes->more > 0)
        report_add(r, NOTE_UNUSED, "%ju positions have more than x, y and z, which is not used",
                   (uintmax_t)notes->more);
    if (notes->nowhere > 0)
        report_add(r, NOTE_SKIPPED, "%ju without a place (a geometry that is null or empty)",
                   (uintmax_t)notes->nowhere);
}

static bool read_geojson(struct source *s, struct points_file *f, const char *text, size_t n)
{
    struct geojson_notes notes;
    bool ok = geojson_text_read(f, text, n, &s->table.fields, &notes);
    s->geographic = !notes.projected;
    show_geojson(s, &f->report, &notes);
    if (ok)
        survey_note_swapped(f);
    return ok;
}

static bool read_gpx(struct source *s, struct points_file *f, const char *text, size_t n)
{
    struct gpx_notes notes;
    bool ok = gpx_text_read(f, text, n, &s->table.fields, &notes);
    gpx_describe(&notes, s->table.using, sizeof s->table.using);
    const struct odd_value *odd = &s->table.fields.odd[0];
    if (odd->line > 0 && !notes.heights)
        report_add(&f->report, NOTE_MISSING,
                   "no elevation is a number; the first is \"%s\" in line %ju", odd->text,
                   (uintmax_t)odd->line);
    return ok;
}

static bool read_las(struct source *s, struct points_file *f, const struct input *in)
{
    struct table_fields *t = &s->table.fields;
    struct las_notes notes;
    bool compressed, ok;
    if (!las_is_compressed(f, in->fd, &compressed))
        return false;
    if (compressed && (in->member[0] != '\0' || in->child != 0 || in->standard))
        return points_file_stop(
            f, "LAZ is read from a file of its own, not from an archive or a pipe");
    ok = compressed ? laz_file_read(f, s->path, in->fd, t) : las_file_read(f, in->fd, t, &notes);
    snprintf(s->table.using, sizeof s->table.using, "x y z of the points%s",
             ok && t->n > 1 ? ", intensity and classification" : "");
    if (ok && t->n == 1)
        report_add(&f->report, NOTE_UNUSED,
                   "not used: intensity, classification, times and others%s",
                   compressed ? "" : " (--fields keeps intensity and classification)");
    if (ok && !compressed && notes.behind > 0)
        report_add(&f->report, NOTE_DOUBT,
                   "the file has room for %ju more points than its header says; they are not read",
                   (uintmax_t)notes.behind);
    if (ok && !compressed && notes.withheld > 0)
        report_add(&f->report, NOTE_DOUBT,
                   "%ju points are marked as withheld; they are loaded, too",
                   (uintmax_t)notes.withheld);
    if (ok && !compressed && notes.noise > 0)
        report_add(&f->report, NOTE_DOUBT,
                   "%ju points are classified as noise; they are loaded, too",
                   (uintmax_t)notes.noise);
    return ok;
}

static bool read_poly(struct source *s, struct points_file *f, const char *text, size_t n)
{
    struct table_fields *t = &s->table.fields;
    struct poly_notes notes = {0};
    char *node = NULL;
    size_t node_n = 0, shown = 0;
    bool ok = poly_read_node(f, s->path, &node, &node_n) &&
              poly_text_read(f, text, n, node, node_n, t, &notes);
    free(node);
    for (size_t i = 0; i < t->n && shown + FIELDS_NAME + 20 < sizeof s->table.using; i++)
        shown += (size_t)snprintf(s->table.using + shown, sizeof s->table.using - shown, "%s%s",
                                  i == 0 ? "attributes " : " ", t->name[i]);
    if (notes.negative > 0)
        report_add(&f->report, NOTE_DOUBT,
                   "%ju markers of segments are no numbers from 0 to %d and "
                   "become 0",
                   (uintmax_t)notes.negative, PATHS_MOST_NUMBER);
    if (notes.unnamed > 0)
        report_add(&f->report, NOTE_DOUBT,
                   "the attributes of %ju regions are no numbers from 0 to %d; "
                   "their places in the file are taken",
                   (uintmax_t)notes.unnamed, PATHS_MOST_NUMBER);
    if (notes.areas > 0)
        report_add(&f->report, NOTE_UNUSED, "the greatest areas of %ju regions are not used",
                   (uintmax_t)notes.areas);
    return ok;
}

static bool read_obj(struct source *s, struct points_file *f, const char *text, size_t n)
{
    struct obj_notes notes;
    bool ok = obj_text_read(f, text, n, &s->table.fields, &notes);
    if (notes.heights)
        snprintf(s->table.using, sizeof s->table.using, "x y z of the points");
    if (notes.faces > 0)
        report_add(&f->report, NOTE_UNUSED, "%ju faces are not used; their points are",
                   (uintmax_t)notes.faces);
    if (notes.others > 0)
        report_add(&f->report, NOTE_UNUSED, "%ju elements other than points and lines are not used",
                   (uintmax_t)notes.others);
    return ok;
}

static bool read_grid(struct source *s, struct points_file *f, const struct input *in)
{
    struct grid_notes notes;
    bool piped = in->member[0] == '\0' ? in->child != 0 : strcmp(s->path, "-") == 0;
    if (in->raster && (in->standard || piped))
        return points_file_stop(
            f, "a raster is read from a file of its own or a zip archive, not from a pipe");
    bool ok = in->raster ? raster_file_read(f, s->path, in->member, &s->table.fields, &notes)
                         : asc_file_read(f, in->fd, NULL, &s->table.fields, &notes);
    if (!ok)
        return false;
    grid_describe(&notes, s->table.using, sizeof s->table.using);
    s->geographic = notes.frame.geographic;
    if (notes.empty > 0)
        report_add(&f->report, NOTE_SKIPPED, "%ju cell%s without a value (%.17g) %s left out",
                   (uintmax_t)notes.empty, notes.empty == 1 ? "" : "s", notes.nodata,
                   notes.empty == 1 ? "is" : "are");
    return true;
}

/* The formats that are read as a whole. */
static bool read_text(struct source *s, struct points_file *f, int fd)
{
    char *text = NULL;
    size_t n;
    bool ok = points_file_read_all(f, fd, &text, &n);
    if (ok)
        ok = s->form == SOURCE_GEOJSON ? read_geojson(s, f, text, n)
             : s->form == SOURCE_GPX   ? read_gpx(s, f, text, n)
             : s->form == SOURCE_POLY  ? read_poly(s, f, text, n)
                                       : read_obj(s, f, text, n);
    free(text);
    return ok;
}

static bool is_table(const struct source *s)
{
    return s->form == SOURCE_TABLE || s->form == SOURCE_NODE || s->form == SOURCE_XY;
}

static bool read_points(struct source *s, struct points_file *f, const struct input *in)
{
    struct reading r = {.size = in->size};
    s->table.wish.node = s->form == SOURCE_NODE;
    s->table.wish.xy = s->form == SOURCE_XY;
    f->skip_bad = s->skip_bad;
    f->paths.number = s->first_number;
    f->paths.lines_border = s->lines_border;
    if (in->member[0] != '\0')
        report_add(&f->report, NOTE_READ, "reading %s of the archive", in->member);
    if (s->form == SOURCE_LAS)
        return read_las(s, f, in);
    if (s->form == SOURCE_GRID)
        return read_grid(s, f, in);
    if (!is_table(s))
        return read_text(s, f, in->fd);
    progress_start(&r.bar, "reading");
    bool ok = table_file_read(&s->table, f, in->fd, show_reading, &r);
    progress_end(&r.bar);
    return ok;
}

/* Says what of the lines is left out. */
static void note_paths(struct report *r, const struct paths *p)
{
    static const struct {
        const char *one, *many;
    } text[] = {{"step of a line has no length and is left out",
                 "steps of lines have no length and are left out"},
                {"ring has fewer than three corners and is left out",
                 "rings have fewer than three corners and are left out"},
                {"ring is there twice in its polygon; it counts once",
                 "rings are there twice in their polygons; they count once"},
                {"ring does not end where it begins; it is closed",
                 "rings do not end where they begin; they are closed"}};
    const size_t n[] = {p->short_steps, p->flat_rings, p->same_rings, p->open_rings};
    for (size_t i = 0; i < sizeof n / sizeof n[0]; i++)
        if (n[i] > 0)
            report_add(r, i == 3 ? NOTE_DOUBT : NOTE_SKIPPED, "%zu %s", n[i],
                       n[i] == 1 ? text[i].one : text[i].many);
}

/* Says which options of reading have no effect on this file. */
static void note_useless_options(const struct source *s, struct points_file *f)
{
    const bool lines = s->points_only || s->lines_border || s->first_number > 0;
    const struct {
        bool useless;
        const char *text;
    } rows[] = {
        {s->table.wish.chosen && !is_table(s), "--columns is not used: the file is no table"},
        {s->table.wish.skip_lines > 0 && !is_table(s),
         "--skip-lines is not used: the file is no table"},
        {lines && f->paths.n == 0, "--points, --border and --of are not used: there are no lines"},
        {s->wish.nodata_n > 0 && f->fields == 0,
         "--nodata is not used: the points have no values"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (rows[i].useless)
            report_add(&f->report, NOTE_UNUSED, "%s", rows[i].text);
}

/* Joins the lines, or forgets them. */
static bool finish_paths(struct source *s, struct points_file *f)
{
    note_useless_options(s, f);
    if (s->points_only)
        paths_free(&f->paths);
    bool ok = paths_clean(f);
    note_paths(&f->report, &f->paths);
    return ok;
}

bool source_is_geographic(const struct source *s, const struct points_file *f)
{
    const struct plan *p = &s->table.plan;
    bool named =
        is_table(s) ? p->pair == PAIR_LON_LAT && p->headed : s->form == SOURCE_GPX || s->geographic;
    struct range x = survey_range(f, 0), y = survey_range(f, 1);
    return named && x.least >= -360 && x.greatest <= 360 && y.least >= -90 && y.greatest <= 90;
}

static void show_skipped(const char *name, const struct points_file *f)
{
    size_t shown = f->skipped < SKIPPED_SHOWN ? (size_t)f->skipped : SKIPPED_SHOWN;
    for (size_t i = 0; i < shown; i++)
        fprintf(stderr, "delaunay: %s:%ju: skipped, %s: %s\n", name, (uintmax_t)f->skip[i].line,
                f->skip[i].fault, f->skip[i].text);
    if (f->skipped > 0)
        fprintf(stderr, "delaunay: %ju skipped%s, %zu points read\n", (uintmax_t)f->skipped,
                f->skipped > shown ? " in all" : "", f->n);
}

static void fail(struct source *s, const struct points_file *f)
{
    const char *hint = !f->fatal && !s->skip_bad ? " (--skip-bad leaves such out)" : "";
    char line[32] = "";
    if (f->line > 0)
        snprintf(line, sizeof line, ":%ju", (uintmax_t)f->line);
    snprintf(s->message, sizeof s->message, "%s%s: %s; nothing was loaded%s", source_name(s), line,
             f->fault, f->line > 0 ? hint : "");
    fprintf(stderr, "delaunay: %s\n", s->message);
}

bool source_read(struct source *s, struct points_file *f)
{
    char why[300];
    struct input in;
    const char *name = source_name(s);
    if (!input_open(&in, s->path, why, sizeof why)) {
        snprintf(s->message, sizeof s->message, "%s: %s", name, why);
        fprintf(stderr, "delaunay: %s\n", s->message);
        return false;
    }
    if (s->form == SOURCE_GUESS)
        guess_form(s, &in);
    bool ok = read_points(s, f, &in);
    if (!input_close(&in, ok, why, sizeof why)) {
        f->line = 0;
        ok = points_file_stop(f, "%s", why);
    }
    ok = ok && finish_paths(s, f) && survey(f, &s->table, &s->wish);
    if (!ok)
        fail(s, f);
    if (ok && s->table.using[0] != '\0')
        fprintf(stderr, "delaunay: %s: using %s%s\n", name, is_table(s) ? "columns " : "",
                s->table.using);
    report_print(&f->report, name, stderr);
    if (ok)
        show_skipped(name, f);
    return ok;
}

void source_free(struct source *s)
{
    table_file_free(&s->table);
}
