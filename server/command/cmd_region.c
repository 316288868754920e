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
    if (query.kind == REGIONS_ALL || read_places(s, a, q, q->n, &query.places))
        regions_answer(s, a, set, &query);
    else
        dt_pages_release(query.places.p);
}
