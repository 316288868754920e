/* cmd_watch.c - WATCH and UNWATCH. */
#include "server/command/command.h"

#include "server/clients/clients.h"
#include "server/watch/watch.h"

/* A version; false: the ERR line has been written. */
static bool read_version(struct answer *a, const struct word *w, uint64_t *version)
{
    enum { DIGITS = 18 };
    bool good = w->len > 0 && w->len <= DIGITS;
    *version = 0;
    for (size_t i = 0; good && i < w->len; i++) {
        good = w->text[i] >= '0' && w->text[i] <= '9';
        *version = 10 * *version + (uint64_t)(w->text[i] - '0');
    }
    if (!good)
        reply_err(a->out, ERR_NUMBER, "%.*s is not a version", QUOTED(w));
    return good;
}

void cmd_watch(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct session *who = clients_asker(s, a);
    uint64_t since = 0;
    if (q->n == 3 || (q->n == 4 && !word_is(&q->word[2], "SINCE"))) {
        answer_usage(a, q);
        return;
    }
    if (q->n == 4 && !read_version(a, &q->word[3], &since))
        return;
    if (who == NULL || watch_count(who) >= WATCH_MOST)
        reply_err(a->out, ERR_TOOBIG, "a connection watches at most %d sets", WATCH_MOST);
    else if (!watch_begin(s, who, set, since == set->version))
        answer_out_of_memory(a);
    else
        answer_changed(a, set->version);
}

void cmd_unwatch(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct session *who = clients_asker(s, a);
    (void)q;
    bool watched = who != NULL && watch_end(who, set);
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "watched", watched);
    reply_end(a->out);
}
