/* survey.c - see survey.h. */
#include "clients/files/survey.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/points/clean_paths.h"
#include "proto/number.h"

/* ---- columns ---- */

/* The values of x (0), y (1) or a field, `*step` apart. */
static double *column_of(const struct points_file *f, size_t column, size_t *step)
{
    *step = column < 2 ? 2 : f->fields;
    return column < 2 ? f->xy + column : f->value + (column - 2);
}

static const char *column_name(const struct table_file *t, size_t column)
{
    return column == 0 ? "x" : column == 1 ? "y" : t->fields.name[column - 2];
}

struct range survey_range(const struct points_file *f, size_t column)
{
    struct range r = {(double)INFINITY, -(double)INFINITY, 0};
    size_t step = 0;
    const double *v = f->n > 0 ? column_of(f, column, &step) : NULL;
    for (size_t i = 0; i < f->n; i++, v += step) {
        r.least = *v < r.least ? *v : r.least;
        r.greatest = *v > r.greatest ? *v : r.greatest;
        r.missing += isnan(*v) != 0;
    }
    if (r.least > r.greatest)
        r.least = r.greatest = (double)NAN;
    return r;
}

/* A number for messages, in room[PROTO_NUMBER_MAX + 1]. */
static const char *shown(double v, char *room)
{
    room[isfinite(v) ? proto_write_double(room, v) : 0] = '\0';
    return room;
}

/* ---- changes ---- */

static void apply_nodata(struct points_file *f, struct table_file *t, double nodata)
{
    char number[PROTO_NUMBER_MAX + 1];
    bool any = false;
    for (size_t k = 0; k < f->fields; k++) {
        uint64_t found = 0;
        for (size_t i = 0; i < f->n; i++) {
            double *v = &f->value[i * f->fields + k];
            if (*v == nodata) {
                *v = (double)NAN;
                found++;
            }
        }
        if (found > 0)
            report_add(&f->report, NOTE_READ, "%s: %s means missing, %ju times", t->fields.name[k],
                       shown(nodata, number), (uintmax_t)found);
        any |= found > 0;
    }
    if (!any && f->fields > 0)
        report_add(&f->report, NOTE_UNUSED, "--nodata %s is not used: no value is that",
                   shown(nodata, number));
}

static bool find_column(const struct points_file *f, const struct table_file *t, const char *name,
                        size_t *column)
{
    for (*column = 0; *column < f->fields + 2; ++*column)
        if (strcmp(column_name(t, *column), name) == 0)
            return true;
    return false;
}

static bool negate(struct points_file *f, const struct table_file *t, const char *name)
{
    size_t column, step;
    if (!find_column(f, t, name, &column)) {
        f->line = 0;
        return points_file_stop(f, "no field %s to negate; there are x, y%s%s", name,
                                f->fields > 0 ? ", " : "", f->fields > 0 ? t->fields.name[0] : "");
    }
    double *v = f->n > 0 ? column_of(f, column, &step) : NULL;
    for (size_t i = 0; i < f->n; i++, v += step)
        *v = *v == 0 ? 0 : isnan(*v) ? *v : -*v;
    return true;
}

static bool is_negated(const struct survey_wish *w, const char *name)
{
    for (size_t i = 0; i < w->negate_n; i++)
        if (strcmp(w->negate[i], name) == 0)
            return true;
    return false;
}

/* ---- doubts ---- */

static void note_missing(struct points_file *f, struct table_file *t, size_t k)
{
    const struct odd_value *odd = &t->fields.odd[k];
    char where[120] = "";
    if (t->fields.missing[k] == 0)
        return;
    if (odd->line > 0)
        snprintf(where, sizeof where, "; the first that is not a number is \"%s\" in line %ju",
                 odd->text, (uintmax_t)odd->line);
    report_add(&f->report, NOTE_MISSING, "%s: %ju of %zu values are missing%s", t->fields.name[k],
               (uintmax_t)t->fields.missing[k], f->n, where);
}

