/* power_cut.c - see power_cut.h. First the log is followed once, to find which file each descriptor
 * and name stood for (resolve). Then, for each state, every file has two images: what the process saw,
 * and what is on the disk. Operations are carried out on the first; the parts of them that a sync covers,
 * or that are kept, are copied to the second, sector by sector. So a sector on the disk always has the
 * content that the process saw at some moment. */
#include "tests/faults/power_cut.h"

#include "tests/test.h"

#include <fcntl.h>
#include <string.h>

enum { DESCRIPTORS = 1024, NOTHING = -1, ROOT = 0, PATH_LIMIT = 256 };

struct image {
    char *bytes; /* owns; n of them, then zeros up to the size */
    size_t n, cap;
    uint64_t size;
};

struct node {
    bool dir;
    const struct tree_file *before; /* borrows; NULL: it did not exist */
    struct image seen, disk;
};

struct entry {
    char *path; /* owns; when it was first seen: a directory above may have got another name */
    const char *name;       /* its last part */
    int dir;                /* the node that it is a name in */
    int before, seen, disk; /* the node that it stands for, or NOTHING */
};

/* The nodes and entries that an operation concerns. */
struct step {
    int node;   /* its data, or the directory that it syncs; NOTHING: no data */
    int dir;    /* NOTHING: no name */
    int entry;  /* that changes, to */
    int to;     /* this node or NOTHING */
    int gone;   /* the entry that a rename leaves behind; or NOTHING */
    bool empty; /* an opening that truncates the file to 0 bytes */
    bool covered;
};

struct power_cut {
    const struct power_log *log;
    struct node *node; /* owns */
    struct entry *entry;
    struct step *step; /* one for each operation */
    int nodes, entries;
};

/* ---- resolving names and descriptors ---- */

static int add_node(struct power_cut *c, bool dir, const struct tree_file *before)
{
    c->node = realloc(c->node, (size_t)(c->nodes + 1) * sizeof *c->node);
    CHECK(c->node != NULL);
    c->node[c->nodes] = (struct node){.dir = dir, .before = before};
    return c->nodes++;
}

static int find_entry(struct power_cut *c, const char *path);

/* The node that the path stands for, as far as the log has been followed. */
static int node_of(struct power_cut *c, const char *path)
{
    int entry = path[0] == '\0' ? NOTHING : find_entry(c, path);
    return entry == NOTHING ? ROOT : c->entry[entry].seen;
}

/* The node of the directory that the path is in. */
static int parent_of(struct power_cut *c, const char *path)
{
    char parent[PATH_LIMIT];
    const char *slash = strrchr(path, '/');
    if (slash == NULL)
        return ROOT;
    snprintf(parent, sizeof parent, "%.*s", (int)(slash - path), path);
    int dir = node_of(c, parent);
    CHECK(dir != NOTHING);
    return dir;
}

