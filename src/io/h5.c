/* SPDX-License-Identifier: GPL-2.0-or-later */
/* HDF5: one writer, datasets of numbers.
 * A file that is written is built in memory (HDF5's core driver) and goes to disk as a whole at the commit,
 * by the same way as text files, sealed with a checksum (seal.c). HDF5 1.10 does not survive a full disk: the
 * file cannot be closed any more and the program crashes at its end. HDF5 prints nothing: every public
 * function switches its error printing off while it runs. */
#include "io/file.h"
#include "io/seal.h"

#include <hdf5.h>
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MEMORY_STEP = 1 << 20, RESERVE = 1 << 20, REASON = 512 };

struct gh_h5 {
  gh_context *ctx;
  char *path;
  char kind[40];
  hid_t id;
  bool writing;
  bool foreign; /* without a checksum: damage may look like anything */
};

/* ---- HDF5's errors ---- */

typedef struct {
  H5E_auto2_t function;
  void *data;
} printing;

static printing printing_off(void) {
  printing p = {0};
  H5dont_atexit(); /* what a failure has left open would crash the program at its end; nothing is to be saved
                    */
  H5Eget_auto2(H5E_DEFAULT, &p.function, &p.data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  return p;
}

static void printing_on(printing p) {
  H5Eset_auto2(H5E_DEFAULT, p.function, p.data);
}

typedef struct reason {
  char text[REASON];
  gh_status status; /* GH_OK: the error's number does not say whose fault it is */
} reason;

static herr_t reason_add(unsigned n, const H5E_error2_t *error, void *data) {
  reason *r = data;
  if (n == 0 && error->desc)
    snprintf(r->text, sizeof r->text, "%.*s", (int)strcspn(error->desc, "\n"), error->desc);
  if (error->maj_num == H5E_RESOURCE || error->min_num == H5E_NOSPACE || error->min_num == H5E_CANTALLOC)
    r->status = GH_MEMORY;
  else if (r->status == GH_OK && (error->maj_num == H5E_IO || error->min_num == H5E_READERROR ||
                                  error->min_num == H5E_WRITEERROR || error->min_num == H5E_BADFILE))
    r->status = GH_SYSTEM;
  return 0;
}

/* Fails with the innermost message of HDF5's error stack, so call it before any other function of HDF5. s:
 * where HDF5 does not say that it had no memory or could not read. */
static gh_status fail(const gh_h5 *f, gh_status s, const char *what, const char *name) {
  reason r = {.text = "HDF5 gives no reason"};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, reason_add, &r);
  if (f->foreign) s = GH_INPUT;
  else if (r.status != GH_OK) s = r.status;
  return gh_fail(f->ctx, s, "%s: cannot %s %s: %s", f->path, what, name, r.text);
}

/* ---- open and close ---- */

/* HDF5 1.10 does not check each of its own small allocations, and crashes where one fails. So no work of HDF5
 * begins unless there is room for far more than it takes besides the data. */
static gh_status room_check(gh_context *ctx, const char *path) {
  void *room = malloc(RESERVE);
  free(room);
  return room ? GH_OK : gh_fail(ctx, GH_MEMORY, "%s: no memory for HDF5", path);
}

static gh_status file_create(gh_context *ctx, const char *path, const char *kind, bool writing, gh_h5 **out) {
  gh_h5 *f;
  GH_TRY(gh_alloc(ctx, 1, sizeof *f, &f));
  *f = (gh_h5){.ctx = ctx, .path = strdup(path), .id = H5I_INVALID_HID, .writing = writing};
  snprintf(f->kind, sizeof f->kind, "%s", kind);
  *out = f;
  return f->path ? GH_OK : gh_fail(ctx, GH_MEMORY, "%s: no memory for its name", path);
}

/* Opens what is there, once each of its bytes was checked. No locks: files are replaced as a whole, and some
 * network file systems refuse locks. */
