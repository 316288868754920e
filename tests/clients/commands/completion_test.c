/* completion_test.c - the words that the shells' completion offers; the manual page documents each of them. */
#include <string.h>
#include <unistd.h>

#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/meshes/formats.h"
#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

/* The words as bash has them: divided at : and =. */
static const char *divide(const char *words)
{
    static char divided[300];
    size_t n = 0;
    for (; *words != '\0'; words++)
        n += (size_t)snprintf(divided + n, sizeof divided - n,
                              strchr(":=", *words) != NULL ? " %c " : "%c", *words);
    return divided;
}

/* Compares what bash completes the line to, in a directory with the file cities.csv. A last word "" is empty. */
static void expect(const char *words, const char *want)
{
    char command[800];
    int status;
    const char *slash = strrchr(getenv("DELAUNAY"), '/');
    snprintf(command, sizeof command,
             "PATH=$(realpath %.*s):$PATH DELAUNAY_PORT=%s; export PATH DELAUNAY_PORT; cd %s; "
             "bash -c 'source <(delaunay completion bash); COMP_LINE=\"%.*s\"; COMP_WORDS=(%s); "
             "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _delaunay; echo ${COMPREPLY[*]}'",
             (int)(slash - getenv("DELAUNAY")), getenv("DELAUNAY"), cli_daemon.port_text,
             cli_path(""), (int)strcspn(words, "\""), words, divide(words));
    const char *got = peer_shell(&status, "%s", command);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0 && strcmp(got + strlen(want), "\n") == 0,
              "%s: %s", words, got);
}

TEST(completion_offers_sets_and_files_where_they_belong)
{
    cli_begin();
    cli_write("cities.csv", "");
    cli_run_well("add cities 0 0");
    cli_run_well("add boats 0 0");
    expect("delaunay load \"\"", "boats cities");
    expect("delaunay load c", "cities");
    expect("delaunay load boats c", "cities.csv");
    expect("delaunay load -c x,y boats c", "cities.csv");
    expect("delaunay hull b", "boats");
    expect("delaunay hull boats c", "");
    expect("delaunay draw c", "cities.csv");
    expect("delaunay copy b", "boats");
    cli_write("a:b.csv", "");
    expect("delaunay load boats a:b", "b.csv");
    char line[100];
    snprintf(line, sizeof line, "delaunay -u delaunay://127.0.0.1:%s hull b", cli_daemon.port_text);
    expect(line, "boats");
    snprintf(line, sizeof line, "delaunay -p 1 --port=%s hull \"\"", cli_daemon.port_text);
    expect(line, "boats cities");
    cli_finish();
}

TEST(completion_offers_commands_options_and_their_values)
{
    cli_begin();
    expect("delaunay tri", "triangulate triangles");
    expect("delaunay -p 1 tri", "triangulate triangles");
    expect("delaunay --v", "--version");
    expect("delaunay load cities --skip-b", "--skip-bad");
    expect("delaunay load -f n", "node");
    expect("delaunay export -f n", "node neigh ndjson");
    expect("delaunay export t x.svg --colour q", "quality");
    expect("delaunay raster t z x.png --colour \"\"", "relief light height");
    expect("delaunay raster t z x.png --color l", "light");
    expect("delaunay raster t z x.png --color=l", "light");
    expect("delaunay raster t z x.png --colour=", "relief light height");
    expect("delaunay export t x --format=s", "svg");
    expect("delaunay load t x --skip-bad=", "");
    expect("delaunay voronoi t x --format \"\"", "geojson svg wkt");
    expect("delaunay contour t z --crs EPSG:1 --crs \"\"", "");
    expect("delaunay completion f", "fish");
    expect("delaunay slowlog L", "LEN");
    expect("delaunay hull cities \"\"", "CW");
    expect("delaunay weights cities 1 2 METHOD n", "natural");
    expect("delaunay fdrop cities --h", "--help");
    cli_finish();
}

