/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom help keys, granhom help columns. */
#include "reference.h"
#include "pack_spec.h"

#include "granhom/report.h"
#include "granhom/scene.h"
#include "study/study.h"

#include <stdio.h>
#include <string.h>

static void print_list(gh_text *out, const gh_term_list *list) {
  for (const gh_term_list *l = list; l->title; l++) {
    gh_text_print(out, "%s### %s\n\n", l == list ? "" : "\n", l->title);
    gh_terms_print(out, l->terms);
  }
}

static void print_pack(gh_text *out) {
  pack_terms t;
  pack_terms_list(&t);
  const gh_term_list list[] = {{"packing file", t.terms}, {0}};
  print_list(out, list);
}

static void print_element(gh_text *out) {
  static const gh_term_list list[] = {{"control file", element_keys},
                                      {"steps", element_step_keys},
                                      {"values of control", element_way_keys},
                                      {"repetition, in the place of a step", element_repeat_keys},
                                      {0}};
  print_list(out, list);
}

static void print_scene(gh_text *out) {
  print_list(out, gh_scene_keys());
}

static void print_study(gh_text *out) {
  print_list(out, gh_study_keys());
}

static void print_run_columns(gh_text *out) {
  print_list(out, gh_results_columns());
  print_list(out, gh_scene_columns());
}

static void print_point_columns(gh_text *out) {
  static const gh_term_list list[] = {{"OUT.csv of rve and element", columns_point},
                                      {"OUT.csv with friction", columns_friction},
                                      {"OUT.csv on a frame, then", columns_frame},
                                      {"OUT.csv with servo-control, then", columns_servo},
                                      {"OUT.csv of rve with friction, then", columns_ramp},
                                      {"OUT.csv of rve, then", columns_path},
                                      {"OUT.csv of element, then", columns_control},
                                      {"--tangent", columns_tangent},
                                      {0}};
  print_list(out, list);
}

static void print_compared_columns(gh_text *out) {
  print_list(out, gh_comparison_columns());
}

static void print_study_columns(gh_text *out) {
  print_list(out, gh_study_columns());
}

static const struct {
  const char *topic, *file;
  void (*print)(gh_text *out);
} pages[] = {{"keys", "scene", print_scene},
             {"keys", "element", print_element},
             {"keys", "pack", print_pack},
             {"keys", "study", print_study},
             {"columns", "run", print_run_columns},
             {"columns", "rve", print_point_columns},
             {"columns", "study", print_study_columns},
             {"columns", "compare", print_compared_columns}};
enum { PAGES = sizeof pages / sizeof *pages };

static int print_text(gh_context *ctx, const char *topic, const char *file) {
  gh_text *out;
  int found = 0;
  if (gh_text_create(ctx, &out) != GH_OK) return 1;
  for (int k = 0; k < PAGES; k++) {
    if (strcmp(pages[k].topic, topic) != 0 || (file && strcmp(pages[k].file, file) != 0)) continue;
    if (found++) gh_text_print(out, "\n");
    pages[k].print(out);
  }
  const bool good = gh_text_check(out) == GH_OK;
  if (good && found) fputs(gh_text_get(out, NULL), stdout);
  gh_text_destroy(&out);
  if (good && found) return 0;
  if (good) fprintf(stderr, "granhom: `granhom help %s` knows no '%s'\n", topic, file);
  return good ? 2 : 1;
}

int reference_help(const char *topic, const char *file) {
  gh_context *ctx;
  if (strcmp(topic, "keys") != 0 && strcmp(topic, "columns") != 0) return -1;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  const int code = print_text(ctx, topic, file);
  gh_context_destroy(&ctx);
  return code;
}
