/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Functions of liblammps.so that are replaced.
 *
 * Calls inside a shared library go through a table of addresses, in which the ones here take the place of
 * LAMMPS's: because they come first in the search order, or by rebind.cpp. A library without exceptions
 * (Debian 12) ends the process on an error: its Error class is replaced by one that throws. */
#include "engine/lammps/c_mpi.h"
#include "engine/lammps/interpose.h"

#include "engine/lammps/versions.h"

#include "error.h"
#include "input.h"
#include "lammps.h"
#include "universe.h"
#include "update.h"

#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <exception>

#if !GH_LAMMPS_THROWS

using granhom::lammps_error;
using granhom::lammps_quit;

/* "message (src/file.cpp:123)" */
static std::string located(const std::string &file, int line, const std::string &text) {
  std::size_t at = file.rfind("src/");
  return text + " (" + (at == std::string::npos ? file : file.substr(at)) + ":" + std::to_string(line) + ")";
}

static std::string formatted(fmt::string_view format, fmt::format_args args) {
  try {
    return fmt::detail::vformat(format, args);
  } catch (const std::exception &e) {
    return e.what();
  }
}

/* LAMMPS's own function, for instances of the program's own: they are none of our business, and nobody would
 * catch what is thrown. */
template <typename... Args, typename... Given>
[[noreturn]] static void lammps_own(LAMMPS_NS::Error *error, void (LAMMPS_NS::Error::*replaced)(Args...),
                                    Given &&...given) {
  void *address;
  std::memcpy(&address, &replaced, sizeof address);
  Dl_info info;
  void *found = dladdr(address, &info) && info.dli_sname ? dlsym(RTLD_NEXT, info.dli_sname) : nullptr;
  if (found) reinterpret_cast<void (*)(LAMMPS_NS::Error *, Args...)>(found)(error, given...);
  std::abort();
}

using plain = void (LAMMPS_NS::Error::*)(const std::string &, int, const std::string &);

namespace LAMMPS_NS {

void Error::all(const std::string &file, int line, const std::string &text) {
  if (!granhom::in_guarded_call()) lammps_own(this, static_cast<plain>(&Error::all), file, line, text);
  MPI_Barrier(world);
  std::string message = located(file, line, text);
  int me;
  MPI_Comm_rank(world, &me);
  if (me == 0 && (screen || logfile))
    utils::logmesg(lmp, "ERROR: " + message +
                            "\nLast command: " + (input && input->line ? input->line : "(none)") + "\n");
  if (update) update->whichflag = 0;
  throw lammps_error(message, false);
}

void Error::one(const std::string &file, int line, const std::string &text) {
  if (!granhom::in_guarded_call()) lammps_own(this, static_cast<plain>(&Error::one), file, line, text);
  std::string message = located(file, line, text);
  int me = 0;
  if (world) MPI_Comm_rank(world, &me); /* without one, memory was short while LAMMPS came up */
  if (screen || logfile)
    utils::logmesg(lmp, "ERROR on proc " + std::to_string(me) + ": " + message +
                            "\nLast command: " + (input && input->line ? input->line : "(none)") + "\n");
  if (update) update->whichflag = 0;
  throw lammps_error(message, true);
}

void Error::_all(const std::string &file, int line, fmt::string_view format, fmt::format_args args) {
  all(file, line, formatted(format, args));
}

void Error::_one(const std::string &file, int line, fmt::string_view format, fmt::format_args args) {
  one(file, line, formatted(format, args));
}

void Error::universe_all(const std::string &file, int line, const std::string &text) {
  if (!granhom::in_guarded_call()) lammps_own(this, &Error::universe_all, file, line, text);
  MPI_Barrier(universe->uworld);
  throw lammps_error(located(file, line, text), false);
}

void Error::universe_one(const std::string &file, int line, const std::string &text) {
  if (!granhom::in_guarded_call()) lammps_own(this, &Error::universe_one, file, line, text);
  throw lammps_error(located(file, line, text), true);
}

void Error::done(int status) {
  if (!granhom::in_guarded_call()) lammps_own(this, &Error::done, status);
  MPI_Barrier(world);
  throw lammps_quit{status};
}

} // namespace LAMMPS_NS

#endif
