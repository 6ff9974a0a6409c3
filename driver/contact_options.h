/* The contact law on a command line: options that `granhom rve` and `granhom element` share.
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * A command puts CONTACT_OPTIONS into its table of long options and CONTACT_HELP into its help, offers each
 * code that it does not know itself to contact_option(), and asks contact_law() at the end. */
#ifndef GRANHOM_CONTACT_OPTIONS_H
#define GRANHOM_CONTACT_OPTIONS_H

#include "cli.h"

#include "granhom/contact.h"

/* Above all characters, so that they meet no short option. */
enum {
  CONTACT_NORMAL = 512,
  CONTACT_TANGENTIAL,
  CONTACT_ANGLE,
  CONTACT_COEFFICIENT,
  CONTACT_HARDENING,
  CONTACT_ROTATIONS,
  CONTACT_SLIP,
  CONTACT_END
};

/* Entries of an array of struct option. */
#define CONTACT_OPTIONS                                                                                      \
  {"normal-stiffness", 1, 0, CONTACT_NORMAL}, {"tangential-stiffness", 1, 0, CONTACT_TANGENTIAL},            \
      {"friction-angle", 1, 0, CONTACT_ANGLE}, {"friction-coefficient", 1, 0, CONTACT_COEFFICIENT},          \
      {"hardening", 1, 0, CONTACT_HARDENING}, {"rotations", 1, 0, CONTACT_ROTATIONS}, {                      \
    "slip", 1, 0, CONTACT_SLIP                                                                               \
  }

#define CONTACT_HELP                                                                                         \
  "  --normal-stiffness E   force per overlap, > 0 (default 1)\n"                                            \
  "  --friction-angle DEG   angle of friction between grains, 0 <= DEG < 90; without friction given, the\n"  \
  "                         packing is frictionless\n"                                                       \
  "  --friction-coefficient MU   the same as its tangent, >= 0\n"                                            \
  "  --tangential-stiffness ET   tangential force per slip, > 0 (default E); with friction\n"                \
  "  --hardening H          growth of the friction limit with plastic slip, force per length, >= 0\n"        \
  "                         (default 0); with friction\n"                                                    \
  "  --rotations WORD       free (default) or fixed: whether grains rotate; with friction\n"                 \
  "  --slip WORD            projected (default): slip as printed in (7.5); objective: by the angle, which\n" \
  "                         a rigid rotation leaves at zero; with friction\n"

/* What was given. Zero-initialised: nothing. */
typedef struct contact_options {
  double value[CONTACT_END - CONTACT_NORMAL];
  bool given[CONTACT_END - CONTACT_NORMAL];
  int fixed_rotations;
  gh_slip_measure slip;
} contact_options;

/* Takes one option of getopt_long and its value. 0: taken; 2: wrong, and said so; -1: none of these. */
int contact_option(const cli_command *command, int code, const char *text, contact_options *o);
/* The law that the options say. 0, or 2 after a message: options that exclude or need each other. */
int contact_law(const cli_command *command, const contact_options *o, gh_contact_law *law);

#endif