/* Whether programs write this value where there is none. */
static bool is_sentinel(double v)
{
    static const double values[] = {
        -99,      -999, -9999, -99999,        -999999,    -9999999, -9999.9, -999.9, -99.9, -999.25,
        -9999.25, 9999, 99999, 999999,        9999999,    -32768,   32767,   -32767, 65535, -1e30,
        1e30,     1e20, -1e20, -2147483648.0, 2147483647, 1e10,     -1e10,   -88888, -8888};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        if (v == values[i])
            return true;
    return fabs(v) >
           1e36; /* the greatest floats and doubles, Surfer's 1.70141e38, NetCDF's 9.97e36 */
}

/* A least or greatest value of a column that is far from the others and may mean: missing. */
static bool check_extreme(struct points_file *f, const char *name, size_t column, bool least)
{
    const struct range all = survey_range(f, column);
    const double extreme = least ? all.least : all.greatest;
    char number[PROTO_NUMBER_MAX + 1], from[PROTO_NUMBER_MAX + 1], to[PROTO_NUMBER_MAX + 1];
    double low = (double)INFINITY, high = -(double)INFINITY;
    size_t step;
    uint64_t found = 0;
    if (!is_sentinel(extreme))
        return false;
    const double *value = column_of(f, column, &step);
    for (size_t i = 0; i < f->n; i++) {
        double v = value[i * step];
        found += v == extreme;
        if (v != extreme && !is_sentinel(v)) {
            low = v < low ? v : low;
            high = v > high ? v : high;
        }
    }
    double gap = least ? low - extreme : extreme - high;
    bool far = low > high || (gap > 0 && gap > (high - low) / (least ? 10 : 1));
    if (!far)
        return false;
    shown(extreme, number);
    if (low > high)
        report_add(&f->report, NOTE_DOUBT, "%s: all values are %s, which may mean missing", name,
                   number);
    else if (column < 2)
        report_add(&f->report, NOTE_DOUBT,
                   "%s: %s in %ju of %zu points, far from the others (%s to %s), may mean missing",
                   name, number, (uintmax_t)found, f->n, shown(low, from), shown(high, to));
    else
        report_add(&f->report, NOTE_DOUBT,
                   "%s: %s in %ju of %zu values, far from the others (%s to %s); --nodata %s makes "
                   "them missing",
                   name, number, (uintmax_t)found, f->n, shown(low, from), shown(high, to), number);
    return true;
}

/* Points at 0 0 whose place may be missing: the others are far away. */
static void check_origin(struct points_file *f)
{
    struct range r[2] = {{(double)INFINITY, -(double)INFINITY, 0},
                         {(double)INFINITY, -(double)INFINITY, 0}};
    size_t others = 0;
    for (size_t i = 0; i < f->n; i++) {
        const double *p = f->xy + 2 * i;
        if (p[0] == 0 && p[1] == 0)
            continue;
        for (int k = 0; k < 2; k++) {
            r[k].least = fmin(r[k].least, p[k]);
            r[k].greatest = fmax(r[k].greatest, p[k]);
        }
        others++;
    }
    bool far = false;
    for (int k = 0; k < 2 && others > 2; k++)
        far |= fmax(r[k].least, -r[k].greatest) > 3 * (r[k].greatest - r[k].least);
    if (far && others < f->n)
        report_add(&f->report, NOTE_DOUBT,
                   "%zu of %zu points are at 0 0, far from the others; their places may be missing",
                   f->n - others, f->n);
}

static uint64_t count_beyond(const struct points_file *f, size_t axis, double most)
{
    uint64_t n = 0;
    for (size_t i = 0; i < f->n; i++)
        n += fabs(f->xy[2 * i + axis]) > most;
    return n;
}

bool survey_note_swapped(struct points_file *f)
{
    uint64_t latitudes = count_beyond(f, 1, 90);
    if (latitudes == 0 || count_beyond(f, 0, 90) > 0 || count_beyond(f, 1, 360) > 0)
        return false;
    report_add(&f->report, NOTE_DOUBT,
               "latitudes beyond 90 degrees: %ju, longitudes: none; they seem to be swapped",
               (uintmax_t)latitudes);
    return true;
}

