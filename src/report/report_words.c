/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What came out and what was computed, in words. */
#include "report/report.h"

#include <string.h>

/* ---- sums over the increments ---- */

static double sum(const report *r, const char *column) {
  double total = 0;
  for (int k = 0; k < r->n; k++) {
    double v = report_history(r, k, column);
    if (isfinite(v)) total += v;
  }
  return total;
}

/* The largest residual and its increment. */
static double worst_residual(const report *r, int *at) {
  double worst = -1;
  *at = 0;
  for (int k = 0; k < r->n; k++)
    if (report_history(r, k, "residual") > worst) worst = report_history(r, k, "residual"), *at = k;
  return worst;
}

static double tolerance(const report *r) {
  return report_run_number(r, (const char *const[]){"options", "solver", "tolerance", NULL});
}

static int lost_at(const report *r, int k) {
  int n = 0;
  for (int p = 0; p < r->np; p++) n += !(r->acoustic[(size_t)k * (size_t)r->np + (size_t)p] > 0);
  return n;
}

/* ---- the verdict ---- */

static void begin(report *r, const char *class, const char *head) {
  static const char *const signs[] = {"\xe2\x9c\x93", "!", "\xe2\x9c\x97"};
  int k = strcmp(class, "good") == 0 ? 0 : strcmp(class, "warn") == 0 ? 1 : 2;
  gh_text_print(r->out, "<div class=\"verdict %s\"><b>%s %s</b>", class, signs[k], head);
}

static void end(report *r) {
  gh_text_print(r->out, "</div>\n");
}

static void tell_outcome(report *r) {
  const char *status = report_run_text(r, "status"), *message = report_run_text(r, "message");
  int at;
  double worst = worst_residual(r, &at), wanted = tolerance(r);
  bool done = strcmp(status, "done") == 0, met = !(worst > wanted * (1 + 1e-12));
  if (done && met) begin(r, "good", "Done, and every increment converged");
  else if (done) begin(r, "bad", "Done, but not every increment converged");
  else if (strcmp(status, "running") == 0) begin(r, "warn", "The run is under way, or was killed");
  else if (strcmp(status, "stopped") == 0) begin(r, "warn", "The run was stopped");
  else begin(r, "bad", "The run ended before its end");
  gh_text_print(
      r->out,
      "%d increment%s after the start %s complete. Largest relative residual at the end of an increment "
      "%.2e (increment %d)",
      r->n - 1, GH_S(r->n - 1), r->n == 2 ? "is" : "are", worst, at);
  if (isfinite(wanted)) gh_text_print(r->out, ", tolerance %.0e", wanted);
  gh_text_print(r->out, ".");
  if (!done && *message) {
    gh_text_print(r->out, " It ended with: ");
    report_escape(r->out, message);
  }
  end(r);
}

/* "3 bisections", "1 bisection". */
static void count(report *r, double n, const char *what) {
  gh_text_print(r->out, "%.0f %s%s", n, what, n == 1 ? "" : "s");
}

/* The numbers of the increments for which a column is above 0, as "3, 7, 12 ...". */
static void list_increments(report *r, const char *column) {
  enum { MOST = 12 };
  int all = 0, told = 0;
  for (int k = 0; k < r->n; k++) all += report_history(r, k, column) > 0;
  gh_text_print(r->out, "increment%s ", all == 1 ? "" : "s");
  for (int k = 0; k < r->n && told < MOST; k++)
    if (report_history(r, k, column) > 0) gh_text_print(r->out, "%s%d", told++ ? ", " : "", k);
  if (all > MOST) gh_text_print(r->out, " \xe2\x80\xa6");
}

static void tell_jumps(report *r) {
  double jumps = sum(r, "jumps"), cuts = sum(r, "cuts");
  if (jumps == 0) {
    begin(r, "good", cuts > 0 ? "No instabilities" : "No instabilities, no bisections");
    if (cuts == 0) gh_text_print(r->out, "Each increment was solved in one substep.");
    else {
      count(r, cuts, "bisection");
      gh_text_print(r->out, ", in ");
      list_increments(r, "cuts");
      gh_text_print(r->out, ".");
    }
  } else {
    begin(r, "warn", "Instabilities were stepped over");
    gh_text_print(r->out, "%.0f instabilit%s", jumps, jumps == 1 ? "y" : "ies");
    gh_text_print(r->out, ", in ");
    list_increments(r, "jumps");
    gh_text_print(
        r->out,
        ": the path is not continuous there, and the state after an instability is one of several that "
        "the body could have come to. ");
    count(r, cuts, "bisection");
    gh_text_print(r->out, ".");
  }
  end(r);
}

