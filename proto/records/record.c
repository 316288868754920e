/* record.c - see record.h. */
#include "proto/records/record.h"

#include "proto/records/crc32c.h"
#include "proto/records/hash.h"

#include <string.h>

static const char magic[] = "DELAUNAY";

enum { MAGIC = sizeof magic - 1, VERSION_BYTES = 8, NAME_AT = RECORD_HEADER };

/* ---- numbers, which are little-endian (number.h) and may have any alignment ---- */

static void put_u32(char *p, uint32_t v)
{
    memcpy(p, &v, sizeof v);
}

static void put_u64(char *p, uint64_t v)
{
    memcpy(p, &v, sizeof v);
}

static void put_f64(char *p, double v)
{
    memcpy(p, &v, sizeof v);
}

static uint32_t get_u32(const char *p)
{
    uint32_t v;
    memcpy(&v, p, sizeof v);
    return v;
}

static uint64_t get_u64(const char *p)
{
    uint64_t v;
    memcpy(&v, p, sizeof v);
    return v;
}

static double get_f64(const char *p)
{
    double v;
    memcpy(&v, p, sizeof v);
    return v;
}

/* ---- segments ---- */

size_t segment_header_size(uint32_t version)
{
    return version <= 3 ? SEGMENT_HEADER_3 : SEGMENT_HEADER;
}

void segment_write(char bytes[SEGMENT_HEADER], const struct segment *s)
{
    size_t sum_at = segment_header_size(s->version) - 4;
    memset(bytes, 0, SEGMENT_HEADER);
    memcpy(bytes, magic, MAGIC);
    put_u32(bytes + 8, s->version);
    put_u32(bytes + 12, s->kind);
    put_u64(bytes + 16, s->lsn);
    put_u32(bytes + 24, s->life);
    if (s->version > 3) {
        put_u32(bytes + 28, s->history.generation);
        put_u64(bytes + 32, s->history.origin);
        put_u64(bytes + 40, s->digest);
        put_u32(bytes + 48, s->history.nonce);
        put_u32(bytes + 52, s->history.parent);
        put_u32(bytes + 56, s->flags);
    }
    put_u32(bytes + sum_at, crc32c(0, bytes, sum_at));
}

void segment_append(struct buf *out, const struct segment *s)
{
    char *to = buf_reserve(out, SEGMENT_HEADER);
    if (to == NULL)
        return;
    segment_write(to, s);
    buf_commit(out, SEGMENT_HEADER);
}

static void read_history(const char *bytes, struct segment *s)
{
    s->history = (struct history){.origin = get_u64(bytes + 32),
                                  .generation = get_u32(bytes + 28),
                                  .nonce = get_u32(bytes + 48),
                                  .parent = get_u32(bytes + 52)};
    s->digest = get_u64(bytes + 40);
    s->flags = get_u32(bytes + 56);
}

static ptrdiff_t bad_segment(struct segment *s, const char *fault)
{
    s->fault = fault;
    return -1;
}

ptrdiff_t segment_read(const char *bytes, size_t n, struct segment *s)
{
    if (n < SEGMENT_HEADER_3)
        return 0;
    size_t size = segment_header_size(get_u32(bytes + 8));
    *s = (struct segment){
        .version = get_u32(bytes + 8), .lsn = get_u64(bytes + 16), .life = get_u32(bytes + 24)};
    uint32_t kind = get_u32(bytes + 12);
    if (memcmp(bytes, magic, MAGIC) != 0)
        return bad_segment(s, "its header is not that of a delaunayd file");
    if (n < size)
        return 0;
    if (get_u32(bytes + size - 4) != crc32c(0, bytes, size - 4))
        return bad_segment(s, "the checksum of its header is wrong");
    if (s->version > RECORD_VERSION)
        return bad_segment(s, "it was written by a later version of delaunayd");
    if (s->version == 0 || (kind != SEGMENT_LOG && kind != SEGMENT_SNAPSHOT))
        return bad_segment(s, "its header makes no sense");
    s->kind = (enum segment_kind)kind;
    if (s->version > 3)
        read_history(bytes, s);
    return (ptrdiff_t)size;
}

/* ---- types ---- */

