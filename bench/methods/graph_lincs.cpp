// LINCS (Hess, Bekker, Berendsen and Fraaije 1997, J. Comput. Chem. 18, 1463) for molecules of any shape: a projection
// along the old bond directions with the inverse of the coupling matrix expanded in powers up to `order`, then
// `iterations` corrections for the lengthening by rotation, as in Hess 2008 (P-LINCS).
#include <algorithm>
#include <cmath>
#include <memory>

#include "../molecules/elimination.hpp"
#include "graph_methods.hpp"

namespace bench {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Workspace {
    std::vector<int> start, neighbour;        ///< bond k couples to neighbour[start[k]] .. neighbour[start[k+1]-1]
    std::vector<double> factor, coupling;     ///< - s s w S S, the same times the cosine between the bonds
    std::vector<double> s;                    ///< S = 1 / sqrt(w_i + w_j)
    std::vector<double> b, right, next, sum;  ///< b: old bond directions [n][3]

    explicit Workspace(const Kind &kind) : b(3 * kind.n_bonds()), right(kind.n_bonds()), next(right), sum(right) {
        const std::size_t n = kind.n_bonds();
        std::vector<std::vector<int>> list(n);
        for (const auto &pair : coupled_bonds(kind)) {
            list[at(pair.first)].push_back(pair.second);
            list[at(pair.second)].push_back(pair.first);
        }
        for (std::size_t k = 0; k < n; ++k)
            s.push_back(1 / std::sqrt(kind.w[at(kind.first[k])] + kind.w[at(kind.second[k])]));
        start.push_back(0);
        for (std::size_t k = 0; k < n; ++k) {
            for (int l : list[k]) {
                neighbour.push_back(l);
                factor.push_back(-coupling_factor(kind, static_cast<int>(k), l) * s[k] * s[at(l)]);
            }
            start.push_back(static_cast<int>(neighbour.size()));
        }
        coupling.resize(factor.size());
    }
};

/// sum = (1 + A + A^2 + .. + A^order) right
void expand(Workspace &a, int order) {
    const std::size_t n = a.right.size();
    a.sum = a.right;
    for (int power = 0; power < order; ++power) {
        for (std::size_t k = 0; k < n; ++k) {
            double x = 0;
            for (int e = a.start[k]; e < a.start[k + 1]; ++e) x += a.coupling[at(e)] * a.right[at(a.neighbour[at(e)])];
            a.next[k] = x;
            a.sum[k] += x;
        }
        a.right.swap(a.next);
    }
}

void move(const Kind &kind, const Workspace &a, double *r) {
    for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
        const std::size_t i = at(kind.first[k]), j = at(kind.second[k]);
        const double t = a.s[k] * a.sum[k], pull = kind.w[i] * t, push = kind.w[j] * t;
        for (std::size_t c = 0; c < 3; ++c) {
            r[3 * i + c] += pull * a.b[3 * k + c];
            r[3 * j + c] -= push * a.b[3 * k + c];
        }
    }
}

void project(const Kind &kind, const double *reference, int order, int iterations, Workspace &a, double *r) {
    const std::size_t n = kind.n_bonds();
    for (std::size_t k = 0; k < n; ++k) {
        const double *i = reference + 3 * kind.first[k], *j = reference + 3 * kind.second[k];
        double *b = &a.b[3 * k];
        for (int c = 0; c < 3; ++c) b[c] = j[c] - i[c];
        const double inverse = 1 / std::sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
        for (int c = 0; c < 3; ++c) b[c] *= inverse;
        const double *ri = r + 3 * kind.first[k], *rj = r + 3 * kind.second[k];
        const double along = b[0] * (rj[0] - ri[0]) + b[1] * (rj[1] - ri[1]) + b[2] * (rj[2] - ri[2]);
        a.right[k] = a.s[k] * (along - kind.length[k]);
    }
    for (std::size_t k = 0; k < n; ++k)
        for (int e = a.start[k]; e < a.start[k + 1]; ++e) {
            const double *b = &a.b[3 * k], *other = &a.b[3 * at(a.neighbour[at(e)])];
            a.coupling[at(e)] = a.factor[at(e)] * (b[0] * other[0] + b[1] * other[1] + b[2] * other[2]);
        }
    expand(a, order);
    move(kind, a, r);
    for (int iteration = 0; iteration < iterations; ++iteration) {
        for (std::size_t k = 0; k < n; ++k) {
            const double *i = r + 3 * kind.first[k], *j = r + 3 * kind.second[k];
            const double d[3] = {j[0] - i[0], j[1] - i[1], j[2] - i[2]}, length = kind.length[k];
            // The projection of the bond on its old direction must be this long for the bond to have its length.
            const double square = 2 * length * length - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            a.right[k] = a.s[k] * (length - std::sqrt(std::max(square, 0.0)));
        }
        expand(a, order);
        move(kind, a, r);
    }
}

}  // namespace

Method graph_lincs(const Molecules &m, int order, int iterations) {
    auto spaces = std::make_shared<std::vector<Workspace>>(m.kinds.begin(), m.kinds.end());
    const std::string setting = "order " + std::to_string(order) + " iterations " + std::to_string(iterations);
    return {"lincs", setting, [&m, order, iterations, spaces](State &state) {
                state.iterations = iterations;
                for (const Molecules::Place &place : m.places)
                    project(m.kind_of(place), &m.r[3 * place.atom], order, iterations, (*spaces)[place.kind],
                            &state.r[3 * place.atom]);
            }};
}

}  // namespace bench
