/* power_cut_test.c - what a power cut may leave behind, and what it may not. Each test lists the
 * operations of a process and the parts of them that are lost, and examines what is left. */
#include "tests/faults/power_cut.h"

#include "tests/test.h"

#include <fcntl.h>
#include <string.h>

/* ---- the operations of a process ---- */

enum { MOST = 32, A = 5, B = 6, DIR_FD = 4, NEW_FILE = O_WRONLY | O_CREAT };

static struct power_op op[MOST];
static size_t ops;

/* Each returns the number of the operation. */
static size_t add(struct power_op o)
{
    CHECK(ops < MOST);
    o.name = o.name == NULL ? "" : o.name;
    o.other = o.other == NULL ? "" : o.other;
    op[ops] = o;
    return ops++;
}

static size_t opens(int fd, const char *name, int flags)
{
    return add((struct power_op){.kind = POWER_OPEN, .fd = fd, .name = name, .a = (uint64_t)flags});
}

static size_t writes(int fd, uint64_t at, const char *data, size_t n)
{
    return add((struct power_op){.kind = POWER_WRITE, .fd = fd, .a = at, .data = data, .n = n});
}

static size_t cuts(int fd, uint64_t size)
{
    return add((struct power_op){.kind = POWER_SIZE, .fd = fd, .a = size});
}

static size_t renames(const char *from, const char *to)
{
    return add((struct power_op){.kind = POWER_RENAME, .name = from, .other = to});
}

/* A sync of everything before it. */
static size_t syncs(int fd)
{
    return add((struct power_op){.kind = POWER_SYNC, .fd = fd, .a = ops});
}

static size_t fails_to_sync(int fd)
{
    return add((struct power_op){.kind = POWER_SYNC, .fd = fd, .a = ops, .error = 5});
}

/* A new file of n bytes, synced with its name; its descriptor stays open. */
static void has_file(int fd, const char *name, const char *data, size_t n)
{
    opens(fd, name, NEW_FILE);
    writes(fd, 0, data, n);
    syncs(fd);
    opens(DIR_FD, "", O_RDONLY);
    syncs(DIR_FD);
}

/* ---- the power fails ---- */

struct loss {
    size_t number;
    enum power_cut_part part;
    uint64_t sector;
};

struct losses {
    struct power_cut_fate fate;
    const struct loss *v;
    size_t n;
    bool all;
};

static bool keeps(struct power_cut_fate *fate, size_t number, enum power_cut_part part,
                  uint64_t sector)
{
    const struct losses *l = (const struct losses *)(const void *)fate;
    for (size_t i = 0; i < l->n; i++)
        if (l->v[i].number == number && l->v[i].part == part && l->v[i].sector == sector)
            return false;
    return !l->all;
}

static struct tree left_after(const struct losses *l)
{
    struct power_log log = {.op = op, .n = ops};
    struct tree before = {0};
    struct losses fate = *l;
    struct power_cut *c = power_cut_new(&before, &log);
    fate.fate.keeps = keeps;
    struct tree t = power_cut_state(c, ops, &fate.fate);
    power_cut_free(c);
    return t;
}

/* The directory without these parts. */
static struct tree without(const struct loss *v, size_t n)
{
    return left_after(&(struct losses){.v = v, .n = n});
}

static struct tree without_name(size_t number)
{
    return without(&(struct loss){number, PART_NAME, 0}, 1);
}

static struct tree without_size(size_t number)
{
    return without(&(struct loss){number, PART_SIZE, 0}, 1);
}

static struct tree without_sector(size_t number, uint64_t sector)
{
    return without(&(struct loss){number, PART_SECTOR, sector}, 1);
}

/* The directory without all parts that may be lost. */
static struct tree without_all(void)
{
    return left_after(&(struct losses){.all = true});
}

/* ---- what is left ---- */

static bool has(const struct tree *t, const char *name)
{
    return tree_find(t, name) != NULL;
}

/* The byte of the file at this offset; -1: the file is shorter. */
static int byte_at(const struct tree *t, const char *name, uint64_t at)
{
    const struct tree_file *f = tree_find(t, name);
    CHECK(f != NULL);
    return at >= f->size ? -1 : at >= f->n ? 0 : f->bytes[at];
}

static bool holds(const struct tree *t, const char *name, const char *text)
{
    const struct tree_file *f = tree_find(t, name);
    return f != NULL && f->size == strlen(text) && f->n == f->size &&
           memcmp(f->bytes, text, f->n) == 0;
}

