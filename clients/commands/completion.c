/* completion.c - `delaunay completion SHELL`: completion of commands, options, sets and files, for bash, zsh and fish,
 * from the table of subcommands. */
#include <stdio.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/meshes/line_formats.h"
#include "clients/reading/word_list.h"

static const char read_sets[] = "sets 2>/dev/null | sed -n '2,$s/ .*//p'";
static const char global_options[] = "--host --port --url --json --help --version";
static const char inputs[] = "xy csv geojson node xyz gpx las poly obj",
                  grids[] = "asc bil png tif", shapes[] = "geojson svg wkt",
                  methods[] = "linear natural laplace nearest", paints[] = "relief light height",
                  colours[] = "quality degree relief";

static void put_formats(void)
{
    char names[FORMATS_LIST];
    formats_list(names, sizeof names, " ");
    fputs(names, stdout);
}

static bool is_any(const struct subcommand *s)
{
    return s != NULL;
}

static bool takes_set(const struct subcommand *s)
{
    return s->set || s->run == command_copy;
}

static bool takes_files(const struct subcommand *s)
{
    return s->files;
}

static bool takes_set_and_files(const struct subcommand *s)
{
    return s->files && s->set;
}

static bool takes_only_files(const struct subcommand *s)
{
    return s->files && !s->set;
}

/* Writes the names of these subcommands, with the text between them. */
static void put_names(bool (*chosen)(const struct subcommand *s), const char *between)
{
    bool first = true;
    for (size_t i = 0; i < subcommand_count; i++)
        if (chosen(&subcommands[i])) {
            printf("%s%s", first ? "" : between, subcommands[i].name);
            first = false;
        }
}

/* Each with a blank behind it. */
static void put_options(const char *options)
{
    size_t n;
    for (const char *name; (name = word_list_next(&options, &n)) != NULL;)
        printf("--%.*s ", (int)strcspn(name, "= "), name);
}

/* The options that take a value, as further patterns of a case. */
static void put_valued(void)
{
    for (size_t i = 0; i < subcommand_count; i++) {
        const char *rest = subcommands[i].options != NULL ? subcommands[i].options : "";
        size_t n;
        for (const char *word; (word = word_list_next(&rest, &n)) != NULL;) {
            bool named = false;
            for (size_t k = 0; k < i; k++)
                named |= subcommands[k].options != NULL &&
                         word_list_has(subcommands[k].options, word, n);
            if (!named && word[n - 1] == '=')
                printf(" | --%.*s", (int)n - 1, word);
        }
    }
}

/* The part that bash and zsh share: finds the command and the number of its words before the one to be
 * completed; `where` gets the options for the server. */
static void put_shell_scan(const char *word, const char *from, const char *to)
{
    printf("    local command= at=0 i w\n"
           "    local -a where\n"
           "    for ((i = %s; i < %s; i++)); do\n"
           "        w=${%s[i]}\n"
           "        case $w in\n"
           "        -h | -p | -u | --host | --port | --url)\n"
           "            where+=(\"$w\" \"${%s[i + 1]}\"); ((i++)) ;;\n"
           "        -f | -c",
           from, to, word, word);
    put_valued();
    puts(")\n            ((i++)) ;;\n"
         "        -*) ;;\n"
         "        *) if [[ -z $command ]]; then command=$w; else ((at += 1)); fi ;;\n"
         "        esac\n"
         "    done");
}

/* Completes the values of options, with the words between `before` and `after`. */
static void put_value_cases(const char *before, const char *after)
{
    printf("    -f | --format)\n        case $command in\n        load) %s%s%s ;;\n"
           "        raster) %s%s%s ;;\n        contour | voronoi | alpha) %s%s%s ;;\n        *) %s",
           before, inputs, after, before, grids, after, before, shapes, after, before);
    put_formats();
    printf("%s ;;\n        esac\n        return ;;\n    --input-format) %s%s%s; return ;;\n"
           "    --method) %s%s%s; return ;;\n"
           "    --colour) if [[ $command == raster ]]; then %s%s%s; else %s%s%s; fi; return ;;\n"
           "    -h | -p | -u | -c | --host | --port | --url",
           after, before, inputs, after, before, methods, after, before, paints, after, before,
           colours, after);
    put_valued();
    puts(") return ;;\n    esac");
}

/* A case for the options of each subcommand that has some, which are words of `before` ... `after`. */
static void put_option_cases(const char *before, const char *after)
{
    printf("        '') %s%s%s ;;\n", before, global_options, after);
    for (size_t i = 0; i < subcommand_count; i++)
        if (subcommands[i].options != NULL) {
            printf("        %s) %s", subcommands[i].name, before);
            put_options(subcommands[i].options);
            printf("--help --json%s ;;\n", after);
        }
    printf("        *) %s--help --json%s ;;\n", before, after);
}

/* A case for each subcommand's words. */
static void put_word_cases(const char *before, const char *after)
{
    for (size_t i = 0; i < subcommand_count; i++)
        if (subcommands[i].words != NULL)
            printf("    %s) %s%s%s ;;\n", subcommands[i].name, before, subcommands[i].words, after);
}

/* ---- bash ---- */

