/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Studies that are run: records, failures, references that are no runs, the closed form. */
#include "study_read_help.h"

#include <inttypes.h>

/* ---- runs and records ---- */

static int told; /* lines of finished runs, counted by the log */
static void count_lines(void *data, gh_level level, const char *line) {
  (void)data, (void)level;
  told += strstr(line, ": done, ") || strstr(line, ": failed after ");
}

static bool after_some(void *data) {
  return --*(int *)data < 0;
}

static void run_study(place *p, gh_study *s, gh_status wanted, bool (*stop)(void *data), void *data,
                      bool fresh) {
  char folder[128];
  gh_study_options options = {.stop = stop, .stop_data = data, .fresh = fresh};
  snprintf(folder, sizeof folder, "%s/out", p->folder);
  gh_set_log(p->ctx, count_lines, NULL);
  told = 0;
  gh_status status = gh_study_run(s, folder, &options);
  if (status != wanted) fail_msg("status %d: %s", status, gh_message(p->ctx));
}

/* What has a record is not repeated; what was stopped is; a record with a changed byte is none. */
static void runs_are_kept(void **state) {
  place *p = *state;
  gh_study *s = study_of(p, SMALL "vary: {micro.tolerance: [1e-2, 1e-4, 1e-6]}\n" REFERENCE, false);
  int calls = 8;
  run_study(p, s, GH_STOPPED, after_some, &calls, false);
  int first = told;
  assert_in_range(first, 1, 3);
  assert_non_null(strstr(gh_message(p->ctx), "of 4 runs are finished and kept"));
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 4 - first);
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 0);
  study_run *run = s->configs[1].runs;
  const double P11 = run->curve.value[2 * 9];
  assert_true(run->finished && run->status == GH_OK && run->curve.n == 3 && run->curve.t[2] == 2 && P11 < 0);
  assert_true(run->force_evaluations > 0 && run->wall > 0 && run->core > 0 && run->residual <= 1e-4);
  assert_true(fabs(run->energy_defect) < 0.05); /* of the trapezoidal rule over two increments */
  char path[128];
  size_t length;
  snprintf(path, sizeof path, "%s/out/runs/%s.json", p->folder, run->id);
  char *text = get_file(path, &length);
  srand(5);
  print_message("seed 5\n");
  for (int k = 0; k < 300; k++) {
    size_t at = (size_t)rand() % length;
    char old = text[at];
    text[at] = (char)(old ^ (1 << rand() % 7));
    assert_int_equal(study_record_parse(s, text, run), text[at] == old ? GH_OK : GH_INPUT);
    text[at] = 0; /* cut there */
    assert_int_equal(study_record_parse(s, text, run), GH_INPUT);
    text[at] = old;
  }
  study_curve_free(&run->curve);
  assert_int_equal(study_record_parse(s, text, run), GH_OK);
  assert_true(run->curve.value[2 * 9] == P11); /* to the last bit */
  strcpy(run->id, "0");
  assert_int_equal(study_record_parse(s, text, run), GH_INPUT); /* of another run */
  free(text);
  gh_study_destroy(&s);
  s = study_of(p, SMALL "vary: {micro.tolerance: [1e-2, 1e-4, 1e-6]}\n" REFERENCE, false);
  put_file(p, "out/runs/x", "");
  FILE *file = fopen(path, "r+");
  assert_non_null(file);
  fputc('#', file);
  fclose(file);
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 1);
  run_study(p, s, GH_OK, NULL, NULL, true);
  assert_int_equal(told, 4);
  /* a fresh study that is stopped keeps no old records, so that it can be continued */
  calls = 8;
  run_study(p, s, GH_STOPPED, after_some, &calls, true);
  first = told;
  assert_in_range(first, 1, 3);
  assert_non_null(strstr(gh_message(p->ctx), "the same command without --fresh continues"));
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 4 - first);
  gh_study_destroy(&s);
}

