#include "holonomic_chains.hpp"

#include <stdexcept>

#include "random.h"

namespace bench {

void check(int status) {
    const bool bad_chains =
        status == HOL_ERR_NOT_FINITE || status == HOL_ERR_DEGENERATE || status == HOL_ERR_NO_CONVERGENCE;
    if (status != HOL_OK && !bad_chains)
        throw std::runtime_error(std::string(hol_status_name(status)) + ": " + hol_error_message());
}

namespace {

Handle make_empty(const std::vector<double> &mass) {
    hol_chains *chains = nullptr;
    check(hol_chains_create(static_cast<std::int64_t>(mass.size()), mass.data(), &chains));
    return Handle(chains, hol_chains_destroy);
}

}  // namespace

Handle make_block(const Problem &p, std::int64_t chains) {
    std::vector<double> mass;
    for (std::int64_t c = 0; c < chains; ++c) mass.insert(mass.end(), p.mass.begin(), p.mass.end());
    Handle handle = make_empty(mass);
    check(hol_chains_add_block(handle.get(), chains, p.bonds, 0, p.length.data()));
    return handle;
}

std::vector<Handle> make_handles(const Problem &p, int threads) {
    std::vector<Handle> handles;
    for (std::int64_t c = 0; c < p.chains; c += p.chains_per_call()) {
        handles.push_back(make_block(p, p.chains_per_call()));
        check(hol_chains_set_threads(handles.back().get(), threads));
    }
    return handles;
}

std::vector<std::int64_t> shuffled_atoms(const Problem &p) {
    std::vector<std::int64_t> order;
    for (std::int64_t i = 0; i <= p.bonds; ++i) order.push_back(i);
    random_stream s = random_seed(7);
    for (std::int64_t i = p.bonds; i > 0; --i)
        std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(random_integer(&s, 0, i))]);
    return order;
}

Handle make_listed(const Problem &p, const std::vector<std::int64_t> &order) {
    std::vector<double> mass(p.atoms());
    for (std::size_t c = 0; c < p.n_chains(); ++c)
        for (std::size_t i = 0; i <= p.n(); ++i) mass[p.first_atom(c) + static_cast<std::size_t>(order[i])] = p.mass[i];
    Handle handle = make_empty(mass);
    std::vector<std::int64_t> atoms(order.size());
    for (std::size_t c = 0; c < p.n_chains(); ++c) {
        for (std::size_t i = 0; i <= p.n(); ++i) atoms[i] = static_cast<std::int64_t>(p.first_atom(c)) + order[i];
        check(hol_chains_add(handle.get(), p.bonds, atoms.data(), p.length.data()));
    }
    return handle;
}

}  // namespace bench
