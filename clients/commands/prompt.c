/* prompt.c - `delaunay` without a command: carries out lines from the standard input one by one. Requests of
 * the protocol are sent unchanged, and subcommands that read or write files work as from a shell. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "clients/cli/line_editor.h"
#include "clients/cli/message.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/dispatch.h"

enum { MOST_WORDS = 64 };

/* Splits the line in place into words, which may be within quotes, single or double. Returns how many; -1 if there
 * are too many or a quote is open. */
static int split(char *line, char **word)
{
    int n = 0;
    for (char *from = line;;) {
        while (isspace((unsigned char)*from))
            from++;
        if (*from == '\0')
            return n;
        if (n == MOST_WORDS)
            return -1;
        char *to = word[n++] = from, quote = '\0';
        for (; *from != '\0' && (quote != '\0' || !isspace((unsigned char)*from)); from++)
            if (quote == '\0' && (*from == '"' || *from == '\''))
                quote = *from;
            else if (quote != '\0' && *from == quote)
                quote = '\0';
            else
                *to++ = *from;
        if (quote != '\0')
            return -1;
        from += *from != '\0';
        *to = '\0';
    }
}

static bool is_first_word(const char *line, const char *word)
{
    size_t n = strcspn(line, " \t");
    return n == strlen(word) && strncasecmp(line, word, n) == 0;
}

/* Whether the line is for this program instead of the server. */
static bool is_ours(const char *line)
{
    char name[24];
    size_t n = strcspn(line, " \t");
    snprintf(name, sizeof name, "%.*s", n < sizeof name ? (int)n : 0, line);
    const struct subcommand *s = subcommand_find(name);
    return (s != NULL && s->run != NULL) || strstr(line, " --help") != NULL;
}

/* The escape sequence of an arrow key, where no library edits the line. */
static bool has_control_characters(const char *line)
{
    for (; *line != '\0'; line++)
        if (iscntrl((unsigned char)*line) && *line != '\t')
            return true;
    return false;
}

static int carry_out(struct delaunay_client *c, char *line)
{
    char *word[MOST_WORDS + 1];
    if (has_control_characters(line)) {
        message_print("a control character in the line; nothing was sent");
        return EXIT_USAGE;
    }
    if (!is_ours(line))
        return request_send_words(c, 1, &line);
    int words = split(line, word);
    if (words < 0) {
        message_print("a quote is open, or too many words");
        return EXIT_USAGE;
    }
    word[words] = NULL;
    return dispatch(c, words, word, NULL);
}

int command_prompt(struct delaunay_client *c)
{
    bool terminal = isatty(STDIN_FILENO), ended = false;
    int status = EXIT_DONE, outcome;
    char *line;
    if (terminal)
        line_editor_begin(c);
    while (!ended &&
           (line = terminal ? line_editor_read("delaunay> ") : line_editor_next()) != NULL) {
        char *first = line + strspn(line, " \t");
        bool leaves = is_first_word(first, "exit"); /* QUIT is a request, too */
        ended = leaves || is_first_word(first, "quit");
        if (*first != '\0' && *first != '#' && !leaves) { /* a comment is no request */
            outcome = carry_out(c, first);
            status = outcome != EXIT_DONE ? outcome : status;
            ended |= outcome == EXIT_NO_CONNECTION && !terminal;
        }
        free(line);
        fflush(stdout);
    }
    if (terminal) {
        putchar('\n');
        line_editor_end();
    }
    return status;
}
