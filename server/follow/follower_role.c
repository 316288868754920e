/* follower_role.c - whom this daemon follows, and whether it accepts changes (follower.h). */
#include "server/follow/follower.h"

#include "server/follow/follower_inside.h"
#include "server/follow/leader.h"
#include "server/jobs/durable.h"
#include "server/system/notice.h"
#include "server/system/random.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A follower that is promoted informs its former leader as soon as that is back: within about three seconds. */
enum { SETTLE_MS = 4000 };

/* ---- the role ---- */

static void refuse_changes(struct follower *f)
{
    struct server *s = f->server;
    char history[HISTORY_TEXT], leader[ROLE_TEXT];
    history_write(history, &f->role.newer);
    role_write_address(leader, f->role.host, f->role.port);
    if (f->role.kind == ROLE_FENCED)
        snprintf(
            f->why, sizeof f->why,
            "there is a newer history %s: FOLLOW its leader, or FOLLOW NONE to go on without it",
            history);
    else
        snprintf(f->why, sizeof f->why, "leader=%s", leader);
    s->read_only.code = ERR_READONLY;
    s->read_only.why = f->why;
    s->follows = f->role.kind == ROLE_FOLLOWS;
}

/* Whether --follow names this daemon: the address that it listens on, or an equivalent address. */
static bool is_itself(const struct config *c, const char *host, unsigned port)
{
    bool any = strcmp(host, "0.0.0.0") == 0 || strcmp(host, "::") == 0;
    return port == c->port && (any || strcmp(host, c->bind_address) == 0);
}

/* An operator who changes --follow means it; one who has used FOLLOW since does not mean the flag any more. */
static bool decide(struct follower *f)
{
    static const char *const kinds[] = {"", "a follower of another one", "a leader", "fenced"};
    const char *flag = f->server->config->follow;
    if (flag != NULL && f->server->config->data == NULL)
        return notice_error("--follow needs --data");
    if (f->server->config->data != NULL)
        f->role = role_read(f->server->config->data);
    struct remembered_role known = f->role;
    if (!role_decide(&f->role, flag))
        return notice_error("--follow %s: not ADDR:PORT", flag);
    char host[ROLE_ADDRESS];
    unsigned port;
    if (flag == NULL || !role_read_address(flag, host, &port))
        return true;
    if (is_itself(f->server->config, host, port))
        return notice_error("--follow %s: that is this daemon itself", flag);
    bool followed = known.kind == ROLE_FOLLOWS && known.port == port && !strcmp(known.host, host);
    if (strcmp(known.flag, flag) == 0 && !followed)
        notice(NOTICE_WARNING,
               "--follow %s is ignored: since the last start with it this daemon is %s", flag,
               kinds[f->role.kind]);
    return true;
}

bool follower_prepare(struct server *s, struct loop *loop)
{
    struct follower *f = calloc(1, sizeof *f);
    if (f == NULL)
        return notice_error("out of memory");
    s->follower = f;
    f->server = s;
    f->loop = loop;
    f->identity = random_bits();
    f->source.fd = -1;
    if (!decide(f))
        return false;
    if (f->role.kind == ROLE_FENCED || f->role.kind == ROLE_FOLLOWS)
        refuse_changes(f);
    return true;
}

/* ---- following, and informing a former leader ---- */

static const char *start_link(struct follower *f)
{
    struct server *s = f->server;
    struct link *l = calloc(1, sizeof *l);
    if (l == NULL)
        return "out of memory";
    if (!dial_read_token(s->config->follow_token_file, l->dial.token)) {
        free(l);
        return "the file of --follow-token-file cannot be read";
    }
    snprintf(l->host, sizeof l->host, "%s", f->role.host);
    l->dial.port = f->role.port;
    l->confirmed = f->confirmed;
    l->own = f->role.own;
    l->dir = durable_dir(s);
    l->pages = s->pages;
    l->budget = &s->budget;
    l->event = f->source.fd;
    if (!link_start(l)) {
        free(l);
        return strerror(errno);
    }
    f->link = l;
    return NULL;
}

