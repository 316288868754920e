/* cmd_mesh.c - REFINE: the request becomes a PSLG that is planned as a split is (changes/pslg.h). */
#include "server/command/command.h"

#include "server/command/options.h"
#include "server/rows/surface_rows.h"

enum { ANGLE_UNASKED = 25, POINTS_EACH = 16 }; /* without limits; and that may be added for each */

static bool check_limit(struct answer *a, const struct word *w, const void *value)
{
    return *(const double *)value > 0 || answer_err(a, ERR_RANGE, "a limit is more than 0");
}

static bool check_angle(struct answer *a, const struct word *w, const void *value)
{
    if (!check_limit(a, w, value))
        return false;
    bool good = *(const double *)value < 60;
    if (!good)
        answer_err(a, ERR_RANGE, "no triangle has all angles above 60 degrees; this is %.*s",
                   QUOTED(w));
    return good;
}

struct refinement {
    double angle, area, length;
    struct inside inside;
    bool keep;
    uint32_t most;
};

#define AT(FIELD) .offset = offsetof(struct refinement, FIELD)

static const struct option options[] = {
    {"ANGLE", OPTION_LENGTH, AT(angle), .what = "limit", .check = check_angle},
    {"AREA", OPTION_LENGTH, AT(area), .what = "limit", .check = check_limit},
    {"LENGTH", OPTION_LENGTH, AT(length), .what = "limit", .check = check_limit},
    {"INSIDE", OPTION_INSIDE, AT(inside)},
    {"KEEP", OPTION_FLAG, AT(keep)},
    {"LIMIT", OPTION_COUNT, AT(most), .what = "a number of points"},
};

bool read_refinement(struct server *s, const struct dataset *set, const struct request *q,
                     struct answer *a, struct change *c)
{
    struct refinement r = {.inside.number = DT_NONE,
                           .most = POINTS_EACH * set->current->sum.points};
    c->pslg = pslg_new();
    if (c->pslg == NULL)
        answer_out_of_memory(a);
    if (c->pslg == NULL ||
        !options_read(a, q, 2, set, options, sizeof options / sizeof *options, ~0u, &r))
        return false;
    if (r.angle == 0 && r.area == 0 && r.length == 0)
        r.angle = ANGLE_UNASKED;
    c->first = CHANGE_ANY;
    c->pslg->refines = c->pslg->splits = true;
    c->pslg->quality = (struct dt_quality){.angle = r.angle,
                                           .area = r.area,
                                           .length = r.length,
                                           .number = r.inside.number,
                                           .keep = r.keep,
                                           .most = r.most};
    return true;
}
