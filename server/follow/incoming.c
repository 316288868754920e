/* incoming.c - see incoming.h. */
#include "server/follow/incoming.h"

#include "server/system/own_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static bool fail(struct incoming *s, const char *what, const char *why)
{
    snprintf(s->why, sizeof s->why, "%s%s", what, why);
    return false;
}

const char *incoming_disk_fault(int error)
{
    if (!own_file_lacks_space(error))
        return strerror(error);
    return "no room on the disk for its snapshot beside the files here: free space, or start with "
           "an empty data directory";
}

/* The snapshot cannot be written; errno says why. */
static bool fail_to_write(struct incoming *s)
{
    s->disk_failed = true;
    return fail(s, "", incoming_disk_fault(errno));
}

/* Reads the header or the record at that offset of the input; r->type is RECORD_TYPES for a header. > 0: its length; 0: it
 * needs more bytes; -1: it is not valid. */
static ptrdiff_t look(const struct incoming *s, size_t at, struct segment *h, struct record *r)
{
    size_t n = buf_len(&s->in) - at;
    r->type = RECORD_TYPES;
    if (n < 8)
        return 0;
    const char *bytes = buf_head(&s->in) + at;
    if (memcmp(bytes, "DELAUNAY", 8) == 0)
        return segment_read(bytes, n, h);
    return record_read(bytes, n, r);
}

static bool take_header(struct incoming *s, const struct segment *h)
{
    if (s->in_snapshot)
        return fail(s, "", "it sends a header within a snapshot");
    if (!s->calls->header(s->ctx, h))
        return false;
    if (h->kind != SEGMENT_SNAPSHOT)
        return true;
    s->snapshot = *h;
    s->in_snapshot = true;
    return aside_begin(&s->aside, s->dir, h) || fail_to_write(s);
}

/* A record of the snapshot. */
static bool take_row(struct incoming *s, const struct record *r, const char *bytes, size_t n)
{
    if (!aside_write(&s->aside, bytes, n))
        return fail_to_write(s);
    if (r->type != RECORD_END)
        return true;
    s->in_snapshot = false;
    return s->calls->snapshot(s->ctx, &s->aside, &s->snapshot);
}

bool incoming_take(struct incoming *s)
{
    struct segment h;
    struct record r;
    size_t from = 0, at = 0; /* what has been looked at, and not been passed on */
    s->why[0] = '\0';
    for (ptrdiff_t n; (n = look(s, at, &h, &r)) != 0;) {
        bool header = r.type == RECORD_TYPES;
        if (n < 0)
            return fail(s, "what it sends cannot be read: ", header ? h.fault : r.fault);
        bool was_snapshot = s->in_snapshot;
        s->taken += (uint64_t)n;
        if (header ? !take_header(s, &h)
                   : was_snapshot && !take_row(s, &r, buf_head(&s->in) + at, (size_t)n))
            return false;
        at += (size_t)n;
        if (was_snapshot || s->in_snapshot) /* it replaces the records before it */
            from = at;
    }
    if (at > from && !s->calls->log(s->ctx, buf_head(&s->in) + from, at - from))
        return false;
    buf_consume(&s->in, at);
    return true;
}

void incoming_clear(struct incoming *s)
{
    aside_abandon(&s->aside);
    buf_free(&s->in);
}
