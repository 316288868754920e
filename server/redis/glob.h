/* glob.h - patterns of names as Redis has them, for KEYS and SCAN. */
#ifndef SERVER_REDIS_GLOB_H
#define SERVER_REDIS_GLOB_H

#include <stdbool.h>
#include <stddef.h>

enum { GLOB_LIMIT = 256 }; /* bytes of a pattern */

/* Whether the name of n bytes matches pattern[m]: `*` any characters, `?` one, `[abc]`, `[a-z]` and `[^a]` one of those
 * or none of those, `\x` the character x; capitals count. A `[` that is never closed reaches to the end. Cost: at most
 * O(n m), n being at most as long as a set's name. */
bool glob_matches(const char *pattern, size_t m, const char *name, size_t n);

#endif
