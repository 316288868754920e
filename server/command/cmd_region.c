/* cmd_region.c - REGIONS, and the option INSIDE: what borders enclose. */
#include "server/command/command.h"

#include "server/replies/regions.h"

bool read_inside(struct answer *a, const struct request *q, size_t *at, struct inside *out)
{
    const struct word *w = &q->word[*at];
    *out = (struct inside){.asked = true, .number = DT_NONE};
    if (*at == q->n || w->len == 0 || w->text[0] < '0' || w->text[0] > '9')
        return true;
    ++*at;
    return read_number_of_constraint(a, w, &out->number);
}

/* The words from the fourth on. */
static bool read_places(struct server *s, struct answer *a, const struct request *q,
                        struct places *out)
{
    out->n = (q->n - 3) / 2;
    out->p = dt_pages_grow(s->pages, NULL, 0, out->n * sizeof *out->p);
    if (out->p == NULL)
        answer_out_of_memory(a);
    for (size_t i = 0; out->p != NULL && i < out->n; i++)
        if (!read_point(a, &q->word[3 + 2 * i], &out->p[i]))
            return false;
    return out->p != NULL;
}

void cmd_regions(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct regions_query query = {.inside.number = DT_NONE};
    if (q->n > 2) {
        if (q->n == 3 || !word_is(&q->word[2], "AT")) {
            answer_usage(a);
            return;
        }
        if (q->n % 2 == 0) {
            answer_err(a, ERR_SYNTAX, "odd number of coordinates");
            return;
        }
        query.kind = REGIONS_AT;
    }
    if (!regions_ready(s, a, set, query.inside))
        return;
    if (query.kind == REGIONS_ALL || read_places(s, a, q, &query.places))
        regions_answer(s, a, set, &query);
    else
        dt_pages_release(query.places.p);
}