static const char *last_part(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

/* The entry of this path, created if it is new. */
static int find_entry(struct power_cut *c, const char *path)
{
    int dir = parent_of(c, path);
    for (int i = 0; i < c->entries; i++)
        if (c->entry[i].dir == dir && strcmp(c->entry[i].name, last_part(path)) == 0)
            return i;
    c->entry = realloc(c->entry, (size_t)(c->entries + 1) * sizeof *c->entry);
    char *own = strdup(path);
    CHECK(c->entry != NULL && own != NULL);
    c->entry[c->entries] = (struct entry){own, last_part(own), dir, NOTHING, NOTHING, NOTHING};
    return c->entries++;
}

static void take_tree(struct power_cut *c, const struct tree *t)
{
    add_node(c, true, NULL); /* ROOT */
    for (size_t i = 0; i < t->files; i++)
        add_node(c, t->file[i].dir, &t->file[i]);
    for (size_t i = 0; i < t->names; i++) {
        int number = find_entry(c, t->name[i].path);
        struct entry *e = &c->entry[number];
        e->before = e->seen = (int)t->name[i].file + 1;
    }
}

static void change_name(struct power_cut *c, struct step *s, const char *path, int to)
{
    s->entry = find_entry(c, path);
    s->dir = c->entry[s->entry].dir;
    s->to = to;
    c->entry[s->entry].seen = to;
}

static void resolve_open(struct power_cut *c, struct step *s, const struct power_op *op, int fds[])
{
    int node = node_of(c, op->name);
    if (node == NOTHING) {
        node = add_node(c, false, NULL);
        change_name(c, s, op->name, node);
    } else if ((op->a & O_TRUNC) != 0) {
        s->node = node;
        s->empty = true;
    }
    CHECK(op->fd >= 0 && op->fd < DESCRIPTORS);
    fds[op->fd] = node;
}

static void resolve(struct power_cut *c)
{
    int fds[DESCRIPTORS];
    for (size_t i = 0; i < c->log->n; i++) {
        const struct power_op *op = &c->log->op[i];
        struct step *s = &c->step[i];
        *s = (struct step){.node = NOTHING, .dir = NOTHING, .gone = NOTHING};
        switch (op->kind) {
        case POWER_OPEN:
            resolve_open(c, s, op, fds);
            break;
        case POWER_WRITE:
        case POWER_SIZE:
        case POWER_EXTEND:
        case POWER_SYNC:
            s->node = fds[op->fd];
            break;
        case POWER_MKDIR:
            change_name(c, s, op->name, add_node(c, true, NULL));
            break;
        case POWER_LINK:
            change_name(c, s, op->other, node_of(c, op->name));
            break;
        case POWER_RENAME:
            change_name(c, s, op->other, node_of(c, op->name));
            s->gone = find_entry(c, op->name);
            c->entry[s->gone].seen = NOTHING;
            break;
        case POWER_UNLINK:
            change_name(c, s, op->name, NOTHING);
            break;
        case POWER_SENT:
            break;
        }
    }
}

struct power_cut *power_cut_new(const struct tree *before, const struct power_log *log)
{
    struct power_cut *c = calloc(1, sizeof *c);
    CHECK(c != NULL);
    c->log = log;
    c->step = calloc(log->n + 1, sizeof *c->step);
    CHECK(c->step != NULL);
    take_tree(c, before);
    resolve(c);
    return c;
}

void power_cut_free(struct power_cut *c)
{
    for (int i = 0; i < c->entries; i++)
        free(c->entry[i].path);
    free(c->entry);
    free(c->node);
    free(c->step);
    free(c);
}

const char *power_cut_subject(const struct power_cut *c, size_t number)
{
    const struct step *s = &c->step[number];
    if (s->dir != NOTHING)
        return c->entry[s->entry].path;
    for (int i = 0; s->node != NOTHING && i < c->entries; i++)
        if (c->entry[i].seen == s->node)
            return c->entry[i].path;
    for (size_t i = number; s->node != NOTHING && i > 0; i--)
        if (c->step[i - 1].dir != NOTHING && c->step[i - 1].to == s->node)
            return c->entry[c->step[i - 1].entry].path;
    return "";
}

/* ---- which operations are covered by syncs ---- */

static void cover(struct power_cut *c, size_t cut)
{
    size_t *open = malloc((cut + 1) * sizeof *open), n = 0; /* neither covered nor lost for good */
    CHECK(open != NULL);
    for (size_t i = 0; i < cut; i++) {
        const struct power_op *op = &c->log->op[i];
        size_t left = 0;
        c->step[i].covered = false;
        if (op->kind != POWER_SYNC) {
            open[n] = i;
            n += c->step[i].node != NOTHING || c->step[i].dir != NOTHING;
            continue;
        }
        for (size_t k = 0; k < n; k++) {
            struct step *s = &c->step[open[k]];
            int synced = c->step[i].node;
            bool mine = s->dir == synced || (s->dir == NOTHING && s->node == synced);
            if (!mine || (op->error == 0 && open[k] >= op->a))
                open[left++] = open[k];
            else
                s->covered = op->error == 0;
        }
        n = left;
    }
    free(open);
}

/* ---- images ---- */

/* Makes room for n bytes; new ones are zeros. */
static void image_widen(struct image *m, size_t n)
{
    if (n > m->cap) {
        size_t cap = n + n / 2 + POWER_CUT_SECTOR;
        m->bytes = realloc(m->bytes, cap);
        CHECK(m->bytes != NULL);
        m->cap = cap;
    }
    if (n > m->n) {
        memset(m->bytes + m->n, 0, n - m->n);
        m->n = n;
    }
}

static void image_write(struct image *m, uint64_t at, const char *bytes, size_t n)
{
    image_widen(m, (size_t)at + n);
    if (n > 0) /* otherwise there may be no image yet */
        memcpy(m->bytes + at, bytes, n);
}

static void image_cut(struct image *m, uint64_t size)
{
    if (size < m->n)
        m->n = (size_t)size;
    m->size = size;
}

static void copy_sector(struct image *to, const struct image *from, uint64_t sector)
{
    size_t at = (size_t)sector * POWER_CUT_SECTOR;
    size_t n = from->n <= at                     ? 0
               : from->n < at + POWER_CUT_SECTOR ? from->n - at
                                                 : POWER_CUT_SECTOR;
    image_widen(to, at + POWER_CUT_SECTOR);
    memset(to->bytes + at, 0, POWER_CUT_SECTOR);
    if (n > 0)
        memcpy(to->bytes + at, from->bytes + at, n);
}

static void image_set(struct image *m, const struct tree_file *f)
{
    *m = (struct image){0};
    if (f == NULL || f->dir)
        return;
    image_write(m, 0, f->bytes, f->n);
    m->size = f->size;
}

/* ---- carrying out ---- */

static bool keeps(const struct power_cut *c, struct power_cut_fate *fate, size_t i,
                  enum power_cut_part part, uint64_t sector)
{
    return c->step[i].covered || fate == NULL || fate->keeps(fate, i, part, sector);
}

static void resize(struct power_cut *c, size_t i, struct power_cut_fate *fate, uint64_t size)
{
    struct node *node = &c->node[c->step[i].node];
    if (size == node->seen.size)
        return;
    image_cut(&node->seen, size);
    if (keeps(c, fate, i, PART_SIZE, 0))
        image_cut(&node->disk, size);
}

static void write_data(struct power_cut *c, size_t i, struct power_cut_fate *fate)
{
    struct node *node = &c->node[c->step[i].node];
    const struct power_op *op = &c->log->op[i];
    uint64_t end = op->a + op->n;
    image_write(&node->seen, op->a, op->data, op->n);
    for (uint64_t s = op->a / POWER_CUT_SECTOR; s * POWER_CUT_SECTOR < end; s++)
        if (keeps(c, fate, i, PART_SECTOR, s))
            copy_sector(&node->disk, &node->seen, s);
    if (end < node->seen.size)
        return;
    node->seen.size =
        end; /* even if it had this size before: later writes up to it must be found */
    if (keeps(c, fate, i, PART_SIZE, 0))
        node->disk.size = end;
}

static void carry_out(struct power_cut *c, size_t i, struct power_cut_fate *fate)
{
    const struct power_op *op = &c->log->op[i];
    const struct step *s = &c->step[i];
    if (op->kind == POWER_WRITE)
        write_data(c, i, fate);
    else if (op->kind == POWER_SIZE || s->empty)
        resize(c, i, fate, s->empty ? 0 : op->a);
    else if (op->kind == POWER_EXTEND && op->a > c->node[s->node].seen.size)
        resize(c, i, fate, op->a);
    else if (s->dir != NOTHING && keeps(c, fate, i, PART_NAME, 0))
        c->entry[s->entry].disk = s->to;
    if (s->gone != NOTHING && keeps(c, fate, i, PART_OLD_NAME, 0))
        c->entry[s->gone].disk = NOTHING;
}

/* ---- the outcome ---- */

static void begin(struct power_cut *c)
{
    for (int i = 0; i < c->nodes; i++) {
        image_set(&c->node[i].seen, c->node[i].before);
        image_set(&c->node[i].disk, c->node[i].before);
    }
    for (int i = 0; i < c->entries; i++)
        c->entry[i].disk = c->entry[i].before;
}

static uint32_t give_file(const struct node *n, struct tree *out)
{
    const struct image *m = &n->disk;
    struct tree_file f = {.dir = n->dir, .bytes = m->bytes, .n = m->n, .size = m->size};
    if (f.n > f.size)
        f.n = (size_t)f.size;
    return tree_add_file(out, &f);
}

/* All names of the directory at `path` that are on the disk, and their content. */
static void give_names(struct power_cut *c, int dir, const char *path, uint32_t given[],
                       struct tree *out)
{
    char at[PATH_LIMIT];
    for (int i = 0; i < c->entries; i++) {
        const struct entry *e = &c->entry[i];
        if (e->dir != dir || e->disk == NOTHING)
            continue;
        if (given[e->disk] == UINT32_MAX)
            given[e->disk] = give_file(&c->node[e->disk], out);
        snprintf(at, sizeof at, "%s%s%s", path, path[0] == '\0' ? "" : "/", e->name);
        tree_add_name(out, at, given[e->disk]);
        if (c->node[e->disk].dir)
            give_names(c, e->disk, at, given, out);
    }
}

struct tree power_cut_state(struct power_cut *c, size_t cut, struct power_cut_fate *fate)
{
    struct tree out = {0};
    uint32_t *given = malloc((size_t)c->nodes * sizeof *given);
    CHECK(given != NULL && cut <= c->log->n);
    memset(given, 0xFF, (size_t)c->nodes * sizeof *given);
    begin(c);
    cover(c, cut);
    for (size_t i = 0; i < cut; i++)
        carry_out(c, i, fate);
    give_names(c, ROOT, "", given, &out);
    for (int i = 0; i < c->nodes; i++) {
        free(c->node[i].seen.bytes);
        free(c->node[i].disk.bytes);
    }
    free(given);
    return out;
}

struct tree power_cut_none(struct power_cut *c, size_t cut)
{
    return power_cut_state(c, cut, NULL);
}
