/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One walk over the columns of history.csv, for their names and for a row; shared by both kinds of a run. */
#ifndef GRANHOM_SCENE_HISTORY_H
#define GRANHOM_SCENE_HISTORY_H

#include "scene/output.h"

typedef struct scene_walk {
  const gh_scene *scene;
  bool present;      /* an increment is there; false: names alone */
  gh_column *column; /* NULL: values alone, or to be counted */
  double *value;     /* NULL: names alone */
  int n;
} scene_walk;

void scene_walk_column(scene_walk *w, const char *name, bool may_be_nan, double value);
void scene_walk_loads(scene_walk *w);
/* reaction: of a set, asked for only where an increment is there. */
void scene_walk_reactions(scene_walk *w, void (*reaction)(const void *data, int set, double sum[2]),
                          const void *data);

#endif
