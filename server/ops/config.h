/* config.h - what the command line says, and CONFIG SET changes; setting.h has it by name. */
#ifndef SERVER_CONFIG_H
#define SERVER_CONFIG_H

#include "server/system/notice.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DELAUNAYD_VERSION "0.1.0"
#define PROTOCOL_VERSION 1
#define DEFAULT_PORT 6374 /* M-E-S-H on a telephone keypad */

enum { CONFIG_MOST_THREADS = 256 };

/* When a change is durable, and so acknowledged: when it has been synced; or written, and synced once a
 * second, or never. */
enum log_policy { LOG_ALWAYS, LOG_EVERYSEC, LOG_NO };

struct config {
    const char *bind_address; /* a numeric IPv4 or IPv6 address */
    unsigned port;            /* 0: any free one */
    const char *data;         /* the data directory; NULL: everything is in memory only */
    enum log_policy fsync;
    size_t compact_at;     /* bytes of log after which a snapshot is made */
    const char *check;     /* a data directory that is to be checked, and nothing else */
    const char *repair;    /* the same, to be repaired */
    const char *unix_path; /* NULL: no Unix socket */
    bool private; /* for the process that holds the other end of standard input (private.h) */
    const char *auth_file; /* NULL: everybody may do everything */
    unsigned threads;      /* that a job may use; the I/O thread not counted */
    unsigned max_clients;
    unsigned idle_timeout_s; /* after which a client that sends nothing is dropped; 0: never */
    unsigned load_timeout_s; /* after which a load whose points stop coming is given up; 0: never */
    uint32_t max_points;     /* of one set */
    size_t max_memory;       /* bytes of the budget (budget.h) */
    uint32_t slowlog_us;     /* what takes longer goes into the slow log; 0: nothing does */
    uint32_t slowlog_len;    /* how many requests that keeps */
    enum notice_level log_level; /* what is told on standard error */
    bool insecure;               /* a bind beyond loopback is allowed without tokens */
};

/* At most `most` clients, or as many as descriptors allow. */
unsigned config_affordable_clients(unsigned most);

/* The defaults for this machine. */
void config_init(struct config *c);

#endif
