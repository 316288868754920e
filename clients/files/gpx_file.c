/* gpx_file.c - see gpx_file.h. */
#include "clients/files/gpx_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/reading/xml_scan.h"
#include "proto/number.h"
#include "proto/text.h"

static const char *const kinds[GPX_KINDS] = {
    [GPX_WPT] = "wpt", [GPX_RTEPT] = "rtept", [GPX_TRKPT] = "trkpt"};

enum { OUTSIDE = 0 };

struct gpx {
    struct points_file *f;
    struct table_fields *fields;
    struct gpx_notes *notes;
    size_t depth;      /* open elements */
    size_t extensions; /* the depth of the outermost open element `extensions`, or OUTSIDE */
    size_t point;      /* that of the point that is open, or OUTSIDE */
    enum gpx_kind kind;
    struct xml_part lon, lat;
    uint64_t line;
    double z;
    bool root; /* the element gpx has been seen */
};

static int kind_of(struct xml_part name)
{
    for (int i = 0; i < GPX_KINDS; i++)
        if (xml_is(name, kinds[i]))
            return i;
    return -1;
}

/* Without blanks around it. */
static struct xml_part trim(struct xml_part v)
{
    while (v.len > 0 && text_is_space(v.text[0])) {
        v.text++;
        v.len--;
    }
    while (v.len > 0 && text_is_space(v.text[v.len - 1]))
        v.len--;
    return v;
}

static bool open_element(struct gpx *g, const struct xml_tag *tag)
{
    int kind = kind_of(tag->name);
    g->depth++;
    if (g->depth == 1 && !xml_is(tag->name, "gpx"))
        return points_file_stop(g->f, "this XML is not GPX: its first element is %.*s",
                                tag->name.len < 40 ? (int)tag->name.len : 40, tag->name.text);
    g->root = true;
    if (g->extensions != OUTSIDE)
        return true;
    if (xml_is(tag->name, "extensions")) {
        g->extensions = g->depth;
    } else if (kind >= 0 && g->point == OUTSIDE) {
        g->point = g->depth;
        g->kind = (enum gpx_kind)kind;
        g->line = tag->line;
        g->z = (double)NAN;
        if (!xml_attribute(tag, "lon", &g->lon))
            g->lon = (struct xml_part){"", 0};
        if (!xml_attribute(tag, "lat", &g->lat))
            g->lat = (struct xml_part){"", 0};
    }
    return true;
}

static bool add_point(struct gpx *g)
{
    struct points_file *f = g->f;
    struct xml_part lon = trim(g->lon), lat = trim(g->lat);
    double v;
    f->line = g->line;
    f->row = &g->z;
    bool ok =
        lon.len > 0 && lat.len > 0 ? true : points_file_fault(f, "a point without lon and lat");
    if (ok && proto_read_double(lat.text, lat.len, &v) && !(fabs(v) <= 90))
        ok = points_file_fault(f, "a latitude is from -90 to 90");
    ok = ok && points_file_add(f, lon.text, lon.len, lat.text, lat.len);
    if (!ok)
        return points_file_skip(f, lat.text, lat.len);
    g->notes->points[g->kind]++;
    g->notes->heights |= !isnan(g->z);
    return true;
}

static void read_elevation(struct gpx *g, struct xml_part text, uint64_t line)
{
    if (proto_read_double(text.text, text.len, &g->z) && isfinite(g->z))
        return;
    g->z = (double)NAN;
    table_fields_note_odd(g->fields, 0, line, text.text, text.len);
}

static bool close_element(struct gpx *g, const struct xml_tag *tag)
{
    bool ok = true;
    if (g->depth == 0)
        return points_file_stop(g->f, "not GPX: an element ends that has not begun");
    if (g->extensions == g->depth) {
        g->extensions = OUTSIDE;
    } else if (g->point != OUTSIDE && g->extensions == OUTSIDE) {
        struct xml_part text = trim(tag->before);
        if (g->depth == g->point + 1 && !tag->opens && xml_is(tag->name, "ele"))
            read_elevation(g, text, tag->line);
        if (g->depth == g->point) {
            ok = add_point(g);
            g->point = OUTSIDE;
        }
    }
    g->depth--;
    return ok;
}

static bool read_tags(struct gpx *g, struct xml_scan *x)
{
    struct xml_tag tag;
    int got;
    while ((got = xml_next(x, &tag)) > 0) {
        g->f->line = tag.line;
        if (tag.opens && !open_element(g, &tag))
            return false;
        if (tag.closes && !close_element(g, &tag))
            return false;
    }
    g->f->line = x->line;
    if (got < 0 || g->depth > 0)
        return points_file_stop(g->f, "not GPX: the file ends within an element");
    return g->root || points_file_stop(g->f, "not GPX: there is no element");
}

bool gpx_text_read(struct points_file *f, const char *text, size_t n, struct table_fields *t,
                   struct gpx_notes *notes)
{
    struct gpx g = {.f = f, .fields = t, .notes = notes, .z = (double)NAN};
    struct xml_scan x = {.p = text, .end = text + n, .line = 1};
    *notes = (struct gpx_notes){.heights = false};
    f->fields = 1; /* the elevations */
    bool ok = read_tags(&g, &x);
    f->row = NULL;
    if (notes->heights)
        table_fields_add_height(t, 0, "ele", 3);
    else
        f->fields = 0;
    return ok;
}

void gpx_describe(const struct gpx_notes *notes, char *to, size_t room)
{
    size_t n = (size_t)snprintf(to, room, "x=lon y=lat%s of", notes->heights ? " z=ele" : "");
    bool any = false;
    for (int i = 0; i < GPX_KINDS; i++) {
        if (notes->points[i] == 0)
            continue;
        n += (size_t)snprintf(to + n, room - n, "%s %ju %s", any ? "," : "",
                              (uintmax_t)notes->points[i], kinds[i]);
        any = true;
    }
    if (!any)
        snprintf(to + n, room - n, " no point");
}
