/* poly_file.c - see poly_file.h. Sections follow one another, each with its number of lines in front. */
#include "clients/lines/poly_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/lines/text_lines.h"
#include "clients/reading/number.h"
#include "proto/number.h"

struct poly {
    struct points_file *f;
    struct poly_notes *notes;
    struct table_fields *fields;
    struct text_lines_scan *scan;
    uint32_t first; /* the number of the first point, 0 or 1 */
    double row[FIELDS_MOST];
};

static bool next(struct poly *p, const char *what)
{
    if (text_lines_next(p->scan, p->f))
        return true;
    return p->f->fault == NULL && points_file_stop(p->f, "the file ends before %s", what);
}

static bool bad_word(struct poly *p, size_t k, const char *what)
{
    char text[60];
    if (k >= p->scan->n)
        return points_file_stop(p->f, "%s is missing", what);
    return points_file_stop(
        p->f, "%s is not a number: \"%s\"", what,
        report_clean(text, sizeof text, p->scan->word[k].text, p->scan->word[k].len));
}

static bool read_count(struct poly *p, size_t k, const char *what, uint32_t *v)
{
    return (k < p->scan->n && proto_read_u32(p->scan->word[k].text, p->scan->word[k].len, v)) ||
           bad_word(p, k, what);
}

static bool read_value(struct poly *p, size_t k, const char *what, double *v)
{
    return (k < p->scan->n && proto_read_double(p->scan->word[k].text, p->scan->word[k].len, v)) ||
           bad_word(p, k, what);
}

/* ---- points ---- */

static bool name_fields(struct poly *p, uint32_t attributes)
{
    char name[16];
    if (attributes > FIELDS_MOST)
        return points_file_stop(p->f, "a point has at most %d attributes", FIELDS_MOST);
    for (uint32_t k = 0; k < attributes; k++) {
        int len = snprintf(name, sizeof name, "a%u", (unsigned)k + 1);
        table_fields_add(p->fields, 3 + k, name, (size_t)len);
    }
    p->f->fields = p->fields->n;
    p->f->row = p->row;
    return true;
}

static bool read_attribute(struct poly *p, size_t k, double *v)
{
    *v = (double)NAN;
    if (k < p->scan->n && number_is_missing(p->scan->word[k]))
        return true;
    if (!read_value(p, k, "an attribute", v))
        return false;
    if (isinf(*v))
        *v = (double)NAN;
    return true;
}

static bool read_point(struct poly *p, uint32_t i)
{
    uint32_t number;
    double x, y;
    if (!next(p, "its last point") || !read_count(p, 0, "the number of a point", &number))
        return false;
    if (i == 0)
        p->first = number;
    if (number != p->first + i || p->first > 1)
        return points_file_stop(p->f, "points are numbered 0, 1, ... or 1, 2, ..., not %u here",
                                (unsigned)number);
    if (!read_value(p, 1, "x", &x) || !read_value(p, 2, "y", &y))
        return false;
    for (size_t k = 0; k < p->f->fields; k++)
        if (!read_attribute(p, 3 + k, &p->row[k]))
            return false;
    return points_file_append(p->f, x, y) || points_file_stop(p->f, "%s", p->f->fault);
}

/* `count 2 attributes markers`, and the points. *count is 0 if they are in another file. */
static bool read_points(struct poly *p, uint32_t *count)
{
    uint32_t dimension = 2, attributes = 0;
    if (!next(p, "its points") || !read_count(p, 0, "the number of points", count))
        return false;
    if (*count == 0)
        return true;
    if ((p->scan->n > 1 && !read_count(p, 1, "the dimension", &dimension)) ||
        (p->scan->n > 2 && !read_count(p, 2, "the number of attributes", &attributes)))
        return false;
    if (dimension != 2)
        return points_file_stop(p->f, "points have two coordinates, not %u", (unsigned)dimension);
    if (!name_fields(p, attributes))
        return false;
    for (uint32_t i = 0; i < *count; i++)
        if (!read_point(p, i))
            return false;
    return true;
}

static bool read_other_points(struct poly *p, const char *node, size_t n)
{
    struct text_lines_scan scan = text_lines_begin(node, n), *own = p->scan;
    uint32_t count = 0;
    p->scan = &scan;
    bool ok = read_points(p, &count);
    if (!ok) {
        char fault[sizeof p->f->text / 2];
        snprintf(fault, sizeof fault, "%s", p->f->fault);
        points_file_stop(p->f, "in the .node file: %s", fault);
    }
    text_lines_end(&scan);
    p->scan = own;
    return ok;
}

