/* cmd_surface.c - the commands about surfaces: values at points, and what is between them. */
#include "server/command/command.h"

#include "server/bodies/load.h"
#include "server/command/options.h"
#include "server/command/prefetch.h"
#include "server/jobs/missing_skip.h"
#include "server/ops/limits.h"
#include "server/replies/query.h"
#include "server/replies/regions.h"
#include "server/replies/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const methods[] = {
    [DT_LINEAR] = "linear",   [DT_NATURAL] = "natural", [DT_LAPLACE] = "laplace",
    [DT_CLOSEST] = "nearest", [DT_SMOOTH] = "smooth",   NULL};

/* Whether values can be found by this method; else the ERR line has been written. */
static bool check_method(struct answer *a, const struct version *v, enum dt_interpolation how)
{
    return (how != DT_NATURAL && how != DT_LAPLACE) || check_delaunay(a, v);
}

/* Each field would need points of its own. */
static void refuse_skip(struct answer *a)
{
    answer_err(a, ERR_SYNTAX, "MISSING skip is for one field");
}

/* Finds the source of a surface of the field, and sees to its regions. False: the request waits, or the ERR line has been written. */
static bool find_source(struct server *s, struct answer *a, struct dataset *set,
                        const struct dt_field *field, bool skip, struct inside inside,
                        struct surface_source *from)
{
    *from = (struct surface_source){.version = set->current, .set = set};
    if (skip && !missing_skip_ready(s, a, set, field, &from->version))
        return false;
    if (from->version != set->current)
        from->set = NULL;
    if (!inside.asked)
        return true;
    return from->set != NULL ? regions_ready(s, a, set, inside)
                             : regions_check(a, from->version->dt, inside);
}

/* Whether the surface can be computed now, from *from; else the request waits, or the ERR line has been written. */
static bool is_ready(struct server *s, struct answer *a, struct dataset *set, struct surface *q,
                     struct surface_source *from)
{
    if (q->skip && q->n_fields > 1) {
        refuse_skip(a);
        return false;
    }
    if (!find_source(s, a, set, dt_field_find(set->current->dt, q->field, q->field_len), q->skip,
                     q->inside, from) ||
        !check_method(a, from->version, q->how))
        return false;
    if (from->set == NULL)
        q->fields[0] = dt_field_find(from->version->dt, q->field, q->field_len);
    return true;
}

void cmd_weights(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    static const struct option method = {"METHOD", OPTION_CHOICE, .names = methods};
    struct query query = {.kind = QUERY_WEIGHTS, .how = DT_LINEAR};
    if (!options_read(a, q, 4, set, &method, 1, ~0u, &query.how))
        return;
    if (query.how >= DT_CLOSEST)
        answer_usage(a);
    else if (check_method(a, set->current, query.how) && read_place(a, q, &query.place))
        query_answer(s, a, set, &query);
}

/* ---- arguments ---- */

enum { METHOD, MAXEDGE, BINARY, EVERY, BASE, INSIDE, OUTSIDE, CLIP, BANDS, AS, MISSING, OPTIONS };

/* The options of values at places, of rasters, and of contours. */
enum {
    LINEAR_OPTIONS = 1 << MAXEDGE | 1 << INSIDE | 1 << MISSING,
    VALUE_OPTIONS = LINEAR_OPTIONS | 1 << METHOD | 1 << OUTSIDE,
    RASTER_OPTIONS = VALUE_OPTIONS | 1 << AS | 1 << BINARY | 1 << CLIP,
    LEVEL_OPTIONS = LINEAR_OPTIONS | 1 << BANDS,
    EVERY_OPTIONS = LEVEL_OPTIONS | 1 << EVERY | 1 << BASE
};

static const char *const slopes[] = {"slope", "aspect", NULL};
static const char *const outside[] = {"nan", "nearest", NULL};
static const char *const missing[] = {"nan", "skip", NULL};