/* A record of another build is used, and the tables say so; pictures of an earlier study are gone. */
static void other_builds_are_reported(void **state) {
  place *p = *state;
  char path[48], *at;
  size_t length;
  gh_text *text;
  gh_study *s = study_of(p, SMALL VARY REFERENCE, false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  put_file(p, "out/order.png", "old");
  for (int k = 0; k < 2; k++) { /* the second time as all builds before this one had it */
    assert_int_equal(gh_text_create(p->ctx, &text), GH_OK);
    assert_false(s->configs[k].runs[0].other_build);
    snprintf(path, sizeof path, "out/runs/%s.json", s->configs[k].runs[0].id);
    assert_int_equal(study_record_print(s, k, s->configs[k].runs, text), GH_OK);
    char *record = strdup(gh_text_get(text, NULL));
    assert_non_null(record);
    assert_non_null(at = strstr(record, "  \"build\": \""));
    if (k == 0) at[12] = 'x';
    else memmove(at, strchr(at, '\n') + 1, strlen(strchr(at, '\n')));
    assert_non_null(at = strstr(record, "  \"check\": \""));
    length = (size_t)(at - record);
    snprintf(at, 40, "  \"check\": \"%016" PRIx64 "\"\n}\n", gh_sum_bytes(GH_SUM_BEGIN, record, length));
    put_file(p, path, record);
    free(record);
    gh_text_destroy(&text);
  }
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 0);
  assert_true(s->configs[0].runs[0].other_build && s->configs[1].runs[0].other_build);
  char *page = get_file(in_folder(p, "out/study.md"), &length);
  assert_non_null(strstr(page, "2 of 3 runs were computed by another build of granhom"));
  free(page);
  assert_int_not_equal(access(in_folder(p, "out/order.png"), F_OK), 0);
  run_study(p, s, GH_OK, NULL, NULL, true);
  assert_false(s->configs[0].runs[0].other_build);
  gh_study_destroy(&s);
}

/* By relaxation alone, of which a few steps are too few. */
#define LAME                                                                                                 \
  "rve:\n  packing: @/p50.data\n  contact: {normal_stiffness: 50}\n"                                         \
  "  micro: {boundary: periodic, engine: native, relaxation: damped}\n"                                      \
  "  path: {legs: [{to: [0.99, 0, 0, 1], increments: 2}]}\n"

/* A run that fails is a result, and kept like others; when all fail the study has. */
static void failures_are_results(void **state) {
  place *p = *state;
  gh_study *s = study_of(
      p, LAME "vary: {micro.max_steps: [1, 100000]}\nreference: {set: {micro.tolerance: 1e-11}}\n", false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  const study_run *run = s->configs[0].runs;
  assert_true(run->finished && run->status == GH_DIVERGED && run->curve.n == 1);
  assert_non_null(strstr(run->message, "t = 1: no equilibrium within 1 relaxation steps"));
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 0);
  gh_study_destroy(&s);
  s = study_of(p, LAME "vary: {micro.max_steps: [1, 2]}\nreference: {set: {micro.tolerance: 1e-11}}\n",
               false);
  run_study(p, s, GH_DIVERGED, NULL, NULL, false);
  assert_non_null(
      strstr(gh_message(p->ctx), "no configuration has a result; the first one, micro.max_steps 1: t = 1: "));
  gh_study_destroy(&s);
}

