/* replay_test.c - records that contradict the records before them: each is refused, and running out
 * of memory is not mistaken for that. */
#include "server/disk/replay.h"

#include "core/delaunay_fields.h"
#include "tests/test.h"

#include <math.h>
#include <string.h>

/* A record as it is read from a file; they live until the process ends. */
static struct record read_back(struct record r)
{
    static struct buf kept[100];
    static unsigned n;
    CHECK(n < sizeof kept / sizeof kept[0]);
    struct buf *b = &kept[n++];
    r.name_len = r.name != NULL ? (unsigned)strlen(r.name) : 0;
    record_write(b, &r);
    CHECK(record_read(buf_head(b), buf_len(b), &r) > 0);
    return r;
}

static struct record about(const char *name, enum record_type type, uint64_t lsn)
{
    return (struct record){.lsn = lsn, .type = type, .name = name};
}

/* n points on a line from the id `first` on. */
static struct record points(const char *name, enum record_type type, uint64_t lsn, uint32_t first,
                            uint32_t n)
{
    static double xy[2 * RECORD_POINTS];
    struct record r = about(name, type, lsn);
    for (uint32_t i = 0; i < n; i++)
        xy[2 * i] = first + i;
    r.first = first;
    r.n = n;
    r.items = xy;
    return r;
}

static bool takes(struct replay *p, struct record r)
{
    struct record read = read_back(r);
    return replay_log(p, &read) == NULL;
}

static bool takes_of_snapshot(struct replay *p, struct record r)
{
    struct record read = read_back(r);
    return replay_snapshot(p, &read) == NULL;
}

static struct dataset *find(const struct replay *p, const char *name)
{
    return registry_find(&p->sets, &(struct word){name, strlen(name)});
}

/* With a set t of the points 0 to 2. */
static void begin(struct replay *p)
{
    replay_init(p);
    CHECK(takes(p, points("t", RECORD_ADD, 1, 0, 3)));
}

/* ---- the log ---- */

TEST(set_is_created_once_with_a_name_and_a_tolerance_that_it_may_have)
{
    struct replay p;
    begin(&p);
    struct record r = about("t", RECORD_CREATE, 2);
    CHECK(!takes(&p, r) && p.sets.sets == 1);
    r.name = "a b";
    CHECK(!takes(&p, r));
    r.name = "u";
    r.a = -1;
    CHECK(!takes(&p, r));
    r.a = 1e300;
    CHECK(!takes(&p, r) && p.sets.sets == 1);
    r.a = 0.5;
    CHECK(takes(&p, r) && p.sets.sets == 2);
    CHECK(!p.out_of_memory);
    replay_clear(&p);
}

/* Replay does not look at the clock: only a RECORD_DROP drops a set. */
TEST(time_of_a_set_is_restored_and_nothing_is_dropped)
{
    static const double bad[] = {-1, 1e17, (double)NAN, HUGE_VAL};
    struct replay p;
    begin(&p);
    struct record r = about("t", RECORD_EXPIRE, 2);
    r.a = 1;
    CHECK(takes(&p, r) && find(&p, "t")->expires_ms == 1 && p.sets.expiring == 1);
    r.lsn = 3;
    r.a = 0;
    CHECK(takes(&p, r) && find(&p, "t")->expires_ms == 0 && p.sets.expiring == 0);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        r.lsn = 4;
        r.a = bad[i];
        CHECK(!takes(&p, r));
    }
    replay_clear(&p);
    replay_init(&p);
    r = about("t", RECORD_SET, 1);
    r.b = 5;
    CHECK(takes_of_snapshot(&p, r) && find(&p, "t")->expires_ms == 5 && p.sets.expiring == 1);
    CHECK(takes(&p, about("t", RECORD_DROP, 9)) && p.sets.expiring == 0);
    replay_clear(&p);
}

TEST(change_of_a_set_that_is_not_there_is_refused)
{
    static const enum record_type types[] = {RECORD_DROP, RECORD_TRIANGULATE, RECORD_DELETE,
                                             RECORD_MOVE, RECORD_EXPIRE};
    struct replay p;
    begin(&p);
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        CHECK(!takes(&p, about("u", types[i], 2)));
    CHECK(!takes(&p, points("u", RECORD_ADD, 2, 1, 1)) && p.sets.sets == 1);
    replay_clear(&p);
}

