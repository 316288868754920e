/* past.c - see past.h. */
#include "server/jobs/past.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4096, CONSTRAINTS = 2048 }; /* read in one visit */

/* The data that is copied before there is a set. */
struct copy {
    uint32_t n, room;
    size_t fields;
    char (*name)[DT_FIELD_NAME + 1]; /* of the fields */
    uint32_t *id, *representative;
    struct dt_constraint_list constraints;
    struct dt_point *at;
    double *value; /* of `room` points in each field */
};

static void clear(struct copy *c)
{
    free(c->name);
    free(c->id);
    free(c->representative);
    free(c->constraints.v);
    free(c->at);
    free(c->value);
}

static enum dt_status make_room(struct copy *c, const struct dt_view *view)
{
    struct dt_summary sum;
    dt_view_summary(view, &sum);
    c->room = sum.points;
    size_t n = (size_t)c->room + 1;
    c->id = malloc(n * sizeof *c->id);
    c->representative = malloc(n * sizeof *c->representative);
    c->at = malloc(n * sizeof *c->at);
    c->value = malloc(n * c->fields * sizeof *c->value);
    c->name = calloc(c->fields, sizeof *c->name);
    bool good = c->name != NULL && c->id != NULL && c->representative != NULL && c->at != NULL &&
                c->value != NULL;
    return good ? DT_OK : DT_NOMEM;
}

/* Takes the next rows. *done: all have been taken. */
static enum dt_status take_rows(struct copy *c, const struct dt *t, const struct dt_view *view,
                                const struct dt_field *const *field, uint32_t *from, bool *done)
{
    struct dt_row row[ROWS];
    size_t n;
    uint32_t first = c->n;
    enum dt_status status = dt_view_rows(t, view, from, row, ROWS, &n);
    if (status != DT_OK)
        return status;
    for (size_t i = 0; i < n && c->n < c->room; i++) {
        c->id[c->n] = row[i].id;
        c->representative[c->n] = row[i].representative;
        c->at[c->n++] = row[i].at;
    }
    for (size_t k = 0; k < c->fields; k++) {
        strcpy(c->name[k], dt_field_name(field[k]));
        dt_field_values(field[k], view, c->id + first, c->n - first,
                        c->value + k * c->room + first);
    }
    *done = n == 0;
    return DT_OK;
}

static enum dt_status copy_rows(const struct job *j, const struct dt_view *view,
                                const struct dt_field *const *field, struct copy *c)
{
    const struct dt *t = j->base->dt;
    uint32_t from = 0, end = 0;
    enum dt_status status = make_room(c, view);
    for (bool done = false; status == DT_OK && !done;)
        status = job_pause(j, take_rows(c, t, view, field, &from, &done));
    while (status == DT_OK && end != DT_NONE)
        status = job_pause(j, dt_constraints_read(t, view, &end, CONSTRAINTS, &c->constraints));
    return status;
}

/* Deletes the points without a value. Their ids replace the representatives, which have been read. */
static enum dt_status skip_missing(struct copy *c, const struct dt_options *opt, struct dt *t)
{
    uint32_t n = 0, deleted, missing;
    for (uint32_t i = 0; i < c->n; i++)
        if (isnan(c->value[i]))
            c->representative[n++] = c->id[i];
    return dt_delete_cascade(t, c->representative, n, opt, &deleted, &missing);
}

/* Makes the set, outside of any visit. */
static enum dt_status build(struct copy *c, uint32_t next_id, bool skip,
                            const struct dt_options *opt, struct dt *t)
{
    uint32_t missing;
    size_t added;
    enum dt_status status = dt_restore(t, c->id, c->at, c->representative, c->n, next_id, opt);
    for (size_t k = 0; status == DT_OK && k < c->fields; k++)
        status = dt_field_set(t, c->name[k], strlen(c->name[k]), c->id, c->value + k * c->room,
                              c->n, opt, &missing);
    if (status == DT_OK)
        status = dt_constrain(t, c->constraints.v, c->constraints.n, opt, &added, &missing);
    if (status == DT_OK && skip)
        status = skip_missing(c, opt, t);
    if (status == DT_OK)
        status = dt_triangulate(t, opt);
    return status == DT_OK ? dt_prepare(t, opt) : status;
}

/* Finds the regions of the copy, if it has borders. */
static enum dt_status survey(struct dt *t, const struct dt_options *opt, struct reservation *memory)
{
    if (!dt_has_borders(t))
        return DT_OK;
    if (!reservation_resize(memory, memory->bytes + dt_survey_memory(t)))
        return DT_NOMEM;
    return dt_survey(t, opt);
}

size_t past_memory(const struct version *v, size_t n, const struct dt_options *opt)
{
    struct dt_summary sum;
    dt_summary(v->dt, &sum);
    return sum.memory + dt_build_memory(v->dt, opt) +
           (size_t)sum.points *
               (2 * sizeof(uint32_t) + sizeof(struct dt_point) + n * sizeof(double)) +
           dt_constraints_count(v->dt) * sizeof(struct dt_constraint);
}

enum dt_status past_copy(struct job *j, const struct dt_view *view,
                         const struct dt_field *const *field, size_t n, bool skip, struct past *out)
{
    const struct dt_options *opt = &j->options;
    struct copy c = {.fields = n};
    struct dt_summary sum;
    *out = (struct past){0};
    enum dt_status status = job_reserve(j, past_memory(j->base, n, opt));
    if (status != DT_OK)
        return status;
    status = copy_rows(j, view, field, &c);
    job_end_visit(j);
    if (status == DT_OK && (out->dt = dt_new(dt_tolerance(j->base->dt))) == NULL)
        status = DT_NOMEM;
    if (status == DT_OK)
        status = build(&c, dt_view_next_id(view), skip, opt, out->dt);
    if (status == DT_CROSSES)
        dt_crossed(out->dt, &out->crossed);
    if (status == DT_OK)
        status = survey(out->dt, opt, &j->memory);
    for (size_t k = 0; status == DT_OK && k < n; k++)
        out->field[k] = dt_field_find(out->dt, c.name[k], strlen(c.name[k]));
    clear(&c);
    if (status == DT_OK) {
        dt_summary(out->dt, &sum);
        reservation_set(&j->memory, sum.memory);
    } else {
        dt_free(out->dt);
        out->dt = NULL;
    }
    job_visit(j);
    return status;
}
