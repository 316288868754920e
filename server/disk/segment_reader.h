/* segment_reader.h - reads the records of one file in order, through a window. */
#pragma once

#include "proto/records/record.h"
#include "server/disk/datadir.h"

enum reader_result {
    READER_OK,
    READER_END,  /* the file ends here, after an intact record */
    READER_BAD,  /* no valid record here; the reason is in reader->fault */
    READER_ERROR /* the file cannot be read: reader->error is an errno */
};

struct segment_reader {
    int fd;
    struct buf window;
    uint64_t at; /* the offset of the window, where the last record begins */
    size_t last; /* the length of that record; 0: none */
    bool eof;
    bool half; /* READER_BAD: the file ends within the record */
    int error;
    const char *fault;
};

/* Opens the file and reads its header. READER_BAD: the header is invalid or does not match the name. */
enum reader_result reader_open(struct segment_reader *r, const struct datadir *dir,
                               const struct datafile *file, struct segment *header);

/* After READER_BAD from reader_open: whether the file has a later version. */
bool reader_is_later(const struct segment_reader *r, const struct segment *header);

/* After READER_BAD from reader_open: passes over the damaged header, whose length shows in what follows it. Returns the
 * version of a header of that length; 0: the file is too short. */
uint32_t reader_pass_header(struct segment_reader *r);

/* The bytes of the last record, r->last of them, until the next call. */
const char *reader_bytes(struct segment_reader *r);

void reader_close(struct segment_reader *r);

/* Reads the next record, which borrows from the reader until the next call. */
enum reader_result reader_next(struct segment_reader *r, struct record *record);

/* After READER_BAD: searches every following byte offset for an intact record whose lsn is at least `least`.
 * READER_OK, READER_END or READER_ERROR. */
enum reader_result reader_search(struct segment_reader *r, uint64_t least, struct record *record);
