/* cmd_field.c - the commands about fields: named values at points. */
#include "server/command/command.h"

#include "core/delaunay_fields.h"
#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/rows/answer_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)SET_NAME_LIMIT == (int)DT_FIELD_NAME, "fields are named as sets are");

bool read_field_name(struct answer *a, const struct word *w)
{
    if (word_is_field_name(w))
        return true;
    return answer_err(
        a, ERR_SYNTAX,
        "a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a letter or _");
}

const struct dt_field *find_field(struct answer *a, const struct dataset *set, const struct word *w)
{
    const struct dt_field *f = NULL;
    if (!read_field_name(a, w))
        return NULL;
    if (set->current->sum.fields > 0)
        f = dt_field_find(set->current->dt, w->text, w->len);
    if (f == NULL)
        answer_err(a, ERR_NOFIELD, "there is no field %.*s", QUOTED(w));
    return f;
}

bool read_value(struct answer *a, const struct word *w, double *v)
{
    if (word_is(w, "NAN")) {
        *v = (double)NAN;
        return true;
    }
    if (!read_number(a, w, v))
        return false;
    return !isinf(*v) || answer_err(a, ERR_RANGE, "a value is a finite number, or nan");
}

/* Takes the next name off `names`. */
static struct word next_name(struct word *names)
{
    const char *comma = memchr(names->text, ',', names->len);
    struct word name = {names->text, comma == NULL ? names->len : (size_t)(comma - names->text)};
    size_t took = name.len + (comma != NULL);
    names->text += took;
    names->len -= took;
    return name;
}

/* Whether the name is not among the columns before; if not, the ERR line has been written. */
static bool is_new_name(struct answer *a, const struct columns *v, size_t columns,
                        const struct word *name)
{
    for (size_t i = 0; i < columns; i++) {
        if (name_equals(&v->field[i], name->text, name->len))
            return answer_err(a, ERR_SYNTAX, "the field %.*s is named twice", QUOTED(name));
    }
    return true;
}

struct columns *read_field_names(struct answer *a, const struct dataset *set,
                                 const struct word *names)
{
    size_t columns = 1, fields = set == NULL ? 0 : set->current->sum.fields;
    struct word rest = *names;
    for (size_t i = 0; i < names->len; i++)
        columns += names->text[i] == ',';
    struct columns *v = columns > DT_MAX_FIELDS ? NULL : columns_new(columns);
    if (columns > DT_MAX_FIELDS)
        answer_err(a, ERR_TOOBIG, "a set has at most %d fields", DT_MAX_FIELDS);
    else if (v == NULL)
        answer_out_of_memory(a);
    for (size_t i = 0; v != NULL && i < columns; i++) {
        struct word name = next_name(&rest);
        bool good = read_field_name(a, &name) && is_new_name(a, v, i, &name);
        if (good && (set == NULL || dt_field_find(set->current->dt, name.text, name.len) == NULL))
            fields++;
        if (good && fields > DT_MAX_FIELDS) {
            answer_err(a, ERR_TOOBIG, "a set has at most %d fields", DT_MAX_FIELDS);
            good = false;
        }
        if (!good) {
            columns_free(v);
            return NULL;
        }
        v->field[i] = name_of(name.text, name.len);
    }
    return v;
}

const struct dt_field **find_fields(struct answer *a, const struct dataset *set,
                                    const struct word *names, size_t *fields)
{
    struct word rest = *names;
    const struct dt_field **f = malloc(DT_MAX_FIELDS * sizeof(struct dt_field *));
    if (f == NULL)
        answer_out_of_memory(a);
    bool good = f != NULL, more = true;
    for (*fields = 0; good && more; ++*fields) {
        if (*fields == DT_MAX_FIELDS) {
            answer_err(a, ERR_TOOBIG, "at most %d fields in a reply", DT_MAX_FIELDS);
            good = false;
            break;
        }
        more = memchr(rest.text, ',', rest.len) != NULL;
        struct word name = next_name(&rest);
        f[*fields] = find_field(a, set, &name);
        good = f[*fields] != NULL;
    }
    if (good)
        return f;
    free(f);
    return NULL;
}

bool check_field_names(struct answer *a, const struct word *names)
{
    struct word rest = *names;
    for (size_t n = 0; n < DT_MAX_FIELDS; n++) {
        bool last = memchr(rest.text, ',', rest.len) == NULL;
        struct word name = next_name(&rest);
        if (!read_field_name(a, &name))
            return false;
        if (last)
            return true;
    }
    return answer_err(a, ERR_TOOBIG, "at most %d fields in a reply", DT_MAX_FIELDS);
}

