/* before_images_test.c - values of keys at earlier moments, compared with copies of all values at each
 * moment. */
#include <stdlib.h>
#include <string.h>

#include "core/set/before_images.h"
#include "tests/test.h"

enum { KEYS = 60, MOMENTS = 8, MOST_WORDS = 12 };

/* A value is a number and how many words it has, each of them that number plus its place. */
struct values {
    uint32_t number[KEYS], words[KEYS];
};

struct world {
    struct dt_images s;
    struct values now;
    struct values then[MOMENTS];
    uint64_t moment[MOMENTS];
    bool read[MOMENTS];
    uint64_t since; /* the latest moment that is read; 0 and none: nothing is saved */
    bool any;
};

static void begin(struct world *w, uint32_t i)
{
    w->then[i] = w->now;
    w->moment[i] = dt_images_now(&w->s);
    w->read[i] = true;
}

/* As an edit does it. */
static void look_round(struct world *w)
{
    uint64_t oldest = UINT64_MAX;
    w->any = false;
    w->since = 0;
    for (uint32_t i = 0; i < MOMENTS; i++) {
        if (!w->read[i])
            continue;
        w->any = true;
        w->since = w->moment[i] > w->since ? w->moment[i] : w->since;
        oldest = w->moment[i] < oldest ? w->moment[i] : oldest;
    }
    while (test_below(2) && dt_images_trim(&w->s, oldest))
        ;
}

static void change(struct world *w, uint32_t key)
{
    if (w->any && !dt_images_has(&w->s, key, w->since)) {
        uint32_t *image = dt_images_save(&w->s, key, w->now.words[key]);
        CHECK(image != NULL);
        for (uint32_t i = 0; i < w->now.words[key]; i++)
            image[i] = w->now.number[key] + i;
    }
    w->now.number[key] = (uint32_t)test_random();
    w->now.words[key] = test_below(300) == 0 ? test_below(20000) : test_below(MOST_WORDS);
}

static void check(const struct world *w, uint32_t moment)
{
    for (uint32_t key = 0; key < KEYS; key++) {
        uint32_t words = w->now.words[key], number = w->now.number[key];
        const uint32_t *image = dt_images_get(&w->s, key, w->moment[moment], &words);
        for (uint32_t i = 0; image != NULL && i < words; i++)
            CHECK(image[i] == w->then[moment].number[key] + i);
        CHECK(image != NULL || number == w->then[moment].number[key]);
        CHECK(words == w->then[moment].words[key]);
    }
}

static void run(struct world *w, unsigned steps)
{
    for (unsigned step = 0; step < steps; step++) {
        uint32_t i = test_below(MOMENTS);
        switch (test_below(8)) {
        case 0:
            if (!w->read[i])
                begin(w, i);
            break;
        case 1:
            w->read[i] = test_below(step % 500 < 100 ? 1 : 9) != 0 && w->read[i];
            break;
        case 2:
            if (w->read[i])
                check(w, i);
            break;
        default:
            look_round(w);
            for (uint32_t n = test_below(40); n > 0; n--)
                change(w, test_below(test_below(KEYS) + 1));
        }
    }
}

TEST(images_give_every_moment_its_values_as_long_as_it_is_read)
{
    for (unsigned round = 0; round < 6; round++) {
        static struct world w;
        memset(&w, 0, sizeof w);
        run(&w, 4000);
        dt_images_clear(&w.s);
        CHECK(dt_images_memory(&w.s) == 0 && dt_images_is_empty(&w.s));
    }
}

TEST(unused_images_are_freed_chunk_by_chunk_from_the_oldest)
{
    struct dt_images s = {0};
    uint64_t middle = 0;
    for (uint32_t key = 0; key < 20000; key++) {
        middle = key == 10000 ? dt_images_now(&s) : middle;
        CHECK(dt_images_save(&s, key, 5) != NULL);
    }
    size_t all = dt_images_memory(&s);
    CHECK(!dt_images_trim(&s, 0));
    while (dt_images_trim(&s, middle))
        ;
    CHECK(dt_images_memory(&s) < all * 6 / 10);
    CHECK(!dt_images_has(&s, 5000, 0) && dt_images_get(&s, 5000, 0, NULL) == NULL);
    CHECK(dt_images_has(&s, 10000, middle) && dt_images_get(&s, 10000, middle, NULL) != NULL);
    CHECK(dt_idmap_next(&s.newest, 0) <= 10000 && dt_idmap_next(&s.newest, 0) > 9000);
    while (dt_images_trim(&s, UINT64_MAX))
        ;
    CHECK(dt_images_memory(&s) == 0);
}

TEST(images_that_no_moment_reads_go_bit_by_bit_until_nothing_is_left)
{
    struct dt_images s = {0};
    for (uint32_t key = 0; key < 50000; key++)
        CHECK(dt_images_save(&s, key * 100, 5) != NULL);
    uint64_t now = dt_images_now(&s);
    unsigned calls = 0;
    for (size_t left = dt_images_memory(&s); dt_images_trim(&s, UINT64_MAX); calls++) {
        CHECK(dt_images_memory(&s) < left && !dt_images_has(&s, 4999900, now));
        left = dt_images_memory(&s);
    }
    CHECK(calls > 90 && dt_images_memory(&s) == 0 && dt_images_now(&s) >= now);
}

TEST(images_are_as_before_when_memory_runs_out)
{
    for (long n = 1;; n++) {
        struct dt_images s = {0};
        uint32_t saved = 0, words;
        bool failed = false;
        test_fail_alloc(n);
        while (saved < 30) { /* some of them larger than a chunk */
            uint32_t *image = dt_images_save(&s, saved * 5000, saved % 7 * 1000);
            failed = failed || image == NULL;
            for (uint32_t i = 0; image != NULL && i < saved % 7 * 1000; i++)
                image[i] = saved;
            saved += image != NULL;
        }
        CHECK(failed == test_alloc_failed());
        test_fail_alloc(0);
        for (uint32_t i = 0; i < saved; i++) {
            const uint32_t *image = dt_images_get(&s, i * 5000, 0, &words);
            CHECK(image != NULL && words == i % 7 * 1000 && (words == 0 || image[words - 1] == i));
        }
        while (dt_images_trim(&s, UINT64_MAX))
            ;
        dt_images_clear(&s);
        CHECK(dt_images_memory(&s) == 0);
        if (!failed)
            break;
    }
}
