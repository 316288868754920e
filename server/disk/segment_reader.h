/* segment_reader.h - reads the records of one file, one after the other, through a window. */
#ifndef SERVER_SEGMENT_READER_H
#define SERVER_SEGMENT_READER_H

#include "proto/record.h"
#include "server/disk/datadir.h"

enum reader_result {
    READER_OK,
    READER_END,  /* the file ends here, behind a whole record */
    READER_BAD,  /* what is here is no record, or half of one; reader->fault tells */
    READER_ERROR /* the file cannot be read: reader->error is an errno */
};

struct segment_reader {
    int fd;
    struct buf window;
    uint64_t at; /* the offset of the window, behind the last record that was read */
    size_t last; /* the length of that record, which is still in the window */
    bool eof;
    bool half; /* READER_BAD: the file ends within a record, as far as there is one */
    int error;
    const char *fault;
};

/* Opens the file and reads its header. READER_BAD: it is not what its name says. */
enum reader_result reader_open(struct segment_reader *r, const struct datadir *dir,
                               const struct datafile *file, struct segment *header);

/* After READER_BAD from reader_open: whether a later version has written the file. */
bool reader_is_later(const struct segment_reader *r, const struct segment *header);

void reader_close(struct segment_reader *r);

/* The next record, which borrows from the reader until the next call. */
enum reader_result reader_next(struct segment_reader *r, struct record *record);

/* After READER_BAD: looks at every byte that follows for a whole record with an lsn from `least`
 * on. READER_OK or READER_END. */
enum reader_result reader_search(struct segment_reader *r, uint64_t least, struct record *record);

#endif