static void list_lost(report *r, int k) {
  enum { MOST = 6 };
  const double *acoustic = r->acoustic + (size_t)k * (size_t)r->np;
  int all = lost_at(r, k), told = 0;
  for (int p = 0; p < r->np && told < MOST; p++)
    if (!(acoustic[p] > 0))
      gh_text_print(r->out, "%s%d at (%.4g, %.4g)", told++ ? ", " : "", p, r->gauss[2 * p],
                    r->gauss[2 * p + 1]);
  if (all > MOST) gh_text_print(r->out, " and %d more", all - MOST);
}

static void tell_ellipticity(report *r) {
  if (!r->tangents) return;
  int first = -1, now = lost_at(r, r->n - 1);
  for (int k = r->n - 1; k >= 0; k--)
    if (lost_at(r, k)) first = k;
  if (first < 0) {
    begin(r, "good", "Elliptic everywhere");
    gh_text_print(
        r->out,
        "The smallest acoustic eigenvalue is positive at all points and increments; at the end it is "
        "%.4g, at point %d.",
        r->acoustic[(size_t)(r->n - 1) * (size_t)r->np + (size_t)r->least], r->least);
  } else {
    begin(r, "warn", "Ellipticity is lost");
    gh_text_print(r->out, "First in increment %d (%d of %d points: ", first, lost_at(r, first), r->np);
    list_lost(r, first);
    gh_text_print(r->out, "). At the end in %d point%s", now, now == 1 ? "" : "s");
    if (now) gh_text_print(r->out, ": ");
    list_lost(r, r->n - 1);
    gh_text_print(r->out,
                  ". Results there depend on the mesh: localisation, or packings too small for the problem.");
  }
  end(r);
}

static void tell_unjammed(report *r) {
  double now = report_history(r, r->n - 1, "unjammed");
  if (!(sum(r, "unjammed") > 0)) return;
  begin(r, "warn", "Packings without contact");
  gh_text_print(r->out, "Some integration points carried nothing in ");
  list_increments(r, "unjammed");
  gh_text_print(r->out, "; at the end %.0f of %d.", now, r->np);
  end(r);
}

/* Packings that never came to rest are no result like others. */
static void tell_accepted(report *r) {
  const double n = report_run_number(r, (const char *const[]){"summary", "farm", "accepted", NULL}),
               residual = report_run_number(r, (const char *const[]){"error", "micro_residual", NULL});
  if (!(n > 0)) return;
  begin(r, "warn", "Packings accepted unconverged");
  gh_text_print(
      r->out,
      "In %.0f evaluations a packing was accepted unconverged when its relaxation steps were spent, "
      "as the scene allows (<code>micro.accept</code>).",
      n);
  if (isfinite(residual))
    gh_text_print(r->out, " The largest residual of a packing in an equilibrium of the body is %.2g.",
                  residual);
  end(r);
}

static void tile(report *r, const char *value, const char *label) {
  gh_text_print(r->out, "<div><b>%s</b><span>%s</span></div>\n", value, label);
}

static void tiles(report *r) {
  char text[64];
  double seconds = report_run_number(r, (const char *const[]){"summary", "seconds", "total", NULL});
  gh_text_print(r->out, "<div class=\"tiles\">\n");
  snprintf(text, sizeof text, "%d", r->n - 1);
  tile(r, text, "increments");
  snprintf(text, sizeof text, "%.0f", sum(r, "iterations"));
  tile(r, text, "macro iterations");
  snprintf(text, sizeof text, "%.0f / %.0f", sum(r, "cuts"), sum(r, "jumps"));
  tile(r, text, "bisections / instabilities");
  snprintf(text, sizeof text, "%d", lost_at(r, r->n - 1));
  tile(r, text, "points not elliptic");
  snprintf(text, sizeof text, "%d \xc3\x97 %.0f", r->np,
           report_run_number(r, (const char *const[]){"options", "micro", "grains", NULL}));
  tile(r, text, "points \xc3\x97 grains");
  if (isfinite(seconds)) {
    snprintf(text, sizeof text, seconds < 600 ? "%.1f s" : "%.1f min",
             seconds < 600 ? seconds : seconds / 60);
    tile(r, text, "run time");
  }
  gh_text_print(r->out, "</div>\n");
}

