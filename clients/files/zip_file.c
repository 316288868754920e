/* zip_file.c - see zip_file.h. The directory at the end of the archive says where each file is, how it is compressed, its length and
 * its checksum. Deflated bytes are what gzip has between its header and its trailer, so they are given to gzip as such a file. */
#include "clients/files/zip_file.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/lib/bytes.h"
#include "clients/reading/word_list.h"

enum {
    END = 22, /* bytes of the record that ends the directory */
    END_MOST = END + 65535,
    ENTRY = 46,
    LOCAL = 30,
    DIRECTORY_MOST = 1 << 24,
    STORED = 0,
    DEFLATED = 8,
    ENCRYPTED = 1
};

struct entry {
    const unsigned char *name;
    size_t name_len;
    unsigned flags, method;
    uint32_t crc, packed, size, at; /* where its local header is */
};

static bool fail(char *why, size_t room, const char *what)
{
    snprintf(why, room, "%s", what);
    return false;
}

static bool read_at(int fd, void *to, size_t n, uint64_t at)
{
    char *p = to;
    while (n > 0) {
        ssize_t got = pread(fd, p, n, (off_t)at);
        if (got <= 0)
            return false;
        p += got;
        at += (uint64_t)got;
        n -= (size_t)got;
    }
    return true;
}

/* ---- files without a name ---- */

static int open_nameless(void)
{
    FILE *f = tmpfile();
    int fd = f != NULL ? dup(fileno(f)) : -1;
    if (f != NULL)
        fclose(f);
    return fd;
}

static bool write_all(int fd, const void *bytes, size_t n)
{
    const char *p = bytes;
    while (n > 0) {
        ssize_t put = write(fd, p, n);
        if (put <= 0)
            return false;
        p += put;
        n -= (size_t)put;
    }
    return true;
}

/* Copies n bytes, and returns their checksum in *crc. */
static bool copy(int from, uint64_t at, uint64_t n, int to, uint32_t *crc)
{
    char block[65536];
    for (*crc = ~0u; n > 0;) {
        size_t some = n < sizeof block ? (size_t)n : sizeof block;
        if (!read_at(from, block, some, at) || !write_all(to, block, some))
            return false;
        *crc = bytes_crc(*crc, block, some);
        at += some;
        n -= some;
    }
    *crc = ~*crc;
    return true;
}

/* A pipe as a file, in which one can go back. */
static int spool(int fd)
{
    char block[65536];
    int to = open_nameless();
    ssize_t n = -1;
    while (to >= 0 && (n = read(fd, block, sizeof block)) > 0)
        if (!write_all(to, block, (size_t)n)) {
            n = -1;
            break;
        }
    if (n == 0)
        return to;
    if (to >= 0)
        close(to);
    return -1;
}

/* ---- the directory ---- */

/* Reads the directory; NULL if there is none. */
static unsigned char *read_directory(int fd, size_t *bytes, size_t *entries)
{
    unsigned char *tail = malloc(END_MOST), *directory = NULL;
    off_t size = lseek(fd, 0, SEEK_END);
    size_t n = size < END_MOST ? (size_t)(size > 0 ? size : 0) : END_MOST;
    bool ok = tail != NULL && n >= END && read_at(fd, tail, n, (uint64_t)size - n);
    for (size_t i = n; ok && directory == NULL && i-- > 0;) {
        const unsigned char *p = tail + i;
        if (n - i < END || memcmp(p, "PK\5\6", 4) != 0)
            continue;
        *entries = bytes_u16(p + 10);
        *bytes = bytes_u32(p + 12);
        uint32_t at = bytes_u32(p + 16);
        if (*bytes > DIRECTORY_MOST || (directory = malloc(*bytes + 1)) == NULL)
            break;
        if (!read_at(fd, directory, *bytes, at)) {
            free(directory);
            directory = NULL;
        }
    }
    free(tail);
    return directory;
}

/* The entry at *at, which is moved behind it; false at the end, or if it is damaged. */
static bool next_entry(const unsigned char *directory, size_t bytes, size_t *at, struct entry *e)
{
    const unsigned char *p = directory + *at;
    if (bytes - *at < ENTRY || memcmp(p, "PK\1\2", 4) != 0)
        return false;
    *e = (struct entry){.name = p + ENTRY,
                        .name_len = bytes_u16(p + 28),
                        .flags = bytes_u16(p + 8),
                        .method = bytes_u16(p + 10),
                        .crc = bytes_u32(p + 16),
                        .packed = bytes_u32(p + 20),
                        .size = bytes_u32(p + 24),
                        .at = bytes_u32(p + 42)};
    size_t length = ENTRY + e->name_len + bytes_u16(p + 30) + bytes_u16(p + 32);
    if (length > bytes - *at)
        return false;
    *at += length;
    return true;
}

