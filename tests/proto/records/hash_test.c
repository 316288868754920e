/* hash_test.c - the hash of bytes. */
#include "proto/records/hash.h"

#include "tests/test.h"

#include <string.h>

TEST(digest_is_the_same_in_every_version_and_on_every_processor)
{
    unsigned char bytes[256];
    for (unsigned i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)(255 - i);
    CHECK(hash_bytes(0, bytes, 256) == UINT64_C(0x6281069478CF1558));
    CHECK(hash_bytes(0, bytes, 13) == UINT64_C(0x56415A4B54EC2EB3));
}

TEST(digest_changes_with_every_bit_and_length)
{
    unsigned char bytes[40] = {0};
    for (size_t n = 0; n <= sizeof bytes; n++) {
        uint64_t d = hash_bytes(7, bytes, n);
        CHECK(n == sizeof bytes || hash_bytes(7, bytes, n + 1) != d);
        CHECK(hash_bytes(8, bytes, n) != d);
        for (size_t bit = 0; bit < 8 * n; bit++) {
            bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
            CHECK(hash_bytes(7, bytes, n) != d);
            bytes[bit / 8] = 0;
        }
    }
}
