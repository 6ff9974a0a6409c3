/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Guarded calls of LAMMPS's library: its errors become statuses.
 *
 * A library with exceptions throws from C++ calls and keeps the message of C calls for lammps_has_error. In
 * one without, interpose.cpp replaces the functions that would end the process by ones that throw. */
#include "engine/lammps/c_mpi.h"
#include "engine/lammps/guard.h"

#include "engine/lammps/fix_history.h"
#include "engine/lammps/fix_relax.h"
#include "engine/lammps/interpose.h"
#include "engine/lammps/interpose_programs.h"
#include "engine/lammps/rebind.h"
#include "engine/lammps/versions.h"

#include "input.h"
#include "lammps.h"
#include "library.h"
#include "modify.h"

#if GH_LAMMPS_THROWS
#include "exceptions.h"
#endif

#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

using granhom::FixHistory;
using LAMMPS_NS::LAMMPS;

namespace {

enum { OLDEST_VERSION = 20210929 };

/* LAMMPS's text without "ERROR: " or "ERROR on proc 0: " in front, and without the lines behind the first,
 * which repeat the command. */
std::string message_of(std::string text) {
  text = text.substr(0, text.find('\n'));
  if (text.rfind("ERROR", 0) != 0) return text;
  std::size_t colon = text.find(": ");
  return colon == std::string::npos ? text : text.substr(colon + 2);
}

/* Whether the other ranks do not know of the error. */
bool of_one_rank(const std::exception &error) {
  if (auto *ours = dynamic_cast<const granhom::lammps_error *>(&error)) return ours->alone;
#if GH_LAMMPS_THROWS
  return dynamic_cast<const LAMMPS_NS::LAMMPSAbortException *>(&error);
#else
  return false;
#endif
}

gh_status cannot_open(gh_context *ctx) {
  char text[1024] = "";
#if GH_LAMMPS_THROWS
  lammps_get_last_error_message(nullptr, text, sizeof text);
#endif
  std::string reason = message_of(text);
  return gh_fail(ctx, GH_ENGINE, "LAMMPS could not be opened%s%s", reason.empty() ? "" : ": ",
                 reason.c_str());
}

/* The message that a C function of the library has kept, which is cleared; empty when there is none. */
std::string kept_error(void *lmp) {
  char text[1024] = "";
  if (lmp && lammps_has_error(lmp)) lammps_get_last_error_message(lmp, text, sizeof text);
  return message_of(text);
}

/* An allocation has failed within LAMMPS. What it has left half made cannot be destroyed: from then on the
 * program, which ends for it, closes no instance any more. */
std::atomic<bool> memory_failed{false};

gh_status no_memory(gh_context *ctx, const char *what, const char *reason) {
  memory_failed = true;
  return gh_fail(ctx, GH_MEMORY, "LAMMPS (%s): out of memory%s%s", what, *reason ? ": " : "", reason);
}

bool tells_of_memory(const std::string &message) {
  return message.find("Failed to allocate") != std::string::npos ||
         message.find("Failed to reallocate") != std::string::npos;
}

/* How many guarded calls this thread is in. */
thread_local int guarded_calls = 0;
struct guarded_call {
  guarded_call() { guarded_calls++; }
  ~guarded_call() { guarded_calls--; }
  guarded_call(const guarded_call &) = delete;
  guarded_call &operator=(const guarded_call &) = delete;
};

template <typename Call> gh_status guarded(gh_context *ctx, void *lmp, const char *what, Call call) {
  const guarded_call here;
  try {
    gh_status status = call();
    std::string error = kept_error(lmp);
    return error.empty() ? status : gh_fail(ctx, GH_ENGINE, "LAMMPS (%s): %s", what, error.c_str());
  } catch (const std::bad_alloc &) {
    return no_memory(ctx, what, "");
  } catch (const std::exception &e) {
    const std::string message = message_of(e.what());
    if (tells_of_memory(message)) return no_memory(ctx, what, message.c_str());
    return gh_fail(ctx, GH_ENGINE, "LAMMPS (%s): %s", what, message.c_str());
  } catch (const granhom::lammps_quit &q) {
    return gh_fail(ctx, GH_ENGINE, "LAMMPS (%s) ended with status %d", what, q.status);
  }
}

} // namespace