static void put_bash(void)
{
    static const char reply[] = "COMPREPLY=($(compgen -W \"", end[] = "\" -- \"$word\"))";
    puts("# bash completion for delaunay\n_delaunay()\n{\n"
         "    local word=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD - 1]}");
    put_shell_scan("COMP_WORDS", "1", "COMP_CWORD");
    puts("    case $last in");
    put_value_cases(reply, end);
    puts("    if [[ $word == -* ]]; then\n        case $command in");
    put_option_cases(reply, end);
    fputs("        esac\n        return\n    fi\n    case $command in\n", stdout);
    printf("    '') %s", reply);
    put_names(is_any, " ");
    printf("%s; return ;;\n    ", end);
    put_names(takes_set, " | ");
    printf(")\n        if ((at == 0)); then %s$(\"${COMP_WORDS[0]}\" \"${where[@]}\" %s)%s; "
           "return; fi ;;\n"
           "    esac\n    case $command in\n    ",
           reply, read_sets, end);
    put_names(takes_files, " | ");
    puts(") compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -f -- \"$word\")) ;;");
    put_word_cases(reply, end);
    puts("    esac\n}\ncomplete -F _delaunay delaunay");
}

/* ---- zsh ---- */

static void put_zsh(void)
{
    puts("#compdef delaunay\n_delaunay()\n{\n    local last=${words[CURRENT - 1]}");
    put_shell_scan("words", "2", "CURRENT");
    puts("    case $last in");
    put_value_cases("compadd ", "");
    puts("    if [[ ${words[CURRENT]} == -* ]]; then\n        case $command in");
    put_option_cases("compadd -- ", "");
    fputs("        esac\n        return\n    fi\n    case $command in\n    '') compadd ", stdout);
    put_names(is_any, " ");
    fputs("; return ;;\n    ", stdout);
    put_names(takes_set, " | ");
    printf(")\n        if ((at == 0)); then compadd -- ${(f)\"$(${words[1]} $where %s)\"}; return; "
           "fi ;;\n"
           "    esac\n    case $command in\n    ",
           read_sets);
    put_names(takes_files, " | ");
    puts(") _files ;;");
    put_word_cases("compadd ", "");
    puts("    esac\n}\n"
         "if [[ ${zsh_eval_context[-1]} == loadautofunc ]]; then _delaunay \"$@\"; else compdef "
         "_delaunay "
         "delaunay; fi");
}

/* ---- fish ---- */

/* The values of an option, after -a; NULL: others. */
static const char *values_of(const struct subcommand *s, const char *option)
{
    static char names[FORMATS_LIST];
    bool format = options_is(option, "format");
    if (options_is(option, "colour"))
        return s->run == command_raster ? paints : colours;
    if (options_is(option, "method"))
        return methods;
    if (options_is(option, "input-format") || (format && s->run == command_load))
        return inputs;
    if (!format)
        return NULL;
    if (s->run == command_raster)
        return grids;
    if (s->run == command_contour || s->run == command_voronoi || s->run == command_alpha)
        return shapes;
    formats_list(names, sizeof names, " ");
    return names;
}

/* A rule for each option. */
static void put_fish_options(const struct subcommand *s)
{
    const char *rest = s->options != NULL ? s->options : "";
    size_t n;
    for (const char *word; (word = word_list_next(&rest, &n)) != NULL;) {
        char name[32];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "= "), word);
        const char *values = values_of(s, name);
        printf("complete -c delaunay -n '__fish_seen_subcommand_from %s' -l %s", s->name, name);
        if (values != NULL)
            printf(" -x -a '%s'", values);
        else if (word[n - 1] == '=')
            fputs(" -x", stdout);
        putchar('\n');
    }
}

/* The help's first sentence, or the part of it that is on its first line, within single quotes. */
static void put_fish_help(const char *help)
{
    size_t n = strcspn(help, "\n.;");
    for (size_t i = 0; i < n; i++)
        if (help[i] != '\'')
            putchar(help[i]);
}

static void put_fish(void)
{
    puts("# fish completion for delaunay\ncomplete -c delaunay -f\n"
         "function __delaunay_at; test (count (commandline -opc | string match -v -- '-*')) -eq "
         "$argv[1]; end\n"
         "complete -c delaunay -s h -l host -x\ncomplete -c delaunay -s p -l port -x\n"
         "complete -c delaunay -s u -l url -x\ncomplete -c delaunay -l json\n"
         "complete -c delaunay -l version\ncomplete -c delaunay -l help");
    for (size_t i = 0; i < subcommand_count; i++) {
        printf("complete -c delaunay -n __fish_use_subcommand -a %s -d '", subcommands[i].name);
        put_fish_help(subcommands[i].help);
        puts("'");
        put_fish_options(&subcommands[i]);
    }
    fputs("complete -c delaunay -n '__fish_seen_subcommand_from ", stdout);
    put_names(takes_set, " ");
    printf("; and __delaunay_at 2' -a \"(delaunay %s)\"\n",
           "sets 2>/dev/null | sed -n '2,\\$s/ .*//p'");
    fputs("complete -c delaunay -n '__fish_seen_subcommand_from ", stdout);
    put_names(takes_only_files, " ");
    fputs("' -F\ncomplete -c delaunay -n '__fish_seen_subcommand_from ", stdout);
    put_names(takes_set_and_files, " ");
    puts("; and not __delaunay_at 2' -F");
    for (size_t i = 0; i < subcommand_count; i++)
        if (subcommands[i].words != NULL)
            printf("complete -c delaunay -n '__fish_seen_subcommand_from %s%s' -a '%s'\n",
                   subcommands[i].name, subcommands[i].set ? "; and not __delaunay_at 2" : "",
                   subcommands[i].words);
}

int command_completion(struct delaunay_client *c, int argc, char **argv)
{
    const char *shell = argc > 1 ? argv[1] : "bash";
    (void)c;
    if (argc > 2)
        return options_wrong(argv[0], "completion takes one shell");
    if (strcmp(shell, "bash") == 0)
        put_bash();
    else if (strcmp(shell, "zsh") == 0)
        put_zsh();
    else if (strcmp(shell, "fish") == 0)
        put_fish();
    else
        return options_wrong(argv[0], "there is completion for bash, zsh and fish, not for %s",
                             shell);
    return EXIT_DONE;
}