static gh_status file_open(gh_h5 *f, hid_t access, bool *sealed) {
  GH_TRY(gh_seal_check(f->ctx, f->path, f->kind, sealed));
  f->foreign = sealed && !*sealed;
  if (H5Pset_file_locking(access, false, true) < 0) return fail(f, GH_MEMORY, "open", "it");
  f->id = H5Fopen(f->path, f->writing ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access);
  if (f->id >= 0) return GH_OK;
  return fail(f, GH_SYSTEM, "open", "it as an HDF5 file"); /* each byte of it was in order */
}

/* A new file, with room for the seal. */
static gh_status file_make(gh_h5 *f, hid_t access) {
  hid_t creation = H5Pcreate(H5P_FILE_CREATE);
  if (creation >= 0 && H5Pset_userblock(creation, GH_SEAL) >= 0)
    f->id = H5Fcreate(f->path, H5F_ACC_TRUNC, creation, access);
  gh_status s = f->id < 0 ? fail(f, GH_MEMORY, "make", "a file in memory") : GH_OK;
  if (creation >= 0) H5Pclose(creation);
  return s;
}

static gh_status open_for_change(gh_h5 *f, bool append) {
  bool there = false;
  if (append) GH_TRY(gh_file_there(f->ctx, f->path, &there));
  hid_t how = H5Pcreate(H5P_FILE_ACCESS);
  gh_status s = GH_OK;
  if (how < 0 || H5Pset_fapl_core(how, MEMORY_STEP, false) < 0)
    s = fail(f, GH_MEMORY, "make", "a file in memory");
  else s = there ? file_open(f, how, NULL) : file_make(f, how);
  if (how >= 0) H5Pclose(how);
  return s;
}

/* Into memory as a whole: HDF5 takes what it cannot read later, from a failing device, for absent. */
static gh_status open_to_read(gh_h5 *f, bool *sealed) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  gh_status s = GH_OK;
  if (access < 0 || H5Pset_fapl_core(access, MEMORY_STEP, false) < 0) s = fail(f, GH_MEMORY, "open", "it");
  else s = file_open(f, access, sealed);
  if (access >= 0) H5Pclose(access);
  return s;
}

void gh_h5_start(void) {
  if (room_check(NULL, "") != GH_OK) return;
  H5dont_atexit();
  H5open(); /* where it fails, the first file will */
}

bool gh_h5_available(void) {
  return true;
}

gh_status gh_h5_open(gh_context *ctx, const char *path, const char *kind, bool append, gh_h5 **file) {
  *file = NULL;
  GH_TRY(room_check(ctx, path));
  printing p = printing_off();
  gh_status s = file_create(ctx, path, kind, true, file);
  if (s == GH_OK) s = open_for_change(*file, append);
  if (s != GH_OK) gh_h5_close(file);
  printing_on(p);
  return s;
}

gh_status gh_h5_read(gh_context *ctx, const char *path, const char *kind, bool *sealed, gh_h5 **file) {
  *file = NULL;
  GH_TRY(room_check(ctx, path));
  printing p = printing_off();
  gh_status s = file_create(ctx, path, kind, false, file);
  if (s == GH_OK) s = open_to_read(*file, sealed);
  if (s != GH_OK) gh_h5_close(file);
  printing_on(p);
  return s;
}

void gh_h5_close(gh_h5 **file) {
  if (!file || !*file) return;
  printing p = printing_off();
  if ((*file)->id >= 0) H5Fclose((*file)->id);
  printing_on(p);
  free((*file)->path);
  free(*file);
  *file = NULL;
}

/* The file in memory, to disk. Its buffer grows in steps; the image is the part in use behind the seal. */
static gh_status write_image(gh_h5 *f) {
  void **buffer;
  ssize_t size;
  if (!f->writing)
    return gh_fail(f->ctx, GH_INTERNAL, "%s: was opened for reading and cannot be committed", f->path);
  if (H5Fflush(f->id, H5F_SCOPE_GLOBAL) < 0 || (size = H5Fget_file_image(f->id, NULL, 0)) < 0 ||
      H5Fget_vfd_handle(f->id, H5P_DEFAULT, (void **)&buffer) < 0) {
    return fail(f, GH_MEMORY, "finish", "the file in memory");
  }
  gh_seal_make(f->kind, *buffer, GH_SEAL + (size_t)size);
  return gh_file_write(f->ctx, f->path, *buffer, GH_SEAL + (size_t)size);
}

