/* cmd_watch.c - see cmd_watch.h. */
#include "server/watch/cmd_watch.h"

#include "proto/number.h"
#include "server/clients/clients.h"
#include "server/watch/watch.h"

#include <stdlib.h>
#include <string.h>

/* A version; false: the ERR line has been written. */
static bool read_version(struct answer *a, const struct word *w, uint64_t *version)
{
    return proto_read_u64(w->text, w->len, version) ||
           answer_err(a, ERR_NUMBER, "%.*s is not a version", QUOTED(w));
}

/* All of them are fields of the set. */
static bool find_all(struct answer *a, const struct dataset *set, const struct word *names)
{
    size_t n;
    const struct dt_field **f = find_fields(a, set, names, &n);
    free(f);
    return f != NULL;
}

/* A client that comes back may name a field that has been dropped meanwhile. */
static bool read_fields(struct answer *a, const struct dataset *set, const struct word *names,
                        bool comes_back, struct scope *scope)
{
    if (!(comes_back ? check_field_names(a, names) : find_all(a, set, names)))
        return false;
    scope->names = malloc(names->len + 1);
    if (scope->names == NULL)
        return answer_out_of_memory(a);
    memcpy(scope->names, names->text, names->len);
    scope->names[names->len] = '\0';
    return true;
}

/* Reads [SINCE version] [WITHIN x0 y0 x1 y1] [FIELDS name,name ...] [CONSTRAINTS]; false: the ERR line has been written. */
static bool read_options(struct answer *a, const struct dataset *set, const struct request *q,
                         struct scope *scope, uint64_t *since)
{
    const struct word *fields = NULL;
    bool comes_back = false;
    size_t i = 2, took;
    for (bool good; i < q->n; i += took) {
        const struct word *w = &q->word[i];
        took = 2;
        if (word_is(w, "SINCE") && i + 2 <= q->n) {
            good = comes_back = read_version(a, w + 1, since);
        } else if (word_is(w, "WITHIN") && i + 5 <= q->n) {
            took = 5;
            good = scope->boxed = read_box(a, w + 1, &scope->lo, &scope->hi);
        } else if (word_is(w, "FIELDS") && i + 2 <= q->n) {
            fields = w + 1;
            good = true;
        } else if (word_is(w, "CONSTRAINTS")) {
            took = 1;
            good = scope->constraints = true;
        } else {
            answer_usage(a);
            good = false;
        }
        if (!good)
            return false;
    }
    return fields == NULL || read_fields(a, set, fields, comes_back, scope);
}

void cmd_watch(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct session *who = clients_asker(s, a);
    struct scope scope = {.names = NULL};
    uint64_t since = 0;
    if (!read_options(a, set, q, &scope, &since)) {
        scope_clear(&scope);
        return;
    }
    if (who == NULL || who->watches >= WATCH_MOST) {
        scope_clear(&scope);
        answer_err(a, ERR_TOOBIG, "a connection watches at most %d sets", WATCH_MOST);
    } else if (!watch_begin(s, who, set, &scope, since)) {
        answer_out_of_memory(a);
    } else {
        answer_changed(a, set->version);
    }
}

void cmd_unwatch(struct server *s, struct dataset *set, const struct request *q, struct answer *a)
{
    struct session *who = clients_asker(s, a);
    bool watched = who != NULL && watch_end(who, set);
    reply_ok(a->out, 0);
    reply_key_u64(a->out, "watched", watched);
    reply_end(a->out);
}
