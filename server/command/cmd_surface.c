/* cmd_surface.c - the commands about surfaces: values at points, and what is between them. */
#include "server/command/command.h"

#include "server/jobs/query.h"

static bool read_method(const struct word *w, enum dt_interpolation *how)
{
    static const char *const name[] = {
        [DT_LINEAR] = "linear", [DT_NATURAL] = "natural", [DT_LAPLACE] = "laplace"};
    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        if (word_is(w, name[i])) {
            *how = (enum dt_interpolation)i;
            return true;
        }
    }
    return false;
}

void cmd_weights(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct query query = {.kind = QUERY_WEIGHTS, .how = DT_LINEAR};
    bool method =
        q->n == 6 && word_is(&q->word[4], "METHOD") && read_method(&q->word[5], &query.how);
    if (q->n > 4 && !method)
        reply_err(a->out, ERR_SYNTAX, "usage: %s", command_find(&q->word[0])->usage);
    else if (read_place(s, a, q, &query.place))
        query_answer(s, a, set, &query);
}
