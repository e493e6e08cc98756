// Rigid bodies, alone and with bonds: lists of atoms, or copies of one molecule.
#include <algorithm>

#include "session.hpp"

namespace fuzz
{

void session::add_rigid()
{
    const bool copies = (in.byte() & 1) != 0;
    const std::int64_t n_bodies = in.often() ? 1 + in.below(4) : in.whole(), n = in.often() ? in.below(8) : in.whole();
    // Numbers that are no error in themselves have arrays as long as they say.
    if (n_bodies > 2000 || n > 2000) return;
    const std::size_t listed = static_cast<std::size_t>(std::max<std::int64_t>(n_bodies, 0)),
                      n_bonds = static_cast<std::size_t>(std::max<std::int64_t>(n, 0));
    block sizes(listed * sizeof(std::int64_t)), pairs(2 * n_bonds * sizeof(std::int64_t)),
        lengths(n_bonds * sizeof(double));
    std::int64_t *const size = reinterpret_cast<std::int64_t *>(sizes.data());
    std::size_t n_held = 0;
    bool right = true;
    for (std::size_t b = 0; b < listed; ++b) {
        size[b] = in.often() ? 2 + in.below(5) : in.whole();
        right = right && size[b] >= 2 && size[b] < 2000;
        if (right) n_held += static_cast<std::size_t>(size[b]);
    }
    block atoms(n_held * sizeof(std::int64_t)), places(3 * n_held * sizeof(double));
    std::int64_t *const list = reinterpret_cast<std::int64_t *>(atoms.data());
    const std::int64_t first = base + (copies ? 0 : in.byte() % 40);
    for (std::size_t a = 0; a < n_held; ++a) list[a] = in.often() ? first + static_cast<std::int64_t>(a) : in.whole();
    fill(places, 3 * n_held, in);
    // Straight or flat, exactly or nearly so, or as it comes; or all at one point.
    const int form = in.below(8);
    for (std::size_t a = 0; a < n_held; ++a) {
        double *const x = places.doubles() + 3 * a;
        if (form == 1 || form == 3) x[2] *= form == 1 ? 0 : 1e-9;
        if (form == 2 || form == 3) x[1] *= form == 2 ? 0 : 1e-7, x[2] *= form == 2 ? 0 : 1;
        if (form == 4) std::copy_n(places.doubles(), 3, x);
    }
    fill_pairs(pairs, n_bonds, copies ? static_cast<std::int64_t>(n_held) : n_atoms);
    for (std::size_t k = 0; k < n_bonds; ++k)  // most of them at a body
        if (in.often() && n_held > 0) reinterpret_cast<std::int64_t *>(pairs.data())[2 * k] = list[in.byte() % n_held];
    fill(lengths, n_bonds, in, true);
    const std::int64_t n_molecules = !copies      ? 1
                                     : in.often() ? 1 + in.below(6)
                                                  : in.whole(),
                       n_of_each = in.often() ? static_cast<std::int64_t>(n_held) + in.below(4) : in.whole(),
                       from = in.often() ? base + in.below(8) : in.whole();
    const std::int64_t chains_before = hol_chains_n_molecules(chains), bonds_before = hol_chains_n_bonds(chains),
                       freedoms_before = hol_chains_degrees_of_freedom(chains, 3);
    hol_chains *const to = maybe(chains);
    std::int64_t *const bonded = maybe(reinterpret_cast<std::int64_t *>(pairs.data()));
    const int status =
        copies ? hol_chains_add_rigid_molecules(to, n_molecules, n_of_each, from, n_bodies, maybe(size), maybe(list),
                                                maybe(places.doubles()), n, bonded, maybe(lengths.doubles()))
               : hol_chains_add_rigid(to, n_bodies, maybe(size), maybe(list), maybe(places.doubles()), n, bonded,
                                      maybe(lengths.doubles()));
    check_status(status);
    const bool nothing = n_molecules == 0 || (n_bodies == 0 && n == 0);
    if (status == HOL_OK)
        check(hol_chains_n_bonds(chains) == bonds_before + n * n_molecules &&
                  (hol_chains_n_molecules(chains) > chains_before) != nothing,
              "bodies or bonds are missing");
    else
        check(hol_chains_n_molecules(chains) == chains_before && hol_chains_n_bonds(chains) == bonds_before &&
                  hol_chains_degrees_of_freedom(chains, 3) == freedoms_before,
              "a failing add adds");
}

}  // namespace fuzz
