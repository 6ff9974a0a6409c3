/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the replaced functions of liblammps.so throw. */
#ifndef GRANHOM_LAMMPS_INTERPOSE_H
#define GRANHOM_LAMMPS_INTERPOSE_H

#include <exception>
#include <string>
#include <utility>

namespace granhom {

/* An error of a library that has no exceptions of its own. */
struct lammps_error : std::exception {
  std::string text;
  bool alone; /* of one rank: the others do not know */
  lammps_error(std::string t, bool a) : text(std::move(t)), alone(a) {}
  const char *what() const noexcept override { return text.c_str(); }
};

/* A `quit` command in such a library. */
struct lammps_quit {
  int status;
};

/* Whether this thread is in a call of guard.cpp, which catches what is thrown. */
bool in_guarded_call();

/* Why the replaced functions may not be found, and what helps. Whoever calls it links them in. */
const char *advice_on_linking();

} // namespace granhom

#endif
