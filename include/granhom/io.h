/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: file formats; nothing of mechanics.
 * All errors carry the file's name and, for text, the line: "block.yaml:12: ...". Readers give GH_INPUT,
 * writers GH_SYSTEM. */
#ifndef GRANHOM_IO_H
#define GRANHOM_IO_H

#include "granhom/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- numbers in text ---- */

/* The whole of text as a finite number / an integer in [low, high]; false otherwise. */
GH_API bool gh_parse_number(const char *text, double *value);
GH_API bool gh_parse_integer(const char *text, long low, long high, long *value);

/* Why a word that was meant as a number is probably none, as an end of the message: " (a comma: ...)". "" when
 * nothing comes to mind. */
GH_API const char *gh_number_hint(const char *text);

/* The word of a NULL-terminated list that a mistyped one is nearest to, by letters to insert, drop or
 * replace; NULL when none is near (more than 1 + a third of its letters apart). */
GH_API const char *gh_nearest(const char *word, const char *const *known);

/* ---- kinds of files ---- */

typedef enum gh_file_kind {
  GH_FILE_UNKNOWN,
  GH_FILE_PACKING,
  GH_FILE_SCENE,
  GH_FILE_STUDY,
  GH_FILE_CONTROL,    /* of an element test */
  GH_FILE_GROWTH,     /* of `granhom pack` */
  GH_FILE_PATH,       /* of F */
  GH_FILE_CONDITIONS, /* the table of an element test */
  GH_FILE_SIEVE,
  GH_FILE_MESH,
  GH_FILE_STATE,
  GH_FILE_BINARY,
  GH_FILE_HDF5, /* of another program */
  GH_FILE_DUMP,
  GH_FILE_SCRIPT,
  GH_FILE_XML,
  GH_FILE_PICTURE,
  GH_FILE_KINDS
} gh_file_kind;
/* Returns the status of a reader of `wanted`. Where that is GH_INPUT and the file is evidently of another kind,
 * the message becomes one that names both, and who takes the file. */
GH_API gh_status gh_file_expect(gh_context *ctx, gh_status status, const char *path, gh_file_kind wanted);

/* ---- CSV: a header line and rows of numbers ---- */

typedef struct gh_csv {
  int nrows, ncols;
  char **names;  /* ncols */
  double *value; /* nrows x ncols */
  int *line;     /* nrows: line in the file */
  bool *percent; /* ncols: in percent, by its unit or the signs behind its values */
} gh_csv;
/* "-" is standard input. Blank lines and lines that start with # are passed over, as are rows of empty
 * fields; spaces around fields are allowed. Columns are separated by commas, semicolons, tabs or blanks, as
 * the header and the first row agree, and fields may be quoted. With a decimal comma in one field there is no
 * decimal point in any, and between digits in threes it must not be one of thousands. A last comment before
 * rows without a header is the header. The row behind the header may have units. Trailing separators are
 * dropped. An empty field is an error, as are percent signs and units of percent. */
GH_API gh_status gh_csv_read(gh_context *ctx, const char *path, gh_csv **csv);
enum { GH_CSV_PERCENT = 1 /* percent is allowed */, GH_CSV_PAN = 2 /* the word "pan" stands for 0 */ };
/* The same with what `flags` allow. */
GH_API gh_status gh_csv_read_with(gh_context *ctx, const char *path, int flags, gh_csv **csv);
GH_API void gh_csv_destroy(gh_csv **csv);
/* Column of that name, else the one that has it before a unit in brackets ("d [mm]"), unless that is percent;
 * -1 when there is none. */
GH_API int gh_csv_find(const gh_csv *csv, const char *name);
/* Length of a column's name without a unit in [] or () at its end; *unit: where that begins, NULL for none.
 */
GH_API size_t gh_csv_bare(const char *name, const char **unit);

/* ---- LAMMPS data files, atom_style sphere ---- */

