/* line_editor.c - see line_editor.h. The Makefile defines HAVE_EDITLINE or HAVE_READLINE, whose interfaces are the same as far as
 * they are used here. */
#include "clients/cli/line_editor.h"

#include <errno.h>
#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#if defined(HAVE_EDITLINE) || defined(HAVE_READLINE)
#include <sys/stat.h>
#ifdef HAVE_EDITLINE
#include <editline/readline.h>
#else
#include <readline/history.h>
#include <readline/readline.h>
#endif

#include "clients/cli/subcommand.h"

enum { HISTORY = 1000, MOST_SETS = 2000 };

static struct {
    struct delaunay_client *c;
    char path[4096]; /* "": no history is kept */
    char *set[MOST_SETS];
    size_t sets, next;
} prompt;

/* ---- completion ---- */

static void forget_sets(void)
{
    while (prompt.sets > 0)
        free(prompt.set[--prompt.sets]);
}

static bool take_set(void *ctx, const struct delaunay_part *part)
{
    const char *end = part->kind == DELAUNAY_PART_ROW ? memchr(part->text, ' ', part->len) : NULL;
    if (end != NULL && prompt.sets < MOST_SETS) {
        prompt.set[prompt.sets] = strndup(part->text, (size_t)(end - part->text));
        prompt.sets += prompt.set[prompt.sets] != NULL;
    }
    return true;
}

static char *next_set(const char *text, int state)
{
    if (state == 0)
        prompt.next = 0;
    while (prompt.next < prompt.sets) {
        const char *name = prompt.set[prompt.next++];
        if (strncmp(name, text, strlen(text)) == 0)
            return strdup(name);
    }
    return NULL;
}

static char *next_command(const char *text, int state)
{
    if (state == 0)
        prompt.next = 0;
    while (prompt.next < subcommand_count) {
        const char *name = subcommands[prompt.next++].name;
        if (strncasecmp(name, text, strlen(text)) == 0)
            return strdup(name);
    }
    return NULL;
}

/* The command first, then a set where it takes one; after that files, which is what NULL means. */
static char **complete(const char *text, int start, int end)
{
    char name[24];
    if (start == 0)
        return rl_completion_matches(text, next_command);
    const char *line = rl_line_buffer;
    size_t len = strcspn(line, " ");
    snprintf(name, sizeof name, "%.*s", len < sizeof name ? (int)len : 0, line);
    const struct subcommand *s = subcommand_find(name);
    if (s == NULL || !s->set || strspn(line + len, " ") + len != (size_t)start)
        return NULL;
    forget_sets();
    if (delaunay_request(prompt.c, "SETS", take_set, NULL) == DELAUNAY_OK)
        rl_attempted_completion_over = 1;
    return rl_completion_matches(text, next_set);
}

/* ---- lines ---- */

void line_editor_begin(struct delaunay_client *c)
{
    const char *home = getenv("HOME");
    prompt.c = c;
    rl_readline_name = "delaunay";
    rl_attempted_completion_function = complete;
    using_history();
    stifle_history(HISTORY);
    if (home != NULL && (size_t)snprintf(prompt.path, sizeof prompt.path, "%s/.delaunay_history",
                                         home) < sizeof prompt.path)
        read_history(prompt.path);
    else
        prompt.path[0] = '\0';
}

void line_editor_end(void)
{
    mode_t mask = umask(0077);
    if (prompt.path[0] != '\0')
        write_history(prompt.path);
    umask(mask);
    forget_sets();
}

/* Tokens are not stored, nor is a repetition of the last line. */
static bool is_worth_keeping(const char *line)
{
    static char *last;
    if (line[strspn(line, " \t")] == '\0' || strncasecmp(line, "auth", 4) == 0 ||
        (last != NULL && strcmp(last, line) == 0))
        return false;
    free(last);
    last = strdup(line);
    return true;
}

/* ^C while a line is read leaves the library, as its documentation shows; the next call starts the terminal again. */
static sigjmp_buf at_prompt;

static void leave_line(int signal)
{
    siglongjmp(at_prompt, 1);
}

/* An empty line if ^C was pressed. */
char *line_editor_read(const char *text)
{
    struct sigaction mine = {.sa_handler = leave_line}, before;
    char *line;
    sigemptyset(&mine.sa_mask);
    sigaction(SIGINT, &mine, &before);
    if (sigsetjmp(at_prompt, 1) == 0) {
        line = readline(text);
        sigaction(SIGINT, &before, NULL);
        if (line != NULL && is_worth_keeping(line))
            add_history(line);
    } else {
        sigaction(SIGINT, &before, NULL);
        putchar('\n');
        line = strdup("");
    }
    return line;
}

#else

void line_editor_begin(struct delaunay_client *c)
{
}

void line_editor_end(void)
{
}

static void interrupt(int signal)
{
}

/* The terminal discards what was typed when ^C is pressed; read() then ends early. */
char *line_editor_read(const char *text)
{
    struct sigaction mine = {.sa_handler = interrupt}, before;
    fputs(text, stdout);
    fflush(stdout);
    sigemptyset(&mine.sa_mask);
    sigaction(SIGINT, &mine, &before);
    errno = 0;
    char *line = line_editor_next();
    bool interrupted = line == NULL && errno == EINTR;
    sigaction(SIGINT, &before, NULL);
    clearerr(stdin);
    if (interrupted)
        putchar('\n');
    return interrupted ? strdup("") : line;
}

#endif

char *line_editor_next(void)
{
    char *line = NULL;
    size_t room = 0;
    ssize_t n = getline(&line, &room, stdin);
    if (n < 0) {
        free(line);
        return NULL;
    }
    while (n > 0 && (line[n - 1] == '\n' || line[n - 1] == '\r'))
        line[--n] = '\0';
    return line;
}
