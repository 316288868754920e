/* buf_test.c - buffers compared with a plain array. */
#include "proto/buf.h"
#include "tests/test.h"

#include <string.h>

TEST(buf_is_a_queue_of_bytes)
{
    enum { TOTAL = 20000 };
    struct buf b = {0};
    size_t in = 0, out = 0;
    while (out < TOTAL) {
        for (size_t n = test_below(700); n > 0 && in < TOTAL; n--, in++)
            buf_append_char(&b, (char)(in * 7));
        for (size_t n = test_below(700); n > 0 && out < in; n--, out++) {
            CHECK(*buf_head(&b) == (char)(out * 7));
            buf_consume(&b, 1);
        }
        CHECK(buf_len(&b) == in - out);
    }
    CHECK(b.cap <= 64 * 1024);
    buf_free(&b);
    CHECK(b.cap == 0 && b.data == NULL);
}

TEST(buf_keeps_its_content_when_memory_runs_out)
{
    struct buf b = {0};
    char block[1000] = {0};
    buf_append_text(&b, "kept");
    test_fail_alloc(1);
    buf_append(&b, block, sizeof block);
    CHECK(test_alloc_failed());
    CHECK(b.failed && buf_len(&b) == 4 && memcmp(buf_head(&b), "kept", 4) == 0);
    buf_rewind(&b, 2);
    CHECK(!b.failed && buf_len(&b) == 2);
    buf_append_text(&b, "y");
    CHECK(memcmp(buf_head(&b), "key", 3) == 0);
    buf_free(&b);
}

TEST(buf_refuses_a_length_that_would_overflow)
{
    struct buf b = {0};
    buf_append_text(&b, "x");
    CHECK(buf_reserve(&b, SIZE_MAX - 4) == NULL && b.failed);
    buf_free(&b);
}

TEST(buffer_without_memory_has_no_head)
{
    struct buf b = {0};
    CHECK(buf_head(&b) == NULL && buf_len(&b) == 0);
    buf_append(&b, "", 0);
    buf_consume(&b, 0);
    CHECK(buf_head(&b) == NULL && !b.failed);
}

TEST(exact_room_is_no_more_than_was_asked_for_and_can_be_given_back)
{
    struct buf b = {0};
    CHECK(buf_reserve_exactly(&b, 1000) != NULL && b.cap == 1000);
    buf_append(&b, "abcdef", 6);
    buf_consume(&b, 4);
    CHECK(buf_reserve_exactly(&b, 994) != NULL && b.cap == 1000 && b.start == 4);
    CHECK(buf_reserve_exactly(&b, 998) != NULL && b.cap == 1000 && b.start == 0);
    CHECK(buf_reserve_exactly(&b, 2000) != NULL && b.cap == 2002);
    CHECK(buf_len(&b) == 2 && memcmp(buf_head(&b), "ef", 2) == 0);
    buf_fit(&b);
    CHECK(b.cap == 2 && memcmp(buf_head(&b), "ef", 2) == 0);
    CHECK(buf_reserve_exactly(&b, SIZE_MAX) == NULL && b.failed && buf_len(&b) == 2);
    buf_consume(&b, 2);
    buf_fit(&b);
    CHECK(b.data == NULL && b.cap == 0);
}
