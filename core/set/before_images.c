/* before_images.c - see before_images.h.
 *
 *      place      first                                                        end
 *                 |                                                             |
 *      chunk    [ image image .. ][ a large image            ][ image ..        ]
 *                 4096 words        NULL for each 4096 more
 *
 * An image has a header of three words: its key, the distance back to the previous image, and the length of its value.
 * Both are in words. The distance leads to the previous image of that key; 0: none that counts. */
#include "core/set/before_images.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/memory.h"

enum { CHUNK = 4096, KEY = 0, BACK = 1, WORDS = 2, HEADER = 3 };
enum { DROPPED = 16 }; /* pages of the map dropped at a time when no image is read any more */

void dt_images_clear(struct dt_images *s)
{
    for (size_t i = s->head; i < s->chunks; i++)
        free(s->chunk[i]);
    dt_array_free(s->chunk);
    dt_idmap_clear(&s->newest);
    uint64_t end = (s->end + CHUNK - 1) / CHUNK * CHUNK; /* moments do not go back */
    *s = (struct dt_images){.first = end, .end = end};
}

size_t dt_images_memory(const struct dt_images *s)
{
    return s->memory + s->cap * sizeof *s->chunk + dt_idmap_memory(&s->newest);
}

static uint32_t *image_at(const struct dt_images *s, uint64_t place)
{
    return s->chunk[s->head + (size_t)((place - s->first) / CHUNK)] + place % CHUNK;
}

/* ---- saving ---- */

/* Makes room in the table for n more chunks. */
static bool reserve_table(struct dt_images *s, size_t n)
{
    if (s->chunks + n <= s->cap)
        return true;
    size_t used = s->chunks - s->head;
    if (s->head >= used + n) { /* half of it is free at the front */
        memmove(s->chunk, s->chunk + s->head, used * sizeof *s->chunk);
    } else {
        size_t cap = dt_array_room(s->cap, s->chunks + n, SIZE_MAX);
        if (!dt_array_resize(NULL, &s->chunk, s->chunks, cap, sizeof *s->chunk))
            return false;
        s->cap = cap;
        memmove(s->chunk, s->chunk + s->head, used * sizeof *s->chunk);
    }
    s->chunks = used;
    s->head = 0;
    return true;
}

/* The place for an image of `words` words: after the last one, or in a new chunk. False: out of memory. */
static bool make_room(struct dt_images *s, size_t words, uint64_t *place)
{
    uint64_t room = s->first + (s->chunks - s->head) * (uint64_t)CHUNK - s->end;
    *place = s->end;
    if (words <= room)
        return true;
    size_t n = (words + CHUNK - 1) / CHUNK;
    if (s->end + room + n * CHUNK - s->first > UINT32_MAX || !reserve_table(s, n))
        return false; /* or a place is too far away for 32 bits: 16 GiB of images */
    uint32_t *chunk = malloc(n * CHUNK * sizeof *chunk);
    if (chunk == NULL)
        return false;
    if (room > 0)
        image_at(s, s->end)[KEY] = DT_NONE; /* the rest is left empty */
    *place = s->end + room;
    s->chunk[s->chunks++] = chunk;
    while (--n > 0)
        s->chunk[s->chunks++] = NULL;
    s->memory += (words + CHUNK - 1) / CHUNK * CHUNK * sizeof *chunk;
    s->end = *place;
    return true;
}

uint32_t *dt_images_save(struct dt_images *s, uint32_t key, uint32_t words)
{
    uint32_t value = dt_idmap_get(&s->newest, key);
    uint64_t place, before = dt_images_place(s, value);
    if (dt_idmap_reserve(&s->newest, key, 1) != DT_OK ||
        !make_room(s, HEADER + (size_t)words, &place))
        return NULL;
    dt_idmap_set(&s->newest, key, (uint32_t)place); /* not DT_NONE: a header fits behind it */
    uint32_t *image = image_at(s, place);
    image[KEY] = key;
    image[BACK] = value != DT_NONE ? (uint32_t)(place - before) : 0;
    image[WORDS] = words;
    /* The rest of the last chunk of a large image stays empty. */
    s->end = HEADER + (size_t)words <= CHUNK ? place + HEADER + words
                                             : s->first + (s->chunks - s->head) * (uint64_t)CHUNK;
    return image + HEADER;
}

/* ---- reading ---- */

const uint32_t *dt_images_get(const struct dt_images *s, uint32_t key, uint64_t moment,
                              uint32_t *words)
{
    uint32_t value = dt_idmap_get(&s->newest, key);
    if (value == DT_NONE)
        return NULL;
    uint64_t place = dt_images_place(s, value);
    if (place < moment)
        return NULL;
    const uint32_t *image = image_at(s, place);
    while (image[BACK] != 0 && place - image[BACK] >= moment) {
        place -= image[BACK];
        image = image_at(s, place);
    }
    if (words != NULL)
        *words = image[WORDS];
    return image + HEADER;
}

/* ---- freeing ---- */

/* The keys whose newest image lies in the first chunk leave the map. */
static void forget_keys(struct dt_images *s)
{
    const uint32_t *chunk = s->chunk[s->head];
    for (uint32_t at = 0; at < CHUNK && s->first + at < s->end && chunk[at + KEY] != DT_NONE;) {
        const uint32_t *image = chunk + at;
        if (dt_idmap_get(&s->newest, image[KEY]) == (uint32_t)(s->first + at))
            dt_idmap_unset(&s->newest, image[KEY]);
        if (image[WORDS] > CHUNK - HEADER)
            return;
        at += HEADER + image[WORDS];
    }
}

static size_t size_of_first(const struct dt_images *s)
{
    size_t n = 1;
    while (s->head + n < s->chunks && s->chunk[s->head + n] == NULL)
        n++;
    return n;
}

bool dt_images_trim(struct dt_images *s, uint64_t oldest)
{
    if (oldest == UINT64_MAX && dt_idmap_drop(&s->newest, DROPPED))
        return true;
    size_t n = size_of_first(s);
    if (dt_images_is_empty(s) || (oldest != UINT64_MAX && s->first + n * CHUNK > oldest))
        return false;
    if (oldest != UINT64_MAX)
        forget_keys(s);
    dt_idmap_trim(&s->newest);
    free(s->chunk[s->head]);
    s->head += n;
    s->first += n * CHUNK;
    s->memory -= n * CHUNK * sizeof **s->chunk;
    if (dt_images_is_empty(s))
        dt_images_clear(s);
    return true;
}
