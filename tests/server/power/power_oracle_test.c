/* power_oracle_test.c - which states a power cut may leave, by hand: a stream of three changes, of which
 * the first is acknowledged, and sets that some of them have made. */
#include "tests/server/power/power_history.h"
#include "tests/test.h"

#include <string.h>

enum { FIRST = 1, SECOND = 2, THIRD = 4 };

struct scene {
    struct states history;
    struct stream *stream;
    struct registry sets;
    struct dt *dt; /* of the stream's set */
};

static struct request_change adding(double x)
{
    struct request_change c = {.kind = REQUEST_ADD, .n = 1, .points = malloc(sizeof *c.points)};
    CHECK(c.points != NULL);
    c.points[0] = (struct dt_point){x, x};
    return c;
}

static const struct request_change deleting = {.kind = REQUEST_DELETE, .n = 1, .id = {0}};

static void scene_end(struct scene *s)
{
    registry_clear(&s->sets);
    history_clear(&s->history);
}

/* The stream adds a point and then makes the other two changes. */
static void scene_begin(struct scene *s, struct request_change second, struct request_change third)
{
    *s = (struct scene){0};
    history_init(&s->history);
    registry_init(&s->sets);
    s->stream = history_new_stream(&s->history, NULL);
    struct connection *c = history_new_connection(&s->history, 1);
    struct request_change first = adding(1);
    stream_add(s->stream, &first);
    stream_add(s->stream, &second);
    stream_add(s->stream, &third);
    connection_hear(c, s->stream, 0, 10, "OK 0 first=0 added=1 coincident=0");
    history_close(&s->history);
    history_look(&s->history, &(struct power_log){0}, 0, true);
    struct word name = {s->stream->set, strlen(s->stream->set)};
    struct dataset *set = registry_create(&s->sets, &name, 0);
    CHECK(set != NULL);
    set->born = true;
    s->dt = set->current->dt;
}

/* Applies the changes whose bits are set to the set. */
static void carry_out(struct scene *s, unsigned which)
{
    struct model m = {.dt = s->dt};
    char reply[REPLY_BYTES];
    for (int i = 0; i < 3; i++)
        if (which >> i & 1)
            model_apply(&m, &s->stream->sent[i].change, reply);
    CHECK(m.dt == s->dt);
}

static bool allows(struct request_change second, struct request_change third, unsigned which,
                   bool disk_is_full)
{
    struct scene s;
    char why[WHY_BYTES];
    scene_begin(&s, second, third);
    s.history.disk_is_full = disk_is_full;
    carry_out(&s, which);
    bool allowed = history_allows(&s.history, &s.sets, why);
    scene_end(&s);
    return allowed;
}

TEST(power_oracle_allows_a_prefix_that_has_what_was_acknowledged)
{
    for (int full = 0; full < 2; full++) {
        CHECK(allows(adding(2), deleting, FIRST, full));
        CHECK(allows(adding(2), deleting, FIRST | SECOND, full));
        CHECK(allows(adding(2), deleting, FIRST | SECOND | THIRD, full));
    }
}

TEST(power_oracle_requires_what_was_acknowledged_even_when_the_disk_is_full)
{
    for (int full = 0; full < 2; full++) {
        CHECK(!allows(adding(2), adding(3), 0, full));
        CHECK(!allows(adding(2), adding(3), SECOND, full));
        CHECK(!allows(adding(2), adding(3), SECOND | THIRD, full));
    }
}

TEST(power_oracle_allows_that_a_full_disk_refused_an_addition_and_not_the_deletion_after_it)
{
    CHECK(allows(adding(2), deleting, FIRST | THIRD, true));
    CHECK(!allows(adding(2), deleting, FIRST | THIRD, false));
}

TEST(power_oracle_does_not_allow_that_a_full_disk_refused_a_deletion)
{
    CHECK(!allows(deleting, adding(2), FIRST | THIRD, true));
}

/* Assumptions about one moment do not carry over to the next. */
TEST(power_oracle_assumes_refusals_separately_for_each_moment)
{
    struct scene s;
    char why[WHY_BYTES];
    scene_begin(&s, adding(2), deleting);
    s.history.disk_is_full = true;
    carry_out(&s, FIRST | THIRD);
    CHECK(history_allows(&s.history, &s.sets, why) && s.stream->supposed != 0);
    carry_out(&s, SECOND); /* the same as all three in order */
    CHECK(history_allows(&s.history, &s.sets, why) && s.stream->supposed == 0);
    CHECK(s.stream->found == 3);
    carry_out(&s, SECOND);
    CHECK(!history_allows(&s.history, &s.sets, why) && s.stream->supposed == 0);
    scene_end(&s);
}

TEST(power_oracle_begins_the_next_life_with_what_it_found)
{
    struct scene s;
    char why[WHY_BYTES];
    scene_begin(&s, adding(2), deleting);
    s.history.disk_is_full = true;
    carry_out(&s, FIRST | THIRD);
    CHECK(history_allows(&s.history, &s.sets, why));
    history_settle(&s.history, &s.sets);
    history_close(&s.history);
    history_look(&s.history, &(struct power_log){0}, 0, true);
    CHECK(history_allows(&s.history, &s.sets, why) && s.stream->supposed == 0);
    scene_end(&s);
}
