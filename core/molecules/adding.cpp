// Adding molecules to a set.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.hpp"
#include "core/molecules/batch.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/memory_limit.hpp"

namespace holonomic {

namespace {

// A caller's number counted from 0; -1 if it is below the base, however far (the least number minus 1 would overflow).
std::int64_t from_zero(std::int64_t i, int base) { return i < base ? -1 : i - base; }

void check_at_least(const char *what, std::int64_t value, std::int64_t least) {
    if (value < least)
        throw make_error(Status::value, "%s is %lld; it must be at least %lld", what, static_cast<long long>(value),
                         static_cast<long long>(least));
}

// Numbers of a list are kept in 32 bits, two for each bond.
constexpr std::int64_t most_bonds = std::int64_t{1} << 30;

Error outside(const char *what, std::int64_t count, std::int64_t size, std::int64_t first, std::int64_t n_atoms,
              int base) {
    Error error =
        make_error(Status::index, "%lld %s of %lld %s from atom %lld on reach outside the atoms %d .. %lld",
                   static_cast<long long>(count), what, static_cast<long long>(size),
                   what[0] == 'c' ? "bonds" : "atoms", static_cast<long long>(first), base, number(n_atoms - 1, base));
    error.atom = from_zero(first, base);
    error.base = base;
    return error;
}

}  // namespace

// Lengths are compared by their squares, which must neither vanish nor overflow.
void check_lengths(std::int64_t n_bonds, const double *lengths, int base, bool may_be_zero) {
    for (std::int64_t k = 0; k < n_bonds; ++k) {
        if ((lengths[k] >= 1e-150 && lengths[k] <= 1e150) || (may_be_zero && lengths[k] == 0)) continue;
        const char *const range =
            lengths[k] > 0 && std::isfinite(lengths[k]) ? "between 1e-150 and 1e150" : "positive and finite";
        Error error = make_error(Status::value, "the length of bond %lld is %g; it must be %s", number(k, base),
                                 lengths[k], range);
        error.bond = k;
        error.base = base;
        throw error;
    }
}

void Chains::add(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths) {
    check_at_least("n_bonds", n_bonds, 0);
    if (n_bonds == 0) return;
    // Before anything is read: atoms that can move occur once, with one that is fixed between each two at the most.
    if (n_bonds > 2 * n_atoms_)
        throw make_error(Status::value, "n_bonds is %lld: a chain of so many bonds has more than the %lld atoms",
                         static_cast<long long>(n_bonds), static_cast<long long>(n_atoms_));
    check_memory(*this, n_bonds, bytes_of_chain_bond);
    check_lengths(n_bonds, lengths, base);
    std::vector<std::int64_t> list;
    for (std::int64_t k = 0; k <= n_bonds; ++k) {
        if (atoms[k] < base || atoms[k] - base >= n_atoms_) {
            Error error = make_error(Status::index, "atom %lld, number %lld of chain %lld, is outside %d .. %lld",
                                     static_cast<long long>(atoms[k]), number(k, base), number(n_chains(), base), base,
                                     number(n_atoms_ - 1, base));
            error.atom = from_zero(atoms[k], base);
            error.chain = n_chains();
            error.base = base;
            throw error;
        }
        list.push_back(atoms[k] - base);
    }
    Batch batch(*this);
    for (std::int64_t k = 0; k <= n_bonds; ++k) batch.take(list[at(k)], n_chains(), k);
    batch.append_chain(n_bonds, list.data(), lengths);
    batch.commit();
}

void Chains::add_block(std::int64_t count, std::int64_t n_bonds, std::int64_t first_atom, const double *lengths) {
    check_at_least("n_chains", count, 0);
    check_at_least("n_bonds", n_bonds, 0);
    if (count == 0 || n_bonds == 0) return;
    const std::int64_t first = from_zero(first_atom, base);
    if (first < 0 || first >= n_atoms_ || n_bonds >= n_atoms_ || count > (n_atoms_ - first) / (n_bonds + 1))
        throw outside("chains", count, n_bonds, first_atom, n_atoms_, base);
    check_memory(*this, count * n_bonds, bytes_of_chain_bond);
    check_lengths(n_bonds, lengths, base);
    Batch batch(*this);
    for (std::int64_t c = 0; c < count; ++c)
        for (std::int64_t k = 0; k <= n_bonds; ++k) batch.take(first + c * (n_bonds + 1) + k, n_chains() + c, k);
    batch.append_block(count, n_bonds, first, lengths);
    batch.commit();
}

void Chains::add_bonds(std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths) {
    check_at_least("n_bonds", n_bonds, 0);
    if (n_bonds == 0) return;
    if (n_bonds > most_bonds)
        throw make_error(Status::value, "n_bonds is %lld; it must be at most %lld in a call",
                         static_cast<long long>(n_bonds), static_cast<long long>(most_bonds));
    check_memory(*this, n_bonds, bytes_of_listed_bond);
    check_lengths(n_bonds, lengths, base, true);
    add_listed({n_bonds, pairs, base, &labels_, bonds_round(box, *std::max_element(lengths, lengths + n_bonds))},
               lengths, n_bonds);
}

void Chains::add_listed(const BondList &list, const double *lengths, std::int64_t n_lengths) {
    if (std::count(lengths, lengths + n_lengths, 0.0) > 0)
        return add_with_bodies(checked(n_atoms_, list), lengths, n_lengths);
    try {
        const FoundMolecules found = find_molecules(masses_, n_atoms_, list);
        Batch batch(*this);
        batch.append_found(found, list, lengths, n_lengths);
        if (!batch.is_flat()) return batch.commit();
    } catch (const Error &error) {
        if (error.status != Status::degenerate || !finds_bodies) throw;
    }
    add_with_bodies(list, lengths, n_lengths);
}

void Chains::add_molecules(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom, std::int64_t n_bonds,
                           const std::int64_t *pairs, const double *lengths) {
    check_at_least("n_molecules", count, 0);
    check_at_least("n_bonds", n_bonds, 0);
    if (count == 0 || n_bonds == 0) return;
    check_at_least("n_atoms", n_atoms, 2);
    if (n_bonds > most_bonds || count > most_bonds / n_bonds)
        throw make_error(
            Status::value, "n_molecules times n_bonds is %lld times %lld; it must be at most %lld in a call",
            static_cast<long long>(count), static_cast<long long>(n_bonds), static_cast<long long>(most_bonds));
    const std::int64_t first = from_zero(first_atom, base);
    if (first < 0 || first >= n_atoms_ || n_atoms > n_atoms_ || count > (n_atoms_ - first) / n_atoms)
        throw outside("molecules", count, n_atoms, first_atom, n_atoms_, base);
    check_memory(*this, count * n_bonds, bytes_of_listed_bond);
    check_lengths(n_bonds, lengths, base, true);
    for (std::int64_t e = 0; e < 2 * n_bonds; ++e)
        if (pairs[e] < base || pairs[e] - base >= n_atoms) {
            Error error =
                make_error(Status::index, "bond %lld of the list: atom %lld of the molecule is outside %d .. %lld",
                           number(e / 2, base), static_cast<long long>(pairs[e]), base, number(n_atoms - 1, base));
            error.bond = e / 2;
            error.base = base;
            throw error;
        }
    std::vector<std::int64_t> all(at(2 * count * n_bonds));
    for (std::int64_t m = 0; m < count; ++m)
        for (std::int64_t e = 0; e < 2 * n_bonds; ++e) all[at(2 * m * n_bonds + e)] = first + m * n_atoms + pairs[e];
    const std::int64_t round = bonds_round(box, *std::max_element(lengths, lengths + n_bonds));
    add_listed({count * n_bonds, all.data(), base, &labels_, round}, lengths, n_bonds);
}

}  // namespace holonomic
