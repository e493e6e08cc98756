// What it costs to tell the library what is bonded: a million bonds of short molecules, in order and in any order, as a
// program does once, or again whenever it renumbers its atoms. Rows of level `setup`; the error is none.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "memory_pass.hpp"
#include "methods/bond_list.hpp"
#include "sections.hpp"
#include "stopwatch.hpp"

namespace bench {
namespace {

struct Times {
    std::vector<double> add, whole;  ///< hol_chains_add_..; from hol_chains_create to hol_chains_destroy
};

/// Adds the bonds to new handles; `add` does it.
template <class Add>
Times repeat(const BondList &bonds, int repetitions, const Add &add) {
    Times times;
    for (int i = 0; i < repetitions; ++i) {
        const Stopwatch whole(1);
        hol_chains *chains = nullptr;
        check(hol_chains_create(static_cast<std::int64_t>(bonds.mass.size()), bonds.mass.data(), &chains));
        Handle handle(chains, hol_chains_destroy);
        const Stopwatch watch(1);
        check(add(chains));
        times.add.push_back(watch.seconds());
        handle.reset();
        times.whole.push_back(whole.seconds());
    }
    return times;
}

Row row(const Molecules &m, const std::string &setting, std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    const double pass = memory_pass_seconds(3 * m.mass.size()), each = 1e9 / static_cast<double>(m.all_bonds());
    const auto at = [&](double part) {
        return seconds[static_cast<std::size_t>(part * static_cast<double>(seconds.size() - 1))];
    };
    return {"setup",
            m.name,
            m.chains,
            m.bonds,
            1,
            "holonomic",
            setting,
            0,
            each * at(0.5),
            at(0.5) / pass,
            each * at(0),
            each * at(0.25),
            each * at(0.75),
            each * at(1),
            static_cast<int>(seconds.size())};
}

/// Molecules without positions: nothing here needs them.
Molecules bonded(const std::string &name, const Kind &kind, std::int64_t bonds) {
    Molecules m;
    m.name = name;
    m.kinds = {kind};
    for (std::int64_t i = 0; i < bonds / static_cast<std::int64_t>(kind.n_bonds()); ++i) m.add(0);
    return m;
}

Kind linear(int bonds) {
    KindMaker maker;
    maker.atom(1);
    for (int k = 0; k < bonds; ++k) maker.atom(1, k, 1);
    return maker.done();
}

void work(const Run &run, const Molecules &m) {
    const int repetitions = run.full() ? 5 : 3;
    auto store = [&](const std::string &setting, const Times &times) {
        run.results.add({row(m, setting, times.add), row(m, setting + " built anew", times.whole)});
    };
    BondList bonds(m);
    auto listed = [&bonds](hol_chains *chains) {
        return hol_chains_add_bonds(chains, bonds.size(), bonds.pairs.data(), bonds.lengths.data());
    };
    store("bonds in order", repeat(bonds, repetitions, listed));
    const Kind &kind = m.kinds[0];
    std::vector<std::int64_t> pairs;
    for (std::size_t k = 0; k < kind.n_bonds(); ++k) pairs.insert(pairs.end(), {kind.first[k], kind.second[k]});
    store("as molecules", repeat(bonds, repetitions, [&](hol_chains *chains) {
              return hol_chains_add_molecules(chains, m.chains, static_cast<std::int64_t>(kind.n_atoms()), 0,
                                              static_cast<std::int64_t>(kind.n_bonds()), pairs.data(),
                                              kind.length.data());
          }));
    bonds.shuffle_bonds();
    store("bonds in any order", repeat(bonds, repetitions, listed));
    bonds.shuffle_atoms();
    store("bonds and atoms in any order", repeat(bonds, repetitions, listed));
    std::printf("   setup        %-12s %7lld x %-7lld\n", m.name.c_str(), static_cast<long long>(m.chains),
                static_cast<long long>(m.bonds));
}

}  // namespace

void adding_section(const Run &run) {
    const std::int64_t bonds = run.extent == Extent::tiny ? 300 : run.full() ? 1000000 : 100000;
    work(run, bonded("coil", linear(10), bonds));
    work(run, bonded("random_tree", random_tree_kind(10), bonds));
    work(run, bonded("water", water_kind(), bonds));
}

}  // namespace bench