gh_status gh_h5_commit(gh_h5 **file) {
  printing p = printing_off();
  gh_status s = write_image(*file);
  gh_h5_close(file);
  printing_on(p);
  return s;
}

/* ---- names ---- */

/* Whether what has this name is a group; there is nothing in a dataset. */
static gh_status group_check(const gh_h5 *f, const char *name, bool *group) {
  hid_t object = H5Oopen(f->id, name, H5P_DEFAULT);
  if (object < 0) return fail(f, GH_MEMORY, "open", name);
  *group = H5Iget_type(object) == H5I_GROUP;
  H5Oclose(object);
  return GH_OK;
}

/* Asks group by group: HDF5 takes a missing group on the way for an error. */
static gh_status name_find(const gh_h5 *f, const char *name, bool *there) {
  char part[256];
  size_t length = strlen(name);
  *there = false;
  GH_TRY(room_check(f->ctx, f->path));
  if (length >= sizeof part)
    return gh_fail(f->ctx, GH_INTERNAL, "%s: the name %s is too long", f->path, name);
  for (size_t k = 1; k <= length; k++) {
    if (name[k] && name[k] != '/') continue;
    snprintf(part, sizeof part, "%.*s", (int)k, name);
    htri_t found = H5Lexists(f->id, part, H5P_DEFAULT);
    if (found < 0) return fail(f, GH_MEMORY, "look for", name);
    if (found == 0) return GH_OK;
    if (!name[k]) break;
    bool group = false;
    GH_TRY(group_check(f, part, &group));
    if (!group) return GH_OK;
  }
  *there = true;
  return GH_OK;
}

gh_status gh_h5_there(gh_h5 *f, const char *name, bool *there) {
  printing p = printing_off();
  gh_status s = name_find(f, name, there);
  printing_on(p);
  return s;
}

/* ---- writing ---- */

/* Number of bytes of an array; false when no memory could hold it. */
static bool array_bytes(size_t rows, size_t cols, size_t size, size_t *bytes) {
  if (cols != 0 && rows > SIZE_MAX / cols / size) return false;
  *bytes = rows * cols * size;
  return true;
}

/* A dataset of this name makes room. */
static gh_status drop(const gh_h5 *f, const char *name) {
  bool there;
  GH_TRY(name_find(f, name, &there));
  if (!there) return GH_OK;
  hid_t old = H5Dopen2(f->id, name, H5P_DEFAULT);
  if (old < 0) return fail(f, GH_INTERNAL, "replace", name); /* a group */
  H5Dclose(old);
  if (H5Ldelete(f->id, name, H5P_DEFAULT) >= 0) return GH_OK;
  return fail(f, GH_MEMORY, "replace", name);
}

static gh_status write_dataset(const gh_h5 *f, const char *name, hid_t type, hid_t space, const void *data) {
  GH_TRY(drop(f, name));
  hid_t link = H5Pcreate(H5P_LINK_CREATE), creation = H5Pcreate(H5P_DATASET_CREATE), set = H5I_INVALID_HID;
  gh_status s = GH_OK;
  /* without times the same results are the same file */
  if (link < 0 || creation < 0 || H5Pset_create_intermediate_group(link, 1) < 0 ||
      H5Pset_obj_track_times(creation, false) < 0) {
    s = fail(f, GH_MEMORY, "make", name);
  } else if ((set = H5Dcreate2(f->id, name, type, space, link, creation, H5P_DEFAULT)) < 0) {
    s = fail(f, GH_MEMORY, "make", name);
  } else if (data && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    s = fail(f, GH_MEMORY, "write", name);
  }
  if (set >= 0 && H5Dclose(set) < 0 && s == GH_OK) s = fail(f, GH_MEMORY, "write", name);
  if (link >= 0) H5Pclose(link);
  if (creation >= 0) H5Pclose(creation);
  return s;
}