static bool check_step(struct answer *a, const struct word *w, const void *value)
{
    return *(const double *)value > 0 || answer_err(a, ERR_RANGE, "a step is greater than 0");
}

#define AT(FIELD) .offset = offsetof(struct surface, FIELD)

static const struct option options[OPTIONS] = {
    [METHOD] = {"METHOD", OPTION_CHOICE, AT(how), .names = methods},
    [MAXEDGE] = {"MAXEDGE", OPTION_LENGTH, AT(max_edge), .what = "length"},
    [BINARY] = {"BINARY", OPTION_FLAG, AT(binary)},
    [EVERY] = {"EVERY", OPTION_FINITE, AT(step), .what = "step", .check = check_step},
    [BASE] = {"BASE", OPTION_FINITE, AT(base), .what = "base"},
    [INSIDE] = {"INSIDE", OPTION_INSIDE, AT(inside)},
    [OUTSIDE] = {"OUTSIDE", OPTION_EITHER, AT(beyond), .names = outside},
    [CLIP] = {"CLIP", OPTION_WORD, AT(other)},
    [BANDS] = {"BANDS", OPTION_FLAG, AT(bands)},
    [AS] = {"AS", OPTION_CHOICE, AT(quantity), .names = slopes, .first = DT_SLOPE},
    [MISSING] = {"MISSING", OPTION_EITHER, AT(skip), .names = missing},
};

/* The word at which the options begin, behind the field and numbers. */
static size_t first_option(const struct request *q)
{
    size_t at = 3;
    while (at < q->n && option_find(options, OPTIONS, &q->word[at]) == OPTIONS)
        at++;
    return at;
}

static bool read_options(struct answer *a, const struct request *q, size_t at, unsigned allowed,
                         struct surface *out)
{
    return options_read(a, q, at, NULL, options, OPTIONS, allowed, out);
}

/* Finds the fields of the names `a,b,c`; the first of them alone gives the surface its name. */
static bool find_all_fields(struct answer *a, const struct dataset *set, const struct word *names,
                            struct surface *out)
{
    const struct dt_field **field = find_fields(a, set, names, &out->n_fields);
    if (field == NULL)
        return false;
    for (size_t i = 0; i < out->n_fields; i++)
        out->fields[i] = field[i];
    free(field);
    return true;
}

/* The surface of the field that the third word names; of values, of several. */
static bool begin(struct answer *a, const struct dataset *set, const struct request *q,
                  enum surface_kind kind, struct surface *out)
{
    struct word name = q->word[2];
    *out = (struct surface){.kind = kind, .how = DT_LINEAR, .max_edge = HUGE_VAL};
    if (memchr(name.text, ',', name.len) == NULL || kind == SURFACE_CONTOUR ||
        kind == SURFACE_PROFILE) {
        out->fields[0] = find_field(a, set, &name);
        out->n_fields = 1;
        if (out->fields[0] == NULL)
            return false;
    } else if (find_all_fields(a, set, &name, out)) {
        name.len = strlen(dt_field_name(out->fields[0]));
    } else {
        return false;
    }
    memcpy(out->field, name.text, name.len);
    out->field_len = name.len;
    return true;
}

/* ---- INTERPOLATE ---- */

/* Reads a request with places, at least one word of them or `least` words. False: it waits, or the ERR line has been written. */
static bool read_at_places(struct server *s, struct dataset *set, const struct request *q,
                           struct answer *a, enum surface_kind kind, unsigned allowed, size_t least,
                           struct surface *out, struct surface_source *from)
{
    size_t end = first_option(q);
    if (!begin(a, set, q, kind, out) || !read_options(a, q, end, allowed, out) ||
        !is_ready(s, a, set, out, from))
        return false;
    if (end < 3 + least)
        answer_usage(a);
    else if (end % 2 == 0)
        answer_err(a, ERR_SYNTAX, "odd number of coordinates");
    else if (read_places(s, a, q, end, &out->places))
        return true;
    surface_clear(out);
    return false;
}

