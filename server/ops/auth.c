/* auth.c - see auth.h. */
#include "server/ops/auth.h"

#include "server/ops/limits.h"
#include "server/system/notice.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct token {
    enum role role;
    size_t len;
    char text[LIMIT_TOKEN];
};

static bool add_token(struct auth *a, enum role role, const struct word *w)
{
    struct token *token = realloc(a->token, (a->n + 1) * sizeof *token);
    if (token == NULL)
        return false;
    a->token = token;
    token[a->n] = (struct token){.role = role, .len = w->len};
    memcpy(token[a->n].text, w->text, w->len);
    a->n++;
    return true;
}

static bool take_line(struct auth *a, struct request *words, const char *line)
{
    if (!request_split(words, line, strcspn(line, "\r\n")))
        return false;
    if (words->n == 0 || words->word[0].text[0] == '#')
        return true;
    if (words->n != 2 || words->word[1].len > LIMIT_TOKEN)
        return false;
    if (word_is(&words->word[0], "RW"))
        return add_token(a, ROLE_WRITE, &words->word[1]);
    return word_is(&words->word[0], "RO") && add_token(a, ROLE_READ, &words->word[1]);
}

bool auth_load(struct auth *a, const char *path)
{
    char line[512];
    struct request words = {0};
    unsigned number = 0;
    bool good = true;
    FILE *f = fopen(path, "re");
    *a = (struct auth){0};
    if (f == NULL)
        return notice_error("cannot open %s: %s", path, strerror(errno));
    while (good && fgets(line, sizeof line, f) != NULL) {
        number++;
        good = take_line(a, &words, line);
    }
    fclose(f);
    request_free(&words);
    if (!good)
        notice_error("%s:%u: not a line `ro TOKEN` or `rw TOKEN`", path, number);
    else if (a->n == 0)
        notice_error("%s: holds no token", path);
    if (!good)
        auth_clear(a);
    return a->n > 0;
}

void auth_clear(struct auth *a)
{
    free(a->token);
    *a = (struct auth){0};
}

enum role auth_initial_role(const struct auth *a)
{
    return a->n == 0 ? ROLE_WRITE : ROLE_NONE;
}

static bool equal(const struct token *t, const struct word *w)
{
    unsigned differ = t->len != w->len;
    for (size_t i = 0; i < w->len && i < LIMIT_TOKEN; i++)
        differ |= (unsigned char)t->text[i] ^ (unsigned char)w->text[i];
    return differ == 0;
}

enum role auth_role(const struct auth *a, unsigned number)
{
    return number == 0 ? ROLE_NONE : a->token[number - 1].role;
}

enum role auth_check(const struct auth *a, const struct word *token, unsigned *number)
{
    *number = 0;
    for (size_t i = 0; i < a->n; i++) /* every token is compared, whether or not one has matched */
        if (equal(&a->token[i], token))
            *number = (unsigned)i + 1;
    return auth_role(a, *number);
}

/* ---- after a reload ---- */

static int compare(const struct token *a, const struct token *b)
{
    if (a->len != b->len)
        return a->len < b->len ? -1 : 1;
    return memcmp(a->text, b->text, a->len);
}

/* By text; of equal ones, the last in the file comes first, because its role counts. */
static int compare_sorted(const void *p, const void *q)
{
    const struct token *a = *(const struct token *const *)p, *b = *(const struct token *const *)q;
    int order = compare(a, b);
    return order != 0 ? order : (a < b) - (a > b);
}

/* The first of the n sorted tokens that is not before t; n: there is none. */
static size_t find(const struct token *const *sorted, size_t n, const struct token *t)
{
    size_t low = 0;
    for (size_t high = n; low < high;) {
        size_t middle = low + (high - low) / 2;
        if (compare(sorted[middle], t) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool auth_renumber(const struct auth *now, const struct auth *before, unsigned *number)
{
    const struct token **sorted = malloc((now->n + 1) * sizeof(const struct token *));
    if (sorted == NULL)
        return false;
    for (size_t i = 0; i < now->n; i++)
        sorted[i] = &now->token[i];
    qsort(sorted, now->n, sizeof(const struct token *), compare_sorted);
    for (size_t i = 0; i < before->n; i++) {
        size_t at = find(sorted, now->n, &before->token[i]);
        bool found = at < now->n && compare(sorted[at], &before->token[i]) == 0;
        number[i] = found ? (unsigned)(sorted[at] - now->token) + 1 : 0;
    }
    free(sorted);
    return true;
}