static gh_status put(const gh_h5 *f, const char *name, hid_t type, size_t size_of_one, size_t rows,
                     size_t cols, const void *data) {
  const hsize_t size[2] = {rows, cols};
  size_t bytes;
  if (!f->writing)
    return gh_fail(f->ctx, GH_INTERNAL, "%s: %s was to be written, but the file is open for reading", f->path,
                   name);
  if (!array_bytes(rows, cols, size_of_one, &bytes))
    return gh_fail(f->ctx, GH_INTERNAL, "%s: %s: %zu x %zu values are no array", f->path, name, rows, cols);
  hid_t space = H5Screate_simple(cols == 1 ? 1 : 2, size, NULL);
  if (space < 0) return fail(f, GH_MEMORY, "make", name);
  gh_status s = write_dataset(f, name, type, space, bytes ? data : NULL);
  H5Sclose(space);
  return s;
}

gh_status gh_h5_put_doubles(gh_h5 *f, const char *name, size_t rows, size_t cols, const double *data) {
  printing p = printing_off();
  gh_status s = put(f, name, H5T_NATIVE_DOUBLE, sizeof *data, rows, cols, data);
  printing_on(p);
  return s;
}

gh_status gh_h5_put_ints(gh_h5 *f, const char *name, size_t rows, size_t cols, const int *data) {
  printing p = printing_off();
  gh_status s = put(f, name, H5T_NATIVE_INT, sizeof *data, rows, cols, data);
  printing_on(p);
  return s;
}

static gh_status put_text(const gh_h5 *f, const char *name, const char *text) {
  if (!f->writing)
    return gh_fail(f->ctx, GH_INTERNAL, "%s: %s was to be written, but the file is open for reading", f->path,
                   name);
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  gh_status s = GH_OK;
  if (type < 0 || space < 0 || H5Tset_size(type, strlen(text) + 1) < 0 ||
      H5Tset_cset(type, H5T_CSET_UTF8) < 0)
    s = fail(f, GH_MEMORY, "make", name);
  if (s == GH_OK) s = write_dataset(f, name, type, space, text);
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  return s;
}

gh_status gh_h5_put_text(gh_h5 *f, const char *name, const char *text) {
  printing p = printing_off();
  gh_status s = put_text(f, name, text);
  printing_on(p);
  return s;
}

gh_status gh_h5_remove(gh_h5 *f, const char *name, bool *there) {
  printing p = printing_off();
  gh_status s = name_find(f, name, there);
  *there = *there && f->writing;
  if (s == GH_OK && *there && H5Ldelete(f->id, name, H5P_DEFAULT) < 0) s = fail(f, GH_MEMORY, "remove", name);
  printing_on(p);
  return s;
}

/* ---- reading ---- */

static gh_status get_size(const gh_h5 *f, const char *name, hid_t set, size_t *rows, size_t *cols) {
  hsize_t size[2] = {1, 1};
  hid_t space = H5Dget_space(set);
  int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
  gh_status s = rank < 0 ? fail(f, GH_MEMORY, "read", name) : GH_OK;
  if (rank >= 0 && rank <= 2 && H5Sget_simple_extent_dims(space, size, NULL) < 0)
    s = fail(f, GH_MEMORY, "read", name);
  if (space >= 0) H5Sclose(space);
  GH_TRY(s);
  if (rank > 2)
    return gh_fail(f->ctx, GH_INPUT, "%s: %s has %d dimensions, at most 2 are read", f->path, name, rank);
  *rows = (size_t)size[0];
  *cols = (size_t)size[1];
  return GH_OK;
}

/* Integers that fit an int, or numbers that fit a double: nothing is cut silently. */
static gh_status check_type(const gh_h5 *f, const char *name, hid_t set, bool integers) {
  hid_t type = H5Dget_type(set);
  if (type < 0) return fail(f, GH_MEMORY, "read", name);
  H5T_class_t class = H5Tget_class(type);
  size_t size = H5Tget_size(type);
  bool fits =
      class == H5T_INTEGER && (size < sizeof(int) || (size == sizeof(int) && H5Tget_sign(type) == H5T_SGN_2));
  if (!integers) fits = fits || (class == H5T_FLOAT && size <= sizeof(double));
  H5Tclose(type);
  if (fits) return GH_OK;
  return gh_fail(f->ctx, GH_INPUT, "%s: %s does not hold %s", f->path, name,
                 integers ? "integers" : "numbers");
}

