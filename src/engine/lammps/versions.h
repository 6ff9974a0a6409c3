/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What differs between the versions of LAMMPS that granhom builds with (29 Sep 2021 to 4 Feb 2025), found by
 * feature tests, never by version numbers. */
#ifndef GRANHOM_LAMMPS_VERSIONS_H
#define GRANHOM_LAMMPS_VERSIONS_H

/* The header that declares LAMMPSException is installed where the library is built with exceptions. */
#if __has_include(<exceptions.h>)
#define GH_LAMMPS_THROWS 1
#else
#define GH_LAMMPS_THROWS 0
#endif

namespace granhom {

/* Communication for a fix: until 2022 the functions carried `_fix` in their names. */
template <typename Comm, typename Fix>
auto forward_comm(Comm *comm, Fix *fix, int size) -> decltype(comm->forward_comm_fix(fix, size)) {
  return comm->forward_comm_fix(fix, size);
}

template <typename Comm, typename Fix>
auto forward_comm(Comm *comm, Fix *fix, int size) -> decltype(comm->forward_comm(fix, size)) {
  return comm->forward_comm(fix, size);
}

template <typename Comm, typename Fix>
auto reverse_comm(Comm *comm, Fix *fix) -> decltype(comm->reverse_comm_fix(fix)) {
  return comm->reverse_comm_fix(fix);
}

template <typename Comm, typename Fix>
auto reverse_comm(Comm *comm, Fix *fix) -> decltype(comm->reverse_comm(fix)) {
  return comm->reverse_comm(fix);
}

} // namespace granhom

#endif
