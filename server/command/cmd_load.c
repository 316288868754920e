/* cmd_load.c - LOAD and LOADB, when their body is complete: all points are added at once, so that a load is atomic. */
#include "server/command/command.h"

#include "server/command/load.h"
#include "server/jobs/edit.h"

/* Adds the points, if there is memory for them; else they stay. */
void cmd_load(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct load *l = a->body;
    struct arrival points = {.n = l->body.n};
    if (!edit_may_add(s, a, set, points.n, &points.memory))
        return;
    points.expected = load_hand_on_expected(s, l);
    points.p = load_take(l, &points.memory);
    edit_add(s, a, &q->word[1], &points);
}