bool read_values_to_set(struct server *s, const struct dataset *set, const struct request *q,
                        struct answer *a, struct change *c)
{
    if (q->n % 2 == 0)
        return answer_err(a, ERR_SYNTAX, "an id without a value");
    if (!read_field_name(a, &q->word[2]))
        return false;
    c->field = name_of(q->word[2].text, q->word[2].len);
    c->n = (uint32_t)((q->n - 3) / 2);
    c->pairs = malloc(c->n * sizeof *c->pairs);
    if (c->pairs == NULL)
        answer_out_of_memory(a);
    bool good = c->pairs != NULL;
    for (size_t i = 0; i < c->n && good; i++)
        good = read_id(a, &q->word[3 + 2 * i], &c->pairs[i].id) &&
               read_value(a, &q->word[4 + 2 * i], &c->pairs[i].value);
    return good;
}

/* The rows `id value` of n ids; NULL: the ERR line has been written. */
static uint32_t *value_rows(struct answer *a, const struct dataset *set, const struct dt_field *f,
                            const uint32_t *id, size_t n)
{
    uint32_t *row = malloc(n * ROW_VALUE_WORDS * sizeof *row);
    if (row == NULL)
        answer_out_of_memory(a);
    for (size_t i = 0; i < n && row != NULL; i++) {
        struct dt_point p;
        double value;
        if (dt_get(set->current->dt, id[i], &p) != DT_OK) {
            answer_err(a, ERR_NOPOINT, "there is no point %u", id[i]);
            free(row);
            return NULL;
        }
        dt_field_values(f, NULL, &id[i], 1, &value);
        row_value_put(row + i * ROW_VALUE_WORDS, id[i], value);
    }
    return row;
}

void cmd_fget(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    const struct dt_field *f = find_field(a, set, &q->word[2]);
    size_t n = q->n - 3;
    uint32_t *id = f == NULL ? NULL : read_ids(a, &q->word[3], n);
    uint32_t *row = id == NULL ? NULL : value_rows(a, set, f, id, n);
    free(id);
    if (row == NULL)
        return;
    struct dt_ids ids = {row, n * ROW_VALUE_WORDS, n * ROW_VALUE_WORDS};
    struct rows rows = {
        .version = set->current, .form = ROW_WORDS, .format = ROW_VALUE, .width = ROW_VALUE_WORDS};
    reply_ok(a->out, n);
    reply_end(a->out);
    answer_rows(s, a, &rows, &ids);
    free(ids.v);
}

/* ---- FIELDS ---- */

struct fields_job {
    struct job job;
    struct dt_field_summary sum[DT_MAX_FIELDS]; /* their names are those of the fields */
    char name[DT_MAX_FIELDS][DT_FIELD_NAME + 1];
    uint32_t n;
};

static void run_fields(struct job *job)
{
    struct fields_job *j = (struct fields_job *)job;
    const struct dt_field *f = NULL;
    while ((f = dt_field_next(job->dt, NULL, f)) != NULL) {
        dt_field_summary(f, &j->sum[j->n]);
        strcpy(j->name[j->n], j->sum[j->n].name); /* the field may be dropped before the reply */
        j->n++;
    }
}

static void end_fields(struct server *s, struct job *job, struct answer *a)
{
    const struct fields_job *j = (const struct fields_job *)job;
    if (!job_succeeded(job, a))
        return;
    reply_ok(a->out, j->n);
    reply_end(a->out);
    for (uint32_t i = 0; i < j->n; i++)
        reply_row_field(a->out, j->name[i], j->sum[i].values, j->sum[i].least, j->sum[i].most);
}

void cmd_fields(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct version *v = set->current;
    size_t pages = (size_t)v->sum.fields * (dt_next_id(v->dt) / DT_FIELD_PAGE + 1);
    struct fields_job *j = job_new_reading(s, a, sizeof *j, run_fields, end_fields, NULL, NULL);
    if (j != NULL)
        job_read(s, a, &j->job, v, cost_at_once(COST_PAGE, pages) ? JOB_LIGHT : JOB_SHORT);
}

bool read_existing_field(struct server *s, const struct dataset *set, const struct request *q,
                         struct answer *a, struct change *c)
{
    const struct word *field = &q->word[2];
    if (find_field(a, set, field) == NULL)
        return false;
    c->field = name_of(field->text, field->len);
    return true;
}
