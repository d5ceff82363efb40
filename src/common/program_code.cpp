#include "snapwing/common/program_code.h"

#include <elf.h>
#include <link.h>

#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::common {

namespace {

constexpr char OWN[] = "libsnapwing_";
constexpr std::size_t DIGITS = 16;

/// A library or program in memory.
struct Loaded {
  std::string code;              ///< its build id, if it has one
  std::string file;              ///< where its code lies
  std::vector<std::string> own;  ///< snapwing libraries that it names
  bool holds = false;            ///< the address that was asked for
};

struct Asked {
  const void* inside;
  std::map<std::string, Loaded> objects;  ///< by the name under which others link it
};

/// Build id among the notes of a segment; empty if there is none.
std::string buildIdIn(const char* notes, std::size_t size) {
  const auto padded = [](std::size_t bytes) { return (bytes + 3) / 4 * 4; };
  for (std::size_t at = 0; at + sizeof(ElfW(Nhdr)) <= size;) {
    ElfW(Nhdr) head;
    std::memcpy(&head, notes + at, sizeof head);
    const std::size_t name = at + sizeof head, bytes = name + padded(head.n_namesz);
    at = bytes + padded(head.n_descsz);
    const bool gnu =
        head.n_namesz == sizeof ELF_NOTE_GNU && std::memcmp(notes + name, ELF_NOTE_GNU, sizeof ELF_NOTE_GNU) == 0;
    if (gnu && head.n_type == NT_GNU_BUILD_ID && at <= size) return {notes + bytes, head.n_descsz};
  }
  return {};
}

/// Names in the dynamic section: what the object is called, and which snapwing libraries it links.
void readNames(const dl_phdr_info& info, const ElfW(Dyn) * dynamic, std::string* name, Loaded* loaded) {
  const char* strings = nullptr;
  for (const ElfW(Dyn)* d = dynamic; d->d_tag != DT_NULL; ++d) {
    // The loader has made this an address, except on processors where the section stays as it is in the file.
    if (d->d_tag == DT_STRTAB) {
      strings = reinterpret_cast<const char*>(d->d_un.d_ptr < info.dlpi_addr ? info.dlpi_addr + d->d_un.d_ptr
                                                                             : d->d_un.d_ptr);
    }
  }
  if (strings == nullptr) return;
  for (const ElfW(Dyn)* d = dynamic; d->d_tag != DT_NULL; ++d) {
    if (d->d_tag == DT_SONAME) *name = strings + d->d_un.d_val;
    if (d->d_tag != DT_NEEDED) continue;
    const std::string needed = strings + d->d_un.d_val;
    if (needed.rfind(OWN, 0) == 0) loaded->own.push_back(needed);
  }
}

int readObject(dl_phdr_info* info, std::size_t, void* data) {
  Asked& asked = *static_cast<Asked*>(data);
  const auto address = reinterpret_cast<ElfW(Addr)>(asked.inside);
  Loaded loaded;
  std::string name = info->dlpi_name;
  for (int k = 0; k < info->dlpi_phnum; ++k) {
    const ElfW(Phdr)& part = info->dlpi_phdr[k];
    const ElfW(Addr) begin = info->dlpi_addr + part.p_vaddr;
    if (part.p_type == PT_LOAD && address >= begin && address < begin + part.p_memsz) loaded.holds = true;
    if (part.p_type == PT_DYNAMIC) readNames(*info, reinterpret_cast<const ElfW(Dyn)*>(begin), &name, &loaded);
    if (part.p_type == PT_NOTE && loaded.code.empty()) {
      loaded.code = buildIdIn(reinterpret_cast<const char*>(begin), part.p_memsz);
    }
  }
  if (!loaded.holds && name.rfind(OWN, 0) != 0) return 0;
  loaded.file = *info->dlpi_name == 0 ? "/proc/self/exe" : info->dlpi_name;
  asked.objects.emplace(name, std::move(loaded));  // the program itself has no name
  return 0;
}

void addLinked(const Asked& asked, const std::string& name, std::set<std::string>* names) {
  const auto found = asked.objects.find(name);
  if (found == asked.objects.end() || !names->insert(name).second) return;
  for (const std::string& linked : found->second.own) addLinked(asked, linked, names);
}

}  // namespace

std::string programOf(const void* inside) {
  Asked asked{inside, {}};
  dl_iterate_phdr(readObject, &asked);
  std::set<std::string> names;
  for (const auto& [name, loaded] : asked.objects) {
    if (loaded.holds) addLinked(asked, name, &names);
  }
  if (names.empty()) throw Error("programOf: no loaded object holds this address");
  std::string code;
  for (const std::string& name : names) {
    const Loaded& loaded = asked.objects.at(name);
    code += name + "=" + (loaded.code.empty() ? sha256OfFile(loaded.file) : loaded.code) + ";";
  }
  return version() + "+" + sha256(code).substr(0, DIGITS);
}

}  // namespace snapwing::common