static void end_threads(struct follower *f)
{
    if (f->link != NULL)
        link_end(f->link);
    f->link = NULL;
    link_piece_free(f->piece);
    f->piece = NULL;
    f->at = 0;
    announce_end(f->announce);
    f->announce = NULL;
}

/* Begins to follow; the log is at a position of its own. */
static const char *begin(struct follower *f)
{
    struct server *s = f->server;
    const struct log_status *log = durable_status(s);
    f->lsn = log_last(durable_log(s));
    f->digest = log->durable == f->lsn && !durable_has_gap(s) ? log->digest : 0;
    f->whole_digest = f->digest;
    f->claimed = f->done = f->done_bytes = f->acked = f->acked_bytes = 0;
    f->following = true;
    f->drops = false;
    durable_set_digest(s, &f->whole_digest);
    durable_close_mark(s, false);
    durable_keep_log(s); /* others may follow this daemon after its promotion */
    return start_link(f);
}

void follower_remember(struct follower *f)
{
    const struct log_status *log = durable_status(f->server);
    if (log == NULL || log->state == LOG_FAILED || log->failures == f->failures)
        return;
    if (f->role.kind == ROLE_UNKNOWN || role_write(durable_dir(f->server), &f->role))
        f->failures = log->failures;
}

void follower_agrees(struct follower *f)
{
    if (!f->role.own)
        return;
    f->role.own = false;
    f->link->own = false;
    if (!role_write(durable_dir(f->server), &f->role))
        f->role.own = true; /* tried again */
}

/* Informs the former leader, if it is not known that it refuses changes. */
static void inform(struct follower *f)
{
    const struct server *s = f->server;
    char token[DIAL_TOKEN], former[ROLE_TEXT];
    if (f->role.kind != ROLE_LEADS || f->role.port == 0)
        return;
    errno = 0;
    if (dial_read_token(s->config->follow_token_file, token))
        f->announce = announce_start(f->role.host, f->role.port, token,
                                     &durable_dir(s)->lineage.history, f->source.fd);
    role_write_address(former, f->role.host, f->role.port);
    if (f->announce == NULL)
        notice(NOTICE_WARNING, "the former leader %s is not informed: %s", former,
               errno != 0 ? strerror(errno) : "no token");
}

void follower_take_answer(struct follower *f)
{
    struct announcement *a = f->announce;
    if (a == NULL || a->state == ANNOUNCE_TRYING)
        return;
    char former[ROLE_TEXT];
    struct history newer = a->theirs;
    role_write_address(former, f->role.host, f->role.port);
    bool fenced = a->state == ANNOUNCE_NEWER;
    notice(NOTICE_INFO, "the former leader %s has been informed, and answers %s", former,
           a->answer);
    announce_end(a);
    f->announce = NULL;
    f->role.port = 0;
    if (fenced)
        follower_meet(f->server, &newer);
    else if (!role_write(durable_dir(f->server), &f->role))
        notice(NOTICE_WARNING, "it is informed again after a restart: %s", strerror(errno));
}

/* Continues a promotion whose history was not yet in the log when the daemon was killed. */
static void continue_promotion(struct follower *f)
{
    struct server *s = f->server;
    const struct history *own = &durable_dir(s)->lineage.history;
    struct lineage l = {s->sets.life, f->role.newer};
    if (f->role.kind != ROLE_LEADS || history_relation(&l.history, own) != HISTORY_NEWER)
        return;
    l.history.parent = own->nonce;
    durable_set_lineage(s, &l);
}