/* Answers with a quantity of the surface at the places of the request. */
static void answer_at_places(struct server *s, struct dataset *set, const struct request *q,
                             struct answer *a, unsigned allowed, enum dt_quantity quantity)
{
    struct surface surface;
    struct surface_source from;
    if (!read_at_places(s, set, q, a, SURFACE_PLACES, allowed, 1, &surface, &from))
        return;
    surface.quantity = quantity;
    surface_answer(s, a, from.version, &surface);
}

/* The same at the places of its body. */
static void answer_at_body(struct server *s, struct dataset *set, const struct request *q,
                           struct answer *a, unsigned allowed, enum dt_quantity quantity)
{
    struct surface surface;
    struct surface_source from;
    if (!begin(a, set, q, SURFACE_PLACES, &surface) || !read_options(a, q, 4, allowed, &surface) ||
        !is_ready(s, a, set, &surface, &from))
        return;
    surface.quantity = quantity;
    surface.binary = true;
    surface.places.n = a->body->body.n;
    surface.places.p = (struct dt_point *)(void *)load_take(a->body, &surface.places.memory);
    surface_answer(s, a, from.version, &surface);
}

void cmd_interpolate(struct server *s, struct dataset *set, const struct request *q,
                     struct answer *a)
{
    answer_at_places(s, set, q, a, VALUE_OPTIONS, DT_HEIGHT);
}

void cmd_interpolateb(struct server *s, struct dataset *set, const struct request *q,
                      struct answer *a)
{
    answer_at_body(s, set, q, a, VALUE_OPTIONS, DT_HEIGHT);
}

void cmd_gradient(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_at_places(s, set, q, a, LINEAR_OPTIONS, DT_GRADIENT);
}

void cmd_gradientb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    answer_at_body(s, set, q, a, LINEAR_OPTIONS, DT_GRADIENT);
}

/* ---- PROFILE ---- */

void cmd_profile(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    enum { TWO_PLACES = 4 }; /* words */
    struct surface surface;
    struct surface_source from;
    if (read_at_places(s, set, q, a, SURFACE_PROFILE, LINEAR_OPTIONS | 1 << BINARY, TWO_PLACES,
                       &surface, &from))
        profile_answer(s, a, &from, &surface);
}

/* ---- RASTER ---- */

static bool read_side(struct answer *a, const struct word *w, const char *what, uint32_t *n)
{
    if (!read_count(a, w, what, n))
        return false;
    return (*n >= 1 && *n <= LIMIT_RASTER_SIDE) ||
           answer_err(a, ERR_RANGE, "a raster has 1 to %d columns and rows", LIMIT_RASTER_SIDE);
}

static bool read_raster(struct answer *a, const struct request *q, size_t fields,
                        struct dt_raster *r)
{
    const struct word *w = q->word;
    if (!read_box(a, &w[3], &r->lo, &r->hi) ||
        !read_side(a, &w[7], "a number of columns", &r->columns) ||
        !read_side(a, &w[8], "a number of rows", &r->rows))
        return false;
    return (uint64_t)r->columns * r->rows * fields <= LIMIT_RASTER_CELLS ||
           answer_err(a, ERR_TOOBIG, "a raster has at most %d %s", LIMIT_RASTER_CELLS,
                      fields == 1 ? "cells" : "values");
}

/* Finds the set of CLIP, if there is one, and sees to its regions; otherwise as is_ready. */
static bool find_clip(struct server *s, struct answer *a, struct surface *q)
{
    if (q->other == NULL)
        return true;
    return command_find_other(s, a, q->other, &q->clip) && raster_clip_ready(s, a, q->clip);
}

/* Only the linear surface inside the hull has slopes. */
static bool check_quantity(struct answer *a, const struct surface *q)
{
    return q->quantity == DT_HEIGHT || (q->how == DT_LINEAR && !q->beyond) ||
           answer_err(a, ERR_SYNTAX,
                      "slope and aspect are of the method linear and inside the hull");
}

