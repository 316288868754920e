/* rwlock.c - see rwlock.h. */
#include "server/sets/rwlock.h"

void rwlock_init(struct rwlock *l)
{
    *l = (struct rwlock){0};
    pthread_mutex_init(&l->mutex, NULL);
    pthread_cond_init(&l->freed, NULL);
}

void rwlock_clear(struct rwlock *l)
{
    pthread_cond_destroy(&l->freed);
    pthread_mutex_destroy(&l->mutex);
}

static bool admits_reader(const struct rwlock *l)
{
    return !l->writing && l->waiting == 0;
}

static bool admits_writer(const struct rwlock *l)
{
    return !l->writing && l->readers == 0;
}

void rwlock_read(struct rwlock *l)
{
    pthread_mutex_lock(&l->mutex);
    while (!admits_reader(l))
        pthread_cond_wait(&l->freed, &l->mutex);
    l->readers++;
    pthread_mutex_unlock(&l->mutex);
}

void rwlock_write(struct rwlock *l)
{
    pthread_mutex_lock(&l->mutex);
    l->waiting++;
    while (!admits_writer(l))
        pthread_cond_wait(&l->freed, &l->mutex);
    l->waiting--;
    l->writing = true;
    pthread_mutex_unlock(&l->mutex);
}

bool rwlock_try_read(struct rwlock *l)
{
    pthread_mutex_lock(&l->mutex);
    bool admitted = admits_reader(l);
    l->readers += admitted;
    pthread_mutex_unlock(&l->mutex);
    return admitted;
}

bool rwlock_try_write(struct rwlock *l)
{
    pthread_mutex_lock(&l->mutex);
    bool admitted = admits_writer(l) && l->waiting == 0;
    l->writing = l->writing || admitted;
    pthread_mutex_unlock(&l->mutex);
    return admitted;
}

void rwlock_unlock(struct rwlock *l)
{
    pthread_mutex_lock(&l->mutex);
    if (l->writing)
        l->writing = false;
    else
        l->readers--;
    if (l->readers == 0)
        pthread_cond_broadcast(&l->freed);
    pthread_mutex_unlock(&l->mutex);
}