TEST(edit_that_the_core_refuses_is_refused)
{
    static const double far[] = {1e300, 0};
    struct replay p;
    begin(&p);
    struct record r = about("t", RECORD_MOVE, 2);
    r.first = 7; /* there is no such point */
    CHECK(!takes(&p, r) && !p.out_of_memory);
    r = points("t", RECORD_ADD, 2, 3, 1);
    r.items = far;
    CHECK(!takes(&p, r) && !p.out_of_memory);
    r.name = "u"; /* which is not created for that */
    r.first = 0;
    CHECK(!takes(&p, r) && p.sets.sets == 1);
    CHECK(find(&p, "t")->current->lsn == 1);
    replay_clear(&p);
}

static struct record load(uint64_t lsn, uint32_t first, uint32_t n)
{
    struct record r = points("t", RECORD_LOAD, lsn, first, 0);
    r.n = n;
    return r;
}

static struct record loaded(uint64_t lsn, uint32_t n)
{
    struct record r = about("t", RECORD_LOADED, lsn);
    r.n = n;
    return r;
}

TEST(load_is_taken_as_a_whole)
{
    struct replay p;
    begin(&p);
    CHECK(takes(&p, load(2, 3, 2)) && takes(&p, points(NULL, RECORD_CHUNK, 3, 3, 1)));
    CHECK(takes(&p, points(NULL, RECORD_CHUNK, 4, 4, 1)) && replay_in_load(&p));
    CHECK(dt_next_id(find(&p, "t")->current->dt) == 3);
    CHECK(takes(&p, loaded(5, 2)) && !replay_in_load(&p));
    CHECK(dt_next_id(find(&p, "t")->current->dt) == 5 && find(&p, "t")->current->lsn == 5);
    replay_clear(&p);
}

TEST(load_that_has_lost_points_is_refused)
{
    for (uint32_t n = 1; n <= 3; n += 2) {
        struct replay p;
        begin(&p);
        CHECK(takes(&p, load(2, 3, n)) && takes(&p, points(NULL, RECORD_CHUNK, 3, 3, 2)));
        CHECK(!takes(&p, loaded(4, n)) && dt_next_id(find(&p, "t")->current->dt) == 3);
        replay_clear(&p);
    }
}

TEST(records_of_a_load_belong_together)
{
    struct replay p;
    begin(&p);
    CHECK(!takes(&p, points(NULL, RECORD_CHUNK, 2, 3, 1)) && !takes(&p, loaded(2, 0)));
    CHECK(takes(&p, load(2, 3, 1)));
    CHECK(!takes(&p, load(3, 3, 1)));
    CHECK(!takes(&p, about("t", RECORD_TRIANGULATE, 3)) && !find(&p, "t")->triangulated);
    CHECK(!takes(&p, points("t", RECORD_ADD, 3, 3, 1)));
    replay_clear(&p);
}

TEST(load_that_the_snapshot_has_is_passed_over_as_a_whole)
{
    struct replay p;
    begin(&p);
    p.snapshot = 4;
    CHECK(takes(&p, load(2, 3, 1)) && takes(&p, points(NULL, RECORD_CHUNK, 3, 3, 1)));
    CHECK(takes(&p, loaded(4, 1)) && !replay_in_load(&p));
    CHECK(dt_next_id(find(&p, "t")->current->dt) == 3);
    CHECK(takes(&p, points("t", RECORD_ADD, 5, 3, 1)));
    replay_clear(&p);
}

/* ---- a snapshot ---- */

static struct record set_of(const char *name, uint32_t rows)
{
    struct record r = about(name, RECORD_SET, 1);
    r.n = r.first = rows;
    return r;
}

static struct record rows(uint32_t from, uint32_t n)
{
    static struct record_row row[RECORD_POINTS];
    for (uint32_t i = 0; i < n; i++)
        row[i] = (struct record_row){.id = from + i, .representative = from + i, .x = from + i};
    return (struct record){.type = RECORD_ROWS, .n = n, .items = row};
}

static struct record end_of(uint32_t sets)
{
    return (struct record){.type = RECORD_END, .n = sets};
}