uint32_t record_version(enum record_type type)
{
    return type >= RECORD_CONSTRAIN ? RECORD_VERSION_CONSTRAINTS : RECORD_VERSION_PLAIN;
}

uint32_t record_most(enum record_type part)
{
    return part == RECORD_CHUNK    ? RECORD_POINTS
           : part == RECORD_VALUES ? RECORD_MOST_VALUES
                                   : RECORD_CONSTRAINTS;
}

uint32_t record_parts(enum record_type part, uint32_t n)
{
    return n / record_most(part) + (n % record_most(part) > 0);
}

/* ---- items ---- */

/* The fields of an item, in this order on disk and in memory: w, a word of 32 bits, or d, a double. On disk nothing is between them. */
static const char *fields_of(enum record_type type)
{
    static const char *const fields[RECORD_TYPES] = {
        [RECORD_ADD] = "dd",    [RECORD_CHUNK] = "dd",      [RECORD_DELETE] = "w",
        [RECORD_CASCADE] = "w", [RECORD_ROWS] = "wwdd",     [RECORD_FSET] = "wd",
        [RECORD_VALUES] = "d",  [RECORD_CONSTRAIN] = "www", [RECORD_RELEASE] = "www",
        [RECORD_MOVES] = "wdd"};
    return type < RECORD_TYPES && fields[type] != NULL ? fields[type] : "";
}

static size_t field_size(char field)
{
    return field == 'w' ? sizeof(uint32_t) : sizeof(double);
}

/* Returns the offset of a field in memory, behind fields that end at `at`. */
static size_t field_at(char field, size_t at)
{
    enum { ALIGNED = offsetof(struct record_value, value) };
    return field == 'w' ? at : (at + ALIGNED - 1) / ALIGNED * ALIGNED;
}

size_t record_item_size(enum record_type type)
{
    size_t size = 0;
    for (const char *f = fields_of(type); *f != '\0'; f++)
        size += field_size(*f);
    return size;
}

/* Whether items are the same bytes on disk and in memory. */
static bool is_same_in_memory(const char *fields)
{
    size_t disk = 0, memory = 0;
    for (const char *f = fields; *f != '\0'; f++) {
        memory = field_at(*f, memory) + field_size(*f);
        disk += field_size(*f);
    }
    return disk == memory;
}

/* Copies n items from memory to disk, or back. */
static void copy_items(char *to, const char *from, uint32_t n, enum record_type type, bool back)
{
    const char *fields = fields_of(type);
    if (is_same_in_memory(fields)) {
        if (n > 0 && *fields != '\0')
            memcpy(to, from, n * record_item_size(type));
        return;
    }
    size_t disk = 0, memory = 0;
    for (uint32_t i = 0; i < n; i++) {
        for (const char *f = fields; *f != '\0'; f++) {
            memory = field_at(*f, memory);
            memcpy(to + (back ? memory : disk), from + (back ? disk : memory), field_size(*f));
            memory += field_size(*f);
            disk += field_size(*f);
        }
    }
}

void record_items(const struct record *r, uint32_t first, uint32_t n, void *items)
{
    const char *from = (const char *)r->items + first * record_item_size(r->type);
    copy_items(items, from, n, r->type, true);
}

/* ---- writing records ---- */

/* The version of a set is in the place of the field's name. */
static struct record with_version(const struct record *r, char bytes[VERSION_BYTES])
{
    struct record set = *r;
    put_u64(bytes, r->version);
    set.version = 0;
    set.field = bytes;
    set.field_len = VERSION_BYTES;
    return set;
}

