/* tree.c - see tree.h. */
#include "tests/faults/tree.h"

#include "tests/server/directory.h"
#include "tests/test.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_LIMIT = 256 };

static void *grow(void *array, size_t n, size_t size)
{
    if (n > 0 && (n & (n - 1)) != 0)
        return array;
    array = realloc(array, (n == 0 ? 1 : 2 * n) * size);
    CHECK(array != NULL);
    return array;
}

uint32_t tree_add_file(struct tree *t, const struct tree_file *f)
{
    t->file = grow(t->file, t->files, sizeof *t->file);
    t->file[t->files] = *f;
    t->file[t->files].bytes = malloc(f->n + 1);
    CHECK(t->file[t->files].bytes != NULL);
    if (f->n > 0)
        memcpy(t->file[t->files].bytes, f->bytes, f->n);
    return (uint32_t)t->files++;
}

void tree_add_name(struct tree *t, const char *path, uint32_t file)
{
    t->name = grow(t->name, t->names, sizeof *t->name);
    t->name[t->names++] = (struct tree_name){strdup(path), file};
}

void tree_free(struct tree *t)
{
    for (size_t i = 0; i < t->names; i++)
        free(t->name[i].path);
    for (size_t i = 0; i < t->files; i++)
        free(t->file[i].bytes);
    free(t->name);
    free(t->file);
    *t = (struct tree){0};
}

const struct tree_file *tree_find(const struct tree *t, const char *path)
{
    for (size_t i = 0; i < t->names; i++)
        if (strcmp(t->name[i].path, path) == 0)
            return &t->file[t->name[i].file];
    return NULL;
}

/* ---- from the disk; nftw(3) knows no context ---- */

static struct tree *reading;
static struct stat *stats; /* of its files */
static size_t root_length;

static uint32_t find_inode(const struct stat *st)
{
    uint32_t i = 0;
    while (i < reading->files && (stats[i].st_ino != st->st_ino || stats[i].st_dev != st->st_dev))
        i++;
    return i;
}

static int note(const char *path, const struct stat *st, int type, struct FTW *at)
{
    if (at->level == 0)
        return 0;
    uint32_t number = find_inode(st);
    if (number == reading->files) {
        struct tree_file f = {.dir = type == FTW_D, .size = f.dir ? 0 : (uint64_t)st->st_size};
        f.bytes = f.dir ? NULL : file_read(path, &f.n);
        while (f.n > 0 && f.bytes[f.n - 1] == '\0')
            f.n--;
        stats = grow(stats, reading->files, sizeof *stats);
        stats[reading->files] = *st;
        tree_add_file(reading, &f);
        free(f.bytes);
    }
    tree_add_name(reading, path + root_length + 1, number);
    return 0;
}

struct tree tree_read(const char *path)
{
    struct tree t = {0};
    reading = &t;
    root_length = strlen(path);
    CHECK(nftw(path, note, 8, FTW_PHYS) == 0);
    free(stats);
    stats = NULL;
    return t;
}

/* ---- to the disk ---- */

static int remove_one(const char *path, const struct stat *st, int type, struct FTW *at)
{
    (void)st, (void)type, (void)at;
    return remove(path);
}

void tree_remove(const char *path)
{
    CHECK(nftw(path, remove_one, 8, FTW_DEPTH | FTW_PHYS) == 0 || errno == ENOENT);
}

static void write_file(const struct tree_file *f, const char *path)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL, 0600);
    CHECK(fd >= 0 && write(fd, f->bytes, f->n) == (ssize_t)f->n);
    CHECK(ftruncate(fd, (off_t)f->size) == 0);
    close(fd);
}

void tree_write(const struct tree *t, const char *path)
{
    char to[PATH_LIMIT], from[PATH_LIMIT];
    tree_remove(path);
    CHECK(mkdir(path, 0700) == 0);
    for (size_t i = 0, first; i < t->names; i++) {
        const struct tree_file *f = &t->file[t->name[i].file];
        for (first = 0; t->name[first].file != t->name[i].file; first++)
            ;
        snprintf(to, sizeof to, "%s/%s", path, t->name[i].path);
        snprintf(from, sizeof from, "%s/%s", path, t->name[first].path);
        if (f->dir)
            CHECK(mkdir(to, 0700) == 0);
        else if (first < i)
            CHECK(link(from, to) == 0);
        else
            write_file(f, to);
    }
}

/* ---- comparing ---- */

static char byte_at(const struct tree_file *f, uint64_t at)
{
    return at < f->n ? f->bytes[at] : '\0';
}

bool tree_bytes_equal(const struct tree_file *a, uint64_t at, const struct tree_file *b,
                      uint64_t from, uint64_t n)
{
    if (at + n > a->size || from + n > b->size)
        return false;
    while (n > 0 && (at < a->n || from < b->n) && byte_at(a, at) == byte_at(b, from))
        at++, from++, n--;
    return n == 0 || (at >= a->n && from >= b->n);
}

bool tree_file_equal(const struct tree_file *a, const struct tree_file *b)
{
    return a->dir == b->dir && a->size == b->size && tree_bytes_equal(a, 0, b, 0, a->size);
}

const char *tree_difference(const struct tree *a, const struct tree *b)
{
    for (size_t i = 0; i < a->names; i++) {
        const struct tree_file *there = tree_find(b, a->name[i].path);
        if (there == NULL || !tree_file_equal(&a->file[a->name[i].file], there))
            return a->name[i].path;
    }
    for (size_t i = 0; i < b->names; i++)
        if (tree_find(a, b->name[i].path) == NULL)
            return b->name[i].path;
    return NULL;
}
