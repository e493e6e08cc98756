#include "networks/scenes.hpp"

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

typedef std::mt19937_64 Random;

double uniform(Random &random) { return std::uniform_real_distribution<double>(0, 1)(random); }

std::int64_t add_atom(Network &n, double x, double y, double z) {
    n.r.insert(n.r.end(), {x, y, z});
    n.masses.push_back(1);
    return n.n_atoms() - 1;
}
void add_bond(Network &n, std::int64_t i, std::int64_t j) {
    n.pairs.insert(n.pairs.end(), {i, j});
    n.lengths.push_back(0);
    double d[3];
    n.bond(n.n_bonds() - 1, d);
    n.lengths.back() = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

void direction(Random &random, double *d) {
    const double z = 2 * uniform(random) - 1, phi = 6.283185307179586 * uniform(random), s = std::sqrt(1 - z * z);
    d[0] = s * std::cos(phi);
    d[1] = s * std::sin(phi);
    d[2] = z;
}

// A random walk from i by `gap` to j, every step with its part of what is missing.
void add_strand(Network &n, std::int64_t i, std::int64_t j, const double *gap, std::int64_t bonds, double curl,
                Random &random) {
    const std::size_t size = static_cast<std::size_t>(bonds);
    std::vector<double> step(3 * size);
    double missing[3] = {gap[0], gap[1], gap[2]};
    for (std::size_t k = 0; k < size; ++k) {
        direction(random, &step[3 * k]);
        for (std::size_t x = 0; x < 3; ++x) missing[x] -= step[3 * k + x] *= curl;
    }
    double at[3] = {n.r[3 * static_cast<std::size_t>(i)], n.r[3 * static_cast<std::size_t>(i) + 1],
                    n.r[3 * static_cast<std::size_t>(i) + 2]};
    std::int64_t last = i;
    for (std::size_t k = 0; k < size; ++k) {
        for (std::size_t x = 0; x < 3; ++x) at[x] += step[3 * k + x] + missing[x] / static_cast<double>(bonds);
        const std::int64_t next = k + 1 < size ? add_atom(n, at[0], at[1], at[2]) : j;
        add_bond(n, last, next);
        last = next;
    }
}

}  // namespace

void Network::bond(const std::vector<double> &positions, std::int64_t k, double *d) const {
    const double *i = &positions[3 * static_cast<std::size_t>(pairs[2 * static_cast<std::size_t>(k)])],
                 *j = &positions[3 * static_cast<std::size_t>(pairs[2 * static_cast<std::size_t>(k) + 1])];
    for (int x = 0; x < 3; ++x) {
        d[x] = j[x] - i[x];
        if (side[x] > 0) d[x] -= side[x] * std::nearbyint(d[x] / side[x]);
    }
}

Network coils(std::int64_t n, std::int64_t bonds) {
    Network all;
    all.name = std::to_string(n) + " chains of " + std::to_string(bonds);
    Random random(1);
    for (std::int64_t c = 0; c < n; ++c) {
        std::int64_t last = add_atom(all, 0, 0, 0);
        for (std::int64_t k = 0; k < bonds; ++k) {
            double d[3];
            direction(random, d);
            const std::size_t i = 3 * static_cast<std::size_t>(last);
            const std::int64_t next = add_atom(all, all.r[i] + d[0], all.r[i + 1] + d[1], all.r[i + 2] + d[2]);
            add_bond(all, last, next);
            last = next;
        }
    }
    return all;
}

// Nodes anywhere, each joined to the nearest that still have a free place, but not too near.
Network gel(std::int64_t strands, std::int64_t bonds, double curl) {
    Network all;
    all.name = "gel, " + std::to_string(strands) + " strands of " + std::to_string(bonds);
    if (curl != 1) all.name += ", nearly straight";
    Random random(2);
    const std::int64_t nodes = strands / 2;
    const double reach = curl == 1 ? std::sqrt(static_cast<double>(bonds)) : 0.9 * static_cast<double>(bonds);
    const double side = 0.8 * reach * std::cbrt(static_cast<double>(nodes));
    std::fill(all.side, all.side + 3, side);
    for (std::int64_t i = 0; i < nodes; ++i) {
        const double x = side * uniform(random), y = side * uniform(random), z = side * uniform(random);
        add_atom(all, x, y, z);
    }
    const int cells = std::max(3, static_cast<int>(side / (1.5 * reach)));
    std::vector<std::vector<std::int64_t>> in_cell(static_cast<std::size_t>(cells * cells * cells));
    const auto cell_of = [&](std::int64_t i, int x) {
        return std::min(
            cells - 1,
            static_cast<int>(all.r[3 * static_cast<std::size_t>(i) + static_cast<std::size_t>(x)] / side * cells));
    };
    for (std::int64_t i = 0; i < nodes; ++i)
        in_cell[static_cast<std::size_t>((cell_of(i, 0) * cells + cell_of(i, 1)) * cells + cell_of(i, 2))].push_back(i);
    std::vector<int> free(static_cast<std::size_t>(nodes), 4);
    struct Near {
        double square;
        std::int64_t node;
        double gap[3];
    };
    for (std::int64_t i = 0; i < nodes; ++i) {
        std::vector<Near> near;
        for (int n = 0; n < 27; ++n) {
            const int at[3] = {(cell_of(i, 0) + n % 3 + cells - 1) % cells,
                               (cell_of(i, 1) + n / 3 % 3 + cells - 1) % cells,
                               (cell_of(i, 2) + n / 9 + cells - 1) % cells};
            for (const std::int64_t j : in_cell[static_cast<std::size_t>((at[0] * cells + at[1]) * cells + at[2])]) {
                if (j <= i || free[static_cast<std::size_t>(j)] == 0) continue;
                Near one = {0, j, {}};
                for (std::size_t x = 0; x < 3; ++x) {
                    const double d =
                        all.r[3 * static_cast<std::size_t>(j) + x] - all.r[3 * static_cast<std::size_t>(i) + x];
                    one.gap[x] = d - side * std::nearbyint(d / side);
                    one.square += one.gap[x] * one.gap[x];
                }
                near.push_back(one);
            }
        }
        std::sort(near.begin(), near.end(), [](const Near &a, const Near &b) { return a.square < b.square; });
        for (const Near &to : near) {
            int &own = free[static_cast<std::size_t>(i)];
            if (own == 0) break;
            if (to.square > 0.5 * static_cast<double>(bonds * bonds)) break;
            --own;
            --free[static_cast<std::size_t>(to.node)];
            add_strand(all, i, to.node, to.gap, bonds, curl, random);
        }
    }
    return all;
}

