/* Columns over t, one curve for each setting, with the scatter of the packings.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "study/draw.h"

#include <string.h>

enum { BARS = 15, NAME = 256, PANEL = 330, WIDTH = 1100, LEGEND_LINE = 22, CHARACTER = 9 };

/* ---- which curves ---- */

/* An extra setting is drawn where it is the only one, as the reference of all. */
static bool only_reference(const gh_study *s, int k) {
  int extras = 0;
  for (int j = 0; j < s->nsettings; j++) extras += s->settings[j].extra;
  return s->settings[k].extra && extras == 1;
}

static bool drawn(const gh_study *s, int k) {
  return study_first_curve(s->settings + k) && (!s->settings[k].extra || only_reference(s, k));
}

static bool has_given(const gh_study *s) {
  return s->reference != STUDY_SETTING && s->given.n > 0;
}

static int count_curves(const gh_study *s) {
  int n = 0;
  for (int k = 0; k < s->nsettings; k++) n += drawn(s, k) && !s->settings[k].extra;
  return n;
}

/* How many combinations of the other knobs there are, and which of them a setting belongs to. */
static int group_of(const gh_study *s, int setting, int *groups) {
  int group = 0;
  *groups = 0;
  for (int k = 0; k < s->nsettings; k++) {
    if (s->settings[k].extra || !study_first_alike(s, k, s->series)) continue;
    if (study_alike(s, k, setting, s->series)) group = *groups;
    ++*groups;
  }
  return group;
}

typedef struct look {
  int colour, dash;
  bool named;
} look;

/* Few curves have a colour each. Of more, the series has the colours and the other knobs the kinds of lines,
 * if both suffice; else the first ones have colours and the others are grey. */
static look look_of(const gh_study *s, int setting, int number) {
  int groups, group = group_of(s, setting, &groups);
  if (count_curves(s) <= STUDY_COLOURS) return (look){number, 1, true};
  if (s->nknobs > 0 && s->knobs[s->series].nvalues <= STUDY_COLOURS && groups <= 4)
    return (look){s->settings[setting].choice[s->series], (const int[]){1, 2, 4, 3}[group], true};
  return (look){number, 1, number < STUDY_COLOURS};
}

static void name_of(const gh_study *s, int k, char name[NAME]) {
  if (s->settings[k].extra) {
    snprintf(name, NAME, "reference");
    return;
  }
  study_legend(s, k, -1, name, NAME);
  size_t n = strlen(name);
  if (study_is_reference(s, k)) snprintf(name + n, NAME - n, " (reference)");
}

/* ---- data ---- */

/* t, then mean and standard deviation of each plotted column. */
static void write_curve(const gh_study *s, int k, gh_text *t) {
  const study_curve *first = study_first_curve(s->settings + k);
  gh_text_print(t, "$curve%d << EOD\n", k);
  for (int row = 0; row < first->n; row++) {
    if (study_members_at(s, s->settings + k, first->t[row], 0).n == 0) continue;
    gh_text_print(t, "%.17g", first->t[row]);
    for (int c = 0; c < s->nplots; c++) {
      study_sample x = study_members_at(s, s->settings + k, first->t[row], s->plots[c]);
      gh_text_print(t, " %.17g %.17g", x.mean, x.deviation);
    }
    gh_text_print(t, "\n");
  }
  gh_text_print(t, "EOD\n");
}

static void write_given(const gh_study *s, gh_text *t) {
  gh_text_print(t, "$given << EOD\n");
  for (int row = 0; row < s->given.n; row++) {
    gh_text_print(t, "%.17g", s->given.t[row]);
    for (int c = 0; c < s->nplots; c++)
      gh_text_print(t, " %.17g 0", s->given.value[row * s->ncolumns + s->plots[c]]);
    gh_text_print(t, "\n");
  }
  gh_text_print(t, "EOD\n");
}

/* ---- panels ---- */

static void write_unit(const gh_study *s, const char *column, gh_text *t) {
  const char *force = s->force_unit ? s->force_unit : "", *length = s->length_unit ? s->length_unit : "";
  if (strcmp(column, "dilatancy") == 0) gh_text_print(t, " (%%)");
  else if (strncmp(column, "force", 5) == 0 && *force) gh_text_print(t, " (%s)", force);
  else if (strncmp(column, "force", 5) != 0 && *force && *length) gh_text_print(t, " (%s/%s)", force, length);
}

/* About BARS bars on each curve, each curve's a little beside the point where they belong so that they do not
 * hide each other; before the lines, which lie on them. */
static void write_bars(const gh_study *s, int panel, gh_text *t) {
  int curves = count_curves(s), mean = 2 + 2 * panel, deviation = mean + 1;
  for (int k = 0, number = 0; k < s->nsettings; k++) {
    if (!drawn(s, k)) continue;
    look l = look_of(s, k, number++);
    const study_curve *c = study_first_curve(s->settings + k);
    int every = c->n / BARS > 1 ? c->n / BARS : 1;
    if (s->verdict->row[k].members < 2) continue;
    double between = every * (c->t[c->n - 1] - c->t[0]) / fmax(c->n - 1, 1);
    double beside = 0.7 * between * ((number - 0.5) / (curves + 1) - 0.5);
    gh_text_print(t,
                  "$curve%d every %d using ($1+%.17g):($%d-$%d):(0):(2*$%d) with vectors nohead lc rgb '%s' "
                  "lw 0.8 notitle, ",
                  k, every, beside, mean, deviation, deviation,
                  s->settings[k].extra ? "#000000" : study_colour(l.colour));
  }
}