static void check_degrees(struct points_file *f)
{
    uint64_t latitudes = count_beyond(f, 1, 90), longitudes = count_beyond(f, 0, 360);
    if (!survey_note_swapped(f) && latitudes > 0)
        report_add(&f->report, NOTE_DOUBT, "latitudes beyond 90 degrees: %ju",
                   (uintmax_t)latitudes);
    if (longitudes > 0)
        report_add(&f->report, NOTE_DOUBT, "longitudes beyond 360 degrees: %ju",
                   (uintmax_t)longitudes);
    struct range r = survey_range(f, 0);
    char from[PROTO_NUMBER_MAX + 1], to[PROTO_NUMBER_MAX + 1];
    if (longitudes == 0 && r.least < 0 && r.greatest > 180)
        report_add(&f->report, NOTE_DOUBT,
                   "longitudes from %s to %s: some seem to begin at -180, some at 0 degrees",
                   shown(r.least, from), shown(r.greatest, to));
}

/* A latitude that counts to the south, a longitude that counts to the west. */
static void check_hemispheres(struct points_file *f, const struct plan *p,
                              const struct survey_wish *w)
{
    for (size_t axis = 0; axis < 2; axis++) {
        const char *name = axis == 0 ? "x" : "y";
        struct range r = survey_range(f, axis);
        if (p->reversed[axis] && !is_negated(w, name) && r.least >= 0 && r.greatest > 0)
            report_add(&f->report, NOTE_DOUBT,
                       "%s is positive, so the map is a mirror image; --negate %s turns it",
                       p->column[axis == 0 ? p->x : p->y].heading, name);
    }
}

static void check_depths(struct points_file *f, const struct table_file *t,
                         const struct survey_wish *w)
{
    for (size_t k = 0; k < f->fields; k++) {
        if (!t->plan.depth || strcmp(t->fields.name[k], "z") != 0 || is_negated(w, "z"))
            continue;
        struct range r = survey_range(f, k + 2);
        if (r.greatest > 0)
            report_add(&f->report, NOTE_DOUBT,
                       "z is %s as it is, so what is deeper is higher; --negate z turns it",
                       t->fields.height);
    }
}

bool survey(struct points_file *f, struct table_file *t, const struct survey_wish *w)
{
    for (size_t i = 0; i < w->nodata_n; i++)
        apply_nodata(f, t, w->nodata[i]);
    for (size_t k = 0; k < f->fields; k++) {
        t->fields.missing[k] = survey_range(f, k + 2).missing;
        note_missing(f, t, k);
    }
    for (size_t column = 0; f->n > 0 && column < f->fields + 2; column++)
        if (!check_extreme(f, column_name(t, column), column, true))
            check_extreme(f, column_name(t, column), column, false);
    check_origin(f);
    for (size_t i = 0; i < w->negate_n; i++)
        if (!negate(f, t, w->negate[i]))
            return false;
    if (t->plan.pair == PAIR_LON_LAT && t->plan.headed)
        check_degrees(f);
    check_hemispheres(f, &t->plan, w);
    check_depths(f, t, w);
    if (f->n == 0)
        report_add(&f->report, NOTE_DOUBT, "there are no points in it");
    return true;
}

/* ---- coincident points ---- */

bool survey_coincident(const struct points_file *f, struct coincidence *c)
{
    *c = (struct coincidence){.points = 0};
    struct place_table t;
    bool ok = place_table_init(&t, f, f->n);
    for (size_t i = 0; ok && i < f->n; i++) {
        const size_t first = place_table_find(&t, i, false);
        if (first == i)
            continue;
        c->points++;
        size_t k = points_difference(f, first, i);
        if (k < f->fields && c->different++ == 0) {
            c->first = i;
            c->field = k;
        }
    }
    place_table_free(&t);
    return ok;
}

void survey_note_coincident(struct points_file *f, const struct table_file *t)
{
    struct coincidence c;
    char x[PROTO_NUMBER_MAX + 1], y[PROTO_NUMBER_MAX + 1];
    if (f->fields == 0 || !survey_coincident(f, &c) || c.different == 0)
        return;
    report_add(
        &f->report, NOTE_DOUBT,
        "%ju of %ju coincident points have other values than the first point there, as %s at "
        "%s %s; the first counts",
        (uintmax_t)c.different, (uintmax_t)c.points, t->fields.name[c.field],
        shown(f->xy[2 * c.first], x), shown(f->xy[2 * c.first + 1], y));
}
