/* options.c - see options.h. */
#include "clients/cli/options.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/message.h"
#include "clients/cli/request.h"
#include "clients/cli/subcommand.h"
#include "clients/reading/word_list.h"
#include "proto/number.h"

int options_next(int argc, char **argv, const char *letters, const struct option *options)
{
    char with_colon[16];
    opterr = 0;
    /* ':' makes getopt report a missing value as such; a '+' must stay in front of the ':'. */
    bool plus = letters[0] == '+';
    snprintf(with_colon, sizeof with_colon, "%s:%s", plus ? "+" : "", letters + plus);
    return getopt_long(argc, argv, with_colon, options, NULL);
}

/* ---- the table ---- */

enum { MOST_OPTIONS = 40, MOST_LETTERS = 600, FIRST_OPTION = 256 };

bool option_word_next(const char **rest, struct option_word *o)
{
    size_t n;
    const char *word = word_list_next(rest, &n);
    if (word == NULL)
        return false;
    *o = (struct option_word){.name = word, .len = strcspn(word, "=:! ")};
    word += o->len;
    o->valued = *word == '=';
    word += o->valued;
    o->needs = *word == ':' ? word + 1 : "";
    word += *word == ':' ? 1 + strcspn(word + 1, "! ") : 0;
    o->excludes = *word == '!' ? word + 1 : "";
    return true;
}

/* The options of a subcommand as getopt_long has them. */
struct option_list {
    struct option option[MOST_OPTIONS];
    char names[MOST_LETTERS];
    const char *letters; /* of those that have one */
};

static void list_options(const char *command, struct option_list *l)
{
    const char *options = subcommand_find(command)->options, *rest = options;
    char *name = l->names;
    struct option_word o;
    int n = 0;
    for (; option_word_next(&rest, &o); n++, name += o.len + 1) {
        snprintf(name, o.len + 1, "%s", o.name);
        l->option[n] = (struct option){name, o.valued, NULL, FIRST_OPTION + n};
        if (options_is(name, "colour")) {
            l->option[n + 1] = l->option[n];
            l->option[++n].name = "color";
        }
    }
    l->option[n] = (struct option){NULL, 0, NULL, 0};
    l->letters = strstr(options, "columns=") != NULL  ? "f:c:"
                 : strstr(options, "format=") != NULL ? "f:"
                                                      : "";
}

/* The name of the next option; its value is in optarg. NULL at the end, and after an error: then *option is not -1. */
static const char *next_name(int argc, char **argv, const struct option_list *l, int *option)
{
    *option = options_next(argc, argv, l->letters, l->option);
    for (int i = 0; l->option[i].name != NULL; i++)
        if (l->option[i].val == *option)
            return l->option[i].name;
    return *option == 'f' ? "format" : *option == 'c' ? "columns" : NULL;
}

/* ---- what goes together ---- */

/* The kinds of what is written, in the table in capitals. */
static const struct {
    const char *name, *says;
} kinds[] = {{"FILE", "a file to write"},
             {"PICTURE", "a picture"},
             {"POINTS", "a picture with points, not of relief"},
             {"MESH", "a mesh or a picture"},
             {"HEIGHTS", "heights (--colour relief, or a format that has them)"},
             {"GEOJSON", "GeoJSON; other formats here have no reference system"}};

/* The next name of a list with commas, NULL at its end. */
static const char *next_of(const char **list, size_t *n)
{
    const char *name = *list;
    *n = strcspn(name, ",:! ");
    *list = name + *n + (name[*n] == ',');
    return *n > 0 ? name : NULL;
}

/* The first name of the list that is among the words, with its length; NULL: none is. */
static const char *find_given(const char *list, const char *words, size_t *n)
{
    const char *name;
    while ((name = next_of(&list, n)) != NULL && !word_list_has(words, name, *n))
        continue;
    return name;
}

static bool needs_kind(const char *list)
{
    return strcspn(list, "ABCDEFGHIJKLMNOPQRSTUVWXYZ") < strcspn(list, "! ");
}

/* `a picture, --error or --most`, where `last` is " or ". */
static void list_names(const char *list, const char *last, char *to, size_t room)
{
    size_t n, at = 0;
    for (const char *name; at < room && (name = next_of(&list, &n)) != NULL;) {
        const char *between = at == 0 ? "" : strchr(" !", list[0]) != NULL ? last : ", ";
        const char *says = NULL;
        for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
            if (strlen(kinds[i].name) == n && memcmp(kinds[i].name, name, n) == 0)
                says = kinds[i].says;
        at += (size_t)(says != NULL
                           ? snprintf(to + at, room - at, "%s%s", between, says)
                           : snprintf(to + at, room - at, "%s--%.*s", between, (int)n, name));
    }
}

