/* idmap.c - the paged map from ids to values; see idmap.h.
 *
 *     page    0 1 2 ...   127 | 128 ...      255 | 256 | 257 |        the first 128 pages in a block,
 *             |_______________|                     |                 the next block freed, then
 *                     |                             |                 pages of their own
 *                 2 MiB                          16 KiB */
#include "core/points/idmap.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"
#include "core/memory/pages.h"

#define PAGE_BYTES (DT_ID_PAGE * sizeof(uint32_t))
#define WORTH_A_BLOCK (DT_ID_BLOCK / 4 * 3) /* of its pages, wanted at once */

_Static_assert(DT_ID_BLOCK *PAGE_BYTES == DT_HUGE_PAGE, "a block is a huge page");

/* The first page of the block that page i is in. */
static struct dt_id_page *block_of(const struct dt_idmap *m, uint32_t i)
{
    return &m->page[i / DT_ID_BLOCK * DT_ID_BLOCK];
}

/* Frees page i, or the block that begins with it, and returns the number of the page after it. */
static uint32_t free_pages(struct dt_idmap *m, uint32_t i)
{
    struct dt_id_page *p = &m->page[i];
    uint32_t n = p->in_block ? DT_ID_BLOCK : 1;
    if (p->in_block)
        dt_region_give(m->keeper, p->value, DT_HUGE_PAGE);
    else
        free(p->value);
    m->held -= p->value == NULL ? 0 : n;
    memset(p, 0, n * sizeof *p);
    return i + n;
}

void dt_idmap_clear(struct dt_idmap *m)
{
    for (uint32_t i = 0; i < m->pages;)
        i = free_pages(m, i);
    dt_array_free(m->page);
    *m = (struct dt_idmap){.keeper = m->keeper};
}

/* ---- room ---- */

/* Makes the table reach up to page `end`. */
static enum dt_status reserve_table(struct dt_idmap *m, uint32_t end)
{
    if (end > m->cap) {
        size_t cap = dt_array_room(m->cap, end, UINT32_MAX);
        void *page = dt_array_grow(m->page, m->pages, cap, sizeof *m->page);
        if (page == NULL)
            return DT_NOMEM;
        m->page = page;
        m->cap = (uint32_t)cap;
    }
    if (end > m->pages) {
        memset(&m->page[m->pages], 0, (end - m->pages) * sizeof *m->page);
        m->pages = end;
    }
    return DT_OK;
}

static enum dt_status new_page(struct dt_idmap *m, uint32_t i)
{
    uint32_t *value = malloc(PAGE_BYTES);
    if (value == NULL)
        return DT_NOMEM;
    memset(value, 0xff, PAGE_BYTES); /* all DT_NONE */
    m->page[i] = (struct dt_id_page){.value = value};
    m->held++;
    m->empty++;
    return DT_OK;
}

static enum dt_status new_block(struct dt_idmap *m, uint32_t first)
{
    char *value = dt_region_take(m->keeper, DT_HUGE_PAGE);
    if (value == NULL)
        return DT_NOMEM;
    memset(value, 0xff, DT_HUGE_PAGE);
    for (uint32_t i = 0; i < DT_ID_BLOCK; i++)
        m->page[first + i] =
            (struct dt_id_page){.value = (void *)(value + i * PAGE_BYTES), .in_block = true};
    m->held += DT_ID_BLOCK;
    m->empty += DT_ID_BLOCK;
    return DT_OK;
}

/* Whether the pages from i on, of which those below `end` are wanted, should become a block: if a block may
 * begin at i, most of it is wanted, and none of it exists. */
static bool suits_block(const struct dt_idmap *m, uint32_t i, uint32_t end)
{
    if (i % DT_ID_BLOCK != 0 || end - i < WORTH_A_BLOCK)
        return false;
    for (uint32_t k = i; k < i + DT_ID_BLOCK && k < m->pages; k++)
        if (m->page[k].value != NULL)
            return false;
    return true;
}

enum dt_status dt_idmap_reserve(struct dt_idmap *m, uint32_t first, size_t n)
{
    if (n == 0)
        return DT_OK;
    uint32_t end = (uint32_t)((first + n - 1) / DT_ID_PAGE) + 1;
    enum dt_status status = end > m->pages ? reserve_table(m, end) : DT_OK;
    for (uint32_t i = first / DT_ID_PAGE; status == DT_OK && i < end; i++) {
        if (m->page[i].value != NULL)
            continue;
        if (!suits_block(m, i, end)) {
            status = new_page(m, i);
            continue;
        }
        status = reserve_table(m, i + DT_ID_BLOCK);
        if (status == DT_OK)
            status = new_block(m, i);
    }
    return status;
}

/* ---- values ---- */

/* n more ids of page i are live. */
static void count_live(struct dt_idmap *m, uint32_t i, uint32_t n)
{
    struct dt_id_page *p = &m->page[i];
    p->live += n;
    if (p->live > n)
        return;
    if (!p->in_block)
        m->empty--;
    else if (block_of(m, i)->used++ == 0)
        m->empty -= DT_ID_BLOCK;
}

