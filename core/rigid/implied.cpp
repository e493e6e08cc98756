#include "core/rigid/implied.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "core/index.hpp"
#include "core/rigid/rank_of_linear.hpp"
#include "core/rigid/spread.hpp"

namespace holonomic::rigid {

namespace {

class ImpliedSearch {
public:
    ImpliedSearch(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths,
                  const Cliques &cliques)
        : masses_(masses), list_(list), lengths_(lengths), n_lengths_(n_lengths), implied_(at(list.n_bonds), 0) {
        std::size_t next = 0;
        for (std::size_t b = 0; b < cliques.sizes.size(); ++b)
            for (std::int64_t a = 0; a < cliques.sizes[b]; ++a)
                body_of_[cliques.atoms[next++]] = static_cast<std::int64_t>(b);
        for (const std::int64_t bond : cliques.shared) shares_.insert(list.pairs[2 * bond]);
        for (std::int64_t k = 0; k < list.n_bonds; ++k)  // those of length zero are relations (linear.hpp)
            for (int e = 0; e < 2 && length(k) > 0; ++e) bonds_of_[list.pairs[2 * k + e]].push_back(k);
    }

    std::vector<unsigned char> find() {
        std::unordered_map<std::int64_t, bool> seen;
        for (std::int64_t e = 0; e < 2 * list_.n_bonds; ++e) {
            const std::int64_t atom = list_.pairs[e];
            if (!fixed(atom) && !seen[atom] && bonds_of_.count(atom)) look_at_molecule(atom, seen);
        }
        return std::move(implied_);
    }

private:
    bool fixed(std::int64_t atom) const { return masses_.fixed(atom - list_.base); }
    std::int64_t body(std::int64_t atom) const {
        const auto found = body_of_.find(atom);
        return found == body_of_.end() ? -1 : found->second;
    }
    double length(std::int64_t bond) const { return lengths_[bond % n_lengths_]; }

    // A mistake, which is refused elsewhere.
    bool is_twice(std::int64_t bond) const {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        std::int64_t n = 0;
        for (const std::int64_t k : bonds_of_.at(i)) n += list_.pairs[2 * k] == j || list_.pairs[2 * k + 1] == j;
        return n > 1;
    }

    void look_at_molecule(std::int64_t first, std::unordered_map<std::int64_t, bool> &seen) {
        // Atoms in the order in which they are reached: neighbours have near columns.
        std::vector<std::int64_t> atoms{first}, bonds;
        std::unordered_map<std::int64_t, std::int64_t> column;
        seen[first] = true;
        bool has_body = false, shares = false;
        for (std::size_t next = 0; next < atoms.size(); ++next) {
            const std::int64_t atom = atoms[next];
            column[atom] = static_cast<std::int64_t>(next);
            has_body = has_body || body(atom) >= 0;
            shares = shares || shares_.count(atom) > 0;
            for (const std::int64_t k : bonds_of_.at(atom)) {
                const std::int64_t i = list_.pairs[2 * k], other = i == atom ? list_.pairs[2 * k + 1] : i;
                if (fixed(other) || other >= atom) bonds.push_back(k);
                if (fixed(other) || seen[other]) continue;
                seen[other] = true;
                atoms.push_back(other);
            }
        }
        const std::int64_t freedoms = 3 * static_cast<std::int64_t>(atoms.size()) - 6;
        if (!has_body && static_cast<std::int64_t>(bonds.size()) <= freedoms) return;
        std::sort(bonds.begin(), bonds.end(), [this](std::int64_t a, std::int64_t b) {
            return length(a) != length(b) ? length(a) < length(b) : a < b;
        });
        const auto end = [&](std::int64_t e) {
            const std::int64_t atom = list_.pairs[e];
            return fixed(atom) ? Rank::fixed(atom) : Rank::free(column.at(atom));
        };
        const auto is_within = [&](std::int64_t k) {
            const std::int64_t its = body(list_.pairs[2 * k]);
            return its >= 0 && its == body(list_.pairs[2 * k + 1]);
        };
        Rank all, within;  // bodies have columns of their own
        std::int64_t outside = 0;
        std::vector<std::int64_t> found;
        for (const std::int64_t k : bonds) {
            if (all.add(end(2 * k), end(2 * k + 1))) {
                found.push_back(k);
                ++outside;
            }
            outside -= is_within(k) && within.add(end(2 * k), end(2 * k + 1));
        }
        for (const std::int64_t k : found) implied_[at(k)] = (outside > 0 || shares) && !is_twice(k);
    }

