#include "bond_list.hpp"

#include <numeric>

namespace bench {
namespace {

std::vector<std::size_t> random_order(std::size_t n, random_stream &s) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t(0));
    for (std::size_t k = n; k-- > 1;)
        std::swap(order[k], order[static_cast<std::size_t>(random_integer(&s, 0, static_cast<std::int64_t>(k)))]);
    return order;
}

}  // namespace

BondList::BondList(const Molecules &m) : mass(m.mass) {
    for (const Molecules::Place &place : m.places) {
        const Kind &kind = m.kind_of(place);
        const auto base = static_cast<std::int64_t>(place.atom);
        for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
            pairs.push_back(base + kind.first[k]);
            pairs.push_back(base + kind.second[k]);
            lengths.push_back(kind.length[k]);
        }
    }
}

std::vector<std::size_t> BondList::shuffle_bonds() {
    random_stream s = random_seed(7);
    const std::vector<std::size_t> place = random_order(lengths.size(), s);
    const BondList old = *this;
    for (std::size_t k = 0; k < place.size(); ++k) {
        const std::size_t turned = random_uniform(&s) < 0.5 ? 1 : 0;
        pairs[2 * place[k]] = old.pairs[2 * k + turned];
        pairs[2 * place[k] + 1] = old.pairs[2 * k + 1 - turned];
        lengths[place[k]] = old.lengths[k];
    }
    return place;
}

void BondList::shuffle_atoms() {
    random_stream s = random_seed(8);
    const std::vector<std::size_t> number = random_order(mass.size(), s);
    const std::vector<double> old = mass;
    for (std::size_t i = 0; i < old.size(); ++i) mass[number[i]] = old[i];
    for (std::int64_t &atom : pairs) atom = static_cast<std::int64_t>(number[static_cast<std::size_t>(atom)]);
}

Handle make_handle(const BondList &bonds, int threads) {
    hol_chains *chains = nullptr;
    check(hol_chains_create(static_cast<std::int64_t>(bonds.mass.size()), bonds.mass.data(), &chains));
    Handle handle(chains, hol_chains_destroy);
    check(hol_chains_add_bonds(chains, bonds.size(), bonds.pairs.data(), bonds.lengths.data()));
    check(hol_chains_set_threads(chains, threads));
    return handle;
}

}  // namespace bench
