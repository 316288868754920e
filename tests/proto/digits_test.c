/* digits_test.c - numbers that are digits only, decimal and hexadecimal. */
#include "proto/number.h"
#include "tests/test.h"

#include <string.h>

TEST(number_reads_u32)
{
    static const char *const bad[] = {
        "", "-1", "+1", " 1", "1 ", "1.", "4294967296", "99999999999999999999", "a", "0x1"};
    uint32_t v = 42;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!proto_read_u32(bad[i], strlen(bad[i]), &v) && v == 42, "accepted: %s", bad[i]);
    CHECK(proto_read_u32("0", 1, &v) && v == 0);
    CHECK(proto_read_u32("4294967295", 10, &v) && v == UINT32_MAX);
    CHECK(proto_read_u32("0000000000000000000000017", 25, &v) && v == 17);
    CHECK(proto_read_u32("1234", 2, &v) && v == 12);
}

TEST(number_reads_u64_up_to_its_largest_value)
{
    uint64_t v = 42;
    CHECK(!proto_read_u64("18446744073709551616", 20, &v) && !proto_read_u64("", 0, &v));
    CHECK(!proto_read_u64("1844674407370955161a", 20, &v) && !proto_read_u64("-1", 2, &v));
    CHECK(!proto_read_u64("99999999999999999999", 20, &v) && v == 42);
    CHECK(proto_read_u64("18446744073709551615", 20, &v) && v == UINT64_MAX);
    CHECK(proto_read_u64("0000000000000000000000017", 25, &v) && v == 17);
}

TEST(number_reads_hexadecimal_digits_in_lower_case)
{
    static const char *const bad[] = {"",   "-1", "0x1", "g", "A",
                                      "1 ", "/",  ":",   "`", "10000000000000000"};
    uint64_t v = 42;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!proto_read_hex(bad[i], strlen(bad[i]), &v) && v == 42, "accepted: %s", bad[i]);
    CHECK(proto_read_hex("ffffffffffffffff", 16, &v) && v == UINT64_MAX);
    CHECK(proto_read_hex("0123456789abcdef", 16, &v) && v == 0x0123456789abcdef);
}
