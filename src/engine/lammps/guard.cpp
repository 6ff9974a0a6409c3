/* LAMMPS's errors caught: replaced functions of liblammps.so and guarded library calls.
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * The packaged library is built without exceptions: its Error class ends the process. Calls inside a shared
 * library go through its symbol table, where the executable's definitions come first; so the ones here take
 * the place of LAMMPS's. They throw, guarded() catches. In the same way LAMMPS::post_create(), which follows
 * each `clear`, registers our styles. */
#include "engine/lammps/c_mpi.h"
#include "engine/lammps/guard.h"

#include "engine/lammps/fix_history.h"
#include "engine/lammps/fix_relax.h"
#include "engine/lammps/styles.h"

#include "comm.h"
#include "error.h"
#include "input.h"
#include "lammps.h"
#include "library.h"
#include "modify.h"
#include "timer.h"
#include "universe.h"
#include "update.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <exception>
#include <new>
#include <string>

using granhom::FixHistory;
using LAMMPS_NS::LAMMPS;

namespace {

enum { OLDEST_VERSION = 20210929 };

struct lammps_error : std::exception {
  std::string text;
  bool alone; /* of one rank: the others do not know */
  lammps_error(std::string t, bool a) : text(std::move(t)), alone(a) {}
  const char *what() const noexcept override { return text.c_str(); }
};

struct lammps_quit {
  int status;
};

/* "message (src/file.cpp:123)" */
std::string located(const std::string &file, int line, const std::string &text) {
  std::size_t at = file.rfind("src/");
  return text + " (" + (at == std::string::npos ? file : file.substr(at)) + ":" + std::to_string(line) + ")";
}

std::string formatted(fmt::string_view format, fmt::format_args args) {
  try {
    return fmt::detail::vformat(format, args);
  } catch (const std::exception &e) {
    return e.what();
  }
}

template <typename Call> gh_status guarded(gh_context *ctx, const char *what, Call call) {
  try {
    return call();
  } catch (const std::bad_alloc &) {
    return gh_fail(ctx, GH_MEMORY, "LAMMPS (%s): out of memory", what);
  } catch (const std::exception &e) {
    return gh_fail(ctx, GH_ENGINE, "LAMMPS (%s): %s", what, e.what());
  } catch (const lammps_quit &q) {
    return gh_fail(ctx, GH_ENGINE, "LAMMPS (%s) ended with status %d", what, q.status);
  }
}

} // namespace

/* ---- in the place of LAMMPS's own ---- */

namespace LAMMPS_NS {

void Error::all(const std::string &file, int line, const std::string &text) {
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
  std::string message = located(file, line, text);
  int me;
  MPI_Comm_rank(world, &me);
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
  MPI_Barrier(universe->uworld);
  throw lammps_error(located(file, line, text), false);
}

void Error::universe_one(const std::string &file, int line, const std::string &text) {
  throw lammps_error(located(file, line, text), true);
}

void Error::done(int status) {
  MPI_Barrier(world);
  throw lammps_quit{status};
}

void LAMMPS::post_create() {
  using function = void (*)(LAMMPS *);
  auto original = reinterpret_cast<function>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS6LAMMPS11post_createEv"));
  if (original) original(this);
  granhom::register_styles(this);
}

} // namespace LAMMPS_NS

/* ---- guarded library calls ---- */

static void finalize_mpi() {
  int done = 0;
  MPI_Finalized(&done);
  if (!done) MPI_Finalize();
}

static gh_status start_mpi(gh_context *ctx) {
  int begun = 0, done = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&done);
  if (done) return gh_fail(ctx, GH_ENGINE, "LAMMPS needs MPI, which has been finalised already");
  if (begun) return GH_OK;
  if (MPI_Init(nullptr, nullptr) != MPI_SUCCESS) return gh_fail(ctx, GH_ENGINE, "MPI_Init failed");
  atexit(finalize_mpi);
  return GH_OK;
}

static gh_status check_instance(gh_context *ctx, void *lmp) {
  int version = lammps_version(lmp);
  if (version < OLDEST_VERSION)
    return gh_fail(ctx, GH_ENGINE, "LAMMPS %d is too old: granhom needs %d (29 Sep 2021) or later", version,
                   OLDEST_VERSION);
  if (!lammps_has_style(lmp, "pair", "granhom/normal"))
    return gh_fail(
        ctx, GH_ENGINE,
        "LAMMPS does not see granhom's styles: liblammps.so comes before granhom in the search order "
        "of symbols. Link -lgranhom before -llammps; with libgranhom.a, link with -rdynamic");
  return GH_OK;
}