TEST(snapshot_has_the_rows_and_the_sets_that_it_announces)
{
    struct replay p;
    replay_init(&p);
    CHECK(!takes_of_snapshot(&p, rows(0, 1)));
    CHECK(takes_of_snapshot(&p, set_of("t", 3)));
    CHECK(!takes_of_snapshot(&p, set_of("u", 0)) && !takes_of_snapshot(&p, end_of(1)));
    CHECK(takes_of_snapshot(&p, rows(0, 1)) && takes_of_snapshot(&p, rows(1, 1)));
    CHECK(dt_next_id(find(&p, "t")->current->dt) == 0 && !takes_of_snapshot(&p, end_of(1)));
    CHECK(!takes_of_snapshot(&p, rows(2, 2)) && takes_of_snapshot(&p, rows(2, 1)));
    CHECK(dt_next_id(find(&p, "t")->current->dt) == 3);
    CHECK(!takes_of_snapshot(&p, rows(3, 1)) && !takes_of_snapshot(&p, set_of("t", 0)));
    CHECK(takes_of_snapshot(&p, set_of("u", 0)));
    CHECK(!takes_of_snapshot(&p, end_of(1)) && !takes_of_snapshot(&p, end_of(3)) && !p.ended);
    CHECK(takes_of_snapshot(&p, end_of(2)) && p.ended);
    CHECK(!takes_of_snapshot(&p, set_of("v", 0)) && !takes_of_snapshot(&p, end_of(2)));
    CHECK(p.sets.sets == 2 && !p.out_of_memory);
    replay_clear(&p);
}

/* ---- fields ---- */

static const double heights[] = {1.5, -2, 7};

/* Three values of field z from the id `first` on. */
static struct record values(const char *name, uint64_t lsn, uint32_t first)
{
    struct record r = about(name, RECORD_VALUES, lsn);
    r.first = first;
    r.n = 3;
    r.items = heights;
    r.field = "z";
    r.field_len = 1;
    return r;
}

static struct record pair(uint64_t lsn, uint32_t id, const char *field)
{
    static struct record_value v;
    struct record r = about("t", RECORD_FSET, lsn);
    v = (struct record_value){id, 0.25};
    r.n = 1;
    r.items = &v;
    r.field = field;
    r.field_len = strlen(field);
    return r;
}

static struct record drop_field(uint64_t lsn, const char *field)
{
    struct record r = about("t", RECORD_FDROP, lsn);
    r.field = field;
    r.field_len = strlen(field);
    return r;
}

static double height(const struct replay *p, uint32_t id)
{
    double v;
    const struct dt_field *f = dt_field_find(find(p, "t")->current->dt, "z", 1);
    CHECK(f != NULL);
    dt_field_values(f, NULL, &id, 1, &v);
    return v;
}

TEST(values_are_set_and_fields_dropped_where_their_records_make_sense)
{
    struct replay p;
    begin(&p);
    CHECK(takes(&p, values("t", 2, 0)) && height(&p, 0) == 1.5 && height(&p, 2) == 7);
    CHECK(takes(&p, pair(3, 1, "z")) && height(&p, 1) == 0.25);
    CHECK(!takes(&p, values("t", 4, 1)) && !takes(&p, pair(4, 3, "z"))); /* no point 3 */
    CHECK(!takes(&p, values("u", 4, 0)) && !takes(&p, values(NULL, 4, 0)));
    CHECK(!takes(&p, pair(4, 0, "")) && !takes(&p, pair(4, 0, "9")) && height(&p, 0) == 1.5);
    CHECK(!takes(&p, drop_field(4, "y")) && find(&p, "t")->current->lsn == 3);
    CHECK(takes(&p, drop_field(4, "z")) && !takes(&p, drop_field(5, "z")));
    CHECK(!p.out_of_memory);
    replay_clear(&p);
}

TEST(values_of_a_load_count_when_it_is_complete)
{
    struct replay p;
    begin(&p);
    CHECK(takes(&p, load(2, 3, 3)) && takes(&p, points(NULL, RECORD_CHUNK, 3, 3, 3)));
    CHECK(takes(&p, values(NULL, 4, 3)) && !takes(&p, values("t", 5, 0)));
    CHECK(dt_field_next(find(&p, "t")->current->dt, NULL, NULL) == NULL);
    CHECK(takes(&p, loaded(5, 3)) && height(&p, 3) == 1.5 && height(&p, 5) == 7);
    CHECK(takes(&p, load(6, 6, 0)) && takes(&p, values(NULL, 7, 0)) && takes(&p, loaded(8, 0)));
    CHECK(height(&p, 0) == 1.5 && takes(&p, drop_field(9, "z")));
    CHECK(takes(&p, load(10, 6, 0)) && takes(&p, values(NULL, 11, 0)));
    replay_abandon_load(&p); /* a torn end */
    CHECK(takes(&p, load(10, 6, 0)) && takes(&p, loaded(11, 0)));
    CHECK(dt_field_next(find(&p, "t")->current->dt, NULL, NULL) == NULL);
    replay_clear(&p);
}

