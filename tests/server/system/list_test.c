/* list_test.c - lists: elements keep their order, leave from anywhere, and know whether they are in one. */
#include "server/system/list.h"
#include "tests/test.h"

#include <stddef.h>

struct item {
    struct list_link link; /* first */
    int number;
    struct list_link other;
};

static struct item item[4] = {{.number = 1}, {.number = 2}, {.number = 3}, {.number = 4}};

/* The numbers in the list, as decimal digits; forwards and backwards they must be the same. */
static int digits(const struct list *l)
{
    int forwards = 0, backwards = 0, unit = 1;
    const struct item *last = NULL;
    for (const struct item *i = list_first(l); i != NULL; i = list_next(l, i)) {
        forwards = 10 * forwards + i->number;
        last = i;
    }
    CHECK(list_last(l) == last && list_is_empty(l) == (last == NULL));
    for (const struct list_link *e = l->end.prev; last != NULL && e != &l->end; e = e->prev) {
        backwards += unit * ((const struct item *)e)->number;
        unit *= 10;
    }
    CHECK(forwards == backwards);
    return forwards;
}

TEST(list_that_is_all_zero_is_empty)
{
    struct list l = {0};
    CHECK(list_is_empty(&l) && list_first(&l) == NULL && list_pop(&l) == NULL && digits(&l) == 0);
}

TEST(list_keeps_the_order_of_both_ends)
{
    struct list l = {0};
    list_append(&l, &item[1].link);
    list_append(&l, &item[2].link);
    list_prepend(&l, &item[0].link);
    CHECK(digits(&l) == 123);
    CHECK(list_pop(&l) == &item[0] && digits(&l) == 23);
    list_append(&l, &item[0].link);
    CHECK(digits(&l) == 231);
}

TEST(element_leaves_a_list_from_anywhere_and_once)
{
    struct list l = {0};
    for (int i = 0; i < 4; i++)
        list_append(&l, &item[i].link);
    list_remove(&item[1].link);
    CHECK(!list_holds(&item[1].link) && list_holds(&item[2].link) && digits(&l) == 134);
    list_remove(&item[1].link);
    list_remove(&item[3].link);
    list_remove(&item[0].link);
    CHECK(digits(&l) == 3);
    list_remove(&item[2].link);
    CHECK(list_is_empty(&l) && !list_holds(&item[2].link));
    list_prepend(&l, &item[3].link);
    CHECK(digits(&l) == 4);
}

TEST(elements_that_move_come_behind_those_of_the_other_list)
{
    struct list l = {0}, other = {0};
    list_move(&l, &other);
    CHECK(list_is_empty(&l));
    list_append(&other, &item[2].link);
    list_append(&other, &item[3].link);
    list_move(&l, &other);
    CHECK(digits(&l) == 34 && list_is_empty(&other));
    list_append(&other, &item[0].link);
    list_append(&other, &item[1].link);
    list_move(&other, &l);
    CHECK(digits(&other) == 1234 && list_is_empty(&l));
    list_remove(&item[2].link);
    CHECK(digits(&other) == 124);
}

TEST(element_may_be_in_a_list_for_each_of_its_links)
{
    struct list l = {0}, others = {0};
    list_append(&l, &item[0].link);
    list_append(&others, &item[0].other);
    CHECK(list_owner(list_first(&others), offsetof(struct item, other)) == &item[0]);
    list_remove(&item[0].other);
    CHECK(list_owner(list_first(&others), offsetof(struct item, other)) == NULL);
    CHECK(digits(&l) == 1);
}
