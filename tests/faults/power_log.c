/* power_log.c - see power_log.h. */
#include "tests/faults/power_log.h"

#include "tests/server/directory.h"
#include "tests/test.h"

#include <string.h>

static struct power_op take(const char *at)
{
    struct power_head h;
    memcpy(&h, at, sizeof h);
    const char *name = at + sizeof h, *other = name + h.name_len + 1;
    const char *data = other + h.other_len + 1;
    return (struct power_op){.kind = (enum power_kind)h.kind,
                             .name = name,
                             .other = other,
                             .data = data,
                             .n = (size_t)(at + h.bytes - data),
                             .fd = h.fd,
                             .error = h.error,
                             .a = h.a,
                             .b = h.b};
}

/* The length of the operation at `at`; 0: it is not complete. */
static size_t length(const char *at, size_t n)
{
    struct power_head h;
    if (n < sizeof h)
        return 0;
    memcpy(&h, at, sizeof h);
    return h.bytes <= n ? h.bytes : 0;
}

struct power_log power_log_read(const char *path)
{
    struct power_log log = {0};
    size_t n, cap = 0, step;
    log.bytes = file_read(path, &n);
    for (size_t at = 0; (step = length(log.bytes + at, n - at)) > 0; at += step) {
        if (log.n == cap) {
            cap = cap == 0 ? 256 : 2 * cap;
            log.op = realloc(log.op, cap * sizeof *log.op);
            CHECK(log.op != NULL);
        }
        log.op[log.n++] = take(log.bytes + at);
    }
    return log;
}

void power_log_free(struct power_log *log)
{
    free(log->op);
    free(log->bytes);
    *log = (struct power_log){0};
}

uint64_t power_log_sent(const struct power_log *log, size_t n, unsigned port)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < n; i++)
        if (log->op[i].kind == POWER_SENT && log->op[i].a == port)
            bytes += log->op[i].b;
    return bytes;
}
