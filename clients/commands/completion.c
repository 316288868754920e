/* completion.c - `delaunay completion SHELL`: completion of commands, options, sets and files, for bash, zsh and fish.
 *
 * The script of a shell sends the words of the line, up to the one at the cursor, to `delaunay completion words`, a line each.
 * It gets the words that may be there, a line each, which may have a tab and a description; or FILES. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/options.h"
#include "clients/cli/request.h"
#include "clients/cli/subcommand.h"
#include "clients/meshes/line_formats.h"
#include "clients/reading/program.h"
#include "clients/reading/word_list.h"

enum { MOST_WORDS = 200, WORD_ROOM = 256 };

#define FILES "/files" /* no name of a command, an option or a set has a slash */

static const char global_options[] = "--host --port --url --json --help --version";
static const char global_valued[] = "-h -p -u --host --port --url";

/* The values of options. The first row of an option counts that is for the command, or for any (NULL). */
static const struct {
    const char *option;
    int (*run)(struct delaunay_client *c, int argc, char **argv);
    const char *words;
} values[] = {{"input-format", NULL, "xy csv geojson node xyz gpx las poly obj asc"},
              {"format", command_load, "xy csv geojson node xyz gpx las poly obj asc"},
              {"format", command_raster, "asc bil png tif"},
              {"format", command_contour, "geojson svg wkt"},
              {"format", command_voronoi, "geojson svg wkt"},
              {"format", command_alpha, "geojson svg wkt"},
              {"colour", command_raster, "relief light height"},
              {"colour", NULL, "angle quality degree relief"},
              {"method", NULL, "linear natural laplace nearest smooth"},
              {"outside", NULL, "nan nearest"},
              {"missing", NULL, "nan skip"},
              {"as", NULL, "slope aspect"}};

/* ---- the line ---- */

/* A line whose last word is to be completed. */
struct line {
    char word[MOST_WORDS][WORD_ROOM]; /* the first one is the name of the program */
    size_t n;
    const char *where[MOST_WORDS +
                      2]; /* the program, its options that name a server, and room for two more */
    size_t where_n;
    const char *command;        /* NULL: it is to be completed */
    const struct subcommand *s; /* of this name; NULL: none */
    size_t at;          /* words between the command and the last word that are no options */
    const char *option; /* whose value is to be completed; NULL: none */
    const char *before; /* `--format` if the last word is `--format=VALUE`; NULL: it is another */
};

static const char *last_of(const struct line *l)
{
    return l->word[l->n - 1];
}

/* `--option=value` becomes two words. */
static void read_words(struct line *l)
{
    char *word, *value;
    while (l->n + 1 < MOST_WORDS && fgets(word = l->word[l->n], WORD_ROOM, stdin) != NULL) {
        word[strcspn(word, "\n")] = '\0';
        value = strncmp(word, "--", 2) == 0 ? strchr(word, '=') : NULL;
        l->before = value != NULL ? word : NULL;
        if (value != NULL) {
            *value = '\0';
            snprintf(l->word[++l->n], WORD_ROOM, "%s", value + 1);
        }
        l->n++;
    }
}

/* Whether the option has its value in the next word. */
static bool is_valued(const struct line *l, const char *word)
{
    const char *rest = l->s != NULL && l->s->options != NULL ? l->s->options : "";
    struct option_word o;
    if (word_list_has(global_valued, word, strlen(word)) || options_is(word, "-f") ||
        options_is(word, "-c"))
        return true;
    while (option_word_next(&rest, &o))
        if (o.valued && strlen(word) == o.len + 2 && memcmp(word + 2, o.name, o.len) == 0)
            return true;
    return false;
}

static void scan(struct line *l)
{
    l->where[l->where_n++] = l->word[0];
    for (size_t i = 1; i + 1 < l->n; i++) {
        const char *word = options_is(l->word[i], "--color") ? "--colour" : l->word[i];
        if (word[0] == '-' && is_valued(l, word)) {
            bool global = word_list_has(global_valued, word, strlen(word));
            i++;
            if (i + 1 == l->n)
                l->option = word;
            if (global) {
                l->where[l->where_n++] = word;
                l->where[l->where_n++] = l->word[i];
            }
        } else if (word[0] == '-') {
            continue;
        } else if (l->command == NULL) {
            l->command = word;
            l->s = subcommand_find(word);
        } else {
            l->at++;
        }
    }
}

/* ---- what may be there ---- */

static void offer(const struct line *l, const char *word, size_t len)
{
    const char *last = last_of(l);
    if (len >= strlen(last) && memcmp(word, last, strlen(last)) == 0)
        printf("%s%s%.*s\n", l->before != NULL ? l->before : "", l->before != NULL ? "=" : "",
               (int)len, word);
}

static void offer_list(const struct line *l, const char *words)
{
    size_t n;
    for (const char *word; (word = word_list_next(&words, &n)) != NULL;)
        offer(l, word, n);
}

/* Commands, with the first sentence of their help, or the part of it that is on its first line. */
static void offer_commands(const struct line *l)
{
    const char *last = last_of(l);
    for (const struct subcommand *s = subcommands; s < subcommands + subcommand_count; s++)
        if (strncmp(s->name, last, strlen(last)) == 0)
            printf("%s\t%.*s\n", s->name, (int)strcspn(s->help, "\n.;"), s->help);
}

static void offer_options(const struct line *l)
{
    const char *rest = l->s != NULL && l->s->options != NULL ? l->s->options : "";
    char name[40];
    struct option_word o;
    while (option_word_next(&rest, &o))
        offer(l, name, (size_t)snprintf(name, sizeof name, "--%.*s", (int)o.len, o.name));
    offer_list(l, l->command != NULL ? "--help --json" : global_options);
}

