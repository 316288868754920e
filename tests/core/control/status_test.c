/* status_test.c - sentences for statuses. */
#include <string.h>

#include "core/delaunay.h"
#include "tests/test.h"

TEST(every_status_has_a_sentence_of_its_own_and_other_numbers_have_one_too)
{
    for (int i = 0; i <= (int)DT_OPEN; i++)
        for (int j = -1; j < i; j++)
            CHECK(strcmp(dt_status_text((enum dt_status)i), dt_status_text((enum dt_status)j)) !=
                  0);
    CHECK_STR(dt_status_text((enum dt_status)(DT_OPEN + 1)), dt_status_text((enum dt_status) - 1));
    CHECK(strlen(dt_status_text((enum dt_status)1000)) > 0);
}
