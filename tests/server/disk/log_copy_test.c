/* log_copy_test.c - copies of another log's records, as a follower takes them from its leader. */
#include "core/delaunay_constraints.h"
#include "server/disk/log.h"
#include "server/disk/recover.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <sys/eventfd.h>
#include <unistd.h>

/* A log in a directory of its own. */
struct bench {
    struct directory directory;
    struct datadir dir;
    int event;
    struct log *log;
};

static void begin(struct bench *b)
{
    *b = (struct bench){.directory = directory_quick(), .event = eventfd(0, EFD_CLOEXEC)};
    CHECK(b->event >= 0 && datadir_open(&b->dir, b->directory.path, false));
    b->log = log_new(&b->dir, LOG_ALWAYS, 1, 1, b->event);
    CHECK(b->log != NULL);
}

/* Writes the log to its end, with a RECORD_CLOSE, and reads it. */
static void read_all(struct bench *b, struct recovery *r)
{
    log_free(b->log);
    recovery_init(r, &b->dir);
    recovery_run(r);
    CHECK_MSG(r->result == RECOVERY_OK, "%s", r->why);
}

static void end(struct bench *b, struct recovery *r)
{
    recovery_clear(r);
    datadir_close(&b->dir);
    close(b->event);
    directory_remove(&b->directory);
}

TEST(copies_of_records_make_a_log_with_the_same_digest)
{
    struct bench b, copy;
    struct recovery read, read_copy;
    begin(&b);
    begin(&copy);
    struct record r[] = {{.lsn = 1, .type = RECORD_CREATE, .a = 0.5, .name = "t", .name_len = 1},
                         {.lsn = 2, .type = RECORD_CLOSE}};
    for (uint64_t lsn = 1; lsn <= 2; lsn++) {
        struct buf bytes = {0};
        record_write(&bytes, &r[lsn - 1]);
        CHECK(log_append(b.log, &r[lsn - 1]) == lsn);
        CHECK(log_append_copy(copy.log, buf_head(&bytes), buf_len(&bytes)) == lsn);
        buf_free(&bytes);
    }
    read_all(&b, &read);
    read_all(&copy, &read_copy);
    CHECK(read.last == read_copy.last && read.digest == read_copy.digest && read.digest != 0);
    end(&b, &read);
    end(&copy, &read_copy);
}

/* Its first records are of an earlier version than its constraints, which begin a segment of their own otherwise. */
TEST(copies_of_a_load_with_constraints_are_in_one_segment)
{
    static const double p[] = {0, 0, 4, 0, 0, 4};
    static const struct record_constraint edge = {0, 1, 0};
    static const struct record r[] = {
        {.lsn = 2, .type = RECORD_LOAD, .name = "t", .name_len = 1},
        {.lsn = 3, .type = RECORD_CHUNK, .n = 3, .items = p},
        {.lsn = 4, .type = RECORD_CONSTRAIN, .n = 1, .items = &edge},
        {.lsn = 5, .type = RECORD_LOADED, .n = 4, .name = "t", .name_len = 1}};
    struct bench b;
    struct recovery read;
    struct buf load = {0};
    begin(&b);
    log_append(b.log, &(struct record){.type = RECORD_CREATE, .name = "t", .name_len = 1});
    for (size_t i = 0; i < sizeof r / sizeof r[0]; i++)
        record_write(&load, &r[i]);
    CHECK(log_append_copy(b.log, buf_head(&load), buf_len(&load)) == 5);
    buf_free(&load);
    read_all(&b, &read);
    CHECK(read.last == 6 && !read.torn);
    struct word name = {"t", 1};
    struct dataset *set = registry_find(&read.replay.sets, &name);
    CHECK(set != NULL && dt_constraints_count(set->current->dt) == 1);
    end(&b, &read);
}
