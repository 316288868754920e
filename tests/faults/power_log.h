/* power_log.h - the operations of a daemon on the files below a directory, as recorded by
 * tests/faults/power_shim.c, and how much it has sent to its clients in between.
 *
 * An operation is carried out and recorded under the same lock, so the order is the real one. A sync takes
 * a while: it is recorded when it returns, with the number of operations when it began. Names are relative
 * to the directory; "" is the directory itself. */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum power_kind {
    POWER_OPEN,   /* name; fd; a: the flags of open(2) */
    POWER_WRITE,  /* fd; a: the offset; data */
    POWER_SIZE,   /* fd; a: the size that ftruncate(2) has given to it */
    POWER_EXTEND, /* fd; a: the size that posix_fallocate(3) has made sure of */
    POWER_MKDIR,  /* name */
    POWER_RENAME, /* name; other: the new name */
    POWER_LINK,   /* the same */
    POWER_UNLINK, /* name */
    POWER_SYNC,   /* fd; a: the number of operations when it began; error: 0 or errno */
    POWER_SENT    /* to a client; a: its port; b: bytes */
};

/* The format in the file: this head, the name and the other name, each with its NUL, then data. */
struct power_head {
    uint32_t bytes; /* of all that */
    uint16_t kind, name_len, other_len;
    int16_t error;
    int32_t fd;
    uint64_t a, b;
};

struct power_op {
    enum power_kind kind;
    const char *name, *other; /* borrow from the log; "" if there is none */
    const char *data;
    size_t n; /* bytes of data */
    int fd, error;
    uint64_t a, b;
};

struct power_log {
    char *bytes;         /* owns */
    struct power_op *op; /* owns */
    size_t n;
};

/* Reads a log without an incomplete operation at its end, which a killed process may leave. */
struct power_log power_log_read(const char *path);
void power_log_free(struct power_log *log);

/* The bytes that were sent to the client of this port by the first n operations. */
uint64_t power_log_sent(const struct power_log *log, size_t n, unsigned port);
