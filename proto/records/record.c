/* record.c - see record.h. */
#include "proto/records/record.h"

#include "proto/records/crc32c.h"
#include "proto/records/hash.h"

#include <string.h>

static const char magic[] = "DELAUNAY";

enum {
    MAGIC = sizeof magic - 1,
    POINT_BYTES = 16,
    ROW_BYTES = 24,
    PAIR_BYTES = 12, /* an id and its value */
    CONSTRAINT_BYTES = 12,
    MOVE_BYTES = 20,
    VERSION_BYTES = 8,
    NAME_AT = RECORD_HEADER
};

/* ---- numbers; on a little-endian machine the compiler makes moves of these ---- */

static void put_u32(char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (char)(v >> 8 * i);
}

static void put_u64(char *p, uint64_t v)
{
    put_u32(p, (uint32_t)v);
    put_u32(p + 4, (uint32_t)(v >> 32));
}

static void put_f64(char *p, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    put_u64(p, bits);
}

static uint32_t get_u32(const char *p)
{
    const unsigned char *u = (const unsigned char *)p;
    return u[0] | (uint32_t)u[1] << 8 | (uint32_t)u[2] << 16 | (uint32_t)u[3] << 24;
}

static uint64_t get_u64(const char *p)
{
    return get_u32(p) | (uint64_t)get_u32(p + 4) << 32;
}

static double get_f64(const char *p)
{
    uint64_t bits = get_u64(p);
    double v;
    memcpy(&v, &bits, sizeof v);
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

/* ---- writing records ---- */

uint32_t record_version(enum record_type type)
{
    return type >= RECORD_CONSTRAIN ? RECORD_VERSION : RECORD_VERSION_PLAIN;
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

size_t record_item_size(enum record_type type)
{
    switch (type) {
    case RECORD_ADD:
    case RECORD_CHUNK:
        return POINT_BYTES;
    case RECORD_DELETE:
    case RECORD_CASCADE:
        return sizeof(uint32_t);
    case RECORD_ROWS:
        return ROW_BYTES;
    case RECORD_FSET:
        return PAIR_BYTES;
    case RECORD_VALUES:
        return sizeof(double);
    case RECORD_CONSTRAIN:
    case RECORD_RELEASE:
        return CONSTRAINT_BYTES;
    case RECORD_MOVES:
        return MOVE_BYTES;
    default:
        return 0;
    }
}

static void write_doubles(char *to, const double *v, size_t n)
{
    for (size_t i = 0; i < n; i++)
        put_f64(to + 8 * i, v[i]);
}

static void write_words(char *to, const uint32_t *v, size_t n)
{
    for (size_t i = 0; i < n; i++)
        put_u32(to + 4 * i, v[i]);
}

static void write_rows(char *to, const struct record_row *row, size_t n)
{
    for (size_t i = 0; i < n; i++, to += ROW_BYTES) {
        put_u32(to, row[i].id);
        put_u32(to + 4, row[i].representative);
        put_f64(to + 8, row[i].x);
        put_f64(to + 16, row[i].y);
    }
}

static void write_pairs(char *to, const struct record_value *pair, size_t n)
{
    for (size_t i = 0; i < n; i++, to += PAIR_BYTES) {
        put_u32(to, pair[i].id);
        put_f64(to + 4, pair[i].value);
    }
}

static void write_moves(char *to, const struct record_move *move, size_t n)
{
    for (size_t i = 0; i < n; i++, to += MOVE_BYTES) {
        put_u32(to, move[i].id);
        put_f64(to + 4, move[i].x);
        put_f64(to + 12, move[i].y);
    }
}

_Static_assert(sizeof(struct record_constraint) == CONSTRAINT_BYTES, "a constraint is three words");

static void write_items(char *to, const struct record *r)
{
    switch (r->type) {
    case RECORD_ADD:
    case RECORD_CHUNK:
        write_doubles(to, r->items, 2 * (size_t)r->n);
        break;
    case RECORD_VALUES:
        write_doubles(to, r->items, r->n);
        break;
    case RECORD_FSET:
        write_pairs(to, r->items, r->n);
        break;
    case RECORD_DELETE:
    case RECORD_CASCADE:
        write_words(to, r->items, r->n);
        break;
    case RECORD_CONSTRAIN:
    case RECORD_RELEASE:
        write_words(to, r->items, 3 * (size_t)r->n);
        break;
    case RECORD_ROWS:
        write_rows(to, r->items, r->n);
        break;
    case RECORD_MOVES:
        write_moves(to, r->items, r->n);
        break;
    default:
        break;
    }
}

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
    write_items(to + NAME_AT + names, r);
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

void record_points(const struct record *r, double *xy)
{
    const char *from = r->items;
    for (size_t i = 0; i < 2 * (size_t)r->n; i++)
        xy[i] = get_f64(from + 8 * i);
}

void record_ids(const struct record *r, uint32_t *ids)
{
    const char *from = r->items;
    for (size_t i = 0; i < r->n; i++)
        ids[i] = get_u32(from + 4 * i);
}

void record_values(const struct record *r, double *values)
{
    const char *from = r->items;
    for (size_t i = 0; i < r->n; i++)
        values[i] = get_f64(from + 8 * i);
}

void record_value_at(const struct record *r, uint32_t i, struct record_value *value)
{
    const char *from = (const char *)r->items + (size_t)i * PAIR_BYTES;
    *value = (struct record_value){get_u32(from), get_f64(from + 4)};
}

void record_row_at(const struct record *r, uint32_t i, struct record_row *row)
{
    const char *from = (const char *)r->items + (size_t)i * ROW_BYTES;
    *row = (struct record_row){get_u32(from), get_u32(from + 4), get_f64(from + 8),
                               get_f64(from + 16)};
}

void record_constraint_at(const struct record *r, uint32_t i, struct record_constraint *constraint)
{
    const char *from = (const char *)r->items + (size_t)i * CONSTRAINT_BYTES;
    *constraint = (struct record_constraint){get_u32(from), get_u32(from + 4), get_u32(from + 8)};
}

void record_move_at(const struct record *r, uint32_t i, struct record_move *move)
{
    const char *from = (const char *)r->items + (size_t)i * MOVE_BYTES;
    *move = (struct record_move){get_u32(from), get_f64(from + 4), get_f64(from + 12)};
}