void follower_begin(struct server *s)
{
    struct follower *f = s->follower;
    if (f == NULL || durable_dir(s) == NULL || f->source.fd >= 0)
        return;
    if (!follower_watch(f)) {
        notice_error("cannot follow: %s", strerror(errno));
        return;
    }
    f->settled_ms = f->loop->now_ms + SETTLE_MS;
    if (f->role.kind == ROLE_UNKNOWN)
        return;
    struct remembered_role known = role_read(s->config->data);
    if (strcmp(known.flag, f->role.flag) != 0 &&
        !role_write(durable_dir(s), &f->role)) /* a full disk does not keep it from following */
        notice(NOTICE_WARNING, "the role cannot be remembered: %s", strerror(errno));
    continue_promotion(f);
    inform(f);
    if (!s->follows)
        return;
    const char *why = begin(f);
    if (why != NULL)
        notice_error("cannot follow %s: %s", f->why, why);
}

void follower_stop(struct server *s)
{
    struct follower *f = s->follower;
    if (f == NULL)
        return;
    end_threads(f);
    announce_end(f->question);
    if (f->source.fd >= 0) {
        apply_clear(&f->apply);
        close(f->source.fd);
    }
    free(f);
    s->follower = NULL;
}

/* ---- FOLLOW ---- */

void follower_hear(struct follower *f)
{
    if (f->question != NULL && f->question->state != ANNOUNCE_TRYING)
        queue_wake_all(&f->asking);
}

static bool is_asked(const struct announcement *q, const char *host, unsigned port)
{
    return q != NULL && q->dial.port == port && strcmp(q->host, host) == 0;
}

/* Decides by the answer. A daemon that follows, or is fenced, has no followers. */
static enum follow_target judge(const struct follower *f, const struct inquired *who, char *why,
                                size_t size)
{
    char own[20];
    snprintf(own, sizeof own, "%016" PRIx64, f->identity);
    if (strcmp(who->daemon, own) == 0)
        return FOLLOW_ITSELF;
    if (strcmp(who->role, "follower") == 0)
        snprintf(why, size, "it is a follower itself: FOLLOW its leader %s", who->leader);
    else if (strcmp(who->role, "fenced") == 0)
        snprintf(why, size, "it has met a newer history, and is no leader");
    else if (who->refusal[0] != '\0')
        snprintf(why, size, "it answers %s", who->refusal);
    else
        return FOLLOW_POSSIBLE;
    return FOLLOW_IMPOSSIBLE;
}

enum follow_target follower_examine(struct server *s, const char *host, unsigned port,
                                    struct request_queue **queue, char *why, size_t size)
{
    struct follower *f = s->follower;
    char token[DIAL_TOKEN];
    bool answered = f->question != NULL && f->question->state != ANNOUNCE_TRYING;
    *queue = &f->asking;
    if (f->question != NULL && !answered)
        return FOLLOW_ASKED;
    if (is_asked(f->question, host, port)) {
        struct inquired who = f->question->who;
        announce_end(f->question);
        f->question = NULL;
        return judge(f, &who, why, size);
    }
    announce_end(f->question); /* whoever has asked is gone */
    f->question = NULL;
    if (dial_read_token(s->config->follow_token_file, token))
        f->question = announce_start(host, port, token, NULL, f->source.fd);
    return f->question != NULL ? FOLLOW_ASKED : FOLLOW_POSSIBLE;
}

/* The role that a command has decided, with the flag of the last start. */
static struct remembered_role decided(const struct follower *f, enum role_kind kind)
{
    struct remembered_role next = {.kind = kind};
    memcpy(next.flag, f->role.flag, sizeof next.flag);
    return next;
}

const char *follower_follow(struct server *s, const char *host, unsigned port, bool confirmed)
{
    struct follower *f = s->follower;
    struct remembered_role next = decided(f, ROLE_FOLLOWS);
    if (follower_has_record(f))
        return "a change of the leader is being carried out; try again";
    snprintf(next.host, sizeof next.host, "%s", host);
    next.port = port;
    next.own = f->role.own || f->role.kind != ROLE_FOLLOWS;
    if (!role_write(durable_dir(s), &next))
        return strerror(errno);
    end_threads(f);
    leader_dismiss(s);
    f->role = next;
    f->confirmed = confirmed;
    refuse_changes(f);
    follower_forget(f);
    return begin(f);
}

