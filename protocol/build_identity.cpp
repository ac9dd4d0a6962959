#include "protocol/build_identity.h"

#include <elf.h>
#include <link.h>
#include <unistd.h>

#include <cstring>

namespace rayfarm {
namespace {

int read_build_id(dl_phdr_info* info, size_t, void* out) {
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const auto& header = info->dlpi_phdr[i];
    if (header.p_type != PT_NOTE) continue;
    const auto* note = reinterpret_cast<const char*>(info->dlpi_addr + header.p_vaddr);
    const char* end = note + header.p_memsz;
    while (note + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) n;
      std::memcpy(&n, note, sizeof n);
      const char* name = note + sizeof n;
      const char* description = name + (n.n_namesz + 3) / 4 * 4;
      if (n.n_type == NT_GNU_BUILD_ID && n.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0) {
        static constexpr char kDigits[] = "0123456789abcdef";
        auto& text = *static_cast<std::string*>(out);
        for (unsigned b = 0; b < n.n_descsz; ++b) {
          const auto byte = static_cast<unsigned char>(description[b]);
          text += kDigits[byte >> 4];
          text += kDigits[byte & 15];
        }
        return 1;
      }
      note = description + (n.n_descsz + 3) / 4 * 4;
    }
  }
  return 1;  // the first object is the executable itself: look no further
}

}  // namespace

std::string build_identity() {
  std::string text;
  dl_iterate_phdr(read_build_id, &text);
  return text;
}

std::string machine_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

}  // namespace rayfarm
