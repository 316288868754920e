/* clients_test.c - which session an id means. */
#include "server/clients/clients.h"
#include "tests/test.h"

#include <string.h>

TEST(id_is_never_that_of_who_has_its_slot_now)
{
    static struct session first, second;
    struct clients c = {0};
    CHECK(clients_add(&c, &first));
    uint64_t id = first.id;
    CHECK(clients_find(&c, id) == &first);
    clients_remove(&c, &first);
    CHECK(clients_find(&c, id) == NULL);
    CHECK(clients_add(&c, &second) && (uint32_t)second.id == (uint32_t)id);
    CHECK(clients_find(&c, id) == NULL && clients_find(&c, second.id) == &second);
    clients_clear(&c);
}

TEST(id_of_a_slot_that_there_is_not_is_nobody)
{
    static struct session one;
    struct clients c = {0};
    test_guard_alloc(true);
    CHECK(clients_find(&c, 0) == NULL && clients_add(&c, &one));
    for (uint32_t i = 1; i <= 2 * c.cap; i++)
        CHECK(clients_find(&c, (one.id & ~(uint64_t)UINT32_MAX) | ((uint32_t)one.id + i)) == NULL);
    clients_clear(&c);
    test_guard_alloc(false);
}
