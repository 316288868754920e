/* rwlock_test.c - which threads get the lock of a version, and when. */
#include "server/sets/rwlock.h"
#include "tests/test.h"

#include <sched.h>
#include <stdatomic.h>

static struct rwlock lock;
static atomic_bool written, stop;

static void *write_once(void *unused)
{
    rwlock_write(&lock);
    written = true;
    rwlock_unlock(&lock);
    return unused;
}

static pthread_t start(void *(*run)(void *))
{
    pthread_t t;
    CHECK(pthread_create(&t, NULL, run, NULL) == 0);
    return t;
}

TEST(rwlock_is_shared_by_readers_and_held_by_one_writer)
{
    rwlock_init(&lock);
    rwlock_read(&lock);
    CHECK(rwlock_try_read(&lock));
    CHECK(!rwlock_try_write(&lock));
    rwlock_unlock(&lock);
    CHECK(!rwlock_try_write(&lock));
    rwlock_unlock(&lock);
    CHECK(rwlock_try_write(&lock));
    CHECK(!rwlock_try_read(&lock) && !rwlock_try_write(&lock));
    rwlock_unlock(&lock);
    rwlock_write(&lock);
    rwlock_unlock(&lock);
    CHECK(rwlock_try_read(&lock));
    rwlock_unlock(&lock);
    rwlock_clear(&lock);
}

TEST(rwlock_admits_no_new_reader_while_a_writer_waits)
{
    rwlock_init(&lock);
    rwlock_read(&lock);
    pthread_t writer = start(write_once);
    while (rwlock_try_read(&lock)) { /* until it waits */
        rwlock_unlock(&lock);
        sched_yield();
    }
    CHECK(!written && !rwlock_try_write(&lock));
    rwlock_unlock(&lock);
    pthread_join(writer, NULL);
    CHECK(written && rwlock_try_read(&lock));
    rwlock_unlock(&lock);
    rwlock_clear(&lock);
}

/* Takes the lock again before the others release it. */
static void *read_always(void *unused)
{
    while (!stop) {
        rwlock_read(&lock);
        sched_yield();
        rwlock_unlock(&lock);
    }
    return unused;
}

TEST(rwlock_admits_writers_although_readers_keep_coming)
{
    enum { READERS = 4, EDITS = 300 };
    pthread_t readers[READERS];
    static unsigned n; /* tsan sees every access to it */
    rwlock_init(&lock);
    for (unsigned i = 0; i < READERS; i++)
        readers[i] = start(read_always);
    for (unsigned i = 0; i < EDITS; i++) {
        rwlock_write(&lock);
        n++;
        rwlock_unlock(&lock);
    }
    stop = true;
    for (unsigned i = 0; i < READERS; i++)
        pthread_join(readers[i], NULL);
    CHECK(n == EDITS);
    rwlock_clear(&lock);
}