typedef struct gh_lammps_data {
  int natoms, ntypes;
  double low[3], high[3];         /* xlo xhi ... */
  double xy, xz, yz;              /* tilt */
  bool general;                   /* a general triclinic cell: `cell` holds, and low is its origin */
  double cell[4];                 /* columns a and b of a general cell in the plane */
  int *id, *type, *line;          /* natoms; line of the file */
  double *diameter, *density, *x; /* natoms; x is natoms x 3 */
} gh_lammps_data;
/* Reads header, box (also general triclinic ones, if a and b lie in the plane), Atoms (id type diameter
 * density x y z, or of style hybrid sphere; with or without three image flags), Atom Type Labels. Masses,
 * Velocities and coefficients are passed over. Errors: missing file, truncated (fewer atoms than the header
 * states), empty, a number that is none or not finite, another atom style in "Atoms # style", bonds and
 * shapes, type out of range, low >= high. Meaning of the values (radius, ids, z) is checked by the packing.
 */
GH_API gh_status gh_lammps_data_read(gh_context *ctx, const char *path, gh_lammps_data **data);
GH_API gh_status gh_lammps_data_write(gh_context *ctx, const char *path, const char *title,
                                      const gh_lammps_data *data);
GH_API void gh_lammps_data_destroy(gh_lammps_data **data);

/* ---- text files that appear whole or not at all ---- */

/* Collects text in memory; a print never fails. Where one found no memory, the text is lost as a whole: it
 * can neither be read nor written any more. commit writes it under a random name beside path, fsyncs,
 * renames: path holds all of it or what it held before, of the same permissions; a symbolic link keeps
 * pointing where it did. Printing never fails before commit. */
typedef struct gh_text gh_text;
GH_API gh_status gh_text_create(gh_context *ctx, gh_text **text);
GH_API void gh_text_destroy(gh_text **text);
GH_API void gh_text_print(gh_text *text, const char *format, ...) GH_PRINTF(2, 3);
/* Appends bytes of any kind. */
GH_API gh_status gh_text_add(gh_text *text, const void *bytes, size_t length);
/* GH_MEMORY when a print found no memory. */
GH_API gh_status gh_text_check(const gh_text *text);
/* What was collected, with a final 0; NULL when gh_text_check fails. length may be NULL. */
GH_API const char *gh_text_get(const gh_text *text, size_t *length);
/* Adds what another text holds; where that has failed, so has this one. */
GH_API void gh_text_join(gh_text *text, const gh_text *other);
/* Of a table whose header is the text's first line: the rows from the byte `from` on hold no number that is
 * nan or inf. GH_DIVERGED: one does; the message names table and column, and these rows are cut off again. */
GH_API gh_status gh_text_check_row(gh_text *text, size_t from, const char *table);
/* Drops what lies behind this length. */
GH_API void gh_text_cut(gh_text *text, size_t length);
/* Replaces what was collected. */
GH_API gh_status gh_text_set(gh_text *text, const char *bytes, size_t length);
GH_API gh_status gh_text_commit(gh_text *text,
                                const char *path); /* may be called again after more printing */
/* GH_SYSTEM when path could not be written, which is tried with a file beside it that is removed again: what
 * a long computation would find at its end. */
GH_API gh_status gh_file_writable(gh_context *ctx, const char *path);
/* Whether a file can be written: to be asked before what goes into it is computed. The file is not touched.
 * NULL and "-": nothing. GH_INPUT: the name is that of a folder ("out/", "."). GH_SYSTEM: a folder is there, no
 * folder to be in, no permission, a full device. */
GH_API gh_status gh_output_check(gh_context *ctx, const char *path);
/* The same for a folder that is there or will be made. */
GH_API gh_status gh_output_folder_check(gh_context *ctx, const char *folder);
/* GH_INPUT where folder/name is there and is no regular file, or no folder. */
GH_API gh_status gh_output_within(gh_context *ctx, const char *folder, const char *name, bool is_folder);
/* Whether two names are those of one file: by device and inode, so that links and other spellings count; of
 * files that are still to be made by their folder and name, behind symbolic links. */