gh_status gh_lmp_open(gh_context *ctx, void **lmp) {
  *lmp = nullptr;
  GH_TRY(start_mpi(ctx));
  return guarded(ctx, "open", [&] {
    char name[] = "granhom", screen[] = "-screen", log[] = "-log", none[] = "none", nocite[] = "-nocite";
    char *argv[] = {name, screen, none, log, none, nocite, nullptr};
    *lmp = lammps_open(6, argv, MPI_COMM_SELF, nullptr);
    if (!*lmp) return gh_fail(ctx, GH_ENGINE, "LAMMPS could not be opened");
    gh_status status = check_instance(ctx, *lmp);
    if (status != GH_OK) gh_lmp_close(lmp);
    return status;
  });
}

int gh_lmp_version(gh_context *ctx, void *lmp) {
  int version = 0;
  guarded(ctx, "version", [&] {
    version = lammps_version(lmp);
    return GH_OK;
  });
  return version;
}

void gh_lmp_close(void **lmp) {
  if (!lmp || !*lmp) return;
  guarded(nullptr, "close", [&] {
    lammps_close(*lmp);
    return GH_OK;
  });
  *lmp = nullptr;
}

gh_status gh_lmp_command(gh_context *ctx, void *lmp, const char *format, ...) {
  char text[512];
  va_list args;
  va_start(args, format);
  int length = vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (length < 0 || length >= (int)sizeof text)
    return gh_fail(ctx, GH_INTERNAL, "LAMMPS command too long: %s", text);
  return guarded(ctx, text, [&] {
    lammps_command(lmp, text);
    return GH_OK;
  });
}

gh_status gh_lmp_create_atoms(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                              const double *x) {
  return guarded(ctx, "create atoms", [&] {
    int made = lammps_create_atoms(lmp, n, id, type, x, nullptr, nullptr, 0);
    if (made != n) return gh_fail(ctx, GH_ENGINE, "LAMMPS made %d of %d atoms", made, n);
    return GH_OK;
  });
}

gh_status gh_lmp_setting(gh_context *ctx, void *lmp, const char *name, int *value) {
  return guarded(ctx, name, [&] {
    *value = lammps_extract_setting(lmp, name);
    return *value >= 0 ? GH_OK : gh_fail(ctx, GH_ENGINE, "LAMMPS has no setting %s", name);
  });
}

gh_status gh_lmp_atom(gh_context *ctx, void *lmp, const char *name, void *p) {
  return guarded(ctx, name, [&] {
    void *array = lammps_extract_atom(lmp, name);
    *static_cast<void **>(p) = array;
    return array ? GH_OK : gh_fail(ctx, GH_ENGINE, "LAMMPS has no property %s of atoms", name);
  });
}

gh_status gh_lmp_local(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows) {
  return guarded(ctx, id, [&] {
    *rows = nullptr;
    auto *size = static_cast<int *>(lammps_extract_compute(lmp, id, LMP_STYLE_LOCAL, LMP_SIZE_ROWS));
    if (!size) return gh_fail(ctx, GH_ENGINE, "LAMMPS has no compute %s with local data", id);
    *count = *size;
    if (*count)
      *rows = static_cast<double **>(lammps_extract_compute(lmp, id, LMP_STYLE_LOCAL, LMP_TYPE_ARRAY));
    return !*count || *rows ? GH_OK : gh_fail(ctx, GH_ENGINE, "LAMMPS gave no array for compute %s", id);
  });
}

gh_status gh_lmp_fix_vector(gh_context *ctx, void *lmp, const char *id, int component, double *value) {
  return guarded(ctx, id, [&] {
    auto *v =
        static_cast<double *>(lammps_extract_fix(lmp, id, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, component, 0));
    if (!v) return gh_fail(ctx, GH_ENGINE, "LAMMPS has no fix %s with a vector", id);
    *value = *v;
    lammps_free(v);
    return GH_OK;
  });
}

/* ---- driving a fix granhom/relax ---- */