static const char *filled(char c)
{
    static char bytes[256][2000];
    memset(bytes[(unsigned char)c], c, sizeof bytes[0]);
    return bytes[(unsigned char)c];
}

/* ---- names ---- */

TEST(created_file_may_be_missing_until_its_directory_is_synced)
{
    opens(DIR_FD, "", O_RDONLY);
    size_t created = opens(A, "a", NEW_FILE);
    writes(A, 0, "one", 3);
    syncs(A);
    struct tree t = without_name(created);
    CHECK(!has(&t, "a"));
    tree_free(&t);
    syncs(DIR_FD);
    t = without_all();
    CHECK(holds(&t, "a", "one"));
    tree_free(&t);
}

TEST(rename_may_not_have_happened)
{
    has_file(A, "old", "one", 3);
    has_file(B, "new", "two", 3);
    size_t renamed = renames("old", "new");
    struct tree t = without_all();
    CHECK(holds(&t, "old", "one") && holds(&t, "new", "two"));
    tree_free(&t);
    t = without(&(struct loss){renamed, PART_OLD_NAME, 0}, 1);
    CHECK(holds(&t, "old", "one") && holds(&t, "new", "one"));
    tree_free(&t);
    syncs(DIR_FD);
    t = without_all();
    CHECK(!has(&t, "old") && holds(&t, "new", "one"));
    tree_free(&t);
}

TEST(renamed_file_may_be_there_without_its_data)
{
    has_file(A, "old", "one", 3);
    writes(A, 3, "two", 3);
    renames("old", "new");
    opens(DIR_FD, "", O_RDONLY);
    syncs(DIR_FD);
    struct tree t = without_all();
    CHECK(!has(&t, "old") && holds(&t, "new", "one"));
    tree_free(&t);
}

TEST(unlink_may_be_undone)
{
    has_file(A, "a", "one", 3);
    add((struct power_op){.kind = POWER_UNLINK, .name = "a"});
    struct tree t = without_all();
    CHECK(holds(&t, "a", "one"));
    tree_free(&t);
    syncs(DIR_FD);
    t = without_all();
    CHECK(!has(&t, "a"));
    tree_free(&t);
}

TEST(link_gives_a_second_name_to_the_same_file)
{
    has_file(A, "a", "one", 3);
    size_t linked = add((struct power_op){.kind = POWER_LINK, .name = "a", .other = "b"});
    struct tree t = without_name(linked);
    CHECK(!has(&t, "b"));
    tree_free(&t);
    writes(A, 3, "two", 3);
    syncs(A);
    t = left_after(&(struct losses){0});
    CHECK(holds(&t, "a", "onetwo") && tree_find(&t, "a") == tree_find(&t, "b"));
    tree_free(&t);
}

TEST(new_directory_may_be_missing_with_all_that_is_in_it)
{
    opens(DIR_FD, "", O_RDONLY);
    add((struct power_op){.kind = POWER_MKDIR, .name = "d"});
    opens(7, "d", O_RDONLY);
    opens(A, "d/a", NEW_FILE);
    writes(A, 0, "one", 3);
    syncs(A);
    syncs(7);
    struct tree t = without_all();
    CHECK(t.names == 0);
    tree_free(&t);
    syncs(DIR_FD);
    t = without_all();
    CHECK(has(&t, "d") && holds(&t, "d/a", "one"));
    tree_free(&t);
}

/* After a file is removed and created again, its name stands for either of the two. */
TEST(name_that_is_used_again_may_stand_for_the_earlier_file)
{
    has_file(A, "a", "one", 3);
    add((struct power_op){.kind = POWER_UNLINK, .name = "a"});
    size_t again = opens(B, "a", NEW_FILE);
    writes(B, 0, "two", 3);
    syncs(B);
    struct tree t = without_all();
    CHECK(holds(&t, "a", "one"));
    tree_free(&t);
    t = without_name(again);
    CHECK(!has(&t, "a"));
    tree_free(&t);
    t = left_after(&(struct losses){0});
    CHECK(holds(&t, "a", "two"));
    tree_free(&t);
}

/* ---- data and sizes ---- */

TEST(sync_covers_what_came_before_it_began)
{
    has_file(A, "a", "one", 3);
    size_t begin = ops;
    writes(A, 3, "two", 3);
    size_t synced = syncs(A);
    struct tree t = without_all();
    CHECK(holds(&t, "a", "onetwo"));
    tree_free(&t);
    op[synced].a = begin; /* the write came during the sync */
    t = without_all();
    CHECK(holds(&t, "a", "one"));
    tree_free(&t);
}

