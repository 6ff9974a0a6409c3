/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Options of what is done with one packing. */
#include "packing_options.h"

static const char *const boundaries[] = {[GH_TAYLOR] = "taylor",
                                         [GH_TAYLOR_CELL] = "taylor-cell",
                                         [GH_RESTRICTED] = "restricted",
                                         [GH_PERIODIC] = "periodic",
                                         [GH_DISPLACEMENT] = "displacement",
                                         [GH_FRAME_PERIODIC] = "frame-periodic",
                                         [GH_TRACTION] = "traction",
                                         [GH_MIXED] = "mixed",
                                         [GH_SERVO_DISPLACEMENT] = "servo-displacement",
                                         [GH_SERVO_PERIODIC] = "servo-periodic",
                                         [GH_SERVO_TRACTION] = "servo-traction",
                                         NULL};
static const char *const engines[] = {[GH_ENGINE_LAMMPS] = "lammps", [GH_ENGINE_NATIVE] = "native", NULL};
static const char *const relaxations[] = {
    [GH_RELAX_POLISHED] = "polished", [GH_RELAX_DAMPED] = "damped", [GH_RELAX_FIRE] = "fire", NULL};
static const char *const integrations[] = {
    [GH_INTEGRATION_RAMP] = "ramp", [GH_INTEGRATION_WHOLE] = "whole", NULL};
static const char *const rotations[] = {"free", "fixed", NULL};
static const char *const slips[] = {
    [GH_SLIP_PROJECTED] = "projected", [GH_SLIP_OBJECTIVE] = "objective", NULL};
static const char *const hardening_laws[] = {
    [GH_HARDENING_PRINTED] = "printed", [GH_HARDENING_PROPORTIONAL] = "proportional", NULL};

static gh_status mixed_read(gh_context *ctx, const char *where, const char *text, void *group) {
  packing_options *o = group;
  const gh_status status = gh_mixed_read(ctx, text, o->rve.mixed);
  return status == GH_OK ? status : gh_prefix(ctx, status, "%s: ", where);
}

#define PLACE(member) .place = offsetof(packing_options, member)

const option_row packing_condition_rows[] = {
    {.name = "boundary",
     .argument = "NAME",
     .kind = OPTION_CHOICE,
     .words = boundaries,
     PLACE(rve.boundary),
     .help =
         "taylor: all grains of the cluster follow F; taylor-cell: the same in the periodic cell; "
         "restricted: grains at the boundary follow F, the others are in equilibrium; periodic: all "
         "grains of the periodic cell are in equilibrium. On a frame of the grains that the cell's boundary "
         "cuts: displacement: they follow F; frame-periodic: opposite edges move alike; traction: uniform "
         "traction, F in the mean; mixed: see --mixed; servo-displacement, servo-periodic, servo-traction: "
         "the "
         "same by servo-control"},
    {.name = "mixed",
     .argument = "X,Y",
     .kind = OPTION_OWN,
     .read = mixed_read,
     .help = "with --boundary mixed: what the edges that the first (x) and second (y) lattice vector lead to "
             "do, as "
             "x=traction,y=displacement; of displacement, periodic, traction"},
    {.name = "servo-gain",
     .argument = "G",
     .kind = OPTION_NUMBER,
     .below = 1,
     PLACE(rve.servo_gain),
     .help = "of servo-control: displacement of a grain of the frame over its unbalanced force, over 1/E; "
             "below 1"},
    {.name = "servo-tolerance",
     .argument = "T",
     .kind = OPTION_NUMBER,
     .below = 1,
     PLACE(rve.servo_tolerance),
     .help =
         "norm of what servo-control may leave unbalanced on the frame, over the mean normal contact force"},
    {.name = "servo-acceleration",
     .argument = "N",
     .kind = OPTION_INTEGER,
     .low = 0,
     .high = GH_SERVO_DEPTH,
     PLACE(rve.servo_acceleration),
     .help = "sweeps of servo-control that Anderson's acceleration combines; 0: none"},
    {.name = "engine",
     .argument = "NAME",
     .kind = OPTION_CHOICE,
     .words = engines,
     PLACE(rve.engine),
     .help = "lammps or native: what evaluates contacts and relaxes grains"},
    {0}};

