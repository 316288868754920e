/* config.h - the configuration: set by the command line, changed by CONFIG SET; setting.h has it by name. */
#pragma once

#include "server/system/notice.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PROTOCOL_VERSION 1
#define DEFAULT_PORT 6374 /* M-E-S-H on a telephone keypad */

enum { CONFIG_MOST_THREADS = 256, CONFIG_MOST_REACTORS = 64 };

/* When a change counts as durable and is acknowledged: after it has been synced (LOG_ALWAYS), or after it
 * has been written, with a sync every second (LOG_EVERYSEC) or none (LOG_NO). */
enum log_policy { LOG_ALWAYS, LOG_EVERYSEC, LOG_NO };

struct config {
    const char *bind_address; /* a numeric IPv4 or IPv6 address */
    unsigned port;            /* 0: any free one */
    const char *data;         /* the data directory; NULL: everything is in memory only */
    const char *backup_dir;   /* where BACKUP may write; NULL: nowhere */
    enum log_policy fsync;
    size_t compact_at; /* bytes of log after which a snapshot is made */
    /* ADDR:PORT of the leader; NULL: none, or the one that the data directory remembers */
    const char *follow;
    const char *follow_token_file; /* the token for it; NULL: none */
    unsigned min_followers;        /* that have a change on disk before it is acknowledged */
    unsigned follower_timeout_s;   /* a follower that acknowledges nothing for so long is missing */
    size_t keep_log;       /* bytes of log for followers beyond those that are in no snapshot */
    const char *check;     /* the data directory of --check; NULL: none */
    const char *repair;    /* the data directory of --repair; NULL: none */
    const char *unix_path; /* NULL: no Unix socket */
    bool private; /* --private: serves the process at the other end of standard input (private.h) */
    const char *auth_file; /* NULL: every client may do everything */
    unsigned threads;      /* of workers, which a job may use; without those of reactors */
    unsigned reactors;     /* threads that serve connections */
    unsigned max_clients;
    unsigned idle_timeout_s;     /* after which an idle client is disconnected; 0: never */
    unsigned load_timeout_s;     /* after which a stalled load is abandoned; 0: never */
    uint32_t max_points;         /* of one set */
    size_t max_memory;           /* bytes of the budget (budget.h) */
    uint32_t slowlog_us;         /* requests that take longer go into the slow log; 0: none */
    uint32_t slowlog_len;        /* requests that the slow log keeps */
    enum notice_level log_level; /* of messages on standard error */
    bool insecure;               /* a bind beyond loopback is allowed without tokens */
};

/* `most`, or the number of clients that descriptors allow if that is lower. */
unsigned config_affordable_clients(unsigned most);

/* The defaults for this machine. */
void config_init(struct config *c);
