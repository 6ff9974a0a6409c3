/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Calls within liblammps.so of functions that are replaced.
 *
 * A shared library calls its own functions through a table of addresses, which the dynamic linker fills with
 * the definitions that come first in its search order. Ours come first where this module brings LAMMPS along.
 * Where the program is linked to LAMMPS, or has loaded it before (LAMMPS's module for Python), the table
 * names LAMMPS's own functions; so the entries of those that are replaced are written here, in whatever
 * order. */
#include "engine/lammps/rebind.h"

#include "engine/lammps/c_mpi.h"

#include "library.h"

#include <cstdint>
#include <cstring>
#include <dlfcn.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

namespace {

/* A loaded library: what its dynamic section states. */
struct library {
  link_map *map = nullptr;
  const ElfW(Sym) *symbols = nullptr;
  const char *names = nullptr;
  const ElfW(Rela) * entries[2] = {nullptr, nullptr}; /* of calls, of all else */
  std::size_t bytes[2] = {0, 0};
  std::uintptr_t low = 0, high = 0; /* made read-only when it had been loaded */
};

/* The dynamic linker turns offsets into addresses on most systems. */
const char *address_of(const link_map *map, ElfW(Addr) value) {
  return reinterpret_cast<const char *>(value < map->l_addr ? map->l_addr + value : value);
}

void section_read(library *lib) {
  for (const ElfW(Dyn) *d = lib->map->l_ld; d->d_tag != DT_NULL; d++) {
    const char *at = address_of(lib->map, d->d_un.d_ptr);
    if (d->d_tag == DT_SYMTAB) lib->symbols = reinterpret_cast<const ElfW(Sym) *>(at);
    else if (d->d_tag == DT_STRTAB) lib->names = at;
    else if (d->d_tag == DT_JMPREL) lib->entries[0] = reinterpret_cast<const ElfW(Rela) *>(at);
    else if (d->d_tag == DT_PLTRELSZ) lib->bytes[0] = d->d_un.d_val;
    else if (d->d_tag == DT_RELA) lib->entries[1] = reinterpret_cast<const ElfW(Rela) *>(at);
    else if (d->d_tag == DT_RELASZ) lib->bytes[1] = d->d_un.d_val;
  }
}

int relro_read(dl_phdr_info *info, std::size_t, void *data) {
  auto *lib = static_cast<library *>(data);
  if (info->dlpi_addr != lib->map->l_addr || std::strcmp(info->dlpi_name, lib->map->l_name) != 0) return 0;
  for (int k = 0; k < info->dlpi_phnum; k++)
    if (info->dlpi_phdr[k].p_type == PT_GNU_RELRO) {
      lib->low = info->dlpi_addr + info->dlpi_phdr[k].p_vaddr;
      lib->high = lib->low + info->dlpi_phdr[k].p_memsz;
    }
  return 1;
}

bool library_of(const void *function, library *lib) {
  Dl_info info;
  void *map = nullptr;
  if (!dladdr1(function, &info, &map, RTLD_DL_LINKMAP) || !map) return false;
  lib->map = static_cast<link_map *>(map);
  section_read(lib);
  dl_iterate_phdr(relro_read, lib);
  return lib->symbols && lib->names;
}

void entry_write(const library &lib, void **entry, void *function) {
  const auto at = reinterpret_cast<std::uintptr_t>(entry);
  const bool fixed = at >= lib.low && at < lib.high;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  auto *start = reinterpret_cast<void *>(at & ~(page - 1));
  if (fixed && mprotect(start, page, PROT_READ | PROT_WRITE) != 0) return;
  *entry = function;
  if (fixed) mprotect(start, page, PROT_READ);
}

/* Ours of that name, which this module exports; nullptr: it has none. */
void *replacement(void *module, const void *base, const char *name) {
  static const char *const classes[] = {"_ZN9LAMMPS_NS5Error", "_ZN9LAMMPS_NS6LAMMPS", "_ZN9LAMMPS_NS5Input",
                                        "_ZN9LAMMPS_NS6Python"};
  for (const char *prefix : classes) {
    if (std::strncmp(name, prefix, std::strlen(prefix)) != 0) continue;
    Dl_info info;
    void *found = dlsym(module, name);
    return found && dladdr(found, &info) && info.dli_fbase == base ? found : nullptr;
  }
  return nullptr;
}

void entries_write(const library &lib, void *module, const void *base) {
  for (int table = 0; table < 2; table++) {
    const ElfW(Rela) *entry = lib.entries[table], *end = entry + lib.bytes[table] / sizeof *entry;
    for (; entry < end; entry++) {
      const ElfW(Sym) &symbol = lib.symbols[ELF64_R_SYM(entry->r_info)];
      if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC || entry->r_addend != 0) continue;
      if (void *ours = replacement(module, base, lib.names + symbol.st_name))
        entry_write(lib, reinterpret_cast<void **>(lib.map->l_addr + entry->r_offset), ours);
    }
  }
}

bool rebind_once() {
  static const char here = 0;
  Dl_info info;
  void *map = nullptr;
  library lammps;
  if (sizeof(void *) != 8 || !dladdr1(&here, &info, &map, RTLD_DL_LINKMAP) || !map) return false;
  const char *name = static_cast<link_map *>(map)->l_name;
  void *module = dlopen(*name ? name : nullptr, RTLD_LAZY | RTLD_NOLOAD);
  if (!module || !library_of(reinterpret_cast<void *>(lammps_open), &lammps)) return false;
  if (lammps.map != map) entries_write(lammps, module, info.dli_fbase);
  dlclose(module);
  return true;
}

} // namespace

void granhom::rebind() {
  static const bool done = rebind_once();
  (void)done;
}