const char *follower_promote(struct server *s)
{
    struct follower *f = s->follower;
    if (!f->following && f->role.kind != ROLE_FENCED)
        return NULL;
    if (follower_has_record(f))
        return "a change of the leader is being carried out; try again";
    if (durable_status(s)->state == LOG_FAILED)
        return "the disk does not work";
    struct lineage l = durable_dir(s)->lineage;
    if (f->role.kind == ROLE_FENCED && f->role.newer.generation > l.history.generation)
        l.history.generation = f->role.newer.generation;
    l.history = history_next(&l.history, (uint32_t)random_bits());
    struct remembered_role next = decided(f, ROLE_LEADS);
    next.newer = l.history;
    memcpy(next.host, f->role.host, sizeof next.host);
    next.port = f->role.port;
    if (!role_write(durable_dir(s), &next))
        return strerror(errno);
    end_threads(f);
    follower_forget(f);
    f->following = false;
    f->settled_ms = 0;
    f->role = next;
    durable_set_digest(s, NULL);
    durable_close_mark(s, true);
    registry_begin_life(&s->sets, l.life);
    l.life = s->sets.life;
    durable_set_lineage(s, &l);
    leader_dismiss(s);
    s->follows = false;
    s->read_only.why = NULL;
    durable_settings_changed(s);
    notice(NOTICE_INFO, "this daemon is a leader now");
    inform(f);
    return NULL;
}

void follower_meet(struct server *s, const struct history *h)
{
    struct follower *f = s->follower;
    if (f->following || history_relation(h, &durable_dir(s)->lineage.history) != HISTORY_NEWER)
        return;
    if (f->role.kind == ROLE_FENCED && !f->unsaved &&
        history_relation(h, &f->role.newer) == HISTORY_SAME)
        return;     /* it is known */
    end_threads(f); /* it need not inform any other daemon: it is replaced itself */
    f->role = decided(f, ROLE_FENCED);
    f->role.newer = *h;
    f->unsaved = !role_write(durable_dir(s), &f->role);
    if (f->unsaved)
        notice_error("that there is a newer history cannot be saved: %s", strerror(errno));
    refuse_changes(f);
    notice(NOTICE_WARNING, "changes are refused: %s", f->why);
}

/* ---- INFO ---- */

void follower_facts(const struct server *s, struct follower_facts *facts)
{
    struct follower *f = s->follower;
    static const char *const names[] = {"connecting", "receiving", "loading", "refused"};
    *facts = (struct follower_facts){.role = "leader", .state = "", .settled = s->durable == NULL};
    if (f == NULL)
        return;
    facts->identity = f->identity;
    if (f->source.fd >= 0 && s->read_only.why == NULL)
        facts->settled = f->loop->now_ms >= f->settled_ms;
    if (f->role.kind == ROLE_FENCED)
        facts->role = "fenced";
    if (f->role.kind == ROLE_LEADS && f->role.port != 0)
        role_write_address(facts->former, f->role.host, f->role.port);
    if (!s->follows)
        return;
    facts->role = "follower";
    facts->state = "connecting";
    role_write_address(facts->leader, f->role.host, f->role.port);
    if (f->link == NULL)
        return;
    pthread_mutex_lock(&f->link->mutex);
    facts->state = names[f->link->state];
    snprintf(facts->why, sizeof facts->why, "%s", f->link->why);
    facts->leader_lsn = f->link->leader_lsn;
    pthread_mutex_unlock(&f->link->mutex);
    const char *fault = durable_fault(s);
    if (fault != NULL)
        snprintf(facts->why, sizeof facts->why, "changes cannot be saved here: %s", fault);
}
