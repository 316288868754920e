/* history_test.c - histories, their order and their text. */
#include "proto/records/history.h"

#include "tests/test.h"

#include <string.h>

TEST(history_of_a_promotion_is_newer_and_remembers_its_parent)
{
    struct history a = history_begin(0x123456789abcdef0), b = history_next(&a, 7);
    struct history c = history_next(&a, 8), d = history_begin(5), none = {0};
    CHECK(history_relation(&a, &a) == HISTORY_SAME);
    CHECK(history_relation(&b, &a) == HISTORY_NEWER && history_relation(&a, &b) == HISTORY_OLDER);
    CHECK(history_relation(&b, &c) == HISTORY_BESIDE && b.parent == a.nonce);
    CHECK(history_relation(&d, &a) == HISTORY_DIFFERENT);
    CHECK(history_relation(&none, &none) == HISTORY_DIFFERENT);
    CHECK(history_begin(0).origin != 0);
}

TEST(history_text_is_read_as_written)
{
    struct history h = {0xfedcba9876543210, 4294967295, 0x0000000a, 0}, got;
    char text[HISTORY_TEXT];
    history_write(text, &h);
    CHECK(strcmp(text, "fedcba9876543210.4294967295.0000000a") == 0);
    CHECK(history_read(text, strlen(text), &got) && history_relation(&got, &h) == HISTORY_SAME);
    for (size_t n = 0; n < strlen("fedcba9876543210.4294967295."); n++)
        CHECK(!history_read(text, n, &got));
    static const char *const bad[] = {"",       ".1.2",  "1..2",           "1.2.",
                                      "1.2.3x", "g.1.2", "1.4294967296.2", "11111111111111111.1.1",
                                      "1.-1.2", "1 .1.2"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!history_read(bad[i], strlen(bad[i]), &got), "%s", bad[i]);
}
