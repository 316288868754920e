/* recipes_test.c - the recipes in clients/README.md say what the commands answer. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

/* The blocks of the section show commands, each `$ command` with its output; running these commands shows the same. */
TEST(recipes_answer_what_the_readme_says)
{
    int status;
    cli_begin();
    const char *got =
        peer_shell(&status,
                   "R=$PWD D=$(realpath %s) DELAUNAYD=$(realpath %s) DELAUNAY_PORT=%s; "
                   "export D DELAUNAYD DELAUNAY_PORT; cd %s && cp $R/clients/examples/*.geojson "
                   "$R/clients/examples/*.csv $R/clients/examples/*.asc . && "
                   "awk '/^## /{on=/^## Recipes/} /^```/{code=on && /console/; next} on && code' "
                   "$R/clients/README.md > want && "
                   "delaunay() { \"$D\" \"$@\" 2>/dev/null; } && "
                   "grep '^\\$ ' want | cut -c 3- | while IFS= read -r command; do "
                   "printf '$ %%s\\n' \"$command\"; eval \"$command\"; done > got; "
                   "grep -c '^\\$ ' want; diff want got",
                   getenv("DELAUNAY"), getenv("DELAUNAYD"), cli_daemon.port_text, cli_path("."));
    CHECK_STR(got, "32\n");
    CHECK(status == 0);
    cli_finish();
}