TEST(sync_of_another_file_covers_nothing)
{
    has_file(A, "a", "one", 3);
    has_file(B, "b", "one", 3);
    writes(A, 3, "two", 3);
    syncs(B);
    struct tree t = without_all();
    CHECK(holds(&t, "a", "one"));
    tree_free(&t);
}

TEST(write_is_torn_at_512_bytes)
{
    has_file(A, "a", filled('1'), 1000);
    size_t second = writes(A, 1000, filled('2'), 1000);
    struct tree t = without_sector(second, 1); /* it has 24 bytes of the second write */
    CHECK(byte_at(&t, "a", 999) == '1' && byte_at(&t, "a", 1000) == 0);
    CHECK(byte_at(&t, "a", 1023) == 0 && byte_at(&t, "a", 1024) == '2');
    CHECK(byte_at(&t, "a", 1999) == '2' && byte_at(&t, "a", 2000) == -1);
    tree_free(&t);
    t = without_sector(second, 2); /* nothing was ever on the disk there */
    CHECK(byte_at(&t, "a", 1023) == '2' && byte_at(&t, "a", 1024) == 0);
    CHECK(byte_at(&t, "a", 1535) == 0 && byte_at(&t, "a", 1536) == '2');
    tree_free(&t);
}

TEST(lost_sector_has_its_old_content)
{
    has_file(A, "a", filled('1'), 1500);
    size_t second = writes(A, 0, filled('2'), 1500);
    struct tree t = without_sector(second, 1);
    CHECK(byte_at(&t, "a", 511) == '2' && byte_at(&t, "a", 512) == '1');
    CHECK(byte_at(&t, "a", 1023) == '1' && byte_at(&t, "a", 1024) == '2');
    tree_free(&t);
}

/* A sector has content that the process saw at some moment: never a later write without an earlier one. */
TEST(sector_of_two_writes_has_both_or_the_first_or_none)
{
    has_file(A, "a", filled('1'), 512);
    size_t first = writes(A, 0, "22", 2), second = writes(A, 2, "33", 2);
    struct tree t = without_sector(first, 0);
    CHECK(byte_at(&t, "a", 0) == '2' && byte_at(&t, "a", 2) == '3');
    tree_free(&t);
    t = without_sector(second, 0);
    CHECK(byte_at(&t, "a", 0) == '2' && byte_at(&t, "a", 2) == '1');
    tree_free(&t);
    t = without_all();
    CHECK(byte_at(&t, "a", 0) == '1' && byte_at(&t, "a", 2) == '1');
    tree_free(&t);
}

TEST(size_may_be_lost_without_the_data_and_the_data_without_the_size)
{
    has_file(A, "a", filled('1'), 512);
    size_t more = writes(A, 512, filled('2'), 100);
    struct tree t = without_size(more);
    CHECK(byte_at(&t, "a", 511) == '1' && byte_at(&t, "a", 512) == -1);
    tree_free(&t);
    t = without_sector(more, 1);
    CHECK(byte_at(&t, "a", 512) == 0 && byte_at(&t, "a", 611) == 0);
    CHECK(byte_at(&t, "a", 612) == -1);
    tree_free(&t);
    writes(A, 612, filled('3'), 100);
    t = without_size(more); /* a later size is that of the whole file */
    CHECK(byte_at(&t, "a", 512) == '2' && byte_at(&t, "a", 612) == '3');
    tree_free(&t);
}

TEST(truncation_may_be_undone)
{
    has_file(A, "a", filled('1'), 1000);
    size_t cut = cuts(A, 600);
    struct tree t = without_size(cut);
    CHECK(byte_at(&t, "a", 999) == '1');
    tree_free(&t);
    syncs(A);
    t = without_all();
    CHECK(byte_at(&t, "a", 599) == '1' && byte_at(&t, "a", 600) == -1);
    tree_free(&t);
}

TEST(file_that_was_truncated_on_opening_may_have_its_old_content)
{
    has_file(A, "a", filled('1'), 1000);
    opens(B, "a", NEW_FILE | O_TRUNC);
    writes(B, 0, "two", 3);
    struct tree t = without_all();
    CHECK(byte_at(&t, "a", 0) == '1' && byte_at(&t, "a", 999) == '1');
    tree_free(&t);
    t = left_after(&(struct losses){0});
    CHECK(holds(&t, "a", "two"));
    tree_free(&t);
}

