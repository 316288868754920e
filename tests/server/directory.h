/* directory.h - a data directory for a test, removed when the test passes, and daemons on it. */
#pragma once

#include "tests/server/daemon.h"

struct directory {
    char path[64];
};

struct directory directory_new(void);
/* The same on a file system in memory, if there is one: thousands of syncs take long on a disk. */
struct directory directory_quick(void);
void directory_remove(const struct directory *dir);

/* A daemon on the directory, with further arguments up to a NULL, that has read everything: the ready
 * line waits for that, but on a busy machine not long enough. */
struct daemon directory_daemon(const struct directory *dir, const char *const *arguments);

/* The same for a daemon that may refuse to start; false: it has ended. */
bool directory_try(const struct directory *dir, const char *const *arguments, struct daemon *d);

/* Runs delaunayd FLAG DIR; what it prints, up to `size`, goes to text. Returns the exit status. */
int directory_run(const struct directory *dir, const char *flag, char *text, size_t size);

/* Repairs it in this process; what that prints, up to `size`, goes to text. Returns the exit
 * status. */
int directory_repair(const struct directory *dir, char *text, size_t size);

/* Runs delaunayd --repair DIR with a disk on which the n-th call of a kind fails ("write", "sync",
 * "rename", "open"). Returns whether a call failed. */
bool directory_repair_badly(const struct directory *dir, const char *op, unsigned nth);

/* The n-th (from 0) name that begins with `prefix`, in order; false if there are fewer. */
bool directory_file(const struct directory *dir, const char *prefix, unsigned n, char path[128]);

/* Makes an empty file. */
void directory_touch(const struct directory *dir, const char *name);

/* Reads a file; the caller frees its content. */
char *file_read(const char *path, size_t *n);
void file_write(const char *path, const char *bytes, size_t n);

/* Everything that a client can see of the sets, as text; the caller frees it. */
char *directory_state(const struct daemon *d, const char *const *sets);

/* Sends the request lines, one after the other's reply, and checks that none is an error. */
void carry_out(const struct daemon *d, const char *requests);
#define carry_out(...) TEST_CALL(carry_out(__VA_ARGS__))