bool granhom::in_guarded_call() {
  return guarded_calls > 0;
}

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
    return gh_fail(ctx, GH_ENGINE, "LAMMPS does not see granhom's styles: %s", granhom::advice_on_linking());
  return GH_OK;
}

gh_status guard_open(gh_context *ctx, void **lmp) {
  *lmp = nullptr;
  GH_TRY(start_mpi(ctx));
  granhom::rebind();
  return guarded(ctx, nullptr, "open", [&] {
    char name[] = "granhom", screen[] = "-screen", log[] = "-log", none[] = "none", nocite[] = "-nocite";
    char *argv[] = {name, screen, none, log, none, nocite, nullptr};
    *lmp = lammps_open(6, argv, MPI_COMM_SELF, nullptr);
    if (!*lmp) return cannot_open(ctx);
    granhom::refuse_programs(static_cast<LAMMPS *>(*lmp));
    gh_status status = check_instance(ctx, *lmp);
    if (status != GH_OK) guard_close(lmp);
    return status;
  });
}

int guard_version(gh_context *ctx, void *lmp) {
  int version = 0;
  guarded(ctx, lmp, "version", [&] {
    version = lammps_version(lmp);
    return GH_OK;
  });
  return version;
}

void guard_close(void **lmp) {
  if (!lmp || !*lmp || memory_failed) return;
  guarded(nullptr, nullptr, "close", [&] {
    lammps_close(*lmp);
    return GH_OK;
  });
  *lmp = nullptr;
}

gh_status guard_command(gh_context *ctx, void *lmp, const char *format, ...) {
  char text[512];
  va_list args;
  va_start(args, format);
  int length = vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (length < 0 || length >= (int)sizeof text)
    return gh_fail(ctx, GH_INTERNAL, "LAMMPS command too long: %s", text);
  return guarded(ctx, lmp, text, [&] {
    lammps_command(lmp, text);
    return GH_OK;
  });
}

gh_status guard_create_atoms(gh_context *ctx, void *lmp, int n, const int *id, const int *type,
                             const double *x) {
  return guarded(ctx, lmp, "create atoms", [&] {
    int made = lammps_create_atoms(lmp, n, id, type, x, nullptr, nullptr, 0);
    if (made != n) return gh_fail(ctx, GH_ENGINE, "LAMMPS made %d of %d atoms", made, n);
    return GH_OK;
  });
}

gh_status guard_setting(gh_context *ctx, void *lmp, const char *name, int *value) {
  return guarded(ctx, lmp, name, [&] {
    *value = lammps_extract_setting(lmp, name);
    return *value >= 0 ? GH_OK : gh_fail(ctx, GH_ENGINE, "LAMMPS has no parameter %s", name);
  });
}

gh_status guard_atom(gh_context *ctx, void *lmp, const char *name, void *p) {
  return guarded(ctx, lmp, name, [&] {
    void *array = lammps_extract_atom(lmp, name);
    *static_cast<void **>(p) = array;
    return array ? GH_OK : gh_fail(ctx, GH_ENGINE, "LAMMPS has no property %s of atoms", name);
  });
}

gh_status guard_local(gh_context *ctx, void *lmp, const char *id, int *count, double ***rows) {
  return guarded(ctx, lmp, id, [&] {
    *rows = nullptr;
    auto *size = static_cast<int *>(lammps_extract_compute(lmp, id, LMP_STYLE_LOCAL, LMP_SIZE_ROWS));
    if (!size) return gh_fail(ctx, GH_ENGINE, "LAMMPS has no compute %s with local data", id);
    *count = *size;
    if (*count)
      *rows = static_cast<double **>(lammps_extract_compute(lmp, id, LMP_STYLE_LOCAL, LMP_TYPE_ARRAY));
    return !*count || *rows ? GH_OK : gh_fail(ctx, GH_ENGINE, "LAMMPS gave no array for compute %s", id);
  });
}

