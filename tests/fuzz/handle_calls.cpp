// Making a handle, adding chains to it, settings and questions.
#include "session.hpp"

namespace fuzz
{

void session::create()
{
    hol_chains_destroy(chains);
    chains = nullptr;
    // One handle in sixteen is large enough for chains that are cut into segments and windows.
    static const std::int64_t large[] = {258,  300,  511,  700,  1024, 1030, 1100, 1500,
                                         2049, 2051, 2500, 3000, 3300, 4097, 4099, 4500};
    const int size = in.byte();
    n_atoms = size < 240 ? size % 70 : large[size - 240];
    block masses(static_cast<std::size_t>(n_atoms) * sizeof(double));
    fill(masses, static_cast<std::size_t>(n_atoms), in, true);
    hol_chains *const before = reinterpret_cast<hol_chains *>(&masses);
    hol_chains *made = before;
    const std::int64_t n = in.often() ? n_atoms : -1 - in.byte();
    const int status = hol_chains_create(n, maybe(masses.doubles()), in.often() ? &made : nullptr);
    check_status(status);
    if (made == before) made = nullptr;
    check(status == HOL_OK ? made != nullptr || n_atoms < 0 : made == nullptr,
          "a handle after an error, or none after success");
    chains = made;
    base = 0;
    any_inactive = false;
}

// Mostly small; in a large handle mostly nearly all of its atoms.
std::int64_t session::bonds_of_a_chain()
{
    const std::int64_t n = in.whole();
    return n_atoms > 256 && n >= 0 && n < 24 && in.often() ? n_atoms - 1 - n : n;
}

void session::add()
{
    const std::int64_t n = bonds_of_a_chain();
    // Arrays as long as the numbers say, except where the numbers alone are an error.
    const std::size_t length = static_cast<std::size_t>(n > 0 && n <= 2 * n_atoms ? n : 0);
    block atoms((length + 1) * sizeof(std::int64_t)), lengths(length * sizeof(double));
    fill(lengths, length, in, true);
    std::int64_t *list = reinterpret_cast<std::int64_t *>(atoms.data());
    const std::int64_t room = n_atoms - static_cast<std::int64_t>(length);
    const std::int64_t first = in.byte() % (n_atoms > 256 && room > 0 && room < 64 ? room : 64),
                       step = in.byte() % 3 == 0 ? -1 : 1;
    for (std::size_t k = 0; k <= length; ++k)
        list[k] = in.often() ? first + step * static_cast<std::int64_t>(k) : in.whole();
    const std::int64_t chains_before = hol_chains_n_molecules(chains), bonds_before = hol_chains_n_bonds(chains);
    const int status = hol_chains_add(maybe(chains), n, maybe(list), maybe(lengths.doubles()));
    check_status(status);
    if (status != HOL_OK)
        check(hol_chains_n_molecules(chains) == chains_before && hol_chains_n_bonds(chains) == bonds_before,
              "a failing add adds");
}

void session::add_block()
{
    const std::int64_t n_chains = in.whole(), n = bonds_of_a_chain(), first = in.whole();
    const std::size_t length = static_cast<std::size_t>(n > 0 && n <= n_atoms ? n : 0);
    block lengths(length * sizeof(double));
    fill(lengths, length, in, true);
    const std::int64_t chains_before = hol_chains_n_molecules(chains), bonds_before = hol_chains_n_bonds(chains);
    const int status = hol_chains_add_block(maybe(chains), n_chains, n, first, maybe(lengths.doubles()));
    check_status(status);
    if (status != HOL_OK)
        check(hol_chains_n_molecules(chains) == chains_before && hol_chains_n_bonds(chains) == bonds_before,
              "a failing add adds");
}

void session::set()
{
    switch (in.below(6)) {
        case 0: {
            const int wanted = in.below(4) - 1;
            const int status = hol_chains_set_index_base(maybe(chains), wanted);
            check_status(status);
            if (status == HOL_OK) base = wanted;
            break;
        }
        case 1: {
            block box(9 * sizeof(double));
            fill(box, 9, in);
            if (in.byte() & 1)
                for (int i = 0; i < 9; ++i) box.doubles()[i] = i % 4 == 0 ? in.size() * 8 : 0;
            check_status(hol_chains_set_box(maybe(chains), maybe(box.doubles())));
            break;
        }
        case 2:
            check_status(hol_chains_set_threads(maybe(chains), in.below(5) - 1));
            break;
        case 3: {
            const std::size_t n = static_cast<std::size_t>(hol_chains_n_molecules(chains));
            block active(n);
            for (std::size_t c = 0; c < n; ++c) active.data()[c] = static_cast<char>(in.byte() % 3);
            check_status(
                hol_chains_set_active(maybe(chains), maybe(reinterpret_cast<const unsigned char *>(active.data()))));
            any_inactive = true;
            break;
        }
        case 4:
            check_status(hol_chains_set_tolerance(maybe(chains), in.number()));
            break;
        default:
            check_status(
                hol_chains_set_memory_limit(maybe(chains), (std::int64_t{in.byte()} - 1) * (std::int64_t{1} << 40)));
            check_status(hol_chains_set_max_iterations(maybe(chains), static_cast<int>(in.byte()) * 5 - 10));
            break;
    }
}

void session::ask()
{
    const std::size_t n = static_cast<std::size_t>(hol_chains_n_molecules(chains));
    block offsets((n + 1) * sizeof(std::int64_t));
    std::int64_t *const o = reinterpret_cast<std::int64_t *>(offsets.data());
    if (hol_chains_offsets(maybe(chains), maybe(o)) == HOL_OK) {
        const std::int64_t which = in.whole();
        std::size_t size = 0;
        if (which >= base && which < base + static_cast<std::int64_t>(n)) {
            const std::int64_t c = which - base;
            size = static_cast<std::size_t>(o[c + 1] - o[c] + 1);
        }
        block atoms(size * sizeof(std::int64_t));
        check_status(hol_chains_atoms(maybe(chains), which, maybe(reinterpret_cast<std::int64_t *>(atoms.data()))));
    }
    check(hol_chains_memory(chains) >= 0 && hol_chains_n_atoms(chains) >= 0, "a negative count");
    hol_chains_degrees_of_freedom(maybe(chains), in.byte() % 5);
    hol_status_name(static_cast<int>(in.whole() % 1000));
    check(hol_version()[0] != 0 && hol_instruction_set()[0] != 0, "an empty name");
    std::int64_t place[4];
    hol_error_location(maybe(place), maybe(place + 1), maybe(place + 2), maybe(place + 3));
}

}  // namespace fuzz
