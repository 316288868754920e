/* formats_test.c - the files of `delaunay export`, read back by readers of this test's own and compared
 * with the server's replies in lines. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

enum { POINTS = 120, ROOM = 1000 };

struct mesh {
    double xy[ROOM][2];
    unsigned triangle[ROOM][3];
    size_t n, triangles;
};

/* Creates the set t of random points, triangulated, and reads it from the server. */
static void make_set(struct mesh *want)
{
    FILE *f = fopen(cli_path("t.xy"), "w");
    CHECK(f != NULL);
    for (int i = 0; i < POINTS; i++)
        fprintf(f, "%.17g %.17g\n", 100 * test_uniform() - 50, 1e-3 * test_uniform() + 7);
    fclose(f);
    char command[200];
    snprintf(command, sizeof command, "load t %s", cli_path("t.xy"));
    cli_run_well(command);
    cli_run_well("triangulate t");
    int status;
    unsigned id;
    const char *p = cli_run(&status, "points t");
    for (want->n = 0; (p = strchr(p, '\n') + 1)[0] != 0; want->n++)
        CHECK(sscanf(p, "%u %lf %lf", &id, &want->xy[want->n][0], &want->xy[want->n][1]) == 3);
    p = cli_run(&status, "triangles t");
    for (want->triangles = 0; (p = strchr(p, '\n') + 1)[0] != 0; want->triangles++) {
        unsigned *v = want->triangle[want->triangles];
        CHECK(sscanf(p, "%u %u %u", &v[0], &v[1], &v[2]) == 3);
    }
    CHECK(want->n == POINTS && want->triangles > POINTS);
}

static FILE *export(const char *format)
{
    char command[300], name[32];
    snprintf(name, sizeof name, "out.%s", format);
    snprintf(command, sizeof command, "export t %s --format %s", cli_path(name), format);
    cli_run_well(command);
    FILE *f = fopen(cli_path(name), "r");
    CHECK(f != NULL);
    return f;
}

static void close_at_end(FILE *f)
{
    char more[2];
    CHECK(fscanf(f, " %1s", more) == EOF);
    fclose(f);
}

static void check_points(const struct mesh *want, const struct mesh *got)
{
    CHECK(got->n == want->n);
    CHECK(memcmp(got->xy, want->xy, got->n * sizeof got->xy[0]) == 0);
}

static void check_triangles(const struct mesh *want, const struct mesh *got)
{
    CHECK(got->triangles == want->triangles);
    CHECK(memcmp(got->triangle, want->triangle, got->triangles * sizeof got->triangle[0]) == 0);
}

/* Reads rows `[prefix] x y 0` and `[prefix] a b c`, numbers counted from base. */
static void read_xyz(FILE *f, const char *prefix, size_t n, struct mesh *m)
{
    char word[16];
    double z = 1;
    for (m->n = 0; m->n < n; m->n++) {
        CHECK(*prefix == 0 || (fscanf(f, "%15s", word) == 1 && strcmp(word, prefix) == 0));
        CHECK(fscanf(f, "%lf %lf %lf", &m->xy[m->n][0], &m->xy[m->n][1], &z) == 3 && z == 0);
    }
}

static void read_faces(FILE *f, const char *prefix, size_t n, unsigned base, struct mesh *m)
{
    char word[16];
    for (m->triangles = 0; m->triangles < n; m->triangles++) {
        unsigned *v = m->triangle[m->triangles];
        CHECK(fscanf(f, "%15s", word) == 1 && strcmp(word, prefix) == 0);
        CHECK(fscanf(f, "%u %u %u", &v[0], &v[1], &v[2]) == 3);
        for (int k = 0; k < 3; k++)
            v[k] -= base;
    }
}