    const Masses &masses_;
    const BondList &list_;
    const double *const lengths_;
    const std::int64_t n_lengths_;
    std::vector<unsigned char> implied_;
    std::unordered_map<std::int64_t, std::int64_t> body_of_;
    std::unordered_set<std::int64_t> shares_;
    std::unordered_map<std::int64_t, std::vector<std::int64_t>> bonds_of_;
};

}  // namespace

std::vector<unsigned char> implied_bonds(const Masses &masses, const BondList &list, const double *lengths,
                                         std::int64_t n_lengths, const Cliques &cliques) {
    return ImpliedSearch(masses, list, lengths, n_lengths, cliques).find();
}

std::vector<std::int64_t> implied_beside(const LinearParts &linear, const Masses &masses, const BondList &list,
                                         const double *lengths, std::int64_t n_lengths, const Cliques &cliques) {
    std::unordered_map<std::int64_t, std::int64_t> body_of;
    std::size_t next = 0;
    for (std::size_t b = 0; b < cliques.sizes.size(); ++b)
        for (std::int64_t a = 0; a < cliques.sizes[b]; ++a)
            body_of[cliques.atoms[next++]] = static_cast<std::int64_t>(b);
    RankOfLinear rank(linear);
    const auto is_fixed = [&](std::int64_t atom) { return masses.fixed(atom - list.base); };
    // First those that bodies hold, then those between leaders, by which the others are best told, then shorter ones;
    // but last those that say little more than others do.
    struct SortKey {
        int rank;
        double length;
        std::int64_t bond;
        bool operator<(const SortKey &other) const {
            return std::tie(rank, length, bond) < std::tie(other.rank, other.length, other.bond);
        }
    };
    std::vector<SortKey> order;
    for (const std::int64_t k : cliques.linear_bonds) {
        const std::int64_t i = list.pairs[2 * k], j = list.pairs[2 * k + 1];
        const bool within = body_of.count(i) && body_of.count(j) && body_of.at(i) == body_of.at(j);
        order.push_back({within ? -1 : rank.followers(i, j), lengths[k % n_lengths], k});
    }
    std::sort(order.begin(), order.end());
    Spread spread(linear);
    std::vector<SortKey> last;
    const auto says_little = [&](const SortKey &key) {
        const bool far = spread.add(list.pairs[2 * key.bond], list.pairs[2 * key.bond + 1], key.rank < 0);
        if (!far && key.rank >= 0) last.push_back(key);
        return !far && key.rank >= 0;
    };
    order.erase(std::remove_if(order.begin(), order.end(), says_little), order.end());  // from first to last
    order.insert(order.end(), last.begin(), last.end());
    std::vector<std::int64_t> found;
    for (const SortKey &key : order)
        if (rank.add(list.pairs[2 * key.bond], list.pairs[2 * key.bond + 1], is_fixed) && key.rank >= 0)
            found.push_back(key.bond);
    for (const std::int64_t k : found)
        if (!cliques.linear.has_together({list.pairs[2 * k], list.pairs[2 * k + 1]}))
            throw bond_error(
                list, Status::degenerate, k,
                "is one too many: the flat and straight groups and the bonds around it leave fewer freedoms "
                "than there are bonds; hol_chains_add_rigid holds such a part by coordinates");
    return found;
}

}  // namespace holonomic::rigid
