/* The command line of what is done with one packing and a contact law: granhom rve, element and crosscheck.
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * A command puts CONTACT_OPTIONS into its table of long options and CONTACT_HELP into its help, reads its
 * arguments by contact_arguments(), and asks contact_law() at the end. */
#ifndef GRANHOM_CONTACT_OPTIONS_H
#define GRANHOM_CONTACT_OPTIONS_H

#include "cli.h"

#include "granhom/contact.h"

#include <getopt.h>

/* Above all characters, so that they meet no short option. */
enum {
  CONTACT_NORMAL = 512,
  CONTACT_TANGENTIAL,
  CONTACT_ANGLE,
  CONTACT_COEFFICIENT,
  CONTACT_HARDENING,
  CONTACT_ROTATIONS,
  CONTACT_SLIP,
  CONTACT_ALLOWED,
  CONTACT_END
};

/* Entries of an array of struct option. */
#define CONTACT_OPTIONS                                                                                      \
  {"normal-stiffness", 1, 0, CONTACT_NORMAL}, {"tangential-stiffness", 1, 0, CONTACT_TANGENTIAL},            \
      {"friction-angle", 1, 0, CONTACT_ANGLE}, {"friction-coefficient", 1, 0, CONTACT_COEFFICIENT},          \
      {"hardening", 1, 0, CONTACT_HARDENING}, {"rotations", 1, 0, CONTACT_ROTATIONS},                        \
      {"slip", 1, 0, CONTACT_SLIP}, {                                                                        \
    "allow-overlap", 2, 0, CONTACT_ALLOWED                                                                   \
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
  "                         a rigid rotation leaves at zero; with friction\n"                                \
  "  --allow-overlap [X]    goes on where the mean overlap is above 0.2 of the mean radius, or the grains\n" \
  "                         fill more than the cell: up to X of the radius, without X any; such states\n"    \
  "                         usually come from units that do not fit each other\n"

/* What was given. Zero-initialised: nothing. */
typedef struct contact_options {
  double value[CONTACT_END - CONTACT_NORMAL];
  bool given[CONTACT_END - CONTACT_NORMAL];
  int fixed_rotations;
  gh_slip_measure slip;
} contact_options;

/* The arguments of a command: options, of which -o is the only short one, and the packing. An option that is
 * none of the contact law goes to take(code, data), its value in optarg. 0, or 2 after a message. */
int contact_arguments(const cli_command *command, int argc, char **argv, const struct option *options,
                      contact_options *o, int (*take)(int code, void *data), void *data,
                      const char **packing);
/* The law that the options say. 0, or 2 after a message: options that exclude or need each other. */
int contact_law(const cli_command *command, const contact_options *o, gh_contact_law *law);
/* The mean overlap that --allow-overlap allows, as gh_rve_options has it. */
double contact_allowed(const contact_options *o);
/* The default of the normal stiffness is named: its unit is that of the stresses. */
void contact_note(gh_context *ctx, const contact_options *o, const gh_contact_law *law);

#endif