GH_API bool gh_file_same(const char *a, const char *b);
/* GH_INPUT: what is there of this name is no regular file but a folder, a pipe or a device. It is not opened: a
 * pipe would wait for its other end. Nothing there is GH_OK. */
GH_API gh_status gh_file_regular(gh_context *ctx, const char *path);
/* A file that a command will write, and what it will be: GH_FILE_PATH for any table, GH_FILE_UNKNOWN where
 * there is no word for it. path NULL and "-": none. */
typedef struct gh_output {
  const char *path;
  gh_file_kind kind;
} gh_output;
/* gh_output_check of all of them. GH_INPUT: two are one file, one is an input (NULL and "-": none), or a file
 * of another kind is there: a packing, a scene, a state, ... */
GH_API gh_status gh_outputs_check(gh_context *ctx, const gh_output *output, int outputs,
                                  const char *const *input, int inputs);
/* The same for files of these names (the last is NULL) in a folder that may be missing. GH_INPUT: one is there
 * and no regular file, or is an input. */
GH_API gh_status gh_outputs_within(gh_context *ctx, const char *folder, const char *const *name,
                                   const char *const *input, int inputs);
/* GH_INPUT: the folder holds one of these files (the last is NULL), the results of `whose`: those of another
 * command would be mixed into them. */
GH_API gh_status gh_output_unmixed(gh_context *ctx, const char *folder, const char *const *mark,
                                   const char *whose);
/* Makes a folder (and its parents). GH_INPUT when path is a file, GH_SYSTEM otherwise. */
GH_API gh_status gh_folder_make(gh_context *ctx, const char *path);
/* Whether there is something of this name; a link that leads nowhere is nothing. GH_SYSTEM when the system
 * cannot find out. */
GH_API gh_status gh_file_there(gh_context *ctx, const char *path, bool *there);
/* Removes a file that may be missing. GH_SYSTEM: it is still there. */
GH_API gh_status gh_file_remove(gh_context *ctx, const char *path);
/* Makes a folder, as above, and becomes the only one who writes into it, until gh_lock_destroy or the end of
 * the process, whatever ends it. GH_SYSTEM: another process does already (its host and number are in the
 * message); nothing was changed then. A file .lock in the folder marks it; folders that were made for the
 * lock and stay empty are removed with it. Who only reads needs no lock. */
typedef struct gh_lock gh_lock;
GH_API gh_status gh_lock_create(gh_context *ctx, const char *folder, gh_lock **lock);
GH_API void gh_lock_destroy(gh_lock **lock);

/* A folder of this process for temporary files, in $TMPDIR or /tmp. */
typedef struct gh_temporary {
  char folder[512]; /* whole name; "": none */
  int lock;
} gh_temporary;
/* what: a word of small letters for its name. GH_SYSTEM: no folder can be made there. */
GH_API gh_status gh_temporary_make(gh_context *ctx, const char *what, gh_temporary *t);
/* With all that is in it. */
GH_API void gh_temporary_remove(gh_temporary *t);
/* Removes the folders that killed processes of this user have left. Links are not followed. */
GH_API void gh_temporary_clean(void);
/* dir + "/" + name; name alone when it is absolute. Caller frees. NULL when out of memory. */
GH_API char *gh_path_join(const char *dir, const char *name);
/* Folder of a path ("." when it has none). Caller frees. */
GH_API char *gh_path_folder(const char *path);

/* ---- terms: keys of the files that are read, columns of those that are written ---- */

/* One of them: how it is written, and what it means (unit, range, default); an empty text: as the one before.
 * Readers and writers use these lists, and the reference pages are made of them. The last term of a list has
 * the name NULL. */
