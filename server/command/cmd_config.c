/* cmd_config.c - CONFIG: shows and changes settings, and reloads the tokens. */
#include "server/command/command.h"

#include "server/clients/clients.h"
#include "server/clients/reload.h"
#include "server/jobs/durable.h"
#include "server/ops/setting.h"

#include <stdio.h>
#include <string.h>

/* ---- GET ---- */

static void get(struct server *s, const struct request *q, struct answer *a)
{
    char text[SETTING_TEXT_ROOM];
    const char *name[SETTING_MOST];
    uint64_t n = 0;
    for (size_t i = 0; i < setting_count; i++) {
        name[i] = setting_asked(&settings[i], q->word + 2, q->n - 2);
        n += name[i] != NULL;
    }
    reply_ok(a->out, n);
    reply_end(a->out);
    for (size_t i = 0; i < setting_count; i++) {
        if (name[i] == NULL)
            continue;
        buf_append_text(a->out, name[i]);
        buf_append_char(a->out, ' ');
        reply_row_text(a->out, setting_text(&settings[i], s->config, text));
    }
}

/* ---- SET ---- */

/* Parses one name and its value into *next. */
static bool read_pair(struct answer *a, const struct word *w, struct config *next)
{
    char value[64];
    const struct setting *of = setting_find(w[0].text, w[0].len);
    size_t len = w[1].len < sizeof value - 1 ? w[1].len : sizeof value - 1;
    if (of == NULL)
        return answer_err(a, ERR_SYNTAX, "there is no setting %.*s; try CONFIG GET *", QUOTED(w));
    if (!of->live)
        return answer_err(a, ERR_SYNTAX, "%s cannot be changed while the server runs", of->name);
    memcpy(value, w[1].text, len);
    value[len] = '\0';
    if (len == w[1].len && strlen(value) == len && setting_read(of, next, value))
        return true;
    return answer_err(a, ERR_RANGE, "%s %.*s: %s", of->name, QUOTED(&w[1]), of->wanted);
}

static bool affordable(struct server *s, struct answer *a, const struct config *next)
{
    unsigned most = config_affordable_clients(next->max_clients);
    if (next->max_clients <= s->config->max_clients || next->max_clients <= most)
        return true;
    return answer_err(a, ERR_RANGE, "max-clients %u: there are descriptors for %u",
                      next->max_clients, most);
}

/* Writes messages about what has changed. */
static void report(const struct server *s, const struct answer *a, const struct config *next)
{
    char was[SETTING_TEXT_ROOM], now[SETTING_TEXT_ROOM], what[160];
    const struct session *who = clients_asker(s, a);
    for (size_t i = 0; i < setting_count && who != NULL; i++) {
        const char *before = setting_text(&settings[i], s->config, was);
        const char *after = setting_text(&settings[i], next, now);
        if (strcmp(before, after) == 0)
            continue;
        snprintf(what, sizeof what, "has changed %s to %s; it was %s", settings[i].name, after,
                 before);
        notice_client(who, NOTICE_INFO, what);
    }
}

static void set(struct server *s, const struct request *q, struct answer *a)
{
    struct config next = *s->config;
    for (size_t i = 2; i < q->n; i += 2)
        if (!read_pair(a, &q->word[i], &next))
            return;
    if (!affordable(s, a, &next))
        return;
    if (next.slowlog_len != s->slowlog.cap && !slowlog_resize(&s->slowlog, next.slowlog_len)) {
        answer_out_of_memory(a);
        return;
    }
    report(s, a, &next);
    *s->config = next;
    s->budget.limit = next.max_memory; /* workers read this one */
    durable_settings_changed(s);
    notice_set_level(next.log_level);
    server_memory_freed(s); /* a higher limit is like freed memory */
    answer_ok(a);
}

/* ---- RELOAD ---- */

static void reload(struct server *s, struct answer *a)
{
    if (s->config->auth_file == NULL) {
        answer_err(a, ERR_SYNTAX, "there is no --auth-file to reload");
        return;
    }
    if (!reload_tokens(s, a->owner)) {
        answer_err(a, ERR_IO, "the token file is not valid; the old tokens stay: see the log");
        return;
    }
    const struct session *who = clients_asker(s, a);
    if (who != NULL) { /* the new role of the connection; *a still has the old one */
        a->client = who->client;
        if (who->client.role == ROLE_NONE)
            a->closes = true;
    }
    answer_count(a, "tokens", s->auth.n);
}

void cmd_config(struct server *s, struct dataset *none, const struct request *q, struct answer *a)
{
    const struct word *what = &q->word[1];
    bool sets = q->n >= 4 && q->n % 2 == 0 && word_is(what, "SET");
    bool reloads = q->n == 2 && word_is(what, "RELOAD");
    if (q->n >= 3 && word_is(what, "GET"))
        get(s, q, a);
    else if (!sets && !reloads)
        answer_usage(a);
    else if (check_write_role(a))
        sets ? set(s, q, a) : reload(s, a);
}