const option_row packing_contact_rows[] = {
    {.name = "normal-stiffness",
     .argument = "E",
     .kind = OPTION_NUMBER,
     PLACE(contact.normal),
     .standard = "1",
     .help = "force per overlap, > 0"},
    {.name = "friction-angle",
     .argument = "DEG",
     .kind = OPTION_NUMBER,
     .zero = true,
     .below = 90,
     PLACE(contact.angle),
     .wanted = "an angle in degrees, 0 or more and below 90",
     .help = "angle of friction between grains, 0 <= DEG < 90; without friction given, the packing is "
             "frictionless"},
    {.name = "friction-coefficient",
     .argument = "MU",
     .kind = OPTION_NUMBER,
     .zero = true,
     PLACE(contact.coefficient),
     .help = "the same as its tangent, >= 0"},
    {.name = "tangential-stiffness",
     .argument = "ET",
     .kind = OPTION_NUMBER,
     PLACE(contact.tangential),
     .standard = "E",
     .help = "tangential force per slip, > 0; with friction"},
    {.name = "hardening",
     .argument = "H",
     .kind = OPTION_NUMBER,
     .zero = true,
     PLACE(contact.hardening),
     .standard = "0",
     .help = "growth of the friction limit with plastic slip, force per length, >= 0; with friction"},
    {.name = "hardening-law",
     .argument = "WORD",
     .kind = OPTION_CHOICE,
     .words = hardening_laws,
     PLACE(contact.hardening_law),
     .standard = "printed",
     .help =
         "printed: the limit grows by H times plastic slip; proportional: by that times the normal force, "
         "with H per length; with friction"},
    {.name = "rotations",
     .argument = "WORD",
     .kind = OPTION_CHOICE,
     .words = rotations,
     PLACE(contact.rotations),
     .standard = "free",
     .help = "free or fixed: whether grains rotate; with friction"},
    {.name = "slip",
     .argument = "WORD",
     .kind = OPTION_CHOICE,
     .words = slips,
     PLACE(contact.slip),
     .standard = "projected",
     .help = "projected: slip as printed in (7.5); objective: by the angle, which a rigid rotation leaves at "
             "zero; with friction"},
    {.name = "allow-overlap",
     .argument = "X",
     .kind = OPTION_NUMBER,
     .optional = true,
     PLACE(contact.overlap),
     .wanted = "a positive number, or nothing",
     .help = "continues where the mean overlap is above 0.2 of the mean radius, or the grains fill more than "
             "the cell: up to X of the radius, without X any; such states usually come from units that do "
             "not fit each other"},
    {0}};

const option_row packing_solver_rows[] = {
    {.name = "tolerance",
     .argument = "T",
     .kind = OPTION_NUMBER,
     .below = 1,
     PLACE(rve.tolerance),
     .help = "largest force on a grain, and moment over radius, over the mean normal contact force"},
    {.name = "relaxation",
     .argument = "WORD",
     .kind = OPTION_CHOICE,
     .words = relaxations,
     PLACE(rve.relaxation),
     .help = "polished: damped central differences, then Newton where it is safe; damped: damped central "
             "differences alone; fire: FIRE alone"},
    {.name = "integration",
     .argument = "WORD",
     .kind = OPTION_CHOICE,
     .words = integrations,
     PLACE(rve.integration),
     .standard = "ramp",
     .help = "ramp: slip is integrated along a ramp of F, and over a short last part; whole: over the whole "
             "increment at once, as Table 7.1 does, which has no equilibrium in some increments; with "
             "friction and free grains"},
    {.name = "max-steps",
     .argument = "N",
     .kind = OPTION_LONG,
     .low = 1,
     .high = 1000000000,
     PLACE(rve.max_steps),
     .standard = "400000, with friction 50000",
     .help = "relaxation steps after which an evaluation of the packing has failed"},
    {0}};

