/* segment_reader.c - see segment_reader.h. */
#include "server/disk/segment_reader.h"

#include "server/system/own_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

enum { READ_BYTES = 256 << 10, LSN_LEAP = 1 << 30 };

/* Reads until the window holds `want` bytes or the file ends. */
static bool fill(struct segment_reader *r, size_t want)
{
    while (!r->eof && buf_len(&r->window) < want) {
        char *to = buf_reserve(&r->window, READ_BYTES);
        ssize_t n = to == NULL ? -1 : read(r->fd, to, READ_BYTES);
        if (to == NULL) {
            r->error = ENOMEM;
            return false;
        }
        if (n < 0 && errno != EINTR) {
            r->error = errno;
            return false;
        }
        if (n > 0)
            buf_commit(&r->window, (size_t)n);
        r->eof = n == 0;
    }
    return true;
}

static void advance(struct segment_reader *r)
{
    buf_consume(&r->window, r->last);
    r->at += r->last;
    r->last = 0;
}

static enum reader_result bad(struct segment_reader *r, const char *fault)
{
    r->fault = fault;
    return READER_BAD;
}

enum reader_result reader_open(struct segment_reader *r, const struct datadir *dir,
                               const struct datafile *file, struct segment *header)
{
    enum segment_kind kind = file->kind == DATAFILE_LOG ? SEGMENT_LOG : SEGMENT_SNAPSHOT;
    *r = (struct segment_reader){.fd = own_file_open(dir->fd, file->name, O_RDONLY)};
    if (r->fd < 0) {
        r->error = errno;
        return READER_ERROR;
    }
    if (!fill(r, SEGMENT_HEADER))
        return READER_ERROR;
    ptrdiff_t took = buf_len(&r->window) == 0
                         ? 0
                         : segment_read(buf_head(&r->window), buf_len(&r->window), header);
    if (took <= 0)
        return bad(r, took == 0 ? "it ends within its header" : header->fault);
    if (header->kind != kind || header->lsn != file->lsn)
        return bad(r, "its header does not agree with its name");
    r->last = (size_t)took;
    return READER_OK;
}

bool reader_is_later(const struct segment_reader *r, const struct segment *header)
{
    return header->version > RECORD_VERSION && strstr(r->fault, "later version") != NULL;
}

/* Whether an intact record begins at this place of the window. */
static bool has_record(struct segment_reader *r, size_t at)
{
    struct record record;
    return buf_len(&r->window) > at &&
           record_read(buf_head(&r->window) + at, buf_len(&r->window) - at, &record) > 0;
}

uint32_t reader_pass_header(struct segment_reader *r)
{
    if (!fill(r, SEGMENT_HEADER + RECORD_LIMIT) || buf_len(&r->window) < SEGMENT_HEADER_3)
        return 0;
    bool shorter = has_record(r, SEGMENT_HEADER_3) || buf_len(&r->window) < SEGMENT_HEADER;
    uint32_t version = shorter ? 3 : RECORD_VERSION;
    r->last = segment_header_size(version);
    return version;
}

const char *reader_bytes(struct segment_reader *r)
{
    return buf_head(&r->window);
}

void reader_close(struct segment_reader *r)
{
    if (r->fd >= 0)
        close(r->fd);
    r->fd = -1;
    buf_free(&r->window);
}

enum reader_result reader_next(struct segment_reader *r, struct record *record)
{
    ptrdiff_t took = 0;
    advance(r);
    for (size_t want = RECORD_HEADER;; want = RECORD_LIMIT) {
        if (!fill(r, want))
            return READER_ERROR;
        if (buf_len(&r->window) == 0)
            return READER_END;
        took = record_read(buf_head(&r->window), buf_len(&r->window), record);
        if (took != 0 || r->eof || want == RECORD_LIMIT)
            break;
    }
    r->half = took == 0 && !record_is_whole(buf_head(&r->window), buf_len(&r->window));
    if (took <= 0)
        return bad(r, took != 0 ? record->fault
                      : r->half ? "it is cut off"
                                : "its length is wrong");
    r->last = (size_t)took;
    return READER_OK;
}

enum reader_result reader_search(struct segment_reader *r, uint64_t least, struct record *record)
{
    for (;;) {
        r->last = buf_len(&r->window) > 0;
        advance(r);
        if (!fill(r, RECORD_LIMIT))
            return READER_ERROR;
        if (buf_len(&r->window) == 0)
            return READER_END;
        ptrdiff_t took = record_read(buf_head(&r->window), buf_len(&r->window), record);
        if (took > 0 && record->lsn >= least && record->lsn - least < LSN_LEAP) {
            r->last = (size_t)took;
            return READER_OK;
        }
    }
}