void cmd_raster(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct surface surface;
    struct surface_source from;
    if (!begin(a, set, q, SURFACE_RASTER, &surface) ||
        !read_raster(a, q, surface.n_fields, &surface.raster) ||
        !read_options(a, q, 9, RASTER_OPTIONS, &surface) || !check_quantity(a, &surface) ||
        !is_ready(s, a, set, &surface, &from) || !find_clip(s, a, &surface))
        return;
    if (surface.clip != NULL)
        raster_clip_answer(s, a, from.version, &surface);
    else
        surface_answer(s, a, from.version, &surface);
}

/* ---- CONTOUR ---- */

static int compare_levels(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A level: of bands, the lowest and the highest may be infinite. */
static bool read_level(struct answer *a, const struct word *w, bool bands, double *v)
{
    bool below = word_is(w, "-inf");
    if (!bands || (!below && !word_is(w, "inf")))
        return read_finite(a, w, "level", v);
    *v = below ? -HUGE_VAL : HUGE_VAL;
    return true;
}

/* The words from the fourth on, up to `end`: sorted, each once. */
static bool read_levels(struct answer *a, const struct request *q, size_t end, struct surface *out)
{
    uint32_t n = 0;
    if (end - 3 > LIMIT_LEVELS)
        return answer_err(a, ERR_RANGE, "more than %d levels", LIMIT_LEVELS);
    double *level = malloc((end - 3) * sizeof *level + 1);
    out->level = level;
    if (level == NULL)
        return answer_out_of_memory(a);
    for (size_t i = 3; i < end; i++)
        if (!read_level(a, &q->word[i], out->bands, &level[i - 3]))
            return false;
    qsort(level, end - 3, sizeof *level, compare_levels);
    for (size_t i = 0; i < end - 3; i++)
        if (n == 0 || level[i] > level[n - 1])
            level[n++] = level[i];
    out->levels = n;
    return true;
}

void cmd_contour(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct surface surface;
    struct surface_source from;
    size_t end = first_option(q);
    bool every = end < q->n && word_is(&q->word[end], "EVERY");
    if (!begin(a, set, q, SURFACE_CONTOUR, &surface) ||
        !read_options(a, q, end, every ? EVERY_OPTIONS : LEVEL_OPTIONS, &surface))
        return;
    if ((end == 3) != every)
        answer_usage(a);
    else if (!is_ready(s, a, set, &surface, &from))
        return;
    else if (every || read_levels(a, q, end, &surface))
        contour_answer(s, a, &from, &surface);
    else
        surface_clear(&surface);
}

/* ---- VOLUME ---- */

enum { LEVEL, MINUS };

#define IN(FIELD) .offset = offsetof(struct volume, FIELD)

static const struct option volume_options[] = {
    [LEVEL] = {"LEVEL", OPTION_FINITE, IN(level), .what = "level", .bars = 1 << MINUS},
    [MINUS] = {"MINUS", OPTION_FIELD, IN(minus), .bars = 1 << LEVEL},
    {"MISSING", OPTION_EITHER, IN(skip), .names = missing},
    {"INSIDE", OPTION_INSIDE, IN(inside)},
    {"BOX", OPTION_BOX, IN(box)},
};

void cmd_volume(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct volume volume = {.field = find_field(a, set, &q->word[2]), .box[0].x = -HUGE_VAL};
    struct surface_source from;
    if (volume.field == NULL ||
        !options_read(a, q, 3, set, volume_options, sizeof volume_options / sizeof *volume_options,
                      ~0u, &volume))
        return;
    if (volume.skip && volume.minus != NULL)
        refuse_skip(a);
    else if (find_source(s, a, set, volume.field, volume.skip, volume.inside, &from))
        volume_answer(s, a, &from, &volume);
}
