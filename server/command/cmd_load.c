/* cmd_load.c - LOAD, LOADB and FSETB, when their body is complete: all of it counts at once, so that a load is atomic. */
#include "server/command/command.h"

#include "server/command/load.h"
#include "server/jobs/edit.h"

#include <stdlib.h>

/* Adds the points, if there is memory for them; else they stay. */
void cmd_load(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct load *l = a->body;
    struct arrival points = {.n = l->body.n};
    struct word names = load_field_names(q);
    if (names.len > 0 && (points.values = read_field_names(a, set, &names)) == NULL)
        return;
    size_t columns = points.values == NULL ? 0 : points.values->count;
    if (!edit_may_add(s, a, set, points.n, columns, &points.memory)) {
        columns_free(points.values);
        return;
    }
    points.expected = load_hand_on_expected(s, l);
    points.rows = load_take(l, &points.memory);
    edit_add(s, a, &q->word[1], &points);
}

void cmd_fsetb(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct load *l = a->body;
    struct reservation memory;
    uint32_t first;
    if (!read_field_name(a, &q->word[2]) || !read_id(a, &q->word[3], &first) ||
        !edit_may_set_run(s, a, l->body.n, &memory))
        return;
    size_t n = l->body.n;
    edit_set_run(s, a, set, &q->word[2], first, load_take(l, &memory), n, &memory);
}
