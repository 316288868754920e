/* row_memory_test.c - the memory of long rows is counted before it is taken, and is exact. */
#include "server/rows/row_memory.h"
#include "tests/test.h"

static struct budget budget;

static struct reservation begin(size_t bytes)
{
    budget_init(&budget, bytes, NULL);
    return (struct reservation){.budget = &budget, .kind = BUDGET_REPLIES};
}

TEST(a_long_row_is_reserved_with_what_it_takes_beside_its_text)
{
    struct reservation memory = begin(1000000);
    struct buf out = {0};
    buf_append(&out, "0123456789", 10);
    CHECK(row_memory_reserve(&memory, &out, 100000, 50000) && out.cap == 100010 &&
          buf_len(&out) == 10);
    CHECK(memory.bytes == 150010 && budget_used(&budget) == 150010);
    CHECK(row_memory_reserve(&memory, &out, 90000, 0) && out.cap == 100010 &&
          memory.bytes == 150010);
    buf_commit(&out, 90000);
    buf_consume(&out, 50000); /* what has been sent is not moved along with it */
    CHECK(row_memory_reserve(&memory, &out, 120000, 0) && out.cap == 160010 &&
          memory.bytes == 160010);
    buf_free(&out);
    reservation_set(&memory, 0);
}

TEST(a_row_for_which_there_is_no_memory_takes_none)
{
    struct reservation memory = begin(100000);
    struct buf out = {0};
    CHECK(!row_memory_reserve(&memory, &out, 90000, 10001));
    CHECK(out.failed && out.cap == 0 && memory.bytes == 0 && budget_used(&budget) == 0);
    buf_rewind(&out, 0);
    CHECK(row_memory_reserve(&memory, &out, 90000, 10000) && memory.bytes == 100000);
    CHECK(row_memory_reserve(&memory, &out, ROW_MEMORY_SHORT, 0) &&
          row_memory_reserve(NULL, &out, 200000, 0));
    buf_free(&out);
    reservation_set(&memory, 0);
}