TEST(export_meshes_are_read_back)
{
    static struct mesh want, got;
    size_t n = 0, faces = 0;
    char line[200];
    cli_begin();
    make_set(&want);
    FILE *f = export("off");
    CHECK(fscanf(f, "OFF %zu %zu 0", &n, &faces) == 2);
    read_xyz(f, "", n, &got);
    read_faces(f, "3", faces, 0, &got);
    close_at_end(f);
    check_points(&want, &got);
    check_triangles(&want, &got);

    f = export("ply");
    while (fgets(line, sizeof line, f) != NULL && strcmp(line, "end_header\n") != 0) {
        sscanf(line, "element vertex %zu", &n);
        sscanf(line, "element face %zu", &faces);
    }
    read_xyz(f, "", n, &got);
    read_faces(f, "3", faces, 0, &got);
    close_at_end(f);
    check_points(&want, &got);
    check_triangles(&want, &got);

    f = export("obj");
    CHECK(fgets(line, sizeof line, f) != NULL && line[0] == '#');
    read_xyz(f, "v", want.n, &got);
    read_faces(f, "f", want.triangles, 1, &got);
    close_at_end(f);
    check_points(&want, &got);
    check_triangles(&want, &got);
    cli_finish();
}

TEST(export_2dm_is_read_back)
{
    static struct mesh want, got;
    unsigned number, *v;
    double z;
    cli_begin();
    make_set(&want);
    FILE *f = export("2dm");
    CHECK(fscanf(f, "MESH2D") == 0);
    for (; (v = got.triangle[got.triangles],
           fscanf(f, " E3T %u %u %u %u 1", &number, &v[0], &v[1], &v[2]) == 4);
         got.triangles++) {
        CHECK(number == got.triangles + 1);
        for (int k = 0; k < 3; k++)
            v[k]--;
    }
    rewind(f);
    char line[200];
    while (fgets(line, sizeof line, f) != NULL)
        if (sscanf(line, "ND %u %lf %lf %lf", &number, &got.xy[got.n][0], &got.xy[got.n][1], &z) ==
            4)
            CHECK(number == ++got.n && z == 0);
    fclose(f);
    check_points(&want, &got);
    check_triangles(&want, &got);
    cli_finish();
}

/* Whether the triangle has the edge a-b. */
static bool has_edge(const unsigned *v, unsigned a, unsigned b)
{
    return (v[0] == a || v[1] == a || v[2] == a) && (v[0] == b || v[1] == b || v[2] == b);
}

static unsigned triangles_at(const struct mesh *m, unsigned a, unsigned b)
{
    unsigned n = 0;
    for (size_t t = 0; t < m->triangles; t++)
        n += has_edge(m->triangle[t], a, b);
    return n;
}

TEST(export_files_of_triangle_are_read_back)
{
    static struct mesh want, got;
    size_t n = 0;
    unsigned number, a, b, boundary, hull = 0;
    cli_begin();
    make_set(&want);
    FILE *f = export("node");
    CHECK(fscanf(f, "%zu 2 0 1", &n) == 1);
    for (got.n = 0; got.n < n; got.n++) {
        CHECK(fscanf(f, "%u %lf %lf %u", &number, &got.xy[got.n][0], &got.xy[got.n][1],
                     &boundary) == 4);
        CHECK(number == got.n && boundary < 2);
        hull += boundary;
    }
    close_at_end(f);
    check_points(&want, &got);

    f = export("ele");
    CHECK(fscanf(f, "%zu 3 0", &n) == 1);
    for (got.triangles = 0; got.triangles < n; got.triangles++) {
        unsigned *v = got.triangle[got.triangles];
        CHECK(fscanf(f, "%u %u %u %u", &number, &v[0], &v[1], &v[2]) == 4 &&
              number == got.triangles);
    }
    close_at_end(f);
    check_triangles(&want, &got);

    f = export("neigh");
    CHECK(fscanf(f, "%zu 3", &n) == 1 && n == want.triangles);
    for (size_t t = 0; t < n; t++) {
        const unsigned *v = want.triangle[t];
        int next[3];
        CHECK(fscanf(f, "%u %d %d %d", &number, &next[0], &next[1], &next[2]) == 4 && number == t);
        for (int k = 0; k < 3; k++) {
            a = v[(k + 1) % 3];
            b = v[(k + 2) % 3];
            CHECK(next[k] == -1 ? triangles_at(&want, a, b) == 1
                                : has_edge(want.triangle[next[k]], a, b) && (size_t)next[k] != t);
        }
    }
    close_at_end(f);

    f = export("edge");
    CHECK(fscanf(f, "%zu 1", &n) == 1 && n == want.n + want.triangles - 1);
    for (size_t i = 0; i < n; i++) {
        CHECK(fscanf(f, "%u %u %u %u", &number, &a, &b, &boundary) == 4 && number == i);
        CHECK(triangles_at(&want, a, b) == (boundary ? 1 : 2));
        hull -= boundary;
    }
    CHECK(hull == 0); /* as many edges as points */
    close_at_end(f);
    cli_finish();
}

