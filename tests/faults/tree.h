/* tree.h - a directory and its content in memory: names, and the files that they stand for. Two names may
 * stand for one file. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct tree_file {
    bool dir;
    char *bytes; /* owns */
    size_t n;    /* after these there are only zeros, up to the size */
    uint64_t size;
};

struct tree_name {
    char *path; /* owns; relative to the directory */
    uint32_t file;
};

struct tree {
    struct tree_name *name; /* owns; a directory comes before what is in it */
    size_t names;
    struct tree_file *file; /* owns */
    size_t files;
};

/* Returns the number of the new file, a copy of *f. */
uint32_t tree_add_file(struct tree *t, const struct tree_file *f);
void tree_add_name(struct tree *t, const char *path, uint32_t file);
void tree_free(struct tree *t);

/* NULL: there is no such name. */
const struct tree_file *tree_find(const struct tree *t, const char *path);

struct tree tree_read(const char *path);

/* Makes the content of the directory that of the tree. */
void tree_write(const struct tree *t, const char *path);

/* Removes a directory and its content. */
void tree_remove(const char *path);

/* Whether n bytes of two files are equal, from an offset on. */
bool tree_bytes_equal(const struct tree_file *a, uint64_t at, const struct tree_file *b,
                      uint64_t from, uint64_t n);

bool tree_file_equal(const struct tree_file *a, const struct tree_file *b);

/* A name whose content differs; NULL: both trees are equal. */
const char *tree_difference(const struct tree *a, const struct tree *b);
