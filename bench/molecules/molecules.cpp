#include "molecules.hpp"

#include <algorithm>
#include <cmath>

#include "../methods/graph_methods.hpp"

namespace bench {

void Molecules::add(std::size_t kind) {
    places.push_back({kind, mass.size(), bonds_of_all});
    mass.insert(mass.end(), kinds[kind].mass.begin(), kinds[kind].mass.end());
    bonds_of_all += kinds[kind].n_bonds();
    ++chains;
    bonds = static_cast<std::int64_t>(std::llround(static_cast<double>(bonds_of_all) / static_cast<double>(chains)));
}

Molecules make_molecules(const std::string &name, const std::vector<Kind> &kinds, std::int64_t molecules) {
    Molecules m;
    m.name = name;
    m.kinds = kinds;
    for (std::int64_t i = 0; i < molecules; ++i) m.add(static_cast<std::size_t>(i) % kinds.size());
    random_stream s = random_seed(1);
    m.r.resize(3 * m.mass.size());
    for (const Molecules::Place &place : m.places) place_atoms(m.kind_of(place), s, &m.r[3 * place.atom]);
    set_in_motion(m, s);
    return m;
}

void set_in_motion(Molecules &m, random_stream &s) {
    const bool chemical = m.kinds[0].chemical;
    const double kT = chemical ? 2.4943 : 1, force = chemical ? 1000 : 1;
    m.dt = chemical ? 0.002 : 0.005;
    m.drifted = m.r;
    m.raw_v.clear();
    m.f.clear();
    for (double mass : m.mass)
        for (int x = 0; x < 3; ++x) {
            m.raw_v.push_back(std::sqrt(kT / mass) * random_normal(&s));
            m.f.push_back(force * (chemical ? 1 : std::sqrt(mass)) * random_normal(&s));
        }
    m.v = m.raw_v;
    State positions(m, Level::position), velocities(m, Level::velocity);
    graph_newton(m, 1e-15).call(positions);
    m.r = positions.r;
    // The second time takes away what the first left to rounding.
    const Method project = graph_direct(Level::velocity, m);
    for (int turn = 0; turn < 2; ++turn) project.call(velocities);
    m.v = velocities.v;
    for (std::size_t i = 0; i < m.r.size(); ++i) m.drifted[i] = m.r[i] + m.dt * m.v[i];
}

}  // namespace bench
