/* idmap.c - the paged map from ids to values; see idmap.h. */
#include "core/idmap.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

void dt_idmap_clear(struct dt_idmap *m)
{
    for (uint32_t i = 0; i < m->pages; i++)
        free(m->page[i]);
    dt_array_free(m->page);
    *m = (struct dt_idmap){0};
}

static struct dt_id_page *new_page(void)
{
    struct dt_id_page *p = malloc(sizeof *p);
    if (p != NULL) {
        p->live = 0;
        memset(p->value, 0xff, sizeof p->value); /* all DT_NONE */
    }
    return p;
}

enum dt_status dt_idmap_reserve(struct dt_idmap *m, uint32_t first, size_t n)
{
    if (n == 0)
        return DT_OK;
    uint32_t end = (uint32_t)((first + n - 1) / DT_ID_PAGE) + 1;
    if (end > m->cap) {
        size_t cap = dt_array_room(m->cap, end, UINT32_MAX);
        void *page = dt_array_grow(m->page, m->pages, cap, sizeof *m->page);
        if (page == NULL)
            return DT_NOMEM;
        m->page = page;
        m->cap = (uint32_t)cap;
    }
    for (; m->pages < end; m->pages++)
        m->page[m->pages] = NULL;
    for (uint32_t i = first / DT_ID_PAGE; i < end; i++) {
        if (m->page[i] != NULL)
            continue;
        m->page[i] = new_page();
        if (m->page[i] == NULL)
            return DT_NOMEM;
        m->held++;
        m->empty++;
    }
    return DT_OK;
}

void dt_idmap_set(struct dt_idmap *m, uint32_t id, uint32_t value)
{
    struct dt_id_page *p = m->page[id / DT_ID_PAGE];
    if (p->value[id % DT_ID_PAGE] == DT_NONE && p->live++ == 0)
        m->empty--;
    p->value[id % DT_ID_PAGE] = value;
}

void dt_idmap_unset(struct dt_idmap *m, uint32_t id)
{
    struct dt_id_page *p = m->page[id / DT_ID_PAGE];
    p->value[id % DT_ID_PAGE] = DT_NONE;
    if (--p->live == 0)
        m->empty++;
}

void dt_idmap_trim(struct dt_idmap *m)
{
    if (m->empty < 8)
        return;
    for (uint32_t i = 0; i < m->pages; i++) {
        if (m->page[i] != NULL && m->page[i]->live == 0) {
            free(m->page[i]);
            m->page[i] = NULL;
            m->held--;
        }
    }
    m->empty = 0;
}

uint32_t dt_idmap_next(const struct dt_idmap *m, uint32_t from)
{
    uint32_t at = from % DT_ID_PAGE;
    for (uint32_t i = from / DT_ID_PAGE; i < m->pages; i++, at = 0) {
        if (m->page[i] == NULL)
            continue;
        for (; at < DT_ID_PAGE; at++)
            if (m->page[i]->value[at] != DT_NONE)
                return i * DT_ID_PAGE + at;
    }
    return DT_NONE;
}

uint32_t dt_idmap_after(const struct dt_idmap *m, uint32_t from, uint32_t n)
{
    uint32_t at = from % DT_ID_PAGE;
    for (uint32_t i = from / DT_ID_PAGE; i < m->pages; i++, at = 0) {
        uint32_t live = m->page[i] == NULL ? 0 : m->page[i]->live;
        uint32_t here = live * (DT_ID_PAGE - at) / DT_ID_PAGE;
        if (here > n)
            return i * DT_ID_PAGE + at + n * DT_ID_PAGE / live;
        n -= here;
    }
    return DT_NONE;
}

enum dt_status dt_idmap_copy(const struct dt_idmap *m, struct dt_idmap *copy)
{
    *copy = (struct dt_idmap){0};
    if (m->pages == 0)
        return DT_OK;
    copy->page = dt_array_new(m->pages, sizeof *copy->page);
    if (copy->page == NULL)
        return DT_NOMEM;
    copy->cap = m->pages;
    copy->empty = m->empty;
    for (uint32_t i = 0; i < m->pages; i++) {
        copy->page[copy->pages++] = NULL;
        if (m->page[i] == NULL)
            continue;
        copy->page[i] = malloc(sizeof *copy->page[i]);
        if (copy->page[i] == NULL) {
            dt_idmap_clear(copy);
            return DT_NOMEM;
        }
        *copy->page[i] = *m->page[i];
        copy->held++;
    }
    return DT_OK;
}

size_t dt_idmap_memory(const struct dt_idmap *m)
{
    return m->cap * sizeof *m->page + (size_t)m->held * sizeof(struct dt_id_page);
}
