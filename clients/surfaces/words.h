/* words.h - the words of a row of a reply, between blanks. */
#ifndef CLIENTS_WORDS_H
#define CLIENTS_WORDS_H

#include <stddef.h>

/* The rest of the row: s .. end. */
struct words {
    const char *s, *end;
};

/* The length of the next word, which begins at *word; 0 at the end of the row. */
static inline size_t words_next(struct words *w, const char **word)
{
    while (w->s < w->end && *w->s == ' ')
        w->s++;
    *word = w->s;
    while (w->s < w->end && *w->s != ' ')
        w->s++;
    return (size_t)(w->s - *word);
}

#endif
