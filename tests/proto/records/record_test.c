/* record_test.c - records are read as they were written, and nothing else is accepted as a record. */
#include "proto/records/record.h"

#include "proto/records/crc32c.h"
#include "tests/test.h"

#include <string.h>

static const double points[] = {1, 2, -3.5, 0x1p-142, 0x1p201, 0};
static const uint32_t ids[] = {0, 7, UINT32_MAX};
static const double values[] = {0.5, -7, 1e-300};
static const struct record_value pairs[] = {{1, -0.5}, {UINT32_MAX, 3}};
static const struct record_row rows[] = {{3, 3, 0.1, 0.2}, {9, 3, 0.1, -0.25}};

static const struct record_constraint constraints[] = {{0, 7, 0}, {UINT32_MAX, 1, UINT32_MAX}};
static const struct record_move moves[] = {{UINT32_MAX, 0x1p-142, -2}, {0, 0.1, 0x1p201}};

/* One record of every type, with every field in use. */
static struct record sample(enum record_type type)
{
    struct record r = {.lsn = 0x123456789abcdef0u + type,
                       .synced = 0x0fedcba987654321u,
                       .type = type,
                       .flags = 1,
                       .first = 4000000000u,
                       .n = 3,
                       .a = -0x1.8p-20,
                       .b = 1e300,
                       .name = "Roads.of-X:y",
                       .name_len = 12,
                       .field = "depth",
                       .field_len = 5};
    switch (type) {
    case RECORD_ADD:
    case RECORD_CHUNK:
        r.items = points;
        break;
    case RECORD_DELETE:
    case RECORD_CASCADE:
        r.items = ids;
        break;
    case RECORD_ROWS:
        r.items = rows;
        r.n = 2;
        break;
    case RECORD_FSET:
        r.items = pairs;
        r.n = 2;
        break;
    case RECORD_VALUES:
        r.items = values;
        break;
    case RECORD_CONSTRAIN:
    case RECORD_RELEASE:
        r.items = constraints;
        r.n = 2;
        break;
    case RECORD_MOVES:
        r.items = moves;
        r.n = 2;
        break;
    default:
        break;
    }
    return r;
}

static void check_items(const struct record *got)
{
    double xy[6];
    uint32_t id[3];
    struct record_row row;
    struct record_value pair;
    struct record_constraint constraint;
    struct record_move move;
    switch (got->type) {
    case RECORD_VALUES:
        record_items(got, 0, got->n, xy);
        CHECK(memcmp(xy, values, sizeof values) == 0);
        break;
    case RECORD_FSET:
        for (uint32_t i = 0; i < 2; i++) {
            record_items(got, i, 1, &pair);
            CHECK(pair.id == pairs[i].id && pair.value == pairs[i].value);
        }
        break;
    case RECORD_ADD:
    case RECORD_CHUNK:
        record_items(got, 0, got->n, xy);
        CHECK(memcmp(xy, points, sizeof points) == 0);
        break;
    case RECORD_DELETE:
    case RECORD_CASCADE:
        record_items(got, 0, got->n, id);
        CHECK(memcmp(id, ids, sizeof ids) == 0);
        break;
    case RECORD_ROWS:
        for (uint32_t i = 0; i < 2; i++) {
            record_items(got, i, 1, &row);
            CHECK(memcmp(&row, &rows[i], sizeof row) == 0);
        }
        break;
    case RECORD_CONSTRAIN:
    case RECORD_RELEASE:
        for (uint32_t i = 0; i < 2; i++) {
            record_items(got, i, 1, &constraint);
            CHECK(memcmp(&constraint, &constraints[i], sizeof constraint) == 0);
        }
        break;
    case RECORD_MOVES:
        for (uint32_t i = 0; i < 2; i++) {
            record_items(got, i, 1, &move);
            CHECK(move.id == moves[i].id && move.x == moves[i].x && move.y == moves[i].y);
        }
        break;
    default:
        break;
    }
}