/* ---- segments, holes and regions ---- */

/* A marker, which may be missing or below 0. */
static uint32_t read_marker(struct poly *p, size_t k)
{
    uint32_t v;
    if (k >= p->scan->n)
        return 0;
    if (proto_read_u32(p->scan->word[k].text, p->scan->word[k].len, &v) && v <= PATHS_MOST_NUMBER)
        return v;
    p->notes->negative++;
    return 0;
}

static bool add_corner(struct poly *p, size_t k)
{
    uint32_t number;
    if (!read_count(p, k, "an end of a segment", &number))
        return false;
    if (number < p->first || number - p->first >= p->f->n)
        return points_file_stop(p->f, "there is no point %u", (unsigned)number);
    return paths_corner(&p->f->paths, number - p->first) || points_file_stop(p->f, "out of memory");
}

static bool read_segments(struct poly *p)
{
    uint32_t n;
    if (!next(p, "its segments") || !read_count(p, 0, "the number of segments", &n))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        if (!next(p, "its last segment") ||
            !points_file_begin_path(p->f, false, read_marker(p, 3), 0) || !add_corner(p, 1) ||
            !add_corner(p, 2))
            return false;
        points_file_end_path(p->f, false);
    }
    return true;
}

static void name_region(struct poly *p, struct seed *seed, uint32_t place)
{
    double attribute = 0;
    bool number = p->scan->n > 3 &&
                  proto_read_double(p->scan->word[3].text, p->scan->word[3].len, &attribute);
    bool whole =
        number && attribute >= 0 && attribute <= PATHS_MOST_NUMBER && attribute == floor(attribute);
    seed->number = whole ? (uint32_t)attribute : place;
    p->notes->unnamed += !whole;
    p->notes->areas += p->scan->n > 4;
}

static bool read_seeds(struct poly *p, bool holes)
{
    uint32_t n;
    if (!read_count(p, 0, holes ? "the number of holes" : "the number of regions", &n))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        struct seed seed = {.hole = holes};
        if (!next(p, holes ? "its last hole" : "its last region") ||
            !read_value(p, 1, "x", &seed.xy[0]) || !read_value(p, 2, "y", &seed.xy[1]))
            return false;
        if (!proto_is_coordinate(seed.xy[0]) || !proto_is_coordinate(seed.xy[1]))
            return points_file_stop(p->f, "a coordinate is out of range");
        if (!holes)
            name_region(p, &seed, i + 1);
        if (!paths_seed(&p->f->paths, seed))
            return points_file_stop(p->f, "out of memory");
    }
    return true;
}

static bool read_all(struct poly *p, const char *node, size_t node_n)
{
    uint32_t count = 0;
    if (!read_points(p, &count))
        return false;
    if (count == 0 && node == NULL)
        return points_file_stop(p->f, "there are no points, and no .node file beside it has them");
    if (count == 0 && !read_other_points(p, node, node_n))
        return false;
    if (!read_segments(p) || !next(p, "its holes") || !read_seeds(p, true))
        return false;
    return text_lines_next(p->scan, p->f) ? read_seeds(p, false) : p->f->fault == NULL;
}

bool poly_text_read(struct points_file *f, const char *text, size_t n, const char *node,
                    size_t node_n, struct table_fields *t, struct poly_notes *notes)
{
    struct text_lines_scan scan = text_lines_begin(text, n);
    struct poly *p = calloc(1, sizeof *p);
    *notes = (struct poly_notes){0};
    if (p == NULL)
        return points_file_stop(f, "out of memory");
    p->f = f;
    p->notes = notes;
    p->fields = t;
    p->scan = &scan;
    f->paths.given = f->paths.faces = true;
    bool ok = read_all(p, node, node_n);
    text_lines_end(&scan);
    f->row = NULL;
    free(p);
    return ok;
}

bool poly_read_node(struct points_file *f, const char *path, char **text, size_t *n)
{
    char name[4096];
    size_t len = strlen(path);
    if (len < 5 || len + 1 > sizeof name || strcmp(path + len - 5, ".poly") != 0)
        return true;
    snprintf(name, sizeof name, "%.*s.node", (int)(len - 5), path);
    int fd = open(name, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return errno == ENOENT || points_file_stop(f, "%s: %s", name, strerror(errno));
    bool ok = points_file_read_all(f, fd, text, n);
    close(fd);
    return ok;
}