typedef struct gh_term {
  const char *name, *text;
} gh_term;
/* The terms of one map or file; the last of several lists has the title NULL. */
typedef struct gh_term_list {
  const char *title;
  const gh_term *terms;
} gh_term_list;
/* The names, with `separator` between them. */
GH_API void gh_terms_header(gh_text *out, const gh_term *terms, const char *separator);
/* A list in Markdown. */
GH_API void gh_terms_print(gh_text *out, const gh_term *terms);

/* ---- YAML (libyaml) ---- */

typedef struct gh_yaml gh_yaml;
/* A place in a document; a value with node 0 is absent. Copy freely; belongs to the document. */
typedef struct gh_yaml_node {
  const gh_yaml *doc;
  int node;
  int parent; /* of an absent value: the map or list that was asked, so that messages can name its line */
} gh_yaml_node;
GH_API gh_status gh_yaml_read(gh_context *ctx, const char *path, gh_yaml **doc);
/* The same from a text; `name` stands for the file in messages. */
GH_API gh_status gh_yaml_parse(gh_context *ctx, const char *name, const char *text, gh_yaml **doc);
GH_API void gh_yaml_destroy(gh_yaml **doc);
GH_API gh_yaml_node gh_yaml_root(const gh_yaml *doc);
GH_API int gh_yaml_line(gh_yaml_node node);
GH_API const char *gh_yaml_path(gh_yaml_node node); /* the file's name */
GH_API bool gh_yaml_is_map(gh_yaml_node node);
GH_API bool gh_yaml_is_list(gh_yaml_node node);
GH_API bool gh_yaml_is_scalar(gh_yaml_node node);
/* GH_INPUT with file:line: message. */
GH_API gh_status gh_yaml_fail(gh_yaml_node node, const char *format, ...) GH_PRINTF(2, 3);
/* The map's keys must be among `known` (ends with NULL) and occur once; the message names the nearest known
 * key. */
GH_API gh_status gh_yaml_keys(gh_yaml_node map, const char *const *known);
/* The same with the names of terms, at most 31. */
GH_API gh_status gh_yaml_terms(gh_yaml_node map, const gh_term *known);
/* The node must be a map, with no other keys than these. */
GH_API gh_status gh_yaml_map(gh_yaml_node node, const char *what, const gh_term *keys);
/* Value of a key; absent (node 0) when the map has no such key. */
GH_API gh_yaml_node gh_yaml_get(gh_yaml_node map, const char *key);
GH_API bool gh_yaml_has(gh_yaml_node node); /* present */
/* The value of a required key. */
GH_API gh_status gh_yaml_need(gh_yaml_node map, const char *what, const char *key, gh_yaml_node *value);
GH_API int gh_yaml_length(gh_yaml_node list_or_map);
GH_API gh_yaml_node gh_yaml_item(gh_yaml_node list, int k);
GH_API const char *gh_yaml_key(gh_yaml_node map, int k, gh_yaml_node *value);
/* Typed values; `what` names the value in messages ("pressure"). Ranges are inclusive. */
GH_API gh_status gh_yaml_number(gh_yaml_node node, const char *what, double low, double high, double *value);
GH_API gh_status gh_yaml_integer(gh_yaml_node node, const char *what, long low, long high, long *value);
GH_API gh_status gh_yaml_bool(gh_yaml_node node, const char *what, bool *value);
/* A number of magnitude up to 1e300; above 0. */
GH_API gh_status gh_yaml_finite(gh_yaml_node node, const char *what, double *value);
GH_API gh_status gh_yaml_positive(gh_yaml_node node, const char *what, double *value);
/* A text of one line: control characters are refused. */
GH_API gh_status gh_yaml_text(gh_yaml_node node, const char *what, const char **value);
GH_API gh_status gh_yaml_numbers(gh_yaml_node node, const char *what, int n, double *values);
/* Puts a value in the place of another, in memory. key: the way there from the root, with dots, entries of
 * lists by their number from 0: "steps.1.increments". value: YAML in flow style: "1e-6", "[2, 4]", "{balance:
 * true}". A map or list that stands there is replaced as a whole; keys that are missing are made, entries of
 * lists are not. The new value has the line of what it replaces, or of the map that it is put into. GH_INPUT:
 * the way does not exist, the value is no YAML; the document is then as it was. */