/* Folders, and what macOS and Windows put beside files. */
static bool is_file(const struct entry *e)
{
    static const char others[] = ".DS_Store Thumbs.db desktop.ini";
    const char *name = (const char *)e->name;
    return e->name_len > 0 && name[e->name_len - 1] != '/' &&
           (e->name_len <= 9 || memcmp(name, "__MACOSX/", 9) != 0) &&
           !word_list_has(others, name, e->name_len) &&
           !word_list_has_end(others, name, e->name_len);
}

static bool has_points(const struct entry *e)
{
    return word_list_has_end(".csv .tsv .txt .xyz .xy .pts .geojson .json .ndjson .geojsonl .jsonl "
                             ".gpx .node .las .asc .tif .tiff .hgt .dem",
                             (const char *)e->name, e->name_len);
}

/* Finds the file; several are named in `why`. */
static bool choose(const unsigned char *directory, size_t bytes, size_t entries,
                   struct entry *chosen, char *why, size_t room)
{
    size_t files = 0, with_points = 0, at = 0;
    struct entry e, only = {0}, pointed = {0};
    char list[200] = "";
    for (size_t i = 0; i < entries; i++) {
        if (!next_entry(directory, bytes, &at, &e))
            return fail(why, room, "the archive's directory is damaged");
        if (!is_file(&e))
            continue;
        size_t n = strlen(list);
        if (n + e.name_len + 8 < sizeof list)
            snprintf(list + n, sizeof list - n, "%s%.*s", n > 0 ? ", " : "", (int)e.name_len,
                     (const char *)e.name);
        only = files++ == 0 ? e : only;
        if (has_points(&e))
            pointed = with_points++ == 0 ? e : pointed;
    }
    *chosen = files == 1 ? only : pointed;
    if (files == 0)
        return fail(why, room, "the archive has no file");
    if (files == 1 || with_points == 1)
        return true;
    snprintf(why, room, "the archive has %zu files: %s; unpack it, and choose one", files, list);
    return false;
}

/* ---- the file ---- */

/* Copies the bytes to m->fd. */
static bool extract(int fd, const struct entry *e, struct zip_member *m)
{
    static const unsigned char head[10] = {0x1F, 0x8B, 8, 0, 0, 0, 0, 0, 0, 255};
    unsigned char local[LOCAL], tail[8];
    uint32_t crc;
    if (!read_at(fd, local, sizeof local, e->at) || memcmp(local, "PK\3\4", 4) != 0)
        return false;
    uint64_t at = (uint64_t)e->at + LOCAL + bytes_u16(local + 26) + bytes_u16(local + 28);
    if (!m->deflated)
        return e->packed == e->size && copy(fd, at, e->size, m->fd, &crc) && crc == e->crc &&
               lseek(m->fd, 0, SEEK_SET) == 0;
    for (int i = 0; i < 4; i++) {
        tail[i] = (unsigned char)(e->crc >> (8 * i));
        tail[4 + i] = (unsigned char)(e->size >> (8 * i));
    }
    return write_all(m->fd, head, sizeof head) && copy(fd, at, e->packed, m->fd, &crc) &&
           write_all(m->fd, tail, sizeof tail) && lseek(m->fd, 0, SEEK_SET) == 0;
}

static bool open_entry(int fd, const struct entry *e, struct zip_member *m, char *why, size_t room)
{
    snprintf(m->name, sizeof m->name, "%.*s", e->name_len < 250 ? (int)e->name_len : 250,
             (const char *)e->name);
    m->deflated = e->method == DEFLATED;
    if (e->flags & ENCRYPTED)
        return fail(why, room, "the archive is encrypted");
    if (e->method != STORED && e->method != DEFLATED)
        return fail(why, room, "the archive is compressed in a way that is not known; unpack it");
    if (e->size == UINT32_MAX || e->packed == UINT32_MAX || e->at == UINT32_MAX)
        return fail(why, room, "archives beyond 4 GB are not read; unpack it");
    m->fd = open_nameless();
    if (m->fd < 0)
        return fail(why, room, "there is no room for a temporary file");
    if (extract(fd, e, m))
        return true;
    close(m->fd);
    return fail(why, room, "the archive is damaged");
}

bool zip_open(int fd, struct zip_member *m, char *why, size_t room)
{
    size_t bytes, entries;
    struct entry e;
    int own = lseek(fd, 0, SEEK_CUR) < 0 ? spool(fd) : -1, from = own >= 0 ? own : fd;
    unsigned char *directory = read_directory(from, &bytes, &entries);
    bool ok = directory != NULL ? choose(directory, bytes, entries, &e, why, room) &&
                                      open_entry(from, &e, m, why, room)
                                : fail(why, room, "the archive is not complete");
    free(directory);
    if (own >= 0)
        close(own);
    return ok;
}
