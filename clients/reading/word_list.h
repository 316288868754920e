/* word_list.h - lists of words in one text, with a blank between them: "x y z". */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

/* The next word of *list, with its length; NULL at the end. */
static inline const char *word_list_next(const char **list, size_t *len)
{
    const char *word = *list;
    *len = strcspn(word, " ");
    *list = word + *len + (word[*len] == ' ');
    return *len > 0 ? word : NULL;
}

static inline bool word_list_has(const char *list, const char *text, size_t len)
{
    size_t n;
    for (const char *word; (word = word_list_next(&list, &n)) != NULL;)
        if (n == len && memcmp(word, text, n) == 0)
            return true;
    return false;
}

/* Whether the text is longer than one of the words and ends with it, in capitals or not. */
static inline bool word_list_has_end(const char *list, const char *text, size_t len)
{
    size_t n;
    for (const char *word; (word = word_list_next(&list, &n)) != NULL;)
        if (n < len && strncasecmp(word, text + len - n, n) == 0)
            return true;
    return false;
}
