/* view_save.h - edits save for views what they change.
 *
 * An edit learns from the views which moments are read (dt_views_edit_begin) and is called back for what it is
 * about to change (core/points/changes.h). */
#ifndef DT_VIEW_SAVE_H
#define DT_VIEW_SAVE_H

#include "core/set/set.h"

/* To be called at the beginning of every edit. */
void dt_views_edit_begin(struct dt *t);

#endif
