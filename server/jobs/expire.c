/* expire.c - see expire.h. */
#include "server/jobs/expire.h"

#include "server/jobs/durable.h"
#include "server/jobs/submit.h"

#include <time.h>

int64_t expire_now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_REALTIME, &t);
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

bool expire_is_due(const struct dataset *set)
{
    return set->expires_ms != 0 && expire_now_ms() >= set->expires_ms;
}

static bool can_be_dropped(const struct server *s, const struct dataset *set)
{
    return set->writer == NULL && !set->loading && (set->temporary || durable_admits_drops(s));
}

bool expire_drop_if_due(struct server *s, struct dataset *set)
{
    if (!expire_is_due(set) || !can_be_dropped(s, set))
        return false;
    submit_at_once(s, set, CHANGE_DROP, 0);
    return true;
}

void expire_never(struct server *s, struct dataset *set)
{
    submit_at_once(s, set, CHANGE_EXPIRE, 0);
}

bool expire_temporary(struct server *s)
{
    enum { SETS_A_TURN = 200, LONG_AGO_MS = 1 };
    for (int n = 0; n < SETS_A_TURN && !list_is_empty(&s->temporary); n++) {
        struct dataset *set = list_owner(list_pop(&s->temporary), offsetof(struct dataset, fellow));
        registry_expire(&s->sets, set, LONG_AGO_MS);
        expire_drop_if_due(s, set);
    }
    return !list_is_empty(&s->temporary);
}

double expire_seconds_left(const struct dataset *set)
{
    int64_t left = set->expires_ms - expire_now_ms();
    return left > 0 ? (double)left / 1000 : 0;
}

/* ---- the tick ---- */

enum { SETS_A_TICK = 2000 };

void expire_tick(struct server *s)
{
    size_t n = s->sets.expiring < SETS_A_TICK ? s->sets.expiring : SETS_A_TICK;
    while (n-- > 0)
        expire_drop_if_due(s, registry_next_expiring(&s->sets));
}
