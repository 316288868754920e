/* commands_json.c - see commands_json.h. */
#include "server/commands_json.h"

#include "server/commands.h"

/* NULL: nothing. Texts of the table contain no character that JSON would escape. */
static void print_text(FILE *out, const char *key, const char *text)
{
    if (text != NULL)
        fprintf(out, "\"%s\": \"%s\", ", key, text);
}

static void print_flag(FILE *out, const char *key, bool value)
{
    fprintf(out, "\"%s\": %s, ", key, value ? "true" : "false");
}

/* Who may use it, as in the reply to AUTH; CLIENT and CONFIG decide by their second word. */
static const char *role_of(const struct command *c)
{
    if ((c->flags & CMD_OPEN) != 0)
        return "none";
    return (c->flags & (CMD_WRITE | CMD_ADMIN)) != 0 ? "rw" : "ro";
}

static const char *subject_of(const struct command *c)
{
    if ((c->flags & CMD_SET) != 0)
        return "set";
    return (c->flags & CMD_ALL_SETS) != 0 ? "sets" : "server";
}

static void print_command(FILE *out, const struct command *c)
{
    static const char *const body[] = {[LOAD_NOTHING] = "null",
                                       [LOAD_POINTS] = "\"points\"",
                                       [LOAD_PLACES] = "\"places\"",
                                       [LOAD_VALUES] = "\"values\"",
                                       [LOAD_PAIRS] = "\"pairs\""};
    fputc('{', out);
    print_text(out, "name", c->name);
    print_text(out, "usage", c->usage);
    print_text(out, "help", c->help);
    fprintf(out, "\"least\": %u, ", c->least);
    if (c->most != 0)
        fprintf(out, "\"most\": %u, ", c->most);
    else
        fputs("\"most\": null, ", out);
    print_text(out, "role", role_of(c));
    print_text(out, "about", subject_of(c));
    print_text(out, "rows", c->rows);
    print_text(out, "result", c->result);
    print_flag(out, "exists", command_needs_set(c));
    print_flag(out, "changes", (c->flags & CMD_WRITE) != 0);
    fprintf(out, "\"body\": %s}", body[c->body.rows]);
}

void commands_json_print(FILE *out)
{
    for (size_t i = 0; i < command_count; i++) {
        fputs(i == 0 ? "[\n" : ",\n", out);
        print_command(out, &commands[i]);
    }
    fputs("\n]\n", out);
}