/* The options that were given, each once, with a blank between them: at most those of the table. */
static void list_given(char **argv, char *words, size_t room)
{
    struct option_list l;
    const char *name;
    int option, end = optind;
    size_t n = 0;
    words[0] = '\0';
    list_options(argv[0], &l);
    optind = 0;
    while ((name = next_name(end, argv, &l, &option)) != NULL)
        if (!word_list_has(words, name, strlen(name)))
            n += (size_t)snprintf(words + n, room - n, "%s ", name);
    optind = end;
}

int options_suit(char **argv, const char *have)
{
    char words[2 * MOST_LETTERS], names[200];
    const char *rest = subcommand_find(argv[0])->options;
    struct option_word o;
    size_t n;
    list_given(argv, words, MOST_LETTERS);
    size_t given = strlen(words);
    snprintf(words + given, sizeof words - given, "%s", have != NULL ? have : "");
    while (option_word_next(&rest, &o)) {
        if (!word_list_has(words, o.name, o.len))
            continue;
        if (find_given(o.excludes, words, &n) != NULL) {
            list_names(o.excludes, " and ", names, sizeof names);
            return options_wrong(argv[0], "--%.*s, or %s", (int)o.len, o.name, names);
        }
        if (*o.needs == '\0' || (have == NULL && needs_kind(o.needs)) ||
            find_given(o.needs, words, &n) != NULL)
            continue;
        list_names(o.needs, " or ", names, sizeof names);
        return options_wrong(argv[0], "--%.*s needs %s", (int)o.len, o.name, names);
    }
    return EXIT_DONE;
}

int options_read(int argc, char **argv, options_take_fn *take, void *ctx, int words,
                 const char *what)
{
    struct option_list l;
    const char *name;
    int option, status = EXIT_DONE;
    list_options(argv[0], &l);
    optind = 0;
    while (status == EXIT_DONE && (name = next_name(argc, argv, &l, &option)) != NULL)
        status = take(ctx, name, argv);
    if (status == EXIT_DONE && option != -1)
        status = options_unknown(argv[0], argv, option);
    if (status == EXIT_DONE)
        status = options_suit(argv, NULL);
    if (status == EXIT_DONE && words >= 0 && argc - optind != words)
        status = options_wrong(argv[0], "%s takes %s", argv[0], what);
    return status;
}

/* ---- messages ---- */

int options_wrong(const char *command, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    fputs("delaunay: ", stderr);
    vfprintf(stderr, format, values);
    va_end(values);
    va_start(values, format);
    message_keep(format, values);
    va_end(values);
    fprintf(stderr, "\nTry 'delaunay %s%s--help'.\n", command, command[0] != '\0' ? " " : "");
    return EXIT_USAGE;
}

/* The word that getopt has looked at last. If the value of the last option is missing, some C libraries
 * have moved to the end of argv, others after it. */
static const char *last_word(char **argv)
{
    const char *word = argv[optind - 1];
    return word != NULL ? word : argv[optind - 2];
}

int options_unknown(const char *command, char **argv, int option)
{
    /* A letter may be one of several in a word; a long option is a word of its own. */
    const char letter[3] = {'-', (char)optopt, '\0'};
    const char *word = last_word(argv);
    const char *name = optopt != 0 && optopt < 128 && word[1] != '-' ? letter : word;
    return options_wrong(command,
                         option == ':' ? "the option %s needs a value" : "unknown option %s", name);
}

bool options_name_file(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (!proto_is_number(argv[i], strlen(argv[i])) &&
            (argv[i][0] == '-' || (i > 1 && strpbrk(argv[i], "./") != NULL)))
            return true;
    return false;
}

/* ---- values ---- */

static bool read_box(const char *text, double *box)
{
    for (int i = 0; i < 4; i++) {
        size_t len = strcspn(text, ",");
        if (!proto_read_double(text, len, &box[i]) || (text[len] == ',') != (i < 3))
            return false;
        text += len + 1;
    }
    return box[0] < box[2] && box[1] < box[3];
}

int options_viewport(double *box, bool *has_box, char **argv)
{
    *has_box = read_box(optarg, box);
    if (*has_box)
        return EXIT_DONE;
    return options_wrong(
        argv[0], "the viewport %s is not X0,Y0,X1,Y1 from lower left to upper right", optarg);
}

int options_crs(struct crs *crs, char **argv)
{
    if (crs_read(optarg, crs))
        return EXIT_DONE;
    return options_wrong(argv[0], "a reference system is EPSG:32629, for instance, not %s", optarg);
}

int options_inside(const char **inside, char **argv)
{
    size_t len = strlen(optarg);
    *inside = optarg;
    if (strcmp(optarg, "any") == 0 || (len > 0 && len <= 10 && strspn(optarg, "0123456789") == len))
        return EXIT_DONE;
    return options_wrong(argv[0], "inside any border, or of one number, not %s", optarg);
}