TEST(records_of_every_type_are_read_as_written)
{
    for (int t = RECORD_CREATE; t < RECORD_TYPES; t++) {
        struct record want = sample((enum record_type)t), got;
        struct buf b = {0};
        record_write(&b, &want);
        size_t len = buf_len(&b);
        CHECK(record_read(buf_head(&b), len, &got) == (ptrdiff_t)len);
        CHECK(got.lsn == want.lsn && got.synced == want.synced && got.type == want.type);
        CHECK(got.flags == want.flags && got.first == want.first && got.n == want.n);
        CHECK(got.a == want.a && got.b == want.b && got.name_len == want.name_len);
        CHECK(memcmp(got.name, want.name, want.name_len) == 0);
        CHECK(got.field_len == want.field_len && memcmp(got.field, want.field, 5) == 0);
        check_items(&got);
        buf_free(&b);
    }
}

TEST(record_cut_anywhere_needs_more_and_flipped_anywhere_is_refused)
{
    for (int t = RECORD_CREATE; t < RECORD_TYPES; t++) {
        struct record want = sample((enum record_type)t), got;
        struct buf b = {0};
        record_write(&b, &want);
        size_t len = buf_len(&b);
        for (size_t n = 0; n < len; n++) {
            char *exact =
                malloc(n + 1); /* of its exact size, so that a sanitizer sees an overrun */
            memcpy(exact, buf_head(&b), n);
            CHECK(record_read(exact, n, &got) == 0);
            free(exact);
        }
        for (size_t i = 0; i < 8 * len; i++) {
            buf_head(&b)[i / 8] ^= (char)(1 << i % 8);
            CHECK_MSG(record_read(buf_head(&b), len, &got) <= 0, "bit %zu", i);
            buf_head(&b)[i / 8] ^= (char)(1 << i % 8);
        }
        buf_free(&b);
    }
}

TEST(outline_of_a_damaged_record_comes_from_its_header)
{
    struct buf b = {0};
    struct record got, r = sample(RECORD_DELETE);
    record_write(&b, &r);
    buf_head(&b)[8] ^= 1;
    CHECK(record_read(buf_head(&b), buf_len(&b), &got) < 0);
    struct record_outline o = record_outline(buf_head(&b));
    CHECK(o.type == RECORD_DELETE && o.length == buf_len(&b) - RECORD_HEADER && o.n == r.n);
    buf_free(&b);
}

TEST(zeros_are_not_a_record)
{
    char zeros[4096] = {0};
    struct record r;
    CHECK(record_read(zeros, sizeof zeros, &r) == -1 && r.fault != NULL);
}

TEST(record_of_a_set_has_its_version_or_none)
{
    for (uint64_t version = 0; version <= 0x1ffffffffffffe; version += 0x1ffffffffffffe) {
        struct buf b = {0};
        struct record set = {.type = RECORD_SET, .name = "t", .name_len = 1, .version = version},
                      got;
        record_write(&b, &set);
        CHECK(record_read(buf_head(&b), buf_len(&b), &got) == (ptrdiff_t)buf_len(&b));
        CHECK(got.version == version && got.name_len == 1 && got.name[0] == 't');
        buf_free(&b);
    }
}

TEST(segment_header_is_read_as_written_and_has_a_checksum)
{
    struct segment want = {.version = RECORD_VERSION, .kind = SEGMENT_SNAPSHOT, .lsn = 77}, got;
    want.life = 0xfedcba98;
    char bytes[SEGMENT_HEADER];
    segment_write(bytes, &want);
    CHECK(segment_read(bytes, sizeof bytes, &got) == SEGMENT_HEADER);
    CHECK(got.version == RECORD_VERSION && got.kind == SEGMENT_SNAPSHOT && got.lsn == 77);
    CHECK(got.life == want.life);
    for (size_t n = 0; n < sizeof bytes; n++)
        CHECK(segment_read(bytes, n, &got) == 0);
    for (size_t i = 0; i < 8 * sizeof bytes; i++) {
        bytes[i / 8] ^= (char)(1 << i % 8);
        CHECK(segment_read(bytes, sizeof bytes, &got) == -1 && got.fault != NULL);
        bytes[i / 8] ^= (char)(1 << i % 8);
    }
}

TEST(segment_of_a_later_version_is_refused_by_name)
{
    struct segment later = {.version = RECORD_VERSION + 1, .kind = SEGMENT_LOG, .lsn = 1}, got;
    char bytes[SEGMENT_HEADER];
    segment_write(bytes, &later);
    CHECK(segment_read(bytes, sizeof bytes, &got) == -1);
    CHECK(strstr(got.fault, "later version") != NULL);
}

