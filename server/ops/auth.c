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
    if (f == NULL) {
        notice(NOTICE_ERROR, "cannot open %s: %s", path, strerror(errno));
        return false;
    }
    while (good && fgets(line, sizeof line, f) != NULL) {
        number++;
        good = take_line(a, &words, line);
    }
    fclose(f);
    request_free(&words);
    if (!good)
        notice(NOTICE_ERROR, "%s:%u: not a line `ro TOKEN` or `rw TOKEN`", path, number);
    else if (a->n == 0)
        notice(NOTICE_ERROR, "%s: holds no token", path);
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

enum role auth_check(const struct auth *a, const struct word *token, unsigned *number)
{
    *number = 0;
    for (size_t i = 0; i < a->n; i++) /* every token is compared, whether or not one has matched */
        if (equal(&a->token[i], token))
            *number = (unsigned)i + 1;
    return *number == 0 ? ROLE_NONE : a->token[*number - 1].role;
}

enum role auth_renew(const struct auth *now, const struct auth *before, unsigned *number)
{
    if (*number == 0)
        return ROLE_NONE;
    const struct token *t = &before->token[*number - 1];
    return auth_check(now, &(struct word){t->text, t->len}, number);
}
