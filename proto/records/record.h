/* record.h - the format of files on disk: segments of records. Only this module knows the bytes.
 *
 * A file is a segment: a header, then records up to its end. All numbers are little-endian.
 *
 *     segment header, 64 bytes           record header, 52 bytes
 *      0  "DELAUNAY"                      0  u32 CRC-32C of all that follows
 *      8  u32 version                     4  u32 bytes after this header
 *     12  u32 kind                        8  u64 lsn
 *     16  u64 lsn                        16  u64 synced
 *     24  u32 life                       24  u8 type, u8 flags, u8 length of the name, u8 of the field's
 *     28  u32 generation                 28  u32 first   32  u32 n   36  f64 a   44  f64 b
 *     32  u64 origin                     52  the name, the field's name, then n items
 *     40  u64 digest
 *     48  u32 nonce, u32 parent, u32 flags
 *     60  u32 CRC-32C of the above
 *
 * In a log, every record has a log sequence number (lsn), one more than the record before, and the
 * segment's header has the lsn of its first one. `synced` is an lsn up to which everything was known
 * to be on the disk when the record was made. So a damaged record that a later one covers by `synced`
 * is corruption. A damaged record that no later one covers is the torn end after a crash.
 *
 * A life is the time from a start of the daemon to its end. The versions of sets that clients see contain its
 * number, so that no two lives use the same version; 0: unknown, the sets get new versions.
 *
 * A digest of a log is chained: that after a record is record_digest of the record and the digest before it. A segment has
 * the one before its first record; a snapshot has that of its lsn. History (history.h), lsn and digest are a position:
 * two logs that have the same position had the same changes up to it.
 *
 * In a snapshot the records are numbered from 1, and the header has the lsn up to which every
 * change is contained in it. Each set has a RECORD_SET, whose `synced` is the lsn up to which the changes of
 * this set are contained, and then its points. If it has fields, at least one
 * RECORD_VALUES for each of them, and RECORD_SET_END follow. RECORD_END comes last.
 *
 * Upgrades. A program reads every version up to its own and writes its own; it refuses files of later
 * versions. A change of the meaning or the place of a byte, or a new type, increments RECORD_VERSION; the
 * reader of the old layout stays, with a test file of that version. A released version never changes. A
 * downgrade needs an empty directory.
 *
 * Version 2: RECORD_EXPIRE, and b of RECORD_SET, which was 0; fields: the length of a field's name, which was 0, the types from
 * RECORD_FSET on, and RECORD_HAS_FIELDS.
 * Version 3: the life of a segment, which was 0, and the version of RECORD_SET.
 * Version 4: the header has the history and the digest; before, it had 32 bytes, the last of them the CRC-32C.
 * Version 5: constraints: the types from RECORD_CONSTRAIN on, and RECORD_HAS_CONSTRAINTS. A segment that has none of these is
 * written as version 4 (record_version), so that earlier programs can read it. */
#pragma once

#include "proto/buf.h"
#include "proto/records/history.h"

#include <stdint.h>

enum {
    RECORD_VERSION = 5,
    RECORD_VERSION_PLAIN = 4,       /* of segments that need no later one */
    RECORD_VERSION_CONSTRAINTS = 5, /* of segments with constraints */
    SEGMENT_HEADER = 64,
    SEGMENT_HEADER_3 = 32, /* up to version 3 */
    RECORD_HEADER = 52,
    RECORD_NAME_LIMIT = 64,
    RECORD_FIELD_LIMIT = 64,
    RECORD_POINTS = 32768,      /* points of one record at most */
    RECORD_MOST_VALUES = 65536, /* values of one RECORD_VALUES at most */
    RECORD_CONSTRAINTS = 65536, /* constraints of one record at most */
    RECORD_LIMIT = RECORD_HEADER + RECORD_NAME_LIMIT + RECORD_FIELD_LIMIT + RECORD_POINTS * 24
};

enum segment_kind { SEGMENT_LOG = 1, SEGMENT_SNAPSHOT = 2 };

/* Flag of a log's segment: changes before it are only in a snapshot, and its digest is not that of the segment before. */
enum { SEGMENT_BROKEN = 1 };

struct segment {
    uint32_t version;
    enum segment_kind kind;
    uint64_t lsn;
    uint32_t life;
    struct history history; /* unknown up to version 3 */
    uint64_t digest;        /* 0: unknown */
    uint32_t flags;
    const char *fault; /* why segment_read returned -1 */
};

/* The facts about a daemon that the headers of its segments have. */
struct lineage {
    uint32_t life;
    struct history history;
};