Network diamond(int cells, std::int64_t bonds, bool periodic) {
    static const int corner[4][3] = {{0, 0, 0}, {0, 2, 2}, {2, 0, 2}, {2, 2, 0}};
    static const int to[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    Network all;
    all.name = std::string(periodic ? "periodic" : "open") + " diamond network, strands of " + std::to_string(bonds);
    Random random(3);
    const double quarter = std::sqrt(static_cast<double>(bonds) / 3);
    const int n = 4 * cells;
    if (periodic) std::fill(all.side, all.side + 3, n * quarter);
    std::vector<std::int64_t> node(static_cast<std::size_t>(n * n * n), -1);
    const auto place = [&](const int *at) { return static_cast<std::size_t>((at[0] * n + at[1]) * n + at[2]); };
    for (int c = 0; c < 4 * cells * cells * cells; ++c)
        for (int e = -1; e < 4; ++e) {
            const int cell[3] = {c / 4 % cells, c / 4 / cells % cells, c / 4 / cells / cells};
            int at[3];
            bool inside = true;
            for (int x = 0; x < 3; ++x) {
                const int a = 4 * cell[x] + corner[c % 4][x] + (e < 0 ? 0 : to[e][x]);
                inside = inside && a >= 0;
                at[x] = (a + n) % n;
            }
            if ((inside || periodic) && node[place(at)] < 0)
                node[place(at)] = add_atom(all, at[0] * quarter, at[1] * quarter, at[2] * quarter);
        }
    for (int c = 0; c < 4 * cells * cells * cells; ++c)
        for (int e = 0; e < 4; ++e) {
            const int cell[3] = {c / 4 % cells, c / 4 / cells % cells, c / 4 / cells / cells};
            int from[3], at[3];
            double gap[3];
            bool inside = true;
            for (int x = 0; x < 3; ++x) {
                from[x] = 4 * cell[x] + corner[c % 4][x];
                inside = inside && from[x] + to[e][x] >= 0;
                at[x] = (from[x] + to[e][x] + n) % n;
                gap[x] = quarter * to[e][x];
            }
            if (inside || periodic) add_strand(all, node[place(from)], node[place(at)], gap, bonds, 1, random);
        }
    return all;
}

Network cubic(int n) {
    Network all;
    all.name = "cubic lattice, " + std::to_string(n) + "^3, a fifth of the bonds left out";
    Random random(4);
    for (int i = 0; i < n * n * n; ++i) {
        const double x = 0.2 * (uniform(random) - 0.5), y = 0.2 * (uniform(random) - 0.5),
                     z = 0.2 * (uniform(random) - 0.5);
        add_atom(all, i % n + x, i / n % n + y, i / (n * n) + z);
    }
    for (int i = 0; i < n * n * n; ++i) {
        const int at[3] = {i % n, i / n % n, i / (n * n)}, step[3] = {1, n, n * n};
        for (int x = 0; x < 3; ++x)
            if (at[x] + 1 < n && uniform(random) > 0.2) add_bond(all, i, i + step[x]);
    }
    return all;
}

Network sheet(int n, double height) {
    Network all;
    all.name =
        std::string(height > 0 ? "corrugated" : "flat") + " sheet, " + std::to_string(n) + " x " + std::to_string(n);
    if (n > 100) all.step = 0.001;  // along the soft modes of a large sheet Newton's method gets no further
    Random random(5);
    for (int i = 0; i < n * n; ++i) {
        const double z = height * (2 * uniform(random) - 1);
        add_atom(all, i % n, i / n, z);
    }
    for (int i = 0; i < n * n; ++i) {
        const bool right = i % n + 1 < n, up = i / n + 1 < n;
        if (right) add_bond(all, i, i + 1);
        if (up) add_bond(all, i, i + n);
        if (right && up) add_bond(all, i, i + n + 1);
    }
    return all;
}

Network ladder(std::int64_t n, std::int64_t rungs) {
    Network all;
    all.name = std::to_string(n) + " ladders of " + std::to_string(rungs);
    Random random(6);
    for (std::int64_t l = 0; l < n; ++l) {
        double d[3], at[3] = {0, 0, 0};
        std::int64_t left = -1, right = -1;
        for (std::int64_t k = 0; k < rungs; ++k) {
            direction(random, d);
            for (int x = 0; x < 3; ++x) at[x] += d[x];
            const std::int64_t i = add_atom(all, at[0], at[1], at[2]);
            direction(random, d);
            const std::int64_t j = add_atom(all, at[0] + d[0], at[1] + d[1], at[2] + d[2]);
            add_bond(all, i, j);
            if (left >= 0) add_bond(all, left, i), add_bond(all, right, j);
            left = i;
            right = j;
        }
    }
    return all;
}

}  // namespace bench