GH_API gh_status gh_yaml_set(gh_yaml *doc, const char *key, const char *value);
/* The value in one line, in flow style, in the order of the file and without its comments: the same document
 * again when it is parsed. */
GH_API void gh_yaml_print(gh_yaml_node node, gh_text *out);

/* ---- HDF5 ---- */

typedef struct gh_h5 gh_h5;
/* false: built without HDF5 (make HDF5=0). Then gh_h5_open and gh_h5_read fail, GH_INPUT, and say so. */
GH_API bool gh_h5_available(void);
/* For programs that use MPI, before MPI_Init: otherwise HDF5 hangs itself on MPI_Finalize, and what a failure
 * has left open there ends the program. Nothing else needs it. */
GH_API void gh_h5_start(void);
/* Opens a file for change, with what path holds when it exists and append is true. It is kept in memory until
 * gh_h5_commit puts it into place as a text is: HDF5 1.10 itself does not survive a full disk. A dataset that
 * is put again is replaced.
 * kind: what the file holds and the version of that, "state 1" (at most 39 letters). It stands in the first
 * 512 bytes, a user block of HDF5, with the length of the file and a checksum over each of its bytes, which
 * are checked whenever it is opened: GH_INPUT for what is damaged, of another kind or without a checksum. */
GH_API gh_status gh_h5_open(gh_context *ctx, const char *path, const char *kind, bool append, gh_h5 **file);
/* Opens for reading. GH_INPUT: missing, or as above. With `sealed` a file of HDF5 that has no checksum is
 * read all the same, and *sealed states whether. */
GH_API gh_status gh_h5_read(gh_context *ctx, const char *path, const char *kind, bool *sealed, gh_h5 **file);
/* Datasets; groups in the name are made as needed ("/step0003/P"). cols 1: a vector. */
GH_API gh_status gh_h5_put_doubles(gh_h5 *file, const char *name, size_t rows, size_t cols,
                                   const double *data);
GH_API gh_status gh_h5_put_ints(gh_h5 *file, const char *name, size_t rows, size_t cols, const int *data);
GH_API gh_status gh_h5_put_text(gh_h5 *file, const char *name, const char *text);
/* Removes a dataset or a group with all that is in it; *there: it was there. */
GH_API gh_status gh_h5_remove(gh_h5 *file, const char *name, bool *there);
/* Whether there is a dataset or a group of this name. GH_MEMORY, GH_SYSTEM: that cannot be found out. */
GH_API gh_status gh_h5_there(gh_h5 *file, const char *name, bool *there);
/* Rows and columns of a dataset (cols 1 for a vector); GH_INPUT when it is missing. */
GH_API gh_status gh_h5_size(gh_h5 *file, const char *name, size_t *rows, size_t *cols);
GH_API gh_status gh_h5_get_doubles(gh_h5 *file, const char *name, size_t rows, size_t cols, double *data);
GH_API gh_status gh_h5_get_ints(gh_h5 *file, const char *name, size_t rows, size_t cols, int *data);
/* A text that gh_h5_put_text wrote, of at most size - 1 bytes. */
GH_API gh_status gh_h5_get_text(gh_h5 *file, const char *name, size_t size, char *text);
/* Flush, close, fsync, rename. The file is closed afterwards, also when this fails. */
GH_API gh_status gh_h5_commit(gh_h5 **file);
GH_API void gh_h5_close(gh_h5 **file); /* drops what was not committed */

#ifdef __cplusplus
}
#endif
#endif
