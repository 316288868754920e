/* stats.c - see stats.h. */
#include "server/ops/stats.h"

#include "server/system/loop.h"

#include <stdlib.h>

bool stats_init(struct stats *st)
{
    *st = (struct stats){.of = calloc(STATS_COMMANDS, sizeof *st->of), .mark_ns = clock_ns()};
    return st->of != NULL;
}

void stats_clear(struct stats *st)
{
    free(st->of);
    *st = (struct stats){0};
}

void command_stats_join(struct command_stats *of, const struct command_stats *other)
{
    of->calls += other->calls;
    of->errors += other->errors;
    histogram_join(&of->work, &other->work);
    histogram_join(&of->wait, &other->wait);
}

int64_t stats_look(struct stats *st)
{
    int64_t now = clock_ns();
    if (st->run > 0)
        histogram_add(&st->of[st->quick].work, (uint64_t)(now - st->mark_ns) / st->run, st->run);
    st->run = 0;
    st->mark_ns = now;
    return now;
}

void stats_pause(struct stats *st, struct stats_pause *p, bool in_line)
{
    if (p->began_ns == 0)
        p->began_ns = st->mark_ns;
    int64_t now = stats_look(st);
    p->since_ns = in_line ? now : 0;
}

void stats_resume(struct stats *st, struct stats_pause *p)
{
    if (p->since_ns != 0)
        p->waited_ns += st->mark_ns - p->since_ns;
    p->since_ns = 0;
}

struct stats_outcome stats_end(struct stats *st, struct stats_pause *p, unsigned command,
                               bool quick, bool error)
{
    struct command_stats *of = &st->of[command];
    of->calls++;
    of->errors += error;
    if (quick && p->began_ns == 0) {
        st->quick = command;
        st->run++;
        return (struct stats_outcome){0};
    }
    int64_t began = p->began_ns != 0 ? p->began_ns : st->mark_ns;
    int64_t whole = stats_look(st) - began;
    stats_resume(st, p);
    int64_t wait = p->waited_ns < whole ? p->waited_ns : whole;
    histogram_add(&of->work, (uint64_t)(whole - wait), 1);
    if (wait > 0)
        histogram_add(&of->wait, (uint64_t)wait, 1);
    *p = (struct stats_pause){0};
    return (struct stats_outcome){whole - wait, wait};
}