static struct record set_with_fields(uint32_t n)
{
    struct record r = set_of("t", n);
    r.flags = RECORD_HAS_FIELDS;
    return r;
}

TEST(values_in_a_snapshot_follow_the_rows_of_their_set)
{
    struct replay p;
    struct record set_end = about(NULL, RECORD_SET_END, 1);
    replay_init(&p);
    CHECK(!takes_of_snapshot(&p, values(NULL, 1, 0)) && !takes_of_snapshot(&p, set_end));
    CHECK(takes_of_snapshot(&p, set_with_fields(3)) && !takes_of_snapshot(&p, values(NULL, 1, 0)));
    CHECK(!takes_of_snapshot(&p, set_end) && takes_of_snapshot(&p, rows(0, 3)));
    CHECK(!takes_of_snapshot(&p, rows(3, 1)) && takes_of_snapshot(&p, values(NULL, 1, 0)));
    CHECK(!takes_of_snapshot(&p, values(NULL, 1, 1)) && height(&p, 2) == 7);
    CHECK(!takes_of_snapshot(&p, end_of(1)) && !takes_of_snapshot(&p, set_of("u", 0)));
    CHECK(takes_of_snapshot(&p, set_end) && !takes_of_snapshot(&p, values(NULL, 1, 0)));
    CHECK(takes_of_snapshot(&p, set_of("u", 0)) && !takes_of_snapshot(&p, values(NULL, 1, 0)));
    CHECK(!takes_of_snapshot(&p, set_end) && takes_of_snapshot(&p, end_of(2)) && p.ended);
    replay_clear(&p);
}

TEST(set_that_is_lost_after_its_rows_is_dropped)
{
    struct replay p;
    replay_init(&p);
    CHECK(takes_of_snapshot(&p, set_with_fields(3)) && takes_of_snapshot(&p, rows(0, 3)));
    replay_abandon_set(&p);
    CHECK(p.sets.sets == 0 && takes_of_snapshot(&p, set_of("t", 0)));
    replay_clear(&p);
}

/* ---- memory ---- */

/* Applies all of it with the n-th allocation failing; whether one did. */
static bool survives(const struct record *r, size_t records, bool snapshot, long n)
{
    struct replay p;
    bool good = true;
    replay_init(&p);
    test_guard_alloc(true); /* nothing is written beyond what there was memory for */
    test_fail_alloc(n);
    for (size_t i = 0; i < records && good; i++)
        good = (snapshot ? replay_snapshot(&p, &r[i]) : replay_log(&p, &r[i])) == NULL;
    bool failed = test_alloc_failed();
    test_fail_alloc(0);
    CHECK_MSG(good || (failed && p.out_of_memory), "allocation %ld", n);
    CHECK_MSG(!good || dt_next_id(find(&p, "t")->current->dt) == 70, "allocation %ld", n);
    replay_clear(&p);
    test_guard_alloc(false);
    return failed;
}

TEST(memory_that_runs_out_is_no_fault_of_a_record)
{
    static const uint32_t ids[] = {1, 2};
    struct record deleted = about("t", RECORD_DELETE, 8);
    deleted.n = 2;
    deleted.items = ids;
    const struct record log[] = {
        read_back(about("t", RECORD_CREATE, 1)),
        read_back(points("t", RECORD_ADD, 2, 0, 20)),
        read_back(load(3, 20, 50)),
        read_back(points(NULL, RECORD_CHUNK, 4, 20, 25)),
        read_back(points(NULL, RECORD_CHUNK, 5, 45, 25)),
        read_back(values(NULL, 6, 20)),
        read_back(loaded(7, 50)),
        read_back(deleted),
        read_back(values("t", 9, 30)),
        read_back(pair(10, 31, "y")),
        read_back(drop_field(11, "z")),
    };
    const struct record snapshot[] = {
        read_back(set_with_fields(70)), read_back(rows(0, 20)),
        read_back(rows(20, 25)),        read_back(rows(45, 25)),
        read_back(values(NULL, 5, 67)), read_back(about(NULL, RECORD_SET_END, 6)),
        read_back(end_of(1)),
    };
    long n = 1;
    while (survives(log, sizeof log / sizeof log[0], false, n))
        n++;
    CHECK(n > 5);
    for (n = 1; survives(snapshot, sizeof snapshot / sizeof snapshot[0], true, n);)
        n++;
    CHECK(n > 5);
}