TEST(export_lines_of_triangles_are_read_back)
{
    static struct mesh want;
    unsigned v[3];
    double x[4], y[4];
    char line[1000];
    size_t rows = 0;
    cli_begin();
    make_set(&want);
    FILE *f = export("wkt");
    CHECK(fgets(line, sizeof line, f) != NULL && strcmp(line, "WKT,a,b,c\n") == 0);
    for (; fgets(line, sizeof line, f) != NULL; rows++) {
        CHECK(sscanf(line, "\"POLYGON ((%lf %lf, %lf %lf, %lf %lf, %lf %lf))\",%u,%u,%u", &x[0],
                     &y[0], &x[1], &y[1], &x[2], &y[2], &x[3], &y[3], &v[0], &v[1], &v[2]) == 11);
        CHECK(memcmp(v, want.triangle[rows], sizeof v) == 0);
        for (int k = 0; k < 4; k++)
            CHECK(x[k] == want.xy[want.triangle[rows][k % 3]][0] &&
                  y[k] == want.xy[want.triangle[rows][k % 3]][1]);
    }
    CHECK(rows == want.triangles);
    fclose(f);

    f = export("csv");
    CHECK(fgets(line, sizeof line, f) != NULL && strcmp(line, "a,b,c,ax,ay,bx,by,cx,cy\n") == 0);
    for (rows = 0; fgets(line, sizeof line, f) != NULL; rows++) {
        CHECK(sscanf(line, "%u,%u,%u,%lf,%lf,%lf,%lf,%lf,%lf", &v[0], &v[1], &v[2], &x[0], &y[0],
                     &x[1], &y[1], &x[2], &y[2]) == 9);
        CHECK(memcmp(v, want.triangle[rows], sizeof v) == 0);
        CHECK(x[2] == want.xy[v[2]][0] && y[2] == want.xy[v[2]][1]);
    }
    CHECK(rows == want.triangles);
    fclose(f);
    cli_finish();
}

TEST(properties_of_triangles_in_geojson_are_single_values)
{
    static struct mesh want;
    unsigned v[3];
    double x[4], y[4];
    char line[1000];
    static const char *const formats[] = {"geojson", "ndjson"};
    cli_begin();
    make_set(&want);
    for (int i = 0; i < 2; i++) {
        size_t rows = 0;
        FILE *f = export(formats[i]);
        while (fgets(line, sizeof line, f) != NULL) {
            if (sscanf(
                    line,
                    "{\"type\":\"Feature\",\"properties\":{\"a\":%u,\"b\":%u,\"c\":%u},"
                    "\"geometry\":{"
                    "\"type\":\"Polygon\",\"coordinates\":[[[%lf,%lf],[%lf,%lf],[%lf,%lf],[%lf,%lf]"
                    "]]}}",
                    &v[0], &v[1], &v[2], &x[0], &y[0], &x[1], &y[1], &x[2], &y[2], &x[3],
                    &y[3]) != 11)
                continue;
            CHECK(memcmp(v, want.triangle[rows++], sizeof v) == 0);
            CHECK(x[3] == x[0] && y[3] == y[0] && y[1] == want.xy[v[1]][1]);
        }
        CHECK(rows == want.triangles);
        fclose(f);
    }
    cli_finish();
}