static void check_script(const char *shell)
{
    int status;
    const char *out = peer_shell(&status, "%s completion %s", getenv("DELAUNAY"), shell);
    CHECK_MSG(status == 0 && strstr(out, "completion words") != NULL, "%s", shell);
    peer_shell(&status, "command -v %s", shell);
    if (status != 0)
        SKIP("the Debian package %s is missing", shell);
    out = peer_shell(&status, "%s completion %s | %s -n 2>&1", getenv("DELAUNAY"), shell, shell);
    CHECK_MSG(status == 0, "%s", out);
}

TEST(completion_script_is_right_for_bash)
{
    check_script("bash");
}

TEST(completion_script_is_right_for_zsh)
{
    check_script("zsh");
}

TEST(completion_script_is_right_for_fish)
{
    check_script("fish");
}

TEST(fish_completes_commands_with_descriptions_values_and_files)
{
    static const struct {
        const char *line, *want;
    } cases[] = {{"delaunay tri", "triangles\ntriangulate\n"},
                 {"delaunay load -f n", "node\n"},
                 {"delaunay export t --format=s", "--format=svg\n"},
                 {"delaunay draw cit", "cities.csv\n"},
                 {"./delaunay tri", ""}};
    int status;
    const char *slash = strrchr(getenv("DELAUNAY"), '/');
    peer_shell(&status, "command -v fish");
    if (status != 0)
        SKIP("the Debian package fish is missing");
    cli_begin();
    cli_write("cities.csv", "");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        CHECK_STR(peer_shell(&status,
                             "PATH=$(realpath %.*s):$PATH; export PATH; cd %s; HOME=. fish -c "
                             "'delaunay completion fish | source; complete -C \"%s\"' | "
                             "cut -f 1",
                             (int)(slash - getenv("DELAUNAY")), getenv("DELAUNAY"), cli_path(""),
                             cases[i].line),
                  cases[i].want);
    cli_finish();
}

TEST(completion_names_the_shells_that_it_supports)
{
    int status;
    const char *out = peer_shell(&status, "%s completion tcsh 2>&1", getenv("DELAUNAY"));
    CHECK(status == 2 && strstr(out, "bash, zsh and fish, not for tcsh") != NULL);
    out = peer_shell(&status, "%s completion bash zsh 2>&1", getenv("DELAUNAY"));
    CHECK(status == 2 && strstr(out, "completion takes one shell") != NULL);
}

/* The page's text, without the backslashes before hyphens. */
static char *read_page(void)
{
    static char page[40000];
    FILE *f = fopen("man/delaunay.1", "r");
    CHECK(f != NULL);
    size_t n = 0;
    for (int c; (c = getc(f)) != EOF && n + 1 < sizeof page;)
        if (c != '\\')
            page[n++] = (char)c;
    fclose(f);
    page[n] = '\0';
    return page;
}

static void expect_in(const char *page, const char *word, size_t len)
{
    char text[40];
    snprintf(text, sizeof text, "%.*s", (int)len, word);
    CHECK_MSG(strstr(page, text) != NULL, "the manual page does not know %s", text);
}

TEST(manual_page_has_every_option_and_format)
{
    static const char *const more[] = {"--host",    "--port",   "--url",          "--json",
                                       "--version", "NO_COLOR", "DELAUNAY_TOKEN", "DELAUNAYD"};
    const char *page = read_page();
    size_t options = 0;
    for (size_t i = 0; i < subcommand_count; i++) {
        const struct subcommand *s = &subcommands[i];
        if (s->run != NULL)
            expect_in(page, s->name, strlen(s->name));
        const char *rest = s->options != NULL ? s->options : "";
        for (struct option_word o; option_word_next(&rest, &o); options++) {
            char option[40];
            snprintf(option, sizeof option, "--%.*s", (int)o.len, o.name);
            expect_in(page, option, strlen(option));
        }
    }
    CHECK(options > 80);
    for (size_t i = 0; i < format_count; i++)
        expect_in(page, formats[i].name, strlen(formats[i].name));
    for (size_t i = 0; i < sizeof more / sizeof more[0]; i++)
        expect_in(page, more[i], strlen(more[i]));
}