static gh_status open_dataset(const gh_h5 *f, const char *name, hid_t *set) {
  bool there;
  *set = H5I_INVALID_HID;
  GH_TRY(name_find(f, name, &there));
  if (!there) {
    const char *last = strrchr(name, '/');
    return gh_fail(f->ctx, GH_INPUT, "%s: cannot find %s: object '%s' doesn't exist", f->path, name,
                   last ? last + 1 : name);
  }
  *set = H5Oopen(f->id, name, H5P_DEFAULT);
  if (*set < 0) return fail(f, GH_MEMORY, "open", name); /* it is there, and not damaged */
  if (H5Iget_type(*set) == H5I_DATASET) return GH_OK;
  H5Oclose(*set);
  *set = -1;
  return gh_fail(f->ctx, GH_INPUT, "%s: %s is no dataset", f->path, name);
}

static gh_status get(const gh_h5 *f, const char *name, hid_t type, size_t rows, size_t cols, void *data) {
  hid_t set;
  size_t r = 0, c = 0;
  GH_TRY(open_dataset(f, name, &set));
  gh_status s = get_size(f, name, set, &r, &c);
  if (s == GH_OK && (r != rows || c != cols))
    s = gh_fail(f->ctx, GH_INPUT, "%s: %s is %zu x %zu, wanted is %zu x %zu", f->path, name, r, c, rows,
                cols);
  if (s == GH_OK) s = check_type(f, name, set, type == H5T_NATIVE_INT);
  if (s == GH_OK && rows && cols && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
    s = fail(f, GH_MEMORY, "read", name);
  H5Dclose(set);
  return s;
}

gh_status gh_h5_size(gh_h5 *f, const char *name, size_t *rows, size_t *cols) {
  printing p = printing_off();
  hid_t set;
  gh_status s = open_dataset(f, name, &set);
  if (s == GH_OK) {
    s = get_size(f, name, set, rows, cols);
    H5Dclose(set);
  }
  printing_on(p);
  return s;
}

gh_status gh_h5_get_doubles(gh_h5 *f, const char *name, size_t rows, size_t cols, double *data) {
  printing p = printing_off();
  gh_status s = get(f, name, H5T_NATIVE_DOUBLE, rows, cols, data);
  printing_on(p);
  return s;
}

gh_status gh_h5_get_ints(gh_h5 *f, const char *name, size_t rows, size_t cols, int *data) {
  printing p = printing_off();
  gh_status s = get(f, name, H5T_NATIVE_INT, rows, cols, data);
  printing_on(p);
  return s;
}

static gh_status get_text(const gh_h5 *f, const char *name, size_t size, char *text) {
  hid_t set;
  GH_TRY(open_dataset(f, name, &set));
  hid_t type = H5Dget_type(set), space = H5Dget_space(set);
  bool plain = type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 && space >= 0 &&
               H5Sget_simple_extent_npoints(space) == 1;
  gh_status s = GH_OK;
  if (type < 0 || space < 0) s = fail(f, GH_MEMORY, "read", name);
  else if (!plain) s = gh_fail(f->ctx, GH_INPUT, "%s: %s does not hold a text", f->path, name);
  else if (H5Tget_size(type) > size)
    s = gh_fail(f->ctx, GH_INPUT, "%s: %s is a text of %zu bytes, at most %zu are read", f->path, name,
                H5Tget_size(type), size);
  else if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0) s = fail(f, GH_MEMORY, "read", name);
  else text[H5Tget_size(type) - 1] = 0;
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  H5Dclose(set);
  return s;
}

gh_status gh_h5_get_text(gh_h5 *f, const char *name, size_t size, char *text) {
  printing p = printing_off();
  gh_status s = get_text(f, name, size, text);
  printing_on(p);
  return s;
}
