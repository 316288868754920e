/* request_stats.c - see request_stats.h. */
#include "server/session/request_stats.h"

#include "server/command/command.h"

#include <string.h>
#include <time.h>

/* Returns how many words of a request may be shown. A secret follows AUTH, which is a command, possibly after TIMEOUT, or
 * a word of HELLO. */
static size_t open_words(const struct request *q)
{
    if (q->n == 0 || !(word_is(&q->word[0], "AUTH") || word_is(&q->word[0], "HELLO") ||
                       word_is(&q->word[0], "TIMEOUT")))
        return q->n;
    for (size_t i = 0; i < q->n; i++)
        if (word_is(&q->word[i], "AUTH"))
            return i + 1;
    return q->n;
}

/* Copies the words of the request: from the note if it has paused, else from the request itself. */
static void quote(const struct session *s, char *text)
{
    const struct request *q = &s->reactor->request;
    if (s->noted)
        memcpy(text, s->note, sizeof s->note);
    else
        slowlog_quote(text, q->word, open_words(q));
}

static void note_slow(struct session *s, const struct stats_outcome *took)
{
    struct slow entry = {.at_s = (int64_t)time(NULL),
                         .work_us = took->work_ns / 1000,
                         .wait_us = took->wait_ns / 1000,
                         .client = s->id,
                         .peer = s->peer};
    quote(s, entry.text);
    slowlog_add(&s->server->slowlog, &entry);
    s->reactor->slow++;
}

void request_stats_end(struct session *s, const struct answer *a, bool error)
{
    struct server *server = s->server;
    int64_t limit_us = server->config->slowlog_us;
    bool quick = a->command != NULL && (a->command->flags & CMD_QUICK) != 0;
    struct stats_outcome took =
        stats_end(&s->reactor->stats, &s->pause, command_number(server, a->command), quick, error);
    s->requests++;
    s->reactor->commands++;
    s->reactor->errors += error;
    if (limit_us > 0 && took.work_ns + took.wait_ns >= limit_us * 1000)
        note_slow(s, &took);
    s->noted = false;
}

void request_stats_pause(struct session *s, const struct answer *a)
{
    stats_pause(&s->reactor->stats, &s->pause, a->next == ANSWER_WAIT && a->wait_for != WAIT_JOB);
    if (!s->noted)
        quote(s, s->note);
    s->noted = true;
}

void request_stats_load(struct session *s)
{
    stats_look(&s->reactor->stats);
    if (s->pause.since_ns == 0)
        s->pause = (struct stats_pause){.began_ns = s->reactor->stats.mark_ns};
    stats_resume(&s->reactor->stats, &s->pause);
}

void request_stats_job(struct session *s, const struct job *j)
{
    if (j->began_ns > j->queued_ns)
        s->pause.waited_ns += j->began_ns - j->queued_ns;
}