/* The t of all curves. */
static void write_range(const gh_study *s, gh_text *t) {
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < s->nsettings; k++) {
    if (!drawn(s, k)) continue;
    const study_curve *c = study_first_curve(s->settings + k);
    low = fmin(low, c->t[0]), high = fmax(high, c->t[c->n - 1]);
  }
  if (high > low) gh_text_print(t, "set xrange [%.17g:%.17g]\n", low, high);
}

static void write_panel(const gh_study *s, int panel, gh_text *t) {
  char name[NAME];
  const char *comma = "";
  gh_text_print(t, "set ylabel \"%s", s->column[s->plots[panel]]);
  write_unit(s, s->column[s->plots[panel]], t);
  gh_text_print(t, "\" noenhanced\nplot ");
  write_bars(s, panel, t);
  for (int k = 0, number = 0; k < s->nsettings; k++) {
    if (!drawn(s, k)) continue;
    bool extra = s->settings[k].extra;
    look l = look_of(s, k, number);
    gh_text_print(t, "%s$curve%d using 1:%d with lines lc rgb '%s' lw %s dt %d", comma, k, 2 + 2 * panel,
                  extra ? "#000000" : study_colour(l.colour), extra ? "1.6" : "1.1", extra ? 1 : l.dash);
    name_of(s, k, name);
    gh_text_print(t, " title ");
    study_print_quoted(t, panel == 0 && (extra || l.named) ? name : "");
    number += !extra;
    comma = ", ";
  }
  if (has_given(s)) {
    gh_text_print(t, "%s$given using 1:%d with lines lc rgb '#000000' lw 1.6 dt 2 title ", comma,
                  2 + 2 * panel);
    study_print_quoted(t, panel == 0 ? (s->reference_text ? s->reference_text : "reference") : "");
  }
  gh_text_print(t, "\nunset key\n"); /* the first panel has named the curves of all */
}

/* Columns and lines of the key below the panels. */
static void size_key(const gh_study *s, int *columns, int *lines, int *letters) {
  char name[NAME];
  int entries = has_given(s),
      longest = has_given(s) && s->reference_text ? (int)strlen(s->reference_text) : 9;
  for (int k = 0, number = 0; k < s->nsettings; k++) {
    if (!drawn(s, k)) continue;
    bool named = s->settings[k].extra || look_of(s, k, number).named;
    number += !s->settings[k].extra;
    if (!named) continue;
    name_of(s, k, name);
    if ((int)strlen(name) > longest) longest = (int)strlen(name);
    entries++;
  }
  *columns = (WIDTH - 60) / ((longest + 8) * CHARACTER);
  if (*columns < 1) *columns = 1;
  *lines = (entries + *columns - 1) / *columns;
  *letters = longest;
}

static void write_layout(const gh_study *s, int across, int down, int columns, int lines, int letters,
                         int height, gh_text *t) {
  double foot = LEGEND_LINE * lines + 70.0;
  gh_text_print(t, "set multiplot layout %d,%d margins %g,0.98,%.4f,%.4f spacing 0.11,%.4f title ", down,
                across, across > 1 ? 0.08 : 0.1, foot / height, 1 - 50.0 / height, 45.0 / height);
  study_print_quoted(t, s->title ? s->title : "");
  gh_text_print(t, " noenhanced\n");
  gh_text_print(t,
                "set key at screen 0.5, screen %.4f center bottom horizontal maxcols %d width %d Left "
                "reverse samplen 2.5 noenhanced\n",
                6.0 / height, columns, -letters / 5);
}

gh_status study_draw_curves(const gh_study *s, const char *folder) {
  gh_text *t;
  int columns, lines, letters, across = s->nplots > 3 ? 2 : 1, down = (s->nplots + across - 1) / across;
  if (count_curves(s) == 0) return GH_OK;
  size_key(s, &columns, &lines, &letters);
  int height = 120 + LEGEND_LINE * lines + PANEL * down;
  GH_TRY(gh_text_create(s->ctx, &t));
  for (int k = 0; k < s->nsettings; k++)
    if (drawn(s, k)) write_curve(s, k, t);
  if (has_given(s)) write_given(s, t);
  write_layout(s, across, down, columns, lines, letters, height, t);
  write_range(s, t);
  for (int panel = 0; panel < s->nplots; panel++) {
    if (panel == s->nplots - across || (panel == 0 && s->nplots < across))
      gh_text_print(t, "set xlabel '%s' noenhanced\n", s->scene ? "t (load steps)" : "t (rows of the path)");
    write_panel(s, panel, t);
  }
  gh_text_print(t, "unset multiplot\n");
  gh_status status = study_picture(s, folder, "curves.png", WIDTH, height, t);
  gh_text_destroy(&t);
  return status;
}
