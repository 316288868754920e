/* vrt_frame.c - see vrt_frame.h. */
#include "clients/grids/vrt_frame.h"

#include <math.h>
#include <string.h>

#include "clients/reading/xml_scan.h"
#include "proto/number.h"
#include "proto/text.h"

enum { TERMS = 6 };

struct vrt {
    unsigned bands, masks; /* a mask is one of the bands */
    bool sized, placed, complex_values;
    double term[TERMS]; /* x = term[0] + column * term[1] + row * term[2], y = term[3] + ... */
};

static bool read_size(const struct xml_tag *tag, const char *name, uint32_t *size)
{
    struct xml_part text;
    return xml_attribute(tag, name, &text) && proto_read_u32(text.text, text.len, size) &&
           *size > 0;
}

/* Six numbers between commas and blanks. */
static bool read_terms(struct xml_part text, double *term)
{
    const char *p = text.text, *end = p + text.len;
    for (int i = 0; i < TERMS; i++) {
        while (p < end && (text_is_space(*p) || *p == ','))
            p++;
        size_t len = proto_read_leading_double(p, (size_t)(end - p), &term[i]);
        if (len == 0 || !isfinite(term[i]))
            return false;
        p += len;
    }
    return true;
}

static bool has(struct xml_part part, const char *word)
{
    return memmem(part.text, part.len, word, strlen(word)) != NULL;
}

/* A system of longitudes and latitudes, alone or with heights [OGC 01-009, OGC 18-010r7]. A projected system has one, too. */
static bool is_geographic(struct xml_part system)
{
    return (has(system, "GEOGCS[") || has(system, "GEOGCRS[") || has(system, "GEOGRAPHICCRS[")) &&
           !has(system, "PROJCS[") && !has(system, "PROJCRS[") && !has(system, "PROJECTEDCRS[");
}

static void take_band(struct vrt *v, const struct xml_tag *tag)
{
    struct xml_part type;
    v->bands++;
    v->complex_values |= xml_attribute(tag, "dataType", &type) && type.len > 0 &&
                         type.text[0] == 'C'; /* CFloat32 and others */
}

static void take_tag(struct vrt *v, const struct xml_tag *tag, struct grid_frame *g)
{
    if (tag->opens && xml_is(tag->name, "VRTDataset"))
        v->sized =
            read_size(tag, "rasterXSize", &g->columns) && read_size(tag, "rasterYSize", &g->rows);
    else if (tag->opens && xml_is(tag->name, "VRTRasterBand"))
        take_band(v, tag);
    else if (tag->opens && xml_is(tag->name, "MaskBand"))
        v->masks++;
    else if (tag->closes && (xml_is(tag->name, "Scale") || xml_is(tag->name, "Offset")))
        g->scaled = true;
    else if (tag->closes && xml_is(tag->name, "GeoTransform"))
        v->placed = read_terms(tag->before, v->term);
    else if (tag->closes && xml_is(tag->name, "SRS"))
        g->geographic = is_geographic(tag->before);
}

const char *vrt_read_frame(const char *text, size_t n, struct grid_frame *g)
{
    struct xml_scan x = {.p = text, .end = text + n, .line = 1};
    struct vrt v = {.bands = 0};
    struct xml_tag tag;
    int got;
    *g = (struct grid_frame){.first = {0.5, 0.5}};
    while ((got = xml_next(&x, &tag)) > 0)
        take_tag(&v, &tag, g);
    if (got < 0 || !v.sized || v.bands == 0)
        return "GDAL's description of the raster is not understood";
    if (v.bands > 1 + v.masks)
        return "the raster has several bands; gdal_translate -b 1 IN OUT chooses one";
    if (v.masks > 0)
        return "the raster has a mask; gdalwarp -dstnodata VALUE IN OUT gives the cells that it "
               "hides a value that means: none";
    if (v.complex_values)
        return "the values of the raster are complex numbers";
    if (!v.placed)
        return "the raster does not say where it lies; gdal_translate -a_ullr LEFT TOP RIGHT "
               "BOTTOM "
               "IN OUT adds that";
    for (int axis = 0; axis < 2; axis++) {
        g->origin[axis] = v.term[3 * axis];
        g->column[axis] = v.term[3 * axis + 1];
        g->row[axis] = v.term[3 * axis + 2];
    }
    if (g->column[0] * g->row[1] == g->column[1] * g->row[0])
        return "the cells of the raster have no area";
    return NULL;
}