/* Writes a number of `size` bytes. */
static void put(char *at, uint64_t v, unsigned size)
{
    for (unsigned i = 0; i < size; i++)
        at[i] = (char)(v >> 8 * i);
}

/* Reads a segment header whose bytes from `at` on have been changed, with a correct checksum. */
static bool reads_segment(size_t at, uint64_t v, unsigned size)
{
    struct segment s = {.version = RECORD_VERSION, .kind = SEGMENT_LOG, .lsn = 0x123456789abcdef0u};
    char bytes[SEGMENT_HEADER];
    segment_write(bytes, &s);
    put(bytes + at, v, size);
    put(bytes + SEGMENT_HEADER - 4, crc32c(0, bytes, SEGMENT_HEADER - 4), 4);
    ptrdiff_t took = segment_read(bytes, sizeof bytes, &s);
    CHECK(took == -1 || (took == SEGMENT_HEADER && s.lsn == 0x123456789abcdef0u));
    return took > 0;
}

TEST(segment_with_a_correct_checksum_and_a_wrong_field_is_refused)
{
    CHECK(reads_segment(0, 'D', 1) && !reads_segment(0, 'd', 1) && !reads_segment(7, 'X', 1));
    CHECK(reads_segment(8, RECORD_VERSION, 4) && !reads_segment(8, 0, 4));
    CHECK(!reads_segment(8, RECORD_VERSION + 1, 4) && !reads_segment(8, UINT32_MAX, 4));
    CHECK(reads_segment(12, SEGMENT_LOG, 4) && reads_segment(12, SEGMENT_SNAPSHOT, 4));
    CHECK(!reads_segment(12, 0, 4) && !reads_segment(12, 3, 4));
    CHECK(!reads_segment(12, 0x10000 | SEGMENT_LOG, 4));
}

/* Whether a record is accepted whose bytes from `at` on have been changed, with a correct checksum. */
static bool reads_record(enum record_type type, size_t at, uint64_t v, unsigned size)
{
    struct record r = sample(type), got;
    struct buf b = {0};
    record_write(&b, &r);
    put(buf_head(&b) + at, v, size);
    put(buf_head(&b), crc32c(0, buf_head(&b) + 4, buf_len(&b) - 4), 4);
    ptrdiff_t took = record_read(buf_head(&b), buf_len(&b), &got);
    CHECK(took == (ptrdiff_t)buf_len(&b) || (took == -1 && got.fault != NULL));
    buf_free(&b);
    return took > 0;
}

TEST(record_with_a_correct_checksum_and_a_wrong_field_is_refused)
{
    CHECK(reads_record(RECORD_DROP, 24, RECORD_DROP, 1));
    CHECK(!reads_record(RECORD_DROP, 24, 0, 1) && !reads_record(RECORD_DROP, 24, RECORD_TYPES, 1));
    CHECK(!reads_record(RECORD_DROP, 24, 0xff, 1) && !reads_record(RECORD_DROP, 27, 1, 1));
    CHECK(!reads_record(RECORD_DELETE, 26, 11, 1) && !reads_record(RECORD_DELETE, 26, 13, 1));
    CHECK(!reads_record(RECORD_VALUES, 27, 4, 1) && !reads_record(RECORD_VALUES, 27, 65, 1));
    CHECK(!reads_record(RECORD_DELETE, 32, 2, 4) && !reads_record(RECORD_DELETE, 32, 4, 4));
    /* 24 and 16 times these are 0 and 48 in 32 bits. */
    CHECK(!reads_record(RECORD_ROWS, 32, (1u << 29) + 2, 4));
    CHECK(!reads_record(RECORD_ADD, 32, (1u << 28) + 3, 4));
}

/* Checks what record_read returns for a record of n rows with a name of this length, and for its header. */
static void check_length(size_t name_len, uint32_t n, bool good)
{
    static char name[256];
    struct record_row *row = calloc(n, sizeof *row);
    struct record r = {.type = RECORD_ROWS, .n = n, .items = row}, got;
    struct buf b = {0};
    memset(name, 'n', sizeof name);
    r.name = name;
    r.name_len = name_len;
    record_write(&b, &r);
    CHECK(row != NULL && !b.failed);
    CHECK(record_read(buf_head(&b), buf_len(&b), &got) == (good ? (ptrdiff_t)buf_len(&b) : -1));
    CHECK(record_read(buf_head(&b), RECORD_HEADER, &got) == (good ? 0 : -1));
    buf_free(&b);
    free(row);
}