/* Two configurations that come to the same are one run with two rows. */
static void twins_run_once(void **state) {
  place *p = *state;
  gh_study *s =
      study_of(p, SMALL "vary: {packing: ['@/p20.data', '@/../packings/p20.data']}\n" REFERENCE, false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  assert_int_equal(told, 2); /* and one for both references */
  assert_true(s->configs[1].runs->finished && s->configs[1].runs->curve.n == 3);
  assert_memory_equal(s->configs[0].runs->curve.value, s->configs[1].runs->curve.value, 27 * sizeof(double));
  gh_study_destroy(&s);
}

/* A scene that nothing drives is judged by its settlement: mean of the nodes under the last load. The mean of
 * P11 and P22 is that of the dead load, by virtual work in u = (X, 0) and (0, Y). */
static void scenes_without_driven_edges(void **state) {
  place *p = *state;
  put(p, "scene.yaml",
      SCENE "results: {rves: [99]}\nsteps: [{increments: 2, pressure: [{edge: right, to: 0.4}, {edge: top, "
            "to: 0.4}]}]\n");
  gh_study *s = study_of(p,
                         "scene: scene.yaml\nvary: {solver.tolerance: [1e-3, 1e-10]}\nbase: {refine: 2}\n"
                         "reference: {set: {solver.tolerance: 1e-11}}\n",
                         false);
  assert_string_equal(s->column[5], "displacement_y");
  assert_string_equal(s->quantities[1].name, "displacement");
  run_study(p, s, GH_OK, NULL, NULL, false);
  const study_curve *c = &s->configs[1].runs->curve;
  assert_true(c->n == 5 && c->t[0] == 0 && c->t[1] == 0.25 && c->t[4] == 1); /* refine 2 of two increments */
  const double *last = c->value + 4 * 7;
  near(last[0], -0.4, 1e-8), near(last[3], -0.4, 1e-8);
  assert_true(last[4] < 0 && last[6] < 0); /* the first load's edge, right, has moved to the left */
  gh_study_destroy(&s);
}

/* ---- references that are no runs ---- */

static const char lattice_packing[] =
    "lattice\n\n4 atoms\n1 atom types\n\n0 2 xlo xhi\n0 1.7320508075688772 ylo yhi\n"
    "-0.5 0.5 zlo zhi\n\nAtoms # sphere\n\n"
    "1 1 1.04 1 0 0 0\n2 1 1.04 1 1 0 0\n"
    "3 1 1.04 1 0.5 0.8660254037844386 0\n4 1 1.04 1 1.5 0.8660254037844386 0\n";

#define LATTICE                                                                                              \
  "rve:\n  packing: lattice.data\n  contact: {normal_stiffness: 50}\n  micro: {engine: native}\n"            \
  "  path: {legs: [{to: [0.97, 0, 0, 0.97], increments: 2}, {to: [0.95, 0.03, 0.01, 1.08], increments: "     \
  "3}]}\n"

/* P of the program equals that of the closed form, through compression, shear and the opening of bonds. */
static void triangular_lattice(void **state) {
  place *p = *state;
  put_file(p, "lattice.data", lattice_packing);
  gh_study *s = study_of(p,
                         LATTICE "vary: {micro.boundary: [taylor-cell, periodic], refine: [1, 3]}\n"
                                 "reference: {closed_form: triangular-lattice}\n",
                         false);
  assert_int_equal(s->nconfigs, 4);
  assert_int_equal(s->given.n, 16);
  for (int k = 1; k < 16; k++) assert_true(s->given.t[k] > s->given.t[k - 1]);
  run_study(p, s, GH_OK, NULL, NULL, false);
  for (int k = 0; k < 4; k++) {
    const study_judged *row = s->verdict->row + k;
    assert_int_equal(row->points, k % 2 ? 16 : 6);
    for (int q = 0; q < 2; q++)
      if (!(row->l2[q] < 1e-12)) fail_msg("configuration %d, quantity %d: error %g", k, q, row->l2[q]);
  }
  gh_study_destroy(&s);
}

/* Isotropic: three bonds with sum n (x) n = 3/2 give P = -sqrt(3) E (2 r - c a)/a, and the energy is 1.5 E
 * overlap^2 for the area of a grain. Others than this lattice are refused. */
static void lattice_alone(void **state) {
  static const struct {
    const char *from, *to, *message;
  } wrong[] = {{"2 1 1.04", "2 1 1.05", "grains 1 and 2 have the radii 0.52 and 0.525"},
               {"0.5 0.866", "0.51 0.866", "grain 3 is off by"},
               {"0 2 xlo", "0 2.1 xlo", "no triangular lattice"},
               {"4 1 1.04 1 1.5 0.8660254037844386 0\n", "", "no triangular lattice: 3 grains at 4 places"}};
  place *p = *state;
  gh_contact_law law = {.normal_stiffness = 50};
  const double F[4] = {0.95, 0, 0, 0.95}, narrow[4] = {0.5, 0, 0, 1}, overlap = 1.04 - 0.95;
  double answer[9];
  study_lattice l;
  gh_packing *packing;
  assert_int_equal(gh_packing_read(p->ctx, put_file(p, "lattice.data", lattice_packing), &packing), GH_OK);
  assert_int_equal(study_lattice_find(p->ctx, packing, &law, &l), GH_OK);
  assert_true(fabs(l.radius - 0.52) < 1e-15 && fabs(l.spacing - 1) < 1e-15);
  assert_int_equal(study_lattice_answer(p->ctx, &l, F, answer), GH_OK);
  for (int k = 0; k < 4; k++) near(answer[k], k % 3 ? 0 : -sqrt(3) * 50 * overlap, 1e-13);
  near(answer[4], -sqrt(3) * 50 * overlap / 0.95, 1e-13);
  near(answer[8], 1.5 * 50 * overlap * overlap / (sqrt(3) / 2), 1e-13);
  assert_int_equal(study_lattice_answer(p->ctx, &l, narrow, answer), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "grains touch that are not next to each other"));
  law.friction = true;
  assert_int_equal(study_lattice_find(p->ctx, packing, &law, &l), GH_INPUT);
  law.friction = false;
  gh_packing_destroy(&packing);
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char text[1024];
    const char *at = strstr(lattice_packing, wrong[k].from);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - lattice_packing), lattice_packing, wrong[k].to,
             at + strlen(wrong[k].from));
    if (!*wrong[k].to) *strchr(text, '4') = '3';
    assert_int_equal(gh_packing_read(p->ctx, put_file(p, "wrong.data", text), &packing), GH_OK);
    gh_status status = study_lattice_find(p->ctx, packing, &law, &l);
    if (status != GH_INPUT || !strstr(gh_message(p->ctx), wrong[k].message))
      fail_msg("case %zu: %s", k, status == GH_OK ? "accepted" : gh_message(p->ctx));
    gh_packing_destroy(&packing);
  }
  gh_study *s;
  const char *path =
      put(p, "study.yaml",
          LATTICE "vary: {contact.normal_stiffness: [1, 2]}\nreference: {closed_form: triangular-lattice}\n");
  assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_INPUT);
  assert_non_null(
      strstr(gh_message(p->ctx), "study.yaml:7: reference: a closed form needs the same contact law"));
}

