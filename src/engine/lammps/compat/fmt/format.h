/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The few declarations of fmt 7 that LAMMPS's headers need and Debian's liblammps-dev lacks.
 *
 * Names and layouts follow the binary interface of liblammps (inline namespace v7_lmp): both types are passed
 * in two registers. make_args_checked is declared for LAMMPS's templates but never used: our code hands over
 * ready text (std::string). */
#ifndef GRANHOM_COMPAT_FMT_FORMAT_H
#define GRANHOM_COMPAT_FMT_FORMAT_H

#include <cstddef>
#include <string>

namespace fmt {
inline namespace v7_lmp {

template <typename Char> struct basic_string_view {
  const Char *data;
  std::size_t size;
};
using string_view = basic_string_view<char>;

struct format_args {
  unsigned long long kinds;
  const void *values;
};

template <typename... Args, typename S> format_args make_args_checked(const S &, const Args &...);

namespace detail {
std::string vformat(string_view, format_args);
}

} // namespace v7_lmp
} // namespace fmt

#endif
