/* server.c - see server.h. */
#include "server/jobs/server.h"

#include "server/sets/skip_copy.h"

const struct command_stats *server_stats(const struct server *s, size_t command,
                                         struct command_stats *sum)
{
    if (s->reactors == 1)
        return &s->reactor->stats.of[command];
    *sum = (struct command_stats){0};
    for (unsigned i = 0; i < s->reactors; i++)
        command_stats_join(sum, &s->reactor[i].stats.of[command]);
    return sum;
}

struct request_counts server_requests(const struct server *s)
{
    struct request_counts all = {0};
    for (unsigned i = 0; i < s->reactors; i++) {
        all.commands += s->reactor[i].commands;
        all.errors += s->reactor[i].errors;
        all.slow += s->reactor[i].slow;
    }
    return all;
}

/* Makes room for `bytes` by what can be made again. */
static bool make_room(struct server *s, const struct answer *a, size_t bytes)
{
    return !answer_shares(a) && budget_could_fit(&s->budget, bytes) && skip_copy_release(&s->sets);
}

bool server_reserve(struct server *s, struct answer *a, struct reservation *r, size_t bytes)
{
    bool first = queue_is_first(&s->memory, a->turn);
    if (first && (reservation_resize(r, bytes) ||
                  (make_room(s, a, bytes) && reservation_resize(r, bytes)))) {
        server_limit_pages(s);
        return true;
    }
    bool jobs = budget_of(&s->budget, BUDGET_BUILDS) + budget_of(&s->budget, BUDGET_EDITS) > 0;
    if ((jobs || !first) && budget_could_fit(&s->budget, bytes))
        return answer_wait(a, &s->memory, false);
    return server_refuse(s, a, bytes);
}

bool server_refuse(struct server *s, struct answer *a, size_t bytes)
{
    s->budget.short_of = true;
    if (budget_could_fit(&s->budget, bytes))
        return answer_err(a, ERR_BUSY, "not enough free memory at the moment; try again");
    return answer_err(a, ERR_NOMEM, "not enough memory (--max-memory)");
}

void server_memory_freed(struct server *s)
{
    server_limit_pages(s);
    queue_call(&s->memory);
}

size_t server_pages_limit(const struct server *s, size_t large)
{
    size_t used = budget_used(&s->budget), most = s->config->max_memory;
    size_t small = used > large ? used - large : 0;
    return most > small ? most - small : 0;
}

void server_limit_pages(struct server *s)
{
    struct dt_pages_summary now;
    dt_pages_summary(s->pages, &now);
    size_t limit = server_pages_limit(s, now.held - now.kept);
    dt_pages_limit(s->pages, limit);
    s->excess = now.held > limit && now.kept > 0;
}