const option_row packing_accept_rows[] = {
    {.name = "accept",
     .argument = "FORCE",
     .kind = OPTION_NUMBER,
     .below = INFINITY,
     PLACE(rve.accept),
     .help = "... unless no grain then has an unbalanced force above FORCE: the state is accepted "
             "unconverged, with a warning"},
    {0}};

const option_row packing_state_rows[] = {
    {.name = "save-state",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(state_options, save),
     .help = "converged state at the end (HDF5), for --load-state of granhom rve and element"},
    {.name = "load-state",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(state_options, load),
     .help =
         "start from such a state instead of the packing as read; of the same packing, boundary condition "
         "and contact law"},
    {0}};

void packing_defaults(packing_options *o) {
  *o = (packing_options){.contact = {.normal = NAN,
                                     .angle = NAN,
                                     .coefficient = NAN,
                                     .tangential = NAN,
                                     .hardening = NAN,
                                     .overlap = NAN,
                                     .rotations = -1,
                                     .slip = -1,
                                     .hardening_law = -1},
                         .rve = gh_rve_defaults()};
}

/* The first option that means something with friction alone; NULL: none is given. */
static const char *friction_option(const contact_options *c) {
  if (!isnan(c->tangential)) return "--tangential-stiffness";
  if (!isnan(c->hardening)) return "--hardening";
  if (c->hardening_law >= 0) return "--hardening-law";
  if (c->rotations >= 0) return "--rotations";
  return c->slip >= 0 ? "--slip" : NULL;
}

static gh_status law_set(gh_context *ctx, const contact_options *c, gh_contact_law *law) {
  static const double degree = GH_PI / 180;
  const char *option = friction_option(c);
  *law = (gh_contact_law){.normal_stiffness = isnan(c->normal) ? 1 : c->normal};
  if (!isnan(c->angle) && !isnan(c->coefficient))
    return gh_fail(ctx, GH_INPUT,
                   "--friction-angle and --friction-coefficient say the same: give one of them");
  law->friction = !isnan(c->angle) || !isnan(c->coefficient);
  if (!law->friction && option)
    return gh_fail(ctx, GH_INPUT, "%s needs friction: --friction-angle or --friction-coefficient", option);
  if (!law->friction) return GH_OK;
  law->friction_coefficient = isnan(c->angle) ? c->coefficient : tan(c->angle * degree);
  law->tangential_stiffness = isnan(c->tangential) ? law->normal_stiffness : c->tangential;
  law->hardening = isnan(c->hardening) ? 0 : c->hardening;
  law->fixed_rotations = c->rotations > 0;
  law->slip = c->slip > 0 ? GH_SLIP_OBJECTIVE : GH_SLIP_PROJECTED;
  law->hardening_law = c->hardening_law > 0 ? GH_HARDENING_PROPORTIONAL : GH_HARDENING_PRINTED;
  return GH_OK;
}

gh_status packing_check(gh_context *ctx, packing_options *o) {
  const bool mixes = o->rve.mixed[0] != GH_EDGES_OPEN;
  if (mixes != (o->rve.boundary == GH_MIXED))
    return gh_fail(ctx, GH_INPUT,
                   mixes ? "--mixed needs --boundary mixed"
                         : "--boundary mixed needs --mixed, as x=traction,y=displacement");
  o->rve.allow_overlap = isnan(o->contact.overlap) ? 0 : o->contact.overlap;
  return law_set(ctx, &o->contact, &o->rve.law);
}

void packing_note(gh_context *ctx, const packing_options *o) {
  if (isnan(o->contact.normal))
    gh_log(ctx, GH_LEVEL_INFO, "normal stiffness %g (default; --normal-stiffness): stresses are in its unit",
           o->rve.law.normal_stiffness);
}
