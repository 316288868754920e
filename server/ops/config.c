/* config.c - see config.h. */
#include "server/ops/config.h"

#include "core/delaunay.h"
#include "server/system/machine.h"

enum { DESCRIPTORS_APART = 32, MOST_CLIENTS = 10000 };

static unsigned threads_here(void)
{
    unsigned n = machine_processors();
    return n < CONFIG_MOST_THREADS ? n : CONFIG_MOST_THREADS;
}

/* One on up to two processors, otherwise half of them: workers need the rest. Tests have their own number. */
static unsigned reactors_here(void)
{
#ifdef DEFAULT_REACTORS
    unsigned n = DEFAULT_REACTORS;
#else
    unsigned n = machine_processors() / 2;
#endif
    return n < 1 ? 1 : n < CONFIG_MOST_REACTORS ? n : CONFIG_MOST_REACTORS;
}

unsigned config_affordable_clients(unsigned most)
{
    unsigned n = machine_descriptors();
    return n <= DESCRIPTORS_APART          ? 1
           : n - DESCRIPTORS_APART >= most ? most
                                           : n - DESCRIPTORS_APART;
}

void config_init(struct config *c)
{
    *c = (struct config){
        .bind_address = "127.0.0.1",
        .port = DEFAULT_PORT,
        .threads = threads_here(),
        .reactors = reactors_here(),
        .max_clients = config_affordable_clients(MOST_CLIENTS),
        .load_timeout_s = 60,
        .max_points = DT_MAX_POINTS,
        .max_memory = machine_memory() / 5 * 4,
        .compact_at = (size_t)64 << 20,
        .keep_log = (size_t)256 << 20,
        .follower_timeout_s = 10,
        .slowlog_us = 10000,
        .slowlog_len = 128,
        .log_level = NOTICE_INFO,
    };
}
