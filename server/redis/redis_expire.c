/* redis_expire.c - see handlers.h. When sets are dropped. Times are turned into the seconds of our EXPIRE. */
#include "server/redis/handlers.h"

#include "proto/number.h"
#include "server/jobs/expire.h"

#include <math.h>
#include <stdio.h>

enum { MS = 1000 };

/* Whether there is such a set. If not, the answer is 0; a name that no set can have is left to the command. */
static bool is_there(struct server *s, const struct word *name, struct answer *a)
{
    bool there = !word_is_set_name(name) || redis_find(s, name) != NULL;
    if (!there)
        redis_integer(a, 0);
    return there;
}

/* ---- setting ---- */

struct condition {
    bool nx, xx, gt, lt;
};

static bool read_conditions(const struct request *q, struct condition *c)
{
    *c = (struct condition){0};
    for (size_t i = 3; i < q->n; i++) {
        c->nx |= word_is(&q->word[i], "NX");
        c->xx |= word_is(&q->word[i], "XX");
        c->gt |= word_is(&q->word[i], "GT");
        c->lt |= word_is(&q->word[i], "LT");
        if (!word_is(&q->word[i], "NX") && !word_is(&q->word[i], "XX") &&
            !word_is(&q->word[i], "GT") && !word_is(&q->word[i], "LT"))
            return false;
    }
    return !(c->nx && (c->xx || c->gt || c->lt)) && !(c->gt && c->lt);
}

/* Whether a set whose time is `old` (0: none, which is later than any) may get the time `at`. */
static bool holds(const struct condition *c, int64_t old, double at)
{
    return !(c->nx && old != 0) && !(c->xx && old == 0) &&
           !(c->gt && (old == 0 || at <= (double)old)) && !(c->lt && old != 0 && at >= (double)old);
}

/* Milliseconds from now on, from the third word and the command's name. False: not a number. */
static bool read_time(const struct request *q, double *ms)
{
    const struct word *name = &q->word[0];
    bool fine = word_is(name, "PEXPIRE") || word_is(name, "PEXPIREAT");
    bool at = word_is(name, "EXPIREAT") || word_is(name, "PEXPIREAT");
    if (!proto_read_double(q->word[2].text, q->word[2].len, ms) || !isfinite(*ms))
        return false;
    *ms = (fine ? *ms : *ms * MS) - (at ? (double)expire_now_ms() : 0);
    return true;
}

void redis_expire(struct server *s, const struct request *q, struct answer *a)
{
    struct condition c;
    char seconds[40];
    double ms;
    if (q->n < 3 || !read_conditions(q, &c)) {
        redis_usage(a, "EXPIRE|PEXPIRE|EXPIREAT|PEXPIREAT set time [NX | XX | GT | LT]");
        return;
    }
    if (!redis_sees_sets(s, a) || !is_there(s, &q->word[1], a))
        return;
    struct word words[] = {{"EXPIRE", 6}, q->word[1], q->word[2]};
    struct request ours = {.word = words, .n = 3};
    if (read_time(q, &ms)) {
        const struct dataset *set = redis_find(s, &q->word[1]);
        if (set != NULL && !holds(&c, set->expires_ms, ms + (double)expire_now_ms())) {
            redis_integer(a, 0);
            return;
        }
        /* Half a millisecond more, because the product with 1000 is rounded down. */
        ms = fmin(fmax(ms, -1), 1e15);
        words[2] = (struct word){
            seconds, (size_t)snprintf(seconds, sizeof seconds, "%.4f", (ms + 0.5) / MS)};
    }
    if (redis_run(s, &ours, a)) /* else it says what is wrong with a number, or waits */
        redis_integer(a, 1);
}

void redis_persist(struct server *s, const struct request *q, struct answer *a)
{
    if (is_there(s, &q->word[1], a) && redis_run(s, q, a))
        redis_integer(a, (int64_t)a->count);
}

/* ---- showing ---- */

void redis_ttl(struct server *s, const struct request *q, struct answer *a)
{
    const struct word *name = &q->word[0];
    bool fine = (name->text[0] & ~0x20) == 'P',
         left = word_is(name, "TTL") || word_is(name, "PTTL");
    const struct dataset *set = redis_find(s, &q->word[1]);
    if (set == NULL || set->expires_ms == 0) {
        redis_integer(a, set == NULL ? -2 : -1);
        return;
    }
    double ms = left ? expire_seconds_left(set) * MS : (double)set->expires_ms;
    redis_integer(a, (int64_t)(ms / (fine ? 1 : MS) + 0.5));
}
