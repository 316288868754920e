/* slowlog.c - see slowlog.h. */
#include "server/ops/slowlog.h"

#include <stdlib.h>
#include <string.h>

bool slowlog_init(struct slowlog *l, unsigned cap)
{
    *l = (struct slowlog){.entry = calloc(cap + 1, sizeof *l->entry), .cap = cap};
    pthread_mutex_init(&l->adding, NULL);
    return l->entry != NULL;
}

void slowlog_clear(struct slowlog *l)
{
    free(l->entry);
    pthread_mutex_destroy(&l->adding);
    *l = (struct slowlog){0};
}

bool slowlog_resize(struct slowlog *l, unsigned cap)
{
    struct slow *entry = calloc(cap + 1, sizeof *entry);
    unsigned n = slowlog_len(l);
    if (entry == NULL)
        return false;
    l->first = l->next - (n < cap ? n : cap);
    for (uint64_t id = l->first; id < l->next; id++)
        entry[id % cap] = l->entry[id % l->cap];
    free(l->entry);
    l->entry = entry;
    l->cap = cap;
    return true;
}

void slowlog_add(struct slowlog *l, const struct slow *entry)
{
    if (l->cap == 0)
        return;
    pthread_mutex_lock(&l->adding);
    struct slow *to = &l->entry[l->next % l->cap];
    *to = *entry;
    to->id = l->next++;
    pthread_mutex_unlock(&l->adding);
}

unsigned slowlog_len(const struct slowlog *l)
{
    uint64_t n = l->next - l->first;
    return n < l->cap ? (unsigned)n : l->cap;
}

const struct slow *slowlog_find(const struct slowlog *l, uint64_t id)
{
    bool there = id < l->next && l->next - id <= slowlog_len(l);
    return there ? &l->entry[id % l->cap] : NULL;
}

void slowlog_reset(struct slowlog *l)
{
    l->first = l->next;
}

/* Appends as much as fits, with the last byte left for the NUL; returns the new length. */
static size_t append(char *text, size_t at, const char *from, size_t len)
{
    for (size_t i = 0; i < len && at < SLOW_TEXT - 1; i++)
        text[at++] = from[i] > ' ' && from[i] <= '~' ? from[i] : '?';
    return at;
}

void slowlog_quote(char *text, const struct word *word, size_t n)
{
    static const char more[] = "...";
    size_t at = 0, whole = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && at < SLOW_TEXT - 1)
            text[at++] = ' ';
        at = append(text, at, word[i].text, word[i].len);
        whole += word[i].len + (i > 0);
        if (whole > SLOW_TEXT - 1) {
            memcpy(text + SLOW_TEXT - sizeof more, more, sizeof more);
            return;
        }
    }
    text[at] = '\0';
}
