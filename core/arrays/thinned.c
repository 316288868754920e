/* thinned.c - surfaces of few points, of points that may coincide: only the first one at each place is a candidate. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/arrays/workers.h"
#include "core/delaunay_arrays.h"

/* The different places, in the order of the ids of their representatives. */
struct places {
    uint32_t *index; /* owns n, as the next three: of the representative's place, by id */
    uint32_t *id;    /* by place */
    struct dt_point *point;
    double *value;
    uint32_t n;
    struct dt_constraint *constraint; /* owns: between different places, by their indices */
    size_t constraints;
};

static void clear(struct places *s)
{
    free(s->index);
    free(s->id);
    free(s->point);
    free(s->value);
    free(s->constraint);
}

static bool is_right(const struct dt_thinning *in)
{
    for (uint32_t i = 0; i < in->n; i++)
        if (isinf(in->value[i]))
            return false;
    return in->error >= 0 && !isinf(in->error);
}

static enum dt_status check_ends(const struct dt_thinning *in)
{
    for (size_t i = 0; i < in->constraints; i++)
        if (in->constraint[i].a >= in->n || in->constraint[i].b >= in->n)
            return DT_NOPOINT;
        else if (in->constraint[i].a == in->constraint[i].b)
            return DT_NOEDGE;
    return DT_OK;
}

static bool make_room(struct places *s, const struct dt_thinning *in)
{
    size_t n = (size_t)in->n + 1;
    s->index = malloc(n * sizeof *s->index);
    s->id = malloc(n * sizeof *s->id);
    s->point = malloc(n * sizeof *s->point);
    s->value = malloc(n * sizeof *s->value);
    s->constraint = malloc((in->constraints + 1) * sizeof *s->constraint);
    return s->index != NULL && s->id != NULL && s->point != NULL && s->value != NULL &&
           s->constraint != NULL;
}

/* A representative has the smallest id of its place, so its place is known when its aliases come. */
static void list_points(struct places *s, const struct dt *t, const struct dt_thinning *in)
{
    for (uint32_t id = 0; id < in->n; id++) {
        uint32_t representative = id;
        (void)dt_representative(t, id, &representative);
        if (representative != id) {
            s->index[id] = s->index[representative];
            continue;
        }
        s->index[id] = s->n;
        s->id[s->n] = id;
        s->point[s->n] = in->point[id];
        s->value[s->n++] = in->value[id];
    }
}

static void list_constraints(struct places *s, const struct dt_thinning *in)
{
    for (size_t i = 0; i < in->constraints; i++) {
        struct dt_constraint c = in->constraint[i];
        c.a = s->index[c.a];
        c.b = s->index[c.b];
        s->constraint[s->constraints] = c;
        s->constraints += c.a != c.b;
    }
}

/* A set finds the points that coincide. */
static enum dt_status find_places(struct places *s, const struct dt_thinning *in)
{
    struct dt_added added;
    struct dt *t = dt_new(0);
    enum dt_status status =
        t != NULL && make_room(s, in) ? dt_add_many(t, in->point, in->n, NULL, &added) : DT_NOMEM;
    if (status == DT_OK) {
        list_points(s, t, in);
        list_constraints(s, in);
    }
    dt_free(t);
    return status;
}

static enum dt_status thin(struct places *s, const struct dt_thinning *in, struct dt_thinned *out)
{
    struct dt_thinning few = *in;
    enum dt_status status = is_right(in) ? check_ends(in) : DT_RANGE;
    if (status == DT_OK)
        status = find_places(s, in);
    if (status != DT_OK)
        return status;
    few.point = s->point;
    few.value = s->value;
    few.n = s->n;
    few.constraint = s->constraint;
    few.constraints = s->constraints;
    few.reserve = NULL;
    status = dt_thin(&few, NULL, out);
    for (uint32_t i = 0; status == DT_OK && i < out->n; i++)
        out->kept[i] = s->id[out->kept[i]];
    return status;
}

enum dt_status dt_arrays_thin(const struct dt_thinning *in, struct dt_thinned *out)
{
    fenv_t caller = dt_call_begin();
    struct places s = {0};
    memset(out, 0, sizeof *out);
    enum dt_status status = thin(&s, in, out);
    clear(&s);
    dt_call_end(&caller);
    return status;
}