/* Calls call(fix) for the fix of that id and class. */
template <typename Style, typename Call>
static gh_status with_style(gh_context *ctx, void *lmp, const char *id, const char *name, Call call) {
  return guarded(ctx, id, [&] {
    auto *modify = static_cast<LAMMPS *>(lmp)->modify;
    int index = modify->find_fix(id);
    auto *fix = index < 0 ? nullptr : dynamic_cast<Style *>(modify->fix[index]);
    if (!fix) return gh_fail(ctx, GH_ENGINE, "LAMMPS has no fix %s of style %s", id, name);
    return call(fix);
  });
}

template <typename Call> static gh_status with_fix(gh_context *ctx, void *lmp, const char *id, Call call) {
  return with_style<granhom::FixRelax>(ctx, lmp, id, "granhom/relax", call);
}

template <typename Call> static gh_status with_history(gh_context *ctx, void *lmp, Call call) {
  return with_style<FixHistory>(ctx, lmp, FixHistory::ID, "granhom/history", call);
}

gh_status gh_lmp_drive(gh_context *ctx, void *lmp, const char *id, bool periodic, int *group_bit) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->drive(periodic);
    *group_bit = fix->group_bit();
    return GH_OK;
  });
}

gh_status gh_lmp_set_cell(gh_context *ctx, void *lmp, const char *id, const double t[4]) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->set_cell(t[0], t[3], t[1]);
    return GH_OK;
  });
}

gh_status gh_lmp_rebuild(gh_context *ctx, void *lmp, const char *id) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->rebuild_next();
    return GH_OK;
  });
}

gh_status gh_lmp_advance(gh_context *ctx, void *lmp, const char *id) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->advance();
    return GH_OK;
  });
}

gh_status gh_lmp_relax(gh_context *ctx, void *lmp, const char *id, const gh_relax_options *o,
                       gh_lmp_relaxed *r) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->relax_next(*o);
    while (!fix->finished()) fix->advance();
    fix->idle();
    fix->tell(r);
    return GH_OK;
  });
}

gh_status gh_lmp_builds(gh_context *ctx, void *lmp, const char *id, long *builds) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    *builds = fix->builds();
    return GH_OK;
  });
}

gh_status gh_lmp_pairs(gh_context *ctx, void *lmp, const char *id, long *pairs) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    *pairs = fix->pairs_on_list();
    return GH_OK;
  });
}

gh_status gh_lmp_history(gh_context *ctx, void *lmp, const double H[4], const double *x,
                         const double *theta_n, const gh_slip *slips, int nslips) {
  return with_history(ctx, lmp, [&](FixHistory *fix) {
    fix->set_converged(H, x, theta_n, slips, nslips);
    return GH_OK;
  });
}

gh_status gh_lmp_set_rotations(gh_context *ctx, void *lmp, const double *theta) {
  return with_history(ctx, lmp, [&](FixHistory *fix) {
    fix->set_rotations(theta);
    return GH_OK;
  });
}

gh_status gh_lmp_get_rotations(gh_context *ctx, void *lmp, double *theta) {
  return with_history(ctx, lmp, [&](FixHistory *fix) {
    fix->get_rotations(theta);
    return GH_OK;
  });
}

/* ---- a LAMMPS program of its own ---- */

gh_status gh_lmp_program(gh_context *ctx, int argc, char **argv, int *exit_status, bool *alone) {
  void *lmp = nullptr;
  *exit_status = 0;
  *alone = false;
  GH_TRY(start_mpi(ctx));
  gh_status status = guarded(ctx, "script", [&] {
    try {
      lmp = lammps_open(argc, argv, MPI_COMM_WORLD, nullptr);
      if (!lmp) return gh_fail(ctx, GH_ENGINE, "LAMMPS could not be opened");
      GH_TRY(check_instance(ctx, lmp));
      static_cast<LAMMPS *>(lmp)->input->file();
      return GH_OK;
    } catch (const lammps_quit &quit) {
      *exit_status = quit.status;
      return GH_OK;
    } catch (const lammps_error &error) {
      int ranks;
      MPI_Comm_size(MPI_COMM_WORLD, &ranks);
      *alone = error.alone && ranks > 1;
      return gh_fail(ctx, GH_ENGINE, "LAMMPS: %s", error.what());
    }
  });
  if (*alone) return status; /* closing waits for all ranks */
  gh_lmp_close(&lmp);
  lammps_python_finalize();
  return status;
}