/* A file with t and the columns of what is compared. */
static void reference_from_a_file(void **state) {
  static const char study[] = SMALL VARY "reference: {file: other.csv}\nquantities: [stress]\n";
  place *p = *state;
  gh_study *s;
  put_file(p, "other.csv", "t,P11,P12,P21,P22\n0,-1,0,0,-1\n1,-2,0,0,-1\n2,-3,0,0,-1\n");
  s = study_of(p, study, false);
  assert_true(s->reference == STUDY_FILE && s->given.n == 3 && s->given.value[2 * 9] == -3);
  assert_true(isnan(s->given.value[8]) && s->configs[0].reference == -1 && s->nconfigs == 2);
  gh_study_destroy(&s);
  const char *path = put(p, "study.yaml", SMALL VARY "reference: {file: other.csv}\n");
  assert_int_equal(gh_study_read(p->ctx, path, false, &s), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "other.csv:1: no column energy, which a quantity needs"));
  put_file(p, "other.csv", "t,P11,P12,P21,P22\n0,-1,0,0,-1\n0,-2,0,0,-1\n");
  assert_int_equal(gh_study_read(p->ctx, put(p, "study.yaml", study), false, &s), GH_INPUT);
  assert_non_null(strstr(gh_message(p->ctx), "other.csv:3: t is 0, it must grow from row to row"));
}

/* Another program's Cauchy stress becomes P; it reports no energy, and does what it can alone. Without
 * friction both find the same equilibrium. */
static void other_programs(void **state) {
  place *p = *state;
  gh_study *s = study_of(p,
                         "rve:\n  packing: @/p50d.data\n  contact: {normal_stiffness: 50}\n"
                         "  micro: {engine: native}\n"
                         "  path: {legs: [{to: [0.995, 0.004, 0.001, 0.998], increments: 2}]}\n"
                         "vary: {micro.engine: [native, gran], micro.boundary: [periodic, taylor]}\n"
                         "reference: {set: {micro.engine: native, micro.tolerance: 1e-11}}\n",
                         false);
  run_study(p, s, GH_OK, NULL, NULL, false);
  const study_run *gran = s->configs[2].runs, *taylor = s->configs[3].runs;
  if (gran->status != GH_OK) fail_msg("%s", gran->message);
  if (!(s->verdict->row[2].l2[0] < 1e-6)) fail_msg("error of the stress %g", s->verdict->row[2].l2[0]);
  assert_true(gran->curve.n == 3 && gran->force_evaluations > 0 && isnan(gran->curve.value[8]));
  assert_true(isnan(s->verdict->row[2].l2[1]) && isnan(s->verdict->row[2].largest[1]));
  assert_true(taylor->finished && taylor->status == GH_INPUT);
  assert_non_null(strstr(taylor->message, "gran relaxes all grains of a periodic cell"));
  gh_study_destroy(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(runs_are_kept),  TEST(other_builds_are_reported), TEST(failures_are_results),
      TEST(twins_run_once), TEST(triangular_lattice),        TEST(scenes_without_driven_edges),
      TEST(lattice_alone),  TEST(reference_from_a_file),     TEST(other_programs)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
