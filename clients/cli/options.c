/* options.c - see options.h. */
#include "clients/cli/options.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/command.h"
#include "clients/cli/message.h"
#include "clients/cli/subcommand.h"
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

enum { MOST_OPTIONS = 40, MOST_LETTERS = 600, FIRST_OPTION = 256 };

/* The options of getopt_long. Returns the letters of those that have one. */
static const char *list_options(const char *options, char names[MOST_LETTERS],
                                struct option list[MOST_OPTIONS])
{
    int n = 0;
    snprintf(names, MOST_LETTERS, "%s", options);
    for (char *name = strtok(names, " "); name != NULL; name = strtok(NULL, " "), n++) {
        size_t len = strcspn(name, "=");
        list[n] = (struct option){name, name[len] == '=', NULL, FIRST_OPTION + n};
        name[len] = '\0';
        if (options_is(name, "colour")) {
            list[n + 1] = list[n];
            list[++n].name = "color";
        }
    }
    list[n] = (struct option){NULL, 0, NULL, 0};
    return strstr(options, "columns=") != NULL  ? "f:c:"
           : strstr(options, "format=") != NULL ? "f:"
                                                : "";
}

int options_read(int argc, char **argv, options_take_fn *take, void *ctx, int words,
                 const char *what)
{
    struct option list[MOST_OPTIONS];
    char names[MOST_LETTERS];
    const char *letters = list_options(subcommand_find(argv[0])->options, names, list);
    int option, status = EXIT_DONE;
    optind = 0;
    while (status == EXIT_DONE && (option = options_next(argc, argv, letters, list)) != -1)
        status = option >= FIRST_OPTION ? take(ctx, list[option - FIRST_OPTION].name, argv)
                 : option == 'f'        ? take(ctx, "format", argv)
                 : option == 'c'        ? take(ctx, "columns", argv)
                                        : options_unknown(argv[0], argv, option);
    if (status == EXIT_DONE && words >= 0 && argc - optind != words)
        status = options_wrong(argv[0], "%s takes %s", argv[0], what);
    return status;
}

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