void dt_idmap_set(struct dt_idmap *m, uint32_t id, uint32_t value)
{
    uint32_t *at = dt_idmap_at(m, id);
    if (*at == DT_NONE)
        count_live(m, id / DT_ID_PAGE, 1);
    *at = value;
}

void dt_idmap_count(struct dt_idmap *m, uint32_t first, size_t n)
{
    while (n > 0) {
        uint32_t room = DT_ID_PAGE - first % DT_ID_PAGE, part = n < room ? (uint32_t)n : room;
        const uint32_t *value = dt_idmap_at(m, first);
        uint32_t live = 0;
        for (uint32_t i = 0; i < part; i++)
            live += value[i] != DT_NONE;
        if (live > 0)
            count_live(m, first / DT_ID_PAGE, live);
        first += part;
        n -= part;
    }
}

void dt_idmap_unset(struct dt_idmap *m, uint32_t id)
{
    struct dt_id_page *p = &m->page[id / DT_ID_PAGE];
    p->value[id % DT_ID_PAGE] = DT_NONE;
    if (--p->live > 0)
        return;
    if (!p->in_block)
        m->empty++;
    else if (--block_of(m, id / DT_ID_PAGE)->used == 0)
        m->empty += DT_ID_BLOCK;
}

void dt_idmap_trim(struct dt_idmap *m)
{
    if (m->empty < 8)
        return;
    for (uint32_t i = 0; i < m->pages;) {
        const struct dt_id_page *p = &m->page[i];
        if (p->in_block && p->used > 0)
            i += DT_ID_BLOCK;
        else
            i = p->in_block || p->live == 0 ? free_pages(m, i) : i + 1;
    }
    m->empty = 0;
}

bool dt_idmap_drop(struct dt_idmap *m, uint32_t n)
{
    bool any = m->held > 0;
    for (; n > 0 && m->held > 0; m->pages--) {
        uint32_t i = m->pages - 1;
        n -= m->page[i].value != NULL;
        m->empty -= m->page[i].value != NULL && m->page[i].live == 0;
        free_pages(m, i);
    }
    return any;
}

uint32_t dt_idmap_next(const struct dt_idmap *m, uint32_t from)
{
    uint32_t at = from % DT_ID_PAGE;
    for (uint32_t i = from / DT_ID_PAGE; i < m->pages; i++, at = 0) {
        if (m->page[i].live == 0)
            continue;
        for (; at < DT_ID_PAGE; at++)
            if (m->page[i].value[at] != DT_NONE)
                return i * DT_ID_PAGE + at;
    }
    return DT_NONE;
}

uint32_t dt_idmap_after(const struct dt_idmap *m, uint32_t from, uint32_t n)
{
    uint32_t at = from % DT_ID_PAGE;
    for (uint32_t i = from / DT_ID_PAGE; i < m->pages; i++, at = 0) {
        uint32_t live = m->page[i].live;
        uint32_t here = live * (DT_ID_PAGE - at) / DT_ID_PAGE;
        if (here > n)
            return i * DT_ID_PAGE + at + n * DT_ID_PAGE / live;
        n -= here;
    }
    return DT_NONE;
}

/* ---- all of it ---- */

/* Page i, or the block that begins with it; returns the number of the page after it, 0: out of memory. */
static uint32_t copy_pages(const struct dt_idmap *m, struct dt_idmap *copy, uint32_t i)
{
    const struct dt_id_page *p = &m->page[i];
    if (p->value == NULL)
        return i + 1;
    if ((p->in_block ? new_block(copy, i) : new_page(copy, i)) != DT_OK)
        return 0;
    uint32_t n = p->in_block ? DT_ID_BLOCK : 1;
    memcpy(copy->page[i].value, p->value, n * PAGE_BYTES);
    for (uint32_t k = i; k < i + n; k++) {
        copy->page[k].live = m->page[k].live;
        copy->page[k].used = m->page[k].used;
    }
    return i + n;
}

enum dt_status dt_idmap_copy(const struct dt_idmap *m, struct dt_idmap *copy, struct dt_stop *stop)
{
    *copy = (struct dt_idmap){.keeper = m->keeper};
    if (m->pages == 0)
        return DT_OK;
    if (reserve_table(copy, m->pages) != DT_OK)
        return DT_NOMEM;
    for (uint32_t i = 0; i < m->pages && !dt_stopped(stop);) {
        i = copy_pages(m, copy, i);
        if (i == 0) {
            dt_idmap_clear(copy);
            return DT_NOMEM;
        }
    }
    copy->empty = m->empty;
    return DT_OK;
}

size_t dt_idmap_memory(const struct dt_idmap *m)
{
    return m->cap * sizeof *m->page + m->held * PAGE_BYTES;
}
