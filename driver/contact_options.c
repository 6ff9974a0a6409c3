/* The contact law on a command line. SPDX-License-Identifier: GPL-2.0-or-later */
#include "contact_options.h"

#include "granhom/io.h"

#include <string.h>

static const char *const names[] = {"--normal-stiffness",
                                    "--tangential-stiffness",
                                    "--friction-angle",
                                    "--friction-coefficient",
                                    "--hardening",
                                    "--rotations",
                                    "--slip",
                                    "--allow-overlap"};

/* What an option must be, for its message. */
static const char *const wanted[] = {"a positive number",
                                     "a positive number",
                                     "an angle in degrees, 0 or more and below 90",
                                     "a number that is 0 or more",
                                     "a number that is 0 or more",
                                     "free or fixed",
                                     "projected or objective",
                                     "a positive number, or nothing"};

static bool take_number(int code, const char *text, double *value) {
  if (!gh_parse_number(text, value)) return false;
  if (code == CONTACT_NORMAL || code == CONTACT_TANGENTIAL || code == CONTACT_ALLOWED) return *value > 0;
  return *value >= 0 && (code != CONTACT_ANGLE || *value < 90);
}

/* One of two words: 0 or 1. */
static bool take_word(const char *text, const char *first, const char *second, int *value) {
  *value = !strcmp(text, second);
  return *value || !strcmp(text, first);
}

static int take_option(const cli_command *command, int code, const char *text, contact_options *o) {
  int k = code - CONTACT_NORMAL, word = 0;
  bool good;
  if (code == CONTACT_ROTATIONS) good = take_word(text, "free", "fixed", &o->fixed_rotations);
  else if (code == CONTACT_SLIP) good = take_word(text, "projected", "objective", &word);
  else if (code == CONTACT_ALLOWED && !text) good = true, o->value[k] = INFINITY;
  else good = take_number(code, text, &o->value[k]);
  if (!good) return cli_usage(command, "%s must be %s, not \"%s\"", names[k], wanted[k], text);
  if (code == CONTACT_SLIP) o->slip = word ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
  o->given[k] = true;
  return 0;
}

int contact_arguments(const cli_command *command, int argc, char **argv, const struct option *options,
                      contact_options *o, int (*take)(int code, void *data), void *data,
                      const char **packing) {
  opterr = 0;
  optind = 1;
  for (int c, status; (c = getopt_long(argc, argv, ":o:", options, NULL)) != -1;) {
    if (c == '?') return cli_usage(command, "unknown option %s", argv[optind - 1]);
    if (c == ':') return cli_usage(command, "%s needs a value", argv[optind - 1]);
    double number;
    if (c == CONTACT_ALLOWED && !optarg && optind < argc && gh_parse_number(argv[optind], &number))
      optarg = argv[optind++]; /* "--allow-overlap 0.3" as well as "--allow-overlap=0.3" */
    const bool known = c >= CONTACT_NORMAL && c < CONTACT_END;
    if ((status = known ? take_option(command, c, optarg, o) : take(c, data))) return status;
  }
  if (optind == argc) return cli_usage(command, "which packing?");
  *packing = argv[optind++];
  if (optind < argc) return cli_usage(command, "one packing is enough: what is \"%s\"?", argv[optind]);
  return 0;
}

static bool given(const contact_options *o, int code) {
  return o->given[code - CONTACT_NORMAL];
}

static double value(const contact_options *o, int code) {
  return o->value[code - CONTACT_NORMAL];
}

double contact_allowed(const contact_options *o) {
  return given(o, CONTACT_ALLOWED) ? value(o, CONTACT_ALLOWED) : 0;
}

void contact_note(gh_context *ctx, const contact_options *o, const gh_contact_law *law) {
  if (!given(o, CONTACT_NORMAL))
    gh_log(ctx, GH_LEVEL_INFO, "normal stiffness %g (default; --normal-stiffness): stresses are in its unit",
           law->normal_stiffness);
}

int contact_law(const cli_command *command, const contact_options *o, gh_contact_law *law) {
  static const int with_friction[] = {CONTACT_TANGENTIAL, CONTACT_HARDENING, CONTACT_ROTATIONS, CONTACT_SLIP};
  static const double degree = 3.14159265358979323846 / 180;
  *law = (gh_contact_law){.normal_stiffness = given(o, CONTACT_NORMAL) ? value(o, CONTACT_NORMAL) : 1};
  if (given(o, CONTACT_ANGLE) && given(o, CONTACT_COEFFICIENT))
    return cli_usage(command, "--friction-angle and --friction-coefficient say the same: give one of them");
  law->friction = given(o, CONTACT_ANGLE) || given(o, CONTACT_COEFFICIENT);
  if (!law->friction) {
    for (size_t k = 0; k < sizeof with_friction / sizeof *with_friction; k++)
      if (given(o, with_friction[k]))
        return cli_usage(command, "%s needs friction: --friction-angle or --friction-coefficient",
                         names[with_friction[k] - CONTACT_NORMAL]);
    return 0;
  }
  law->friction_coefficient =
      given(o, CONTACT_ANGLE) ? tan(value(o, CONTACT_ANGLE) * degree) : value(o, CONTACT_COEFFICIENT);
  law->tangential_stiffness =
      given(o, CONTACT_TANGENTIAL) ? value(o, CONTACT_TANGENTIAL) : law->normal_stiffness;
  law->hardening = value(o, CONTACT_HARDENING);
  law->fixed_rotations = o->fixed_rotations;
  law->slip = o->slip;
  return 0;
}
