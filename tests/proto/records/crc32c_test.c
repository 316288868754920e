/* crc32c_test.c - the checksum compared with published values and with itself. */
#include "proto/records/crc32c.h"

#include "tests/test.h"

#include <string.h>

TEST(crc32c_agrees_with_rfc_3720)
{
    unsigned char bytes[32];
    CHECK(crc32c(0, "123456789", 9) == 0xE3069283);
    memset(bytes, 0, sizeof bytes);
    CHECK(crc32c(0, bytes, sizeof bytes) == 0x8A9136AA);
    memset(bytes, 0xff, sizeof bytes);
    CHECK(crc32c(0, bytes, sizeof bytes) == 0x62A8AB43);
    for (unsigned i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)i;
    CHECK(crc32c(0, bytes, sizeof bytes) == 0x46DD794E);
}

TEST(crc32c_is_the_same_with_and_without_the_instruction_and_in_pieces)
{
    unsigned char bytes[300];
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)test_random();
    for (size_t n = 0; n <= sizeof bytes; n++) {
        uint32_t want = crc32c_portable(0, bytes, n);
        size_t cut = test_below((uint32_t)n + 1);
        CHECK(crc32c(0, bytes, n) == want);
        CHECK(crc32c(crc32c(0, bytes, cut), bytes + cut, n - cut) == want);
    }
}
