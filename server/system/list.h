/* list.h - doubly linked lists, which are also the queues. An element begins with its link, or has it elsewhere
 * (list_owner), and is in one list at a time for each link.
 *
 * The links form a ring through the list itself, so an element leaves without knowing its list. A list that has elements
 * must not be copied. Cost of each call: constant; nothing is allocated. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* All zero: in no list. */
struct list_link {
    struct list_link *prev, *next;
};

/* All zero: empty. */
struct list {
    struct list_link end; /* its `next` is the first link, its `prev` the last one */
};

static inline bool list_is_empty(const struct list *l)
{
    return l->end.next == NULL || l->end.next == &l->end;
}

/* Whether the link is in a list. */
static inline bool list_holds(const struct list_link *e)
{
    return e->next != NULL;
}

/* The first element, the last one, and the one behind e; NULL: there is none. */
static inline void *list_first(const struct list *l)
{
    return list_is_empty(l) ? NULL : l->end.next;
}

static inline void *list_last(const struct list *l)
{
    return list_is_empty(l) ? NULL : l->end.prev;
}

static inline void *list_next(const struct list *l, const void *e)
{
    struct list_link *next = ((const struct list_link *)e)->next;
    return next == &l->end ? NULL : next;
}

/* The element whose link is `offset` bytes from its beginning; NULL if the link is NULL. */
static inline void *list_owner(void *link, size_t offset)
{
    return link == NULL ? NULL : (char *)link - offset;
}

static inline void list_put(struct list_link *e, struct list_link *before)
{
    e->prev = before->prev;
    e->next = before;
    e->prev->next = e;
    before->prev = e;
}

/* Enters at the end, or at the front. */
static inline void list_append(struct list *l, struct list_link *e)
{
    if (l->end.next == NULL)
        l->end.prev = l->end.next = &l->end;
    list_put(e, &l->end);
}

static inline void list_prepend(struct list *l, struct list_link *e)
{
    if (l->end.next == NULL)
        l->end.prev = l->end.next = &l->end;
    list_put(e, l->end.next);
}

/* Leaves its list; nothing happens if it is in none. */
static inline void list_remove(struct list_link *e)
{
    if (e->next == NULL)
        return;
    e->prev->next = e->next;
    e->next->prev = e->prev;
    e->prev = e->next = NULL;
}

/* Removes the first element; NULL: there is none. */
static inline void *list_pop(struct list *l)
{
    struct list_link *e = list_first(l);
    if (e != NULL)
        list_remove(e);
    return e;
}

/* Moves all elements to the end of another list. */
static inline void list_move(struct list *to, struct list *from)
{
    struct list_link *first = list_first(from), *last = list_last(from);
    if (first == NULL)
        return;
    list_append(to, &from->end); /* its place becomes that of the elements */
    from->end.prev->next = first;
    first->prev = from->end.prev;
    from->end.next->prev = last;
    last->next = from->end.next;
    from->end.prev = from->end.next = NULL;
}
