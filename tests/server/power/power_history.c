/* power_history.c - see power_history.h. */
#include "tests/server/power/power_history.h"

#include "tests/test.h"

#include <inttypes.h>
#include <string.h>

/* ---- recording ---- */

void history_init(struct states *h)
{
    *h = (struct states){0};
    pthread_mutex_init(&h->mutex, NULL);
}

static void *grown(void *array, int n, int *cap, size_t size)
{
    if (n < *cap)
        return array;
    *cap = *cap == 0 ? 16 : 2 * *cap;
    array = realloc(array, (size_t)*cap * size);
    CHECK(array != NULL);
    return array;
}

/* Appends p to a list that grows by one. */
static void *listed(void *list, int n, void *p)
{
    void **v = realloc(list, (size_t)(n + 1) * sizeof *v);
    CHECK(v != NULL && p != NULL);
    v[n] = p;
    return v;
}

struct stream *history_new_stream(struct states *h, const char *set)
{
    struct stream *s = calloc(1, sizeof *s);
    pthread_mutex_lock(&h->mutex);
    h->stream = listed(h->stream, h->streams, s);
    s->number = (unsigned)h->streams++;
    pthread_mutex_unlock(&h->mutex);
    s->shared = set != NULL;
    if (s->shared)
        snprintf(s->set, sizeof s->set, "%s", set);
    else
        snprintf(s->set, sizeof s->set, "own%u", s->number);
    return s;
}

struct connection *history_new_connection(struct states *h, unsigned port)
{
    struct connection *c = calloc(1, sizeof *c);
    CHECK(c != NULL);
    c->port = port;
    pthread_mutex_lock(&h->mutex);
    for (int i = 0; i < h->connections && c != NULL; i++) {
        if (h->connection[i]->port == port) {
            free(c);
            c = NULL;
        }
    }
    if (c != NULL)
        h->connection = listed(h->connection, h->connections++, c);
    pthread_mutex_unlock(&h->mutex);
    return c;
}

int stream_add(struct stream *s, const struct request_change *c)
{
    s->sent = grown(s->sent, s->n, &s->cap, sizeof *s->sent);
    s->sent[s->n] = (struct sent_change){.change = *c};
    if (c->kind <= REQUEST_LOADB)
        s->ids += c->n;
    else if (c->kind == REQUEST_DROP)
        s->ids = 0;
    return s->n++;
}

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* Notes the ids of the points of an addition. */
static void learn_ids(struct stream *s, const struct request_change *c, const char *reply)
{
    uint32_t first;
    if (c->kind > REQUEST_LOADB || sscanf(reply, "OK 0 first=%" SCNu32, &first) != 1)
        return;
    s->id = realloc(s->id, (s->known + c->n) * sizeof *s->id);
    CHECK(s->id != NULL);
    for (uint32_t i = 0; i < c->n; i++)
        s->id[s->known++] = first + i;
}

static void note(struct connection *c, struct heard heard)
{
    c->heard = grown(c->heard, c->n, &c->cap, sizeof *c->heard);
    c->heard[c->n++] = heard;
}

void connection_hear(struct connection *c, struct stream *s, int index, uint64_t end,
                     const char *reply)
{
    struct sent_change *sent = &s->sent[index];
    note(c, (struct heard){.stream = s, .index = index, .end = end});
    snprintf(sent->reply, sizeof sent->reply, "%s", reply);
    sent->refused = begins(reply, "ERR READONLY") || begins(reply, "ERR BUSY") ||
                    begins(reply, "ERR LOADING") || begins(reply, "ERR CANCELLED");
    if (s->shared)
        learn_ids(s, &sent->change, reply);
}

void connection_see(struct connection *c, struct dt_point p, uint64_t end)
{
    note(c, (struct heard){.point = p, .end = end});
}

/* ---- freeing ---- */

void history_forget_connections(struct states *h)
{
    for (int i = 0; i < h->connections; i++) {
        free(h->connection[i]->heard);
        free(h->connection[i]);
    }
    free(h->connection);
    h->connection = NULL;
    h->connections = 0;
}

void history_clear(struct states *h)
{
    for (int i = 0; i < h->streams; i++) {
        struct stream *s = h->stream[i];
        for (int k = 0; k < s->n; k++)
            request_change_clear(&s->sent[k].change);
        model_clear(&s->before);
        free(s->sent);
        free(s->digest);
        free(s->id);
        free(s);
    }
    free(h->stream);
    history_forget_connections(h);
    pthread_mutex_destroy(&h->mutex);
}
