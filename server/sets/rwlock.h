/* rwlock.h - a lock that many readers share or one writer has. A writer that waits comes before new
 * readers, so that a close succession of readers does not starve it. POSIX leaves that order open; glibc
 * has an attribute for it, other C libraries have none.
 *
 * No thread may take it twice. */
#ifndef SERVER_RWLOCK_H
#define SERVER_RWLOCK_H

#include <pthread.h>
#include <stdbool.h>

struct rwlock {
    pthread_mutex_t mutex; /* of the rest; held for a few instructions */
    pthread_cond_t freed;
    unsigned readers, waiting; /* those that have it; writers that wait for it */
    bool writing;              /* a writer has it */
};

void rwlock_init(struct rwlock *l);
void rwlock_clear(struct rwlock *l);

void rwlock_read(struct rwlock *l);
void rwlock_write(struct rwlock *l);
/* The same without waiting. False: another thread has the lock, or a writer waits for it. */
bool rwlock_try_read(struct rwlock *l);
bool rwlock_try_write(struct rwlock *l);
/* Ends any of them, on the thread that began it. */
void rwlock_unlock(struct rwlock *l);

#endif
