/* before_images.h - the values that keys had at earlier moments. They serve readers of an earlier state while the present state
 * changes [Reed 1978: versions of an object by time; the before-images of databases].
 *
 * A before-image is the value of a key as it was until an edit changed it. Images are one after the
 * other in the order in which they were saved, and a moment is a place in that order:
 *
 *      key     | 7 | 3 | 9 |   | 7 | 5 | 3 |   | 7 |
 *                          ^                   ^     ^
 *                          moment 3            7     9: now
 *
 * At a moment a key had the value of its first image that was saved from that moment on. Key 7 at moment 3 had the value
 * of the image at 4; at moment 7 it had the value of the image at 8. A key without such an image still has its present
 * value. So all readers share all images. Before a key is changed, an image must be saved only if there is none since
 * the latest moment that is read.
 *
 * Every image knows how far back the previous image of the same key lies, and a map has the newest image of every key.
 * Keys are ids or about as dense, so this map takes at most about the memory of the map of ids. Images are in chunks; a
 * chunk is freed, and its keys leave the map, when no moment before its end is read any more. A link to a freed chunk
 * leads to before all moments that are read, so it is never followed.
 *
 * Knows keys and words only. Functions that take a const struct may run in several threads at once. */
#pragma once

#include "core/points/idmap.h"

/* Start with {0}. */
struct dt_images {
    struct dt_idmap newest; /* key -> where its newest image lies, modulo 2^32 */
    uint32_t **chunk;       /* owns `cap`, of which [head, chunks) are in use */
    size_t head, chunks, cap;
    uint64_t first; /* where the first chunk that is there begins, in words */
    uint64_t end;   /* where the next image will lie at the earliest: now */
    size_t memory;  /* bytes of the chunks */
};

void dt_images_clear(struct dt_images *s);
size_t dt_images_memory(const struct dt_images *s);

static inline uint64_t dt_images_now(const struct dt_images *s)
{
    return s->end;
}

static inline bool dt_images_is_empty(const struct dt_images *s)
{
    return s->chunks == s->head;
}

/* The place of the newest image of a key, given the map's value of the key, which is not DT_NONE. */
static inline uint64_t dt_images_place(const struct dt_images *s, uint32_t value)
{
    return s->end - (uint32_t)((uint32_t)s->end - value);
}

/* Whether an image of the key has been saved at or after the moment. */
static inline bool dt_images_has(const struct dt_images *s, uint32_t key, uint64_t moment)
{
    uint32_t value = dt_idmap_get(&s->newest, key);
    return value != DT_NONE && dt_images_place(s, value) >= moment;
}

/* Saves an image of the key: returns room for that many words, to be written by the caller before anything else
 * happens to the images. NULL: out of memory. Cost: constant, amortised. */
uint32_t *dt_images_save(struct dt_images *s, uint32_t key, uint32_t words);

/* The value of the key at the moment, *words of them (may be NULL). NULL: the value has not changed since that moment.
 * Cost: the images of the key since that moment. */
const uint32_t *dt_images_get(const struct dt_images *s, uint32_t key, uint64_t moment,
                              uint32_t *words);

/* Frees the first chunk, if no moment before its end is read any more (`oldest` is; UINT64_MAX: none), or, if none
 * is, first a part of the map. Returns whether it did. At the end nothing is left. Cost: the images of the chunk,
 * of 16 KiB unless it has one image only. */
bool dt_images_trim(struct dt_images *s, uint64_t oldest);