enum record_type {
    RECORD_CREATE = 1,  /* a: the tolerance */
    RECORD_ADD,         /* first: the first id; items: points; creates the set if it is missing */
    RECORD_LOAD,        /* begins an ADD that is too long for one record; first: the first id */
    RECORD_CHUNK,       /* items: points, as many as RECORD_POINTS but for the last one */
    RECORD_LOADED,      /* ends it; n: all its points and constraints; only now it counts */
    RECORD_DELETE,      /* items: ids */
    RECORD_MOVE,        /* first: the id; a, b: its place */
    RECORD_DROP,        /* the set */
    RECORD_TRIANGULATE, /* from now on the set has a triangulation */
    RECORD_CLOSE,       /* no change: the end of a log that was closed cleanly, or a gap */
    RECORD_SET, /* snapshot: a: the tolerance; b: as a of RECORD_EXPIRE; first: the next id; n: how many points follow;
                   in the place of the field's name, 8 bytes: the version, unless it is unknown */
    RECORD_ROWS,   /* snapshot: items: points of the set, ids ascending */
    RECORD_END,    /* snapshot: n: how many sets it has */
    RECORD_EXPIRE, /* a: when the set is dropped, in milliseconds since 1970; 0: never */
    RECORD_FSET, /* sets values of the field, which is created if it is missing; items: ids and values */
    RECORD_VALUES, /* the same; first: the first id; items: the values of the ids from it on. Without a name it is part
                      of a LOAD. Snapshot: values of the set; the field is created even if n is 0 */
    RECORD_FDROP,   /* the field */
    RECORD_SET_END, /* snapshot: ends a set with RECORD_HAS_FIELDS or RECORD_HAS_CONSTRAINTS */
    RECORD_CONSTRAIN, /* declares constraints; items: constraints. Without a name it is the last part of a LOAD. Snapshot:
                         constraints of the set */
    RECORD_RELEASE, /* releases constraints. a: 0: the items; 1: those whose `what` is `first`; 2: all. The same in a LOAD, before
                       RECORD_CONSTRAIN */
    RECORD_CASCADE, /* as RECORD_DELETE, with the constraints at these points */
    RECORD_MOVES,   /* several points at once; items: ids and places */
    RECORD_TYPES
};

enum {
    RECORD_TRIANGULATED = 1,
    RECORD_HAS_FIELDS = 2,
    RECORD_HAS_CONSTRAINTS = 4
}; /* flags of RECORD_SET */

/* An item of RECORD_ROWS; 24 bytes on disk in this order. */
struct record_row {
    uint32_t id, representative;
    double x, y;
};

/* An item of RECORD_FSET; 12 bytes on disk in this order. */
struct record_value {
    uint32_t id;
    double value;
};

/* An item of RECORD_CONSTRAIN and RECORD_RELEASE; 12 bytes on disk in this order. */
struct record_constraint {
    uint32_t a, b; /* ids */
    uint32_t what; /* twice the number, plus 1 for a border */
};

/* An item of RECORD_MOVES; 20 bytes on disk in this order. */
struct record_move {
    uint32_t id;
    double x, y;
};

struct record {
    uint64_t lsn, synced;
    enum record_type type;
    unsigned flags;
    uint32_t first, n;
    double a, b;
    const char *name; /* borrows */
    size_t name_len;
    const char *field; /* borrows */
    size_t field_len;
    uint64_t version;  /* of RECORD_SET; 0: unknown */
    const void *items; /* borrows; as on disk, any alignment: see record_items */
    const char *fault; /* why record_read returned -1 */
};

/* Writes the first segment_header_size(s->version) bytes of the header. */
void segment_write(char bytes[SEGMENT_HEADER], const struct segment *s);
void segment_append(struct buf *out, const struct segment *s);

/* Bytes of the header of a segment of that version. */
size_t segment_header_size(uint32_t version);

/* Reads a segment's header from bytes[n]. > 0: consumed, 0: it needs more, -1: invalid, see s->fault. */
ptrdiff_t segment_read(const char *bytes, size_t n, struct segment *s);

/* The least version of a segment that may have records of this type. */
uint32_t record_version(enum record_type type);

/* The items of one record of this type at most, of those that a LOAD may have as parts; and how many records n items take. */
uint32_t record_most(enum record_type part);
uint32_t record_parts(enum record_type part, uint32_t n);

/* Bytes of an item of this type; 0 for types without items, whose n may be anything. */
size_t record_item_size(enum record_type type);

/* Appends r, items encoded from r->items: struct-like arrays of doubles x, y (points), uint32_t
 * (ids), struct record_row and the like, or doubles. out->failed when out of memory. */
void record_write(struct buf *out, const struct record *r);

/* Appends a copy of the record bytes[n], as it was written elsewhere, that says `synced`. */
void record_copy(struct buf *out, const char *bytes, size_t n, uint64_t synced);

/* Reads one record from bytes[n]. > 0: consumed, and r borrows from bytes; 0: it needs more; -1:
 * invalid, see r->fault. Never reads beyond n; checks every length against the limits first. */
ptrdiff_t record_read(const char *bytes, size_t n, struct record *r);

/* The digest of a log after the record bytes[n], as it was written; `before`: the digest before it. Two parts of a record depend
 * on its surroundings, `synced` and the checksum, and do not count. Never 0. */
uint64_t record_digest(uint64_t before, const char *bytes, size_t n);

/* Fields of the header of a damaged record, which may be wrong. */
struct record_outline {
    unsigned type;
    uint32_t length, n; /* of all that follows the header; and record.n */
};
struct record_outline record_outline(const char bytes[RECORD_HEADER]);

/* Whether these n bytes are a whole record, apart from the length in its header, which may be damaged. */
bool record_is_whole(const char *bytes, size_t n);

/* Decodes n items of a record that was read, from number `first` on: into an array as record_write takes it. */
void record_items(const struct record *r, uint32_t first, uint32_t n, void *items);
