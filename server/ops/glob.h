/* glob.h - patterns of names as Redis has them, for KEYS, SCAN and CONFIG GET. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { GLOB_LIMIT = 256 }; /* bytes of a pattern of KEYS and SCAN */

enum glob_case { GLOB_CASED, GLOB_CASELESS };

/* Whether the name of n bytes matches pattern[m]: `*` any characters, `?` one, `[abc]`, `[a-z]` and `[^a]` one of those
 * or none of those, `\x` the character x; capitals count if GLOB_CASED. A `[` that is never closed reaches to the end. Cost: at most
 * O(n m), n being at most as long as a set's name. */
bool glob_matches(const char *pattern, size_t m, const char *name, size_t n, enum glob_case how);
