/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Commands of LAMMPS that run other programs, off unless they are asked for, and those that would remove what
 * friction needs.
 *
 * Replaced functions of liblammps.so, as in interpose.cpp: every command of a script, an included file, an
 * `if` or a program comes through Input::execute_command, and all that runs Python through Python::init. */
#include "engine/lammps/c_mpi.h"
#include "engine/lammps/commands.h"
#include "engine/lammps/interpose_programs.h"

#include "error.h"
#include "input.h"
#include "lammps.h"
#include "lmppython.h"

#include <cstring>
#include <dlfcn.h>
#include <string>

using LAMMPS_NS::LAMMPS;

/* The mark of an instance is a name in its table of commands, which outlives `clear`. */
static const char MARK[] = "other programs are off";

static LAMMPS_NS::Command *no_command(LAMMPS *lmp) {
  lmp->error->all(FLERR, std::string("Unknown command: ") + MARK);
  return nullptr;
}

void granhom::refuse_programs(LAMMPS *lmp) {
  (*lmp->input->command_map)[MARK] = no_command;
}

static bool refuses(LAMMPS *lmp) {
  return lmp->input->command_map->count(MARK) > 0;
}

static std::string refusal(const std::string &what) {
  return what + " is off, because a script that comes from others could run any program with it: start "
                "granhom lammps with --allow-shell to allow it";
}

/* LAMMPS hands names of compressed files to a shell, as part of a command. */
static bool unsafe_name(const char *name) {
  static const char *const packed[] = {".gz", ".bz2", ".xz", ".zst", ".lzma", ".lz4"};
  static const char safe[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./+-,:@%=*^~";
  const std::size_t length = std::strlen(name);
  for (const char *end : packed) {
    const std::size_t n = std::strlen(end);
    if (length > n && std::strcmp(name + length - n, end) == 0) return std::strspn(name, safe) != length;
  }
  return false;
}

/* What the command would run; empty: nothing. */
static std::string program_of(const char *command, int narg, char **arg) {
  static const char *const programs[] = {"shell", "python", "plugin", "geturl"};
  for (const char *program : programs)
    if (std::strcmp(command, program) == 0) return std::string("The command ") + program;
  const bool movie = std::strcmp(command, "dump") == 0 && narg > 2 && std::strcmp(arg[2], "movie") == 0;
  if (movie) return "dump movie, which runs ffmpeg,";
  const bool kim = std::strncmp(command, "kim", 3) == 0 ||
                   (std::strcmp(command, "pair_style") == 0 && narg > 0 && std::strcmp(arg[0], "kim") == 0);
  if (kim) return "Loading models of KIM, which are programs,";
  if (std::strcmp(command, "print") == 0) return "";
  for (int k = 0; k < narg; k++)
    if (unsafe_name(arg[k]))
      return std::string("A name with blanks or special characters of a compressed file, \"") + arg[k] +
             "\", which LAMMPS gives to a shell,";
  return "";
}

namespace LAMMPS_NS {

int Input::execute_command() {
  using function = int (*)(Input *);
  static const auto original =
      reinterpret_cast<function>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS5Input15execute_commandEv"));
  if (command) granhom::refuse_removal(lmp, command, narg, arg);
  if (command && refuses(lmp)) {
    const std::string what = program_of(command, narg, arg);
    if (!what.empty()) error->all(FLERR, refusal(what));
  }
  return original(this);
}

void Python::init() {
  using function = void (*)(Python *);
  static const auto original = reinterpret_cast<function>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS6Python4initEv"));
  if (refuses(lmp)) error->all(FLERR, refusal("Python"));
  original(this);
}

} // namespace LAMMPS_NS
