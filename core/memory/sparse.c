/* sparse.c - see sparse.h. */
#include "core/memory/sparse.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

enum { WORDS = DT_SPARSE_PAGE / 64, FIRST_ROOM = 8 };

static size_t page_bytes(const struct dt_sparse_page *p)
{
    return sizeof *p + p->cap * sizeof *p->value;
}

static void free_page(struct dt_sparse *m, uint32_t i)
{
    if (m->page[i] == NULL)
        return;
    m->memory -= page_bytes(m->page[i]);
    free(m->page[i]->value);
    free(m->page[i]);
    m->page[i] = NULL;
}

void dt_sparse_clear(struct dt_sparse *m)
{
    for (uint32_t i = 0; i < m->pages; i++)
        free_page(m, i);
    dt_array_free(m->page);
    *m = (struct dt_sparse){0};
}

size_t dt_sparse_memory(const struct dt_sparse *m)
{
    return m->memory + m->pages * sizeof *m->page;
}

/* ---- pages ---- */

/* Makes the table reach up to page i. */
static enum dt_status reserve_table(struct dt_sparse *m, uint32_t i)
{
    if (i < m->pages)
        return DT_OK;
    size_t room = dt_array_room(m->pages, (size_t)i + 1, UINT32_MAX / DT_SPARSE_PAGE + 1);
    struct dt_sparse_page **page = dt_array_grow(m->page, m->pages, room, sizeof *page);
    if (page == NULL)
        return DT_NOMEM;
    memset(page + m->pages, 0, (room - m->pages) * sizeof *page);
    m->page = page;
    m->pages = (uint32_t)room;
    return DT_OK;
}

/* The page of the id, with room for one more value; NULL: out of memory. */
static struct dt_sparse_page *page_with_room(struct dt_sparse *m, uint32_t id)
{
    uint32_t i = id / DT_SPARSE_PAGE;
    if (reserve_table(m, i) != DT_OK)
        return NULL;
    struct dt_sparse_page *p = m->page[i];
    uint32_t cap = p == NULL || p->cap == 0 ? FIRST_ROOM : p->cap + p->cap / 2;
    if (p != NULL && p->n < p->cap)
        return p;
    uint32_t *value = realloc(p == NULL ? NULL : p->value, cap * sizeof *value);
    if (value == NULL)
        return NULL;
    if (p == NULL) {
        p = calloc(1, sizeof *p);
        if (p == NULL) {
            free(value);
            return NULL;
        }
        m->page[i] = p;
        m->memory += sizeof *p;
    }
    m->memory += (cap - p->cap) * sizeof *value;
    p->value = value;
    p->cap = cap;
    return p;
}

/* Where the value of the id is in its page, or would be. */
static uint32_t rank(const struct dt_sparse_page *p, uint32_t id)
{
    uint32_t word = id % DT_SPARSE_PAGE / 64;
    uint64_t below = ((uint64_t)1 << id % 64) - 1;
    return p->before[word] + (uint32_t)__builtin_popcountll(p->bits[word] & below);
}

/* ---- values ---- */

enum dt_status dt_sparse_set(struct dt_sparse *m, uint32_t id, uint32_t value)
{
    uint32_t word = id % DT_SPARSE_PAGE / 64, old;
    uint64_t bit = (uint64_t)1 << id % 64;
    if (dt_sparse_get(m, id, &old)) {
        struct dt_sparse_page *p = m->page[id / DT_SPARSE_PAGE];
        p->value[rank(p, id)] = value;
        return DT_OK;
    }
    struct dt_sparse_page *p = page_with_room(m, id);
    if (p == NULL)
        return DT_NOMEM;
    uint32_t at = rank(p, id);
    memmove(p->value + at + 1, p->value + at, (p->n - at) * sizeof *p->value);
    p->value[at] = value;
    p->bits[word] |= bit;
    for (uint32_t w = word + 1; w < WORDS; w++)
        p->before[w]++;
    p->n++;
    m->n++;
    return DT_OK;
}

void dt_sparse_unset(struct dt_sparse *m, uint32_t id)
{
    uint32_t word = id % DT_SPARSE_PAGE / 64;
    struct dt_sparse_page *p = m->page[id / DT_SPARSE_PAGE];
    uint32_t at = rank(p, id);
    m->n--;
    if (--p->n == 0) {
        free_page(m, id / DT_SPARSE_PAGE);
        return;
    }
    memmove(p->value + at, p->value + at + 1, (p->n - at) * sizeof *p->value);
    p->bits[word] &= ~((uint64_t)1 << id % 64);
    for (uint32_t w = word + 1; w < WORDS; w++)
        p->before[w]--;
}

uint32_t dt_sparse_drop(struct dt_sparse *m, uint32_t n)
{
    uint32_t dropped = 0;
    while (dropped < n && m->pages > 0) {
        const struct dt_sparse_page *p = m->page[m->pages - 1];
        m->n -= p == NULL ? 0 : p->n;
        dropped += p != NULL;
        free_page(m, --m->pages);
    }
    return dropped;
}

uint32_t dt_sparse_next(const struct dt_sparse *m, uint32_t from)
{
    uint32_t word = from % DT_SPARSE_PAGE / 64;
    uint64_t wanted = ~(uint64_t)0 << from % 64;
    for (uint32_t i = from / DT_SPARSE_PAGE; i < m->pages; i++, word = 0, wanted = ~(uint64_t)0) {
        const struct dt_sparse_page *p = m->page[i];
        for (; p != NULL && word < WORDS; word++, wanted = ~(uint64_t)0) {
            uint64_t bits = p->bits[word] & wanted;
            if (bits != 0)
                return i * DT_SPARSE_PAGE + word * 64 + (uint32_t)__builtin_ctzll(bits);
        }
    }
    return DT_NONE;
}

uint32_t dt_sparse_after(const struct dt_sparse *m, uint32_t from, uint32_t n)
{
    uint32_t at = from % DT_SPARSE_PAGE;
    for (uint32_t i = from / DT_SPARSE_PAGE; i < m->pages; i++, at = 0) {
        uint32_t keys = m->page[i] == NULL ? 0 : m->page[i]->n;
        uint32_t here = keys * (DT_SPARSE_PAGE - at) / DT_SPARSE_PAGE;
        if (here > n)
            return i * DT_SPARSE_PAGE + at + n * DT_SPARSE_PAGE / keys;
        n -= here;
    }
    return DT_NONE;
}
