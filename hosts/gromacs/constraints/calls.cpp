#include "calls.hpp"

namespace holonomic {

namespace {

// An address in the dynamic section is absolute once glibc has loaded the library.
template <typename T>
T at(const ElfW(Dyn) & entry) {
    return reinterpret_cast<T>(entry.d_un.d_ptr);
}

struct Tables {
    const ElfW(Rela) *calls = nullptr, *others = nullptr;
    size_t n_calls = 0, n_others = 0;
    const ElfW(Sym) *symbols = nullptr;
    const char *names = nullptr;
};

Tables tables_of(const ElfW(Dyn) * entry) {
    Tables tables;
    for (; entry->d_tag != DT_NULL; entry++) switch (entry->d_tag) {
            case DT_JMPREL:
                tables.calls = at<const ElfW(Rela) *>(*entry);
                break;
            case DT_PLTRELSZ:
                tables.n_calls = entry->d_un.d_val / sizeof(ElfW(Rela));
                break;
            case DT_RELA:
                tables.others = at<const ElfW(Rela) *>(*entry);
                break;
            case DT_RELASZ:
                tables.n_others = entry->d_un.d_val / sizeof(ElfW(Rela));
                break;
            case DT_SYMTAB:
                tables.symbols = at<const ElfW(Sym) *>(*entry);
                break;
            case DT_STRTAB:
                tables.names = at<const char *>(*entry);
                break;
            default:
                break;
        }
    return tables;
}

}  // namespace

std::set<std::string> names_called_through_linker(const dl_phdr_info &library) {
    std::set<std::string> names;
    for (int k = 0; k < library.dlpi_phnum; k++) {
        if (library.dlpi_phdr[k].p_type != PT_DYNAMIC) continue;
        const Tables tables =
            tables_of(reinterpret_cast<const ElfW(Dyn) *>(library.dlpi_addr + library.dlpi_phdr[k].p_vaddr));
        if (!tables.symbols || !tables.names) continue;
        const auto add = [&](const ElfW(Rela) * list, size_t n) {
            for (size_t i = 0; list && i < n; i++)
                if (const auto symbol = ELF64_R_SYM(list[i].r_info))
                    names.insert(tables.names + tables.symbols[symbol].st_name);
        };
        add(tables.calls, tables.n_calls);
        add(tables.others, tables.n_others);
    }
    return names;
}

}  // namespace holonomic