/* Shapefile and FlatGeobuf have no lists as values. */
TEST(triangles_keep_their_properties_in_the_formats_of_gdal)
{
    static struct mesh want;
    int status;
    cli_begin();
    make_set(&want);
    peer_shell(&status, "command -v ogr2ogr");
    if (status != 0) {
        puts("skipped: formats of GDAL need ogr2ogr (gdal-bin)");
        cli_finish();
        return;
    }
    char path[128], values[20 * POINTS];
    size_t n = (size_t)sprintf(values, "fset t z");
    for (int i = 0; i < POINTS; i++)
        n += (size_t)sprintf(values + n, "  %d %d.5", i, i);
    cli_run_well(values);
    fclose(export("geojson"));
    fclose(export("wkt"));
    snprintf(path, sizeof path, "%s", cli_path("out"));
    static const char *const formats[] = {"FlatGeobuf:fgb", "ESRI Shapefile:shp"};
    for (int i = 0; i < 2; i++) {
        const char *ending = strchr(formats[i], ':') + 1;
        const char *got = peer_shell(&status,
                                     "ogr2ogr -f '%.*s' %s.%s %s.geojson 2>&1 && ogrinfo -so -al "
                                     "%s.%s",
                                     (int)(ending - formats[i] - 1), formats[i], path, ending, path,
                                     path, ending);
        char count[40];
        snprintf(count, sizeof count, "Feature Count: %zu\n", want.triangles);
        CHECK_MSG(status == 0 && strstr(got, count) != NULL, "%s", got);
        CHECK(strstr(got, "\na: Integer") != NULL && strstr(got, "\nbz: Real") != NULL);
    }
    const char *got = peer_shell(&status, "ogrinfo -al CSV:%s.wkt | grep -c '^  POLYGON'", path);
    CHECK_MSG(status == 0 && (size_t)atoi(got) == want.triangles, "%s", got);
    cli_finish();
}

TEST(export_ids_with_gaps_are_renumbered)
{
    cli_begin();
    cli_run_well("ADD t 9 9  0 0  4 0  4 3");
    cli_run_well("DEL t 0");
    cli_run_well("triangulate t");
    cli_expect("export t - --format ele", "1 3 0\n0 0 1 2\n");
    cli_expect("export t - --format csv", "a,b,c,ax,ay,bx,by,cx,cy\n1,2,3,0,0,4,0,4,3\n");
    cli_finish();
}

TEST(export_colours_numbers_and_viewport)
{
    int status;
    cli_begin();
    cli_run_well("ADD t 0 0  4 0  4 4  0 4  2 2  100 2");
    cli_run_well("triangulate t");
    const char *svg = cli_run(&status, "export t - --colour quality --viewport=-1,-1,5,5");
    CHECK(status == 0 && strstr(svg, "class=\"q8\"") != NULL && strstr(svg, "class=\"t\"") == NULL);
    CHECK(strstr(svg, ">4</text>") != NULL && strstr(svg, ">5</text>") == NULL);
    CHECK(strstr(svg, "triangulation of 5 of 6 points<") != NULL && strstr(svg, ">flat<") != NULL);
    svg = cli_run(&status, "export t - --colour angle --viewport=-1,-1,5,5");
    CHECK(status == 0 && strstr(svg, "fill=\"#96caaf\" stroke=\"#fff\"") != NULL); /* 45 degrees */
    CHECK(strstr(svg, ">least angle</text>") != NULL && strstr(svg, ">60\u00b0</text>") != NULL);
    svg = cli_run(&status, "export t - --viewport 50,1,51,2"); /* a box without points */
    CHECK(status == 0 && strstr(svg, "class=\"t\"") != NULL && strstr(svg, "of 0 of 6") != NULL);
    svg = cli_run(&status, "export t - --colour degree");
    CHECK(status == 0 && strstr(svg, "class=\"q") != NULL);
    cli_run(&status, "export t - --viewport 1,1,0,0");
    CHECK(status == 2);
    cli_run(&status, "export t x.dwg");
    CHECK(status == 2);
    cli_finish();
}
