/* idmap.c - the paged map from ids to values; see idmap.h.
 *
 *     page    0 1 2 ...   511 | 512 ...     1023 | 1024 | 1025 |      the first 512 pages in a block,
 *             |_______________|                      |                the next block freed, then
 *                     |                              |                pages of their own
 *                 2 MiB                            4 KiB */
#include "core/points/idmap.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/pages.h"

#define PAGE_BYTES (DT_ID_PAGE * sizeof(uint32_t))
#define FEW_EMPTY 32                        /* pages that are not worth a search */
#define WORTH_A_BLOCK (DT_ID_BLOCK / 4 * 3) /* of its pages, wanted at once */

_Static_assert(DT_ID_BLOCK *PAGE_BYTES == DT_HUGE_PAGE, "a block is a huge page");

/* The number of pages that are freed together with page i, itself included. */
static uint32_t extent(const struct dt_idmap *m, uint32_t i)
{
    return m->page[i].in_block ? DT_ID_BLOCK : 1;
}

/* Frees page i, or the block that begins with it, and returns the number of the page after it. */
static uint32_t free_pages(struct dt_idmap *m, uint32_t i)
{
    struct dt_id_page *p = &m->page[i];
    uint32_t n = extent(m, i);
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
        if (!dt_array_resize(NULL, &m->page, m->pages, cap, sizeof *m->page))
            return DT_NOMEM;
        m->cap = (uint32_t)cap;
    }
    if (end > m->pages) {
        memset(&m->page[m->pages], 0, (end - m->pages) * sizeof *m->page);
        m->pages = end;
    }
    return DT_OK;
}

/* Makes page i, or the n pages of the block that begins with it. */
static enum dt_status new_pages(struct dt_idmap *m, uint32_t i, uint32_t n)
{
    bool block = n == DT_ID_BLOCK;
    uint32_t *value = block ? dt_region_take(m->keeper, DT_HUGE_PAGE) : malloc(PAGE_BYTES);
    if (value == NULL)
        return DT_NOMEM;
    memset(value, 0xff, n * PAGE_BYTES); /* all DT_NONE */
    for (uint32_t k = 0; k < n; k++)
        m->page[i + k] =
            (struct dt_id_page){.value = value + (size_t)k * DT_ID_PAGE, .in_block = block};
    m->held += n;
    m->empty += n;
    return DT_OK;
}

/* Whether the pages from i on should become a block: a block may begin at i, most of its pages are wanted, that is,
 * before `end`, and none of them exists. */
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
    enum dt_status status = reserve_table(m, end);
    for (uint32_t i = first / DT_ID_PAGE; status == DT_OK && i < end; i++) {
        if (m->page[i].value != NULL)
            continue;
        uint32_t pages = suits_block(m, i, end) ? DT_ID_BLOCK : 1;
        status = reserve_table(m, i + pages);
        if (status == DT_OK)
            status = new_pages(m, i, pages);
    }
    return status;
}

/* ---- values ---- */

void dt_idmap_set(struct dt_idmap *m, uint32_t id, uint32_t value)
{
    uint32_t *at = dt_idmap_at(m, id);
    m->page[id / DT_ID_PAGE].live += *at == DT_NONE;
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
        m->page[first / DT_ID_PAGE].live += live;
        first += part;
        n -= part;
    }
}

void dt_idmap_unset(struct dt_idmap *m, uint32_t id)
{
    uint32_t i = id / DT_ID_PAGE;
    m->page[i].value[id % DT_ID_PAGE] = DT_NONE;
    if (--m->page[i].live == 0)
        m->empty += extent(m, i); /* perhaps: other pages of a block may have live ids */
}

void dt_idmap_trim(struct dt_idmap *m)
{
    if (m->empty < FEW_EMPTY)
        return;
    for (uint32_t i = 0; i < m->pages;) {
        uint32_t end = i + extent(m, i), at = i;
        while (at < end && m->page[at].live == 0)
            at++;
        i = at == end ? free_pages(m, i) : end;
    }
    m->empty = 0;
}

bool dt_idmap_drop(struct dt_idmap *m, uint32_t n)
{
    bool any = m->held > 0;
    for (; n > 0 && m->held > 0; m->pages--) {
        uint32_t i = m->pages - 1;
        n -= m->page[i].value != NULL;
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

enum dt_status dt_idmap_copy(const struct dt_idmap *m, struct dt_idmap *copy, struct dt_stop *stop)
{
    *copy = (struct dt_idmap){.keeper = m->keeper};
    enum dt_status status = reserve_table(copy, m->pages);
    for (uint32_t i = 0, n; i < m->pages && status == DT_OK && !dt_stopped(stop); i += n) {
        n = extent(m, i);
        if (m->page[i].value == NULL)
            continue;
        status = new_pages(copy, i, n);
        if (status == DT_OK)
            memcpy(copy->page[i].value, m->page[i].value, n * PAGE_BYTES);
        for (uint32_t k = i; k < i + n; k++)
            copy->page[k].live = m->page[k].live;
    }
    if (status != DT_OK)
        dt_idmap_clear(copy);
    return status;
}

size_t dt_idmap_memory(const struct dt_idmap *m)
{
    return m->cap * sizeof *m->page + m->held * PAGE_BYTES;
}