gh_status guard_fix_vector(gh_context *ctx, void *lmp, const char *id, int component, double *value) {
  return guarded(ctx, lmp, id, [&] {
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
  return guarded(ctx, lmp, id, [&] {
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

gh_status guard_drive(gh_context *ctx, void *lmp, const char *id, bool periodic, int *group_bit) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->drive(periodic);
    *group_bit = fix->group_bit();
    return GH_OK;
  });
}

gh_status guard_set_cell(gh_context *ctx, void *lmp, const char *id, const double t[4]) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->set_cell(t[0], t[3], t[1]);
    return GH_OK;
  });
}

gh_status guard_rebuild(gh_context *ctx, void *lmp, const char *id) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->rebuild_next();
    return GH_OK;
  });
}

gh_status guard_advance(gh_context *ctx, void *lmp, const char *id) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->advance();
    return GH_OK;
  });
}

gh_status guard_relax(gh_context *ctx, void *lmp, const char *id, const gh_relax_options *o,
                      const gh_relax_frame *frame, guard_relaxed *r) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->relax_next(*o, frame);
    while (!fix->finished()) fix->advance();
    fix->idle();
    fix->tell(r);
    return GH_OK;
  });
}

gh_status guard_ramp(gh_context *ctx, void *lmp, const char *id, const gh_ramp *ramp, gh_relax_friction *s,
                     gh_relax_result *r, guard_ramped *list) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    fix->ramp(*ramp, s, r, list);
    return GH_OK;
  });
}

gh_status guard_builds(gh_context *ctx, void *lmp, const char *id, long *builds) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    *builds = fix->builds();
    return GH_OK;
  });
}

gh_status guard_pairs(gh_context *ctx, void *lmp, const char *id, long *pairs) {
  return with_fix(ctx, lmp, id, [&](granhom::FixRelax *fix) {
    *pairs = fix->pairs_on_list();
    return GH_OK;
  });
}

gh_status guard_history(gh_context *ctx, void *lmp, const double H[4], const double *x, const double *theta_n,
                        const gh_slip *slips, int nslips) {
  return with_history(ctx, lmp, [&](FixHistory *fix) {
    fix->set_converged(H, x, theta_n, slips, nslips);
    return GH_OK;
  });
}

gh_status guard_set_rotations(gh_context *ctx, void *lmp, const double *theta) {
  return with_history(ctx, lmp, [&](FixHistory *fix) {
    fix->set_rotations(theta);
    return GH_OK;
  });
}

gh_status guard_get_rotations(gh_context *ctx, void *lmp, double *theta) {
  return with_history(ctx, lmp, [&](FixHistory *fix) {
    fix->get_rotations(theta);
    return GH_OK;
  });
}

/* ---- a LAMMPS program of its own ---- */

gh_status guard_program(gh_context *ctx, int argc, char **argv, bool programs, int *exit_status,
                        bool *alone) {
  void *lmp = nullptr;
  *exit_status = 0;
  *alone = false;
  GH_TRY(start_mpi(ctx));
  granhom::rebind();
  gh_status status = guarded(ctx, nullptr, "script", [&] {
    try {
      lmp = lammps_open(argc, argv, MPI_COMM_WORLD, nullptr);
      if (!lmp) return cannot_open(ctx);
      GH_TRY(check_instance(ctx, lmp));
      if (!programs) granhom::refuse_programs(static_cast<LAMMPS *>(lmp));
      static_cast<LAMMPS *>(lmp)->input->file();
      return GH_OK;
    } catch (const granhom::lammps_quit &quit) {
      *exit_status = quit.status;
      return GH_OK;
    } catch (const std::bad_alloc &) {
      throw;
    } catch (const std::exception &error) {
      int ranks;
      MPI_Comm_size(MPI_COMM_WORLD, &ranks);
      *alone = of_one_rank(error) && ranks > 1;
      return gh_fail(ctx, GH_ENGINE, "LAMMPS: %s", message_of(error.what()).c_str());
    }
  });
  if (*alone) return status; /* closing waits for all ranks */
  guard_close(&lmp);
  lammps_python_finalize();
  return status;
}