TEST(record_may_be_as_long_as_the_limits_allow_and_no_longer)
{
    check_length(RECORD_NAME_LIMIT, 1, true);
    check_length(RECORD_NAME_LIMIT + 1, 1, false);
    check_length(255, 1, false);
    check_length(RECORD_NAME_LIMIT, RECORD_POINTS, true);
    check_length(0, RECORD_POINTS + 6, false);
}

TEST(record_has_a_field_name_of_64_bytes_and_none_of_65)
{
    static const char name[] =
        "0123456789012345678901234567890123456789012345678901234567890123456";
    for (size_t len = RECORD_FIELD_LIMIT; len <= RECORD_FIELD_LIMIT + 1; len++) {
        struct record r = {.type = RECORD_FDROP, .field = name, .field_len = len}, got;
        struct buf b = {0};
        record_write(&b, &r);
        ptrdiff_t took = record_read(buf_head(&b), buf_len(&b), &got);
        CHECK(took == (len == RECORD_FIELD_LIMIT ? (ptrdiff_t)buf_len(&b) : -1));
        buf_free(&b);
    }
}

/* The bytes of version 1, which never change: a change here is a change of the format. */
TEST(record_of_version_1_has_these_bytes)
{
    static const double p[] = {1, -2};
    static const unsigned char want[] = {
        0xcc, 0x04, 0x61, 0xc6, 17, 0,    0,    0, 5, 0, 0, 0, 0, 0, 0,   0, 4,   0,
        0,    0,    0,    0,    0,  0,    2,    0, 1, 0, 6, 0, 0, 0, 1,   0, 0,   0,
        0,    0,    0,    0,    0,  0,    0,    0, 0, 0, 0, 0, 0, 0, 0,   0, 't', 0,
        0,    0,    0,    0,    0,  0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0xc0};
    struct record r = {.lsn = 5,
                       .synced = 4,
                       .type = RECORD_ADD,
                       .first = 6,
                       .n = 1,
                       .items = p,
                       .name = "t",
                       .name_len = 1};
    struct buf b = {0};
    record_write(&b, &r);
    CHECK(buf_len(&b) == sizeof want);
    for (size_t i = 0; i < sizeof want; i++)
        CHECK_MSG((unsigned char)buf_head(&b)[i] == want[i], "byte %zu is %02x", i,
                  (unsigned char)buf_head(&b)[i]);
    buf_free(&b);
}

TEST(record_write_out_of_memory_is_remembered)
{
    struct record r = sample(RECORD_ADD);
    struct buf b = {0};
    test_fail_alloc(1);
    record_write(&b, &r);
    test_fail_alloc(0);
    CHECK(b.failed && buf_len(&b) == 0);
}

TEST(copy_of_a_record_is_the_record_with_another_synced)
{
    for (int t = RECORD_CREATE; t < RECORD_TYPES; t++) {
        struct record r = sample((enum record_type)t);
        struct buf first = {0}, want = {0}, copy = {0};
        record_write(&first, &r);
        r.synced = 77;
        record_write(&want, &r);
        record_copy(&copy, buf_head(&first), buf_len(&first), 77);
        CHECK(buf_len(&copy) == buf_len(&want));
        CHECK(memcmp(buf_head(&copy), buf_head(&want), buf_len(&want)) == 0);
        CHECK(record_digest(5, buf_head(&copy), buf_len(&copy)) ==
              record_digest(5, buf_head(&first), buf_len(&first)));
        buf_free(&first);
        buf_free(&want);
        buf_free(&copy);
    }
}

TEST(copy_of_a_record_out_of_memory_is_remembered)
{
    struct record r = sample(RECORD_ADD);
    struct buf b = {0}, copy = {0};
    record_write(&b, &r);
    test_fail_alloc(1);
    record_copy(&copy, buf_head(&b), buf_len(&b), 77);
    test_fail_alloc(0);
    CHECK(copy.failed && buf_len(&copy) == 0);
    buf_free(&b);
}