/* The names of the sets, which the program prints for the same server: the first words of all rows but the status line. */
static void offer_sets(struct line *l)
{
    char row[400];
    pid_t pid;
    int from;
    l->where[l->where_n] = "sets";
    l->where[l->where_n + 1] = NULL;
    if (program_start(&pid, l->where, -1, &from, false) != 0)
        return;
    FILE *rows = fdopen(from, "r");
    for (size_t i = 0; rows != NULL && fgets(row, sizeof row, rows) != NULL; i++)
        if (i > 0)
            offer(l, row, strcspn(row, " \n"));
    rows != NULL ? fclose(rows) : close(from);
    program_end(pid);
}

static void offer_values(const struct line *l)
{
    char all[FORMATS_LIST];
    const char *name = l->option + strspn(l->option, "-");
    name = options_is(name, "f") ? "format" : name;
    for (size_t i = 0; l->s != NULL && i < sizeof values / sizeof values[0]; i++)
        if (options_is(name, values[i].option) &&
            (values[i].run == NULL || values[i].run == l->s->run)) {
            offer_list(l, values[i].words);
            return;
        }
    if (options_is(name, "format")) {
        formats_list(all, sizeof all, " ");
        offer_list(l, all);
    }
}

static void offer_words(struct line *l)
{
    const struct subcommand *s = l->s;
    if (l->option != NULL)
        offer_values(l);
    else if (l->before != NULL)
        return; /* an option without values */
    else if (last_of(l)[0] == '-')
        offer_options(l);
    else if (l->command == NULL)
        offer_commands(l);
    else if (s != NULL && (s->set || s->run == command_copy) && l->at == 0)
        offer_sets(l);
    else if (s != NULL && s->files)
        puts(FILES);
    else if (s != NULL && s->words != NULL)
        offer_list(l, s->words);
}

static int complete(void)
{
    struct line *l = calloc(1, sizeof *l);
    if (l == NULL)
        return EXIT_REFUSED;
    read_words(l);
    if (l->n > 1) {
        scan(l);
        offer_words(l);
    }
    free(l);
    return EXIT_DONE;
}

/* ---- scripts ---- */

static const struct {
    const char *shell, *script;
} scripts[] = {
    {"bash", "# bash completion for delaunay\n"
             "_delaunay()\n"
             "{\n"
             "    # words are divided at : and =, where COMP_LINE has no blank\n"
             "    local i n=0 last words=() line=$COMP_LINE part=${COMP_WORDS[COMP_CWORD]}\n"
             "    for ((i = 0; i <= COMP_CWORD; i++)); do\n"
             "        [[ $i == 0 || $line == [[:space:]]* ]] && ((++n))\n"
             "        words[n]+=${COMP_WORDS[i]}\n"
             "        line=${line#\"${line%%[![:space:]]*}\"}\n"
             "        line=${line#\"${COMP_WORDS[i]}\"}\n"
             "    done\n"
             "    last=${words[n]}\n"
             "    mapfile -t COMPREPLY < <(printf '%s\\n' \"${words[@]}\" |\n"
             "        \"${words[1]}\" completion words 2>/dev/null | cut -f 1)\n"
             "    if [[ ${COMPREPLY[0]} == " FILES " ]]; then\n"
             "        compopt -o filenames 2>/dev/null\n"
             "        mapfile -t COMPREPLY < <(compgen -f -- \"$last\")\n"
             "    fi\n"
             "    [[ $part == [:=]* ]] && part=\n"
             "    COMPREPLY=(\"${COMPREPLY[@]#\"${last%\"$part\"}\"}\")\n"
             "}\n"
             "complete -F _delaunay delaunay\n"},
    {"zsh", "#compdef delaunay\n"
            "_delaunay()\n"
            "{\n"
            "    local -a found\n"
            "    found=(${(f)\"$(print -rl -- \"${(@)words[1,CURRENT]}\" |\n"
            "        ${words[1]} completion words 2>/dev/null | cut -f 1)\"})\n"
            "    if [[ ${found[1]} == " FILES " ]]; then _files; else compadd -- $found; fi\n"
            "}\n"
            "if [[ ${zsh_eval_context[-1]} == loadautofunc ]]; then _delaunay \"$@\"\n"
            "else compdef _delaunay delaunay; fi\n"},
    {"fish",
     "# fish completion for delaunay\n"
     "function __delaunay_words\n"
     "    set -l words (commandline -opc)\n"
     "    set -l last (commandline -ct)\n"
     "    command -q $words[1]; or return\n"
     "    printf '%s\\n' $words \"$last\" | command $words[1] completion words 2>/dev/null\n"
     "end\n"
     "function __delaunay_files; contains -- " FILES " (__delaunay_words); end\n"
     "complete -c delaunay -f -n 'not __delaunay_files' -a '(__delaunay_words)'\n"
     "complete -c delaunay -F -n __delaunay_files\n"}};

int command_completion(struct delaunay_client *c, int argc, char **argv)
{
    const char *shell = argc > 1 ? argv[1] : "bash";
    if (argc > 2)
        return options_wrong(argv[0], "completion takes one shell");
    if (strcmp(shell, "words") == 0)
        return complete();
    for (size_t i = 0; i < sizeof scripts / sizeof scripts[0]; i++)
        if (strcmp(scripts[i].shell, shell) == 0) {
            fputs(scripts[i].script, stdout);
            return EXIT_DONE;
        }
    return options_wrong(argv[0], "there is completion for bash, zsh and fish, not for %s", shell);
}