gh_status report_verdict(report *r) {
  const char *title = report_run_text(r, "title"), *started = report_run_text(r, "started");
  const cJSON *program = cJSON_GetObjectItemCaseSensitive(r->run, "program"),
              *version = cJSON_GetObjectItemCaseSensitive(program, "version");
  gh_text_print(r->out, "<header><h1>");
  report_escape(r->out, *title ? title : r->folder);
  gh_text_print(r->out, "</h1><p class=\"soft\">Run started %.10s %.5s UTC", started,
                strlen(started) > 11 ? started + 11 : "");
  if (cJSON_IsString(version)) {
    gh_text_print(r->out, ", granhom ");
    report_escape(r->out, version->valuestring);
  }
  gh_text_print(r->out, ". %d quadrilaterals, %d nodes.</p></header>\n", r->mesh.nelements, r->mesh.nnodes);
  gh_text_print(
      r->out,
      "<nav><div><a href=\"#verdict\">Verdict</a><a href=\"#curves\">Curves</a><a href=\"#body\">The "
      "body</a><a href=\"#packings\">Packings</a>%s<a href=\"#convergence\">Convergence</a><a "
      "href=\"#error\">Error</a><a href=\"#time\">Time</a><a href=\"#computed\">What was "
      "computed</a></div></nav>\n<main>\n",
      r->comparison ? "<a href=\"#comparison\">Comparison</a>" : "");
  gh_text_print(r->out, "<h2 id=\"verdict\">Verdict</h2>\n");
  tell_outcome(r);
  tell_jumps(r);
  tell_ellipticity(r);
  tell_unjammed(r);
  tell_accepted(r);
  tiles(r);
  return GH_OK;
}

/* ---- what was computed ---- */

/* normal_stiffness -> normal stiffness */
static void print_key(gh_text *out, const char *key) {
  for (; *key; key++) report_escape(out, (char[2]){*key == '_' ? ' ' : *key, 0});
}

static void print_value(gh_text *out, const cJSON *item) {
  if (cJSON_IsString(item)) report_escape(out, item->valuestring);
  else if (cJSON_IsNumber(item)) gh_text_print(out, "%.10g", item->valuedouble);
  else if (cJSON_IsBool(item)) gh_text_print(out, "%s", cJSON_IsTrue(item) ? "yes" : "no");
  else gh_text_print(out, "\xe2\x80\x94");
}

/* A group of run.json as pairs; groups in it come after its own values. */
static void print_group(gh_text *out, const cJSON *group, const char *name) {
  const cJSON *item;
  bool any = false;
  cJSON_ArrayForEach(item, group) any = any || !cJSON_IsObject(item);
  if (any) {
    gh_text_print(out, "<div><h3>");
    print_key(out, name);
    gh_text_print(out, "</h3><dl>");
    cJSON_ArrayForEach(item, group) {
      if (cJSON_IsObject(item) || cJSON_IsArray(item) || !item->string) continue;
      gh_text_print(out, "<dt>");
      print_key(out, item->string);
      gh_text_print(out, "</dt><dd>");
      print_value(out, item);
      gh_text_print(out, "</dd>");
    }
    gh_text_print(out, "</dl></div>\n");
  }
  cJSON_ArrayForEach(item, group) if (cJSON_IsObject(item) && item->string)
      print_group(out, item, item->string);
}

gh_status report_options(report *r) {
  static const char *const groups[] = {"options", "units", "program", "machine"};
  const char *scene = report_run_text(r, "scene");
  gh_text_print(r->out, "<h2 id=\"computed\">What was computed</h2>\n<div class=\"grid\">\n");
  for (size_t k = 0; k < sizeof groups / sizeof *groups; k++)
    print_group(r->out, cJSON_GetObjectItemCaseSensitive(r->run, groups[k]), groups[k]);
  gh_text_print(r->out, "</div>\n<p class=\"soft\">Scene ");
  report_escape(r->out, report_run_text(r, "scene_file"));
  gh_text_print(r->out, ", packing ");
  report_escape(r->out, report_run_text(r, "packing_file"));
  gh_text_print(r->out, ".</p>\n");
  if (!*scene) return GH_OK;
  gh_text_print(r->out, "<details><summary>The scene as it was run</summary><pre>");
  report_escape(r->out, scene);
  gh_text_print(r->out, "</pre></details>\n");
  return GH_OK;
}
