/* ogr_file.c - see ogr_file.h. The name is an argument of the program, so such a file is no pipe and in no archive. */
#include "clients/files/ogr_file.h"

#include <stdio.h>
#include <string.h>

#include "clients/reading/program.h"
#include "clients/reading/word_list.h"

const char ogr_program[] = "ogr2ogr";
const char ogr_hint[] =
    " and write it as one layer of GeoJSON (ogr2ogr OUT FILE LAYER copies a layer)";

bool ogr_is_name(const char *path)
{
    return word_list_has_end(".shp .gpkg .fgb", path, strlen(path));
}

bool ogr_start(const char *path, pid_t *pid, int *out, char *why, size_t room)
{
    char name[4100]; /* which is no option */
    snprintf(name, sizeof name, "%s%s", path[0] == '-' ? "./" : "", path);
    const char *word[] = {ogr_program,   "-f", "GeoJSON", "-lco", "SIGNIFICANT_FIGURES=17",
                          "/vsistdout/", name, NULL};
    int failed = program_start(pid, word, -1, out, false);
    if (failed == 0)
        return true;
    *pid = 0;
    *out = -1;
    snprintf(why, room, "to read this file the program %s is needed (Debian: gdal-bin): %s",
             ogr_program, strerror(failed));
    return false;
}
