/* SPDX-License-Identifier: GPL-2.0-or-later */
/* MPI without its C++ bindings, which LAMMPS's headers would pull in and nothing here links. Comes before any
 * header of LAMMPS. */
#ifndef GRANHOM_LAMMPS_C_MPI_H
#define GRANHOM_LAMMPS_C_MPI_H

#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX 1
#endif
#include <mpi.h>

#endif