/* ---- syncs that fail ---- */

TEST(no_later_sync_covers_what_a_failed_sync_should_have_covered)
{
    has_file(A, "a", filled('1'), 512);
    writes(A, 512, filled('2'), 512);
    fails_to_sync(A);
    writes(A, 1024, filled('3'), 512);
    syncs(A);
    struct tree t = without_all();
    CHECK(byte_at(&t, "a", 511) == '1' && byte_at(&t, "a", 512) == 0);
    CHECK(byte_at(&t, "a", 1023) == 0 && byte_at(&t, "a", 1024) == '3');
    tree_free(&t);
}

TEST(sector_that_is_written_again_after_a_failed_sync_is_covered_by_the_next)
{
    has_file(A, "a", filled('1'), 512);
    writes(A, 0, "22", 2);
    fails_to_sync(A);
    writes(A, 2, "33", 2);
    syncs(A);
    struct tree t = without_all();
    CHECK(byte_at(&t, "a", 0) == '2' && byte_at(&t, "a", 2) == '3');
    tree_free(&t);
}

TEST(size_that_a_failed_sync_has_lost_is_covered_after_the_end_is_written_again)
{
    has_file(A, "a", filled('1'), 512);
    writes(A, 512, filled('2'), 100);
    fails_to_sync(A);
    writes(A, 512, filled('2'), 99);
    syncs(A);
    struct tree t = without_all();
    CHECK(byte_at(&t, "a", 512) == -1);
    tree_free(&t);
    writes(A, 512, filled('2'), 100);
    syncs(A);
    t = without_all();
    CHECK(byte_at(&t, "a", 512) == '2' && byte_at(&t, "a", 611) == '2');
    tree_free(&t);
}

TEST(failed_sync_of_a_directory_covers_no_name_and_no_later_one_does)
{
    has_file(A, "old", "one", 3);
    renames("old", "new");
    fails_to_sync(DIR_FD);
    syncs(DIR_FD);
    struct tree t = without_all();
    CHECK(has(&t, "old") && !has(&t, "new"));
    tree_free(&t);
}

/* ---- moments ---- */

TEST(power_may_fail_between_any_two_operations)
{
    struct power_log log = {.op = op};
    struct tree before = {0};
    has_file(A, "a", "one", 3);
    log.n = ops;
    struct power_cut *c = power_cut_new(&before, &log);
    for (size_t cut = 0; cut <= ops; cut++) {
        struct tree t = power_cut_none(c, cut);
        CHECK(has(&t, "a") == (cut > 0) && holds(&t, "a", "one") == (cut > 1));
        tree_free(&t);
    }
    power_cut_free(c);
}

/* ---- directories ---- */

static size_t makes_directory(const char *name)
{
    return add((struct power_op){.kind = POWER_MKDIR, .name = name});
}

TEST(power_cut_of_a_renamed_directory_has_its_files_under_the_new_name)
{
    makes_directory("d");
    opens(A, "d/a", NEW_FILE);
    writes(A, 0, "x", 1);
    size_t number = renames("d", "e");
    opens(B, "e/b", NEW_FILE);
    struct tree t = left_after(&(struct losses){.n = 0});
    CHECK(tree_find(&t, "e/a") != NULL && tree_find(&t, "e/b") != NULL);
    CHECK(tree_find(&t, "d") == NULL && tree_find(&t, "d/a") == NULL);
    tree_free(&t);
    t = without((struct loss[]){{number, PART_NAME, 0}, {number, PART_OLD_NAME, 0}}, 2);
    CHECK(tree_find(&t, "d/a") != NULL && tree_find(&t, "d/b") != NULL);
    CHECK(tree_find(&t, "e") == NULL && tree_find(&t, "e/a") == NULL);
    tree_free(&t);
}

TEST(power_cut_of_a_directory_that_was_made_again_has_only_the_new_files)
{
    makes_directory("d");
    opens(A, "d/a", NEW_FILE);
    renames("d", "e");
    makes_directory("d");
    opens(B, "d/b", NEW_FILE);
    struct tree t = left_after(&(struct losses){.n = 0});
    CHECK(tree_find(&t, "e/a") != NULL && tree_find(&t, "e/b") == NULL);
    CHECK(tree_find(&t, "d/b") != NULL && tree_find(&t, "d/a") == NULL);
    tree_free(&t);
}
