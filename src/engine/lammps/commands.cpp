/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LAMMPS commands that friction cannot follow.
 *
 * Dumps hold positions, but neither rotations nor slip. LAMMPS's own commands are called through its table of
 * commands, in which ours take their places. */
#include "engine/lammps/c_mpi.h"
#include "engine/lammps/commands.h"

#include "engine/lammps/fix_history.h"
#include "engine/lammps/pair_coulomb.h"

#include "error.h"
#include "force.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"

#include <cstring>
#include <string>

using granhom::FixHistory;
using LAMMPS_NS::Command;
using LAMMPS_NS::LAMMPS;

static const char WAY_OUT[] = "Continue from a restart file instead (write_restart, read_restart)";

static bool friction_in_use(LAMMPS *lmp) {
  LAMMPS_NS::Force *force = lmp->force;
  return force->pair_match("granhom/coulomb", 1) || force->pair_match("granhom/coulomb", 1, 1);
}

/* A name with blanks is no command of a script. */
static std::string original(const char *name) {
  return std::string(name) + " of LAMMPS";
}

static Command *call_original(LAMMPS *lmp, const char *name) {
  return (*lmp->input->command_map)[original(name)](lmp);
}

static Command *rerun(LAMMPS *lmp) {
  if (friction_in_use(lmp))
    lmp->error->all(FLERR, std::string("Pair granhom/coulomb does not run with rerun: a dump holds neither "
                                       "the rotations nor the slip of contacts, so that friction would be "
                                       "wrong. ") +
                               WAY_OUT + ", or rerun with pair_style granhom/normal: it has no history");
  return call_original(lmp, "rerun");
}

static Command *read_dump(LAMMPS *lmp) {
  if (friction_in_use(lmp) &&
      (lmp->modify->find_fix(FixHistory::ID) >= 0 || lmp->modify->nfix_restart_peratom > 0))
    lmp->error->all(FLERR,
                    std::string("Pair granhom/coulomb: read_dump after the first run would give the history "
                                "of contacts to other positions: a dump holds neither rotations nor slip. ") +
                        WAY_OUT +
                        ", or drop all history before: pair_style none, and pair_style granhom/coulomb after "
                        "read_dump");
  return call_original(lmp, "read_dump");
}

void granhom::refuse_removal(LAMMPS *lmp, const char *command, int narg, char **arg) {
  if (narg < 1 || std::strcmp(arg[0], FixHistory::ID) != 0) return;
  if (std::strcmp(command, "unfix") != 0 && std::strcmp(command, "fix") != 0) return;
  if (friction_in_use(lmp) && lmp->modify->find_fix(FixHistory::ID) >= 0)
    lmp->error->all(FLERR, std::string(FixHistory::STAYS));
}

void granhom::register_commands(LAMMPS *lmp) {
  auto &table = *lmp->input->command_map;
  const struct {
    const char *name;
    LAMMPS_NS::Input::CommandCreator ours;
  } commands[] = {{"rerun", rerun}, {"read_dump", read_dump}};
  for (const auto &c : commands) {
    if (!table.count(c.name) || table.count(original(c.name))) continue;
    table[original(c.name)] = table[c.name];
    table[c.name] = c.ours;
  }
}
