// Sweeps over the bonds of a molecule of any shape, one at a time, until all are within the tolerance: Ryckaert,
// Ciccotti and Berendsen 1977 for positions, Andersen 1983 for velocities. As in Allen and Tildesley's programs a bond
// neither of whose atoms moved in the last sweep is not looked at again.
#include <algorithm>
#include <cmath>
#include <memory>

#include "graph_methods.hpp"

namespace bench {
namespace {

const std::int64_t sweeps_at_most = 200000;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Bonds {
    struct Bond {
        int i, j;
        double square, wi, wj;
    };
    std::vector<Bond> all;
    explicit Bonds(const Kind &kind) {
        for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
            const int i = kind.first[k], j = kind.second[k];
            all.push_back({i, j, kind.length[k] * kind.length[k], kind.w[at(i)], kind.w[at(j)]});
        }
    }
};

struct Workspace {
    std::vector<char> last, now;
    std::vector<double> d;  ///< reference bonds
};

/// x are the positions or velocities that are corrected along the bonds s.d; `done` tells a bond's excess or 0.
template <class Correction>
std::int64_t sweep(const Kind &kind, const Bonds &bonds, Workspace &s, double *x, const Correction &correction) {
    s.last.assign(kind.n_atoms(), 1);
    for (std::int64_t count = 1; count <= sweeps_at_most; ++count) {
        bool done = true;
        s.now.assign(kind.n_atoms(), 0);
        for (std::size_t k = 0; k < bonds.all.size(); ++k) {
            const Bonds::Bond &bond = bonds.all[k];
            if (!s.last[at(bond.i)] && !s.last[at(bond.j)] && !s.now[at(bond.i)] && !s.now[at(bond.j)]) continue;
            double *xi = x + 3 * bond.i, *xj = x + 3 * bond.j;
            const double *d = &s.d[3 * k], e[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]};
            const double t = correction(bond, d, e);
            if (t == 0) continue;
            const double pull = bond.wi * t, push = bond.wj * t;
            for (int c = 0; c < 3; ++c) {
                xi[c] += pull * d[c];
                xj[c] -= push * d[c];
            }
            s.now[at(bond.i)] = s.now[at(bond.j)] = 1;
            done = false;
        }
        if (done) return count - 1;
        s.last.swap(s.now);
    }
    return sweeps_at_most;
}

double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

Method graph_rattle(Level level, const Molecules &m, double tolerance) {
    auto bonds = std::make_shared<std::vector<Bonds>>(m.kinds.begin(), m.kinds.end());
    auto s = std::make_shared<Workspace>();
    // A bond's velocities are done when |d.dv| <= tolerance x its length x the rms of the velocities' components.
    double squares = 0;
    for (double v : m.v) squares += v * v;
    const double rms = std::sqrt(squares / static_cast<double>(m.v.size()));
    return {"rattle", tolerance_setting(tolerance), [&m, level, tolerance, rms, bonds, s](State &state) {
                const auto length = [tolerance](const Bonds::Bond &bond, const double *d, const double *e) {
                    const double excess = dot(e, e) - bond.square;
                    if (std::abs(excess) <= tolerance * bond.square) return 0.0;
                    return excess / (2 * (bond.wi + bond.wj) * dot(d, e));
                };
                const auto rate = [tolerance, rms](const Bonds::Bond &bond, const double *d, const double *e) {
                    const double along = dot(d, e);
                    if (along * along <= tolerance * tolerance * rms * rms * bond.square) return 0.0;
                    return along / ((bond.wi + bond.wj) * dot(d, d));
                };
                state.iterations = 0;
                for (const Molecules::Place &place : m.places) {
                    const Kind &kind = m.kind_of(place);
                    const double *r = &m.r[3 * place.atom];
                    s->d.resize(3 * kind.n_bonds());
                    for (std::size_t k = 0; k < kind.n_bonds(); ++k)
                        for (std::size_t c = 0; c < 3; ++c)
                            s->d[3 * k + c] = r[3 * at(kind.second[k]) + c] - r[3 * at(kind.first[k]) + c];
                    const Bonds &list = (*bonds)[place.kind];
                    const std::int64_t sweeps = level == Level::position
                                                    ? sweep(kind, list, *s, &state.r[3 * place.atom], length)
                                                    : sweep(kind, list, *s, &state.v[3 * place.atom], rate);
                    state.iterations = std::max(state.iterations, sweeps);
                }
            }};
}

}  // namespace bench