void record_write(struct buf *out, const struct record *r)
{
    char version[VERSION_BYTES];
    if (r->type == RECORD_SET && r->version != 0) {
        struct record set = with_version(r, version);
        record_write(out, &set);
        return;
    }
    size_t names = r->name_len + r->field_len;
    size_t rest = names + r->n * record_item_size(r->type);
    char *to = buf_reserve(out, RECORD_HEADER + rest);
    if (to == NULL)
        return;
    put_u32(to + 4, (uint32_t)rest);
    put_u64(to + 8, r->lsn);
    put_u64(to + 16, r->synced);
    to[24] = (char)r->type;
    to[25] = (char)r->flags;
    to[26] = (char)r->name_len;
    to[27] = (char)r->field_len;
    put_u32(to + 28, r->first);
    put_u32(to + 32, r->n);
    put_f64(to + 36, r->a);
    put_f64(to + 44, r->b);
    if (r->name_len > 0)
        memcpy(to + NAME_AT, r->name, r->name_len);
    if (r->field_len > 0)
        memcpy(to + NAME_AT + r->name_len, r->field, r->field_len);
    copy_items(to + NAME_AT + names, r->items, r->n, r->type, false);
    put_u32(to, crc32c(0, to + 4, RECORD_HEADER - 4 + rest));
    buf_commit(out, RECORD_HEADER + rest);
}

void record_copy(struct buf *out, const char *bytes, size_t n, uint64_t synced)
{
    char *to = buf_reserve(out, n);
    if (to == NULL)
        return;
    memcpy(to, bytes, n);
    put_u64(to + 16, synced);
    put_u32(to, crc32c(0, to + 4, n - 4));
    buf_commit(out, n);
}

/* ---- reading records ---- */

static ptrdiff_t bad_record(struct record *r, const char *fault)
{
    r->fault = fault;
    return -1;
}

ptrdiff_t record_read(const char *bytes, size_t n, struct record *r)
{
    *r = (struct record){0};
    if (n < RECORD_HEADER)
        return 0;
    uint32_t rest = get_u32(bytes + 4);
    unsigned type = (unsigned char)bytes[24];
    r->name_len = (unsigned char)bytes[26];
    r->field_len = (unsigned char)bytes[27];
    r->n = get_u32(bytes + 32);
    if (type == 0 || type >= RECORD_TYPES)
        return bad_record(r, "its type is unknown");
    r->type = (enum record_type)type;
    /* In 64 bits this cannot overflow. */
    if (r->name_len > RECORD_NAME_LIMIT || r->field_len > RECORD_FIELD_LIMIT ||
        rest > RECORD_LIMIT - RECORD_HEADER ||
        rest != r->name_len + r->field_len + (uint64_t)r->n * record_item_size(r->type))
        return bad_record(r, "its length makes no sense");
    if (n < RECORD_HEADER + (size_t)rest)
        return 0;
    if (get_u32(bytes) != crc32c(0, bytes + 4, RECORD_HEADER - 4 + rest))
        return bad_record(r, "its checksum is wrong");
    r->lsn = get_u64(bytes + 8);
    r->synced = get_u64(bytes + 16);
    r->flags = (unsigned char)bytes[25];
    r->first = get_u32(bytes + 28);
    r->a = get_f64(bytes + 36);
    r->b = get_f64(bytes + 44);
    r->name = bytes + NAME_AT;
    r->field = r->name + r->name_len;
    r->items = r->field + r->field_len;
    if (r->type == RECORD_SET && r->field_len == VERSION_BYTES)
        r->version = get_u64(r->field);
    return (ptrdiff_t)(RECORD_HEADER + (size_t)rest);
}

uint64_t record_digest(uint64_t before, const char *bytes, size_t n)
{
    enum { LSN_AT = 4, SYNCED_AT = 16, TYPE_AT = 24 };
    uint64_t d = hash_bytes(before, bytes + LSN_AT, SYNCED_AT - LSN_AT);
    d = hash_bytes(d, bytes + TYPE_AT, n - TYPE_AT);
    return d == 0 ? 1 : d;
}

struct record_outline record_outline(const char bytes[RECORD_HEADER])
{
    return (struct record_outline){(unsigned char)bytes[24], get_u32(bytes + 4),
                                   get_u32(bytes + 32)};
}

bool record_is_whole(const char *bytes, size_t n)
{
    enum { AFTER_LENGTH = 8 };
    char length[4];
    if (n < RECORD_HEADER || n > RECORD_LIMIT)
        return false;
    put_u32(length, (uint32_t)(n - RECORD_HEADER));
    return crc32c(crc32c(0, length, sizeof length), bytes + AFTER_LENGTH, n - AFTER_LENGTH) ==
           get_u32(bytes);
}
