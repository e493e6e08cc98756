/**
 * Networks and what they are compared with: gels, lattices, sheets, chains; any size.
 */
#ifndef BENCH_NETWORKS_SCENES_HPP
#define BENCH_NETWORKS_SCENES_HPP

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace bench {

struct Network {
    std::string name;
    std::vector<double> masses, r, lengths;
    std::vector<std::int64_t> pairs;
    double side[3] = {0, 0, 0};  ///< of the periodic box, or zeros
    bool one_by_one = false;     ///< chains, given as such
    double step = 0.005;         ///< of the drift that positions come back from

    std::int64_t n_atoms() const { return static_cast<std::int64_t>(masses.size()); }
    std::int64_t n_bonds() const { return static_cast<std::int64_t>(lengths.size()); }
    /** Nearest image of a bond, from its first atom to its second. */
    void bond(std::int64_t k, double *d) const { bond(r, k, d); }
    void bond(const std::vector<double> &positions, std::int64_t k, double *d) const;
};

/** Coils of that many bonds. */
Network coils(std::int64_t n, std::int64_t bonds);
/** Strands of that many bonds between nodes of four, each joined to near ones, in a periodic box. `curl` 1: coils. */
Network gel(std::int64_t strands, std::int64_t bonds, double curl = 1);
/** A diamond lattice of strands, open or periodic. */
Network diamond(int cells, std::int64_t bonds, bool periodic);
/** Cubic, open, a fifth of the bonds left out. */
Network cubic(int n);
/** Square, with one diagonal a square; corrugated by that much. */
Network sheet(int n, double height);
/** 2 n atoms, a rung between the two sides at each step. */
Network ladder(std::int64_t n, std::int64_t rungs);

}  // namespace bench

#endif
