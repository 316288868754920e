/* pass.c - see pass.h. */
#include "core/triangle/pass.h"

#include "core/query/query.h"
#include "core/set/view_rows.h"

enum dt_status dt_pass_begin(struct dt_pass *p, const struct dt *t, const struct dt_view *v)
{
    p->view = v;
    return dt_table_begin(t, v, DT_TRIANGLES, false, &p->cursor);
}

enum dt_status dt_pass_inside(struct dt_pass *p, const struct dt *t, uint32_t number)
{
    if (dt_view_if_changed(t, p->view) != NULL)
        return DT_UNSURVEYED;
    p->inside = true;
    return dt_enclosure_of(t, number, &p->enclosure);
}

enum dt_status dt_pass_check(const struct dt_pass *p, const struct dt *t)
{
    enum dt_status status = dt_view_readable(t, p->view, true);
    bool gone = status == DT_OK && p->inside && dt_view_if_changed(t, p->view) != NULL;
    return gone ? DT_UNSURVEYED : status;
}

bool dt_pass_is_late(struct dt_pass *p, const struct dt *t)
{
    if (p->tabled || dt_view_if_changed(t, p->view) == NULL)
        return false;
    p->tabled = true;
    return true;
}

enum dt_status dt_pass_read(struct dt_pass *p, const struct dt *t, bool *done)
{
    size_t rows;
    *done = false;
    if (p->at < p->words)
        return DT_OK;
    enum dt_status status =
        dt_table_read(t, &p->cursor, p->row, 3 * DT_PASS_ROWS, DT_PASS_ROWS, &rows, &p->words);
    p->at = 0;
    *done = status == DT_OK && rows == 0;
    return status == DT_TOOLONG ? DT_OK : status; /* the next call goes on */
}
