#ifndef HOLONOMIC_SUBDOMAIN_GRAPH_HPP
#define HOLONOMIC_SUBDOMAIN_GRAPH_HPP

#include <array>
#include <cstdint>
#include <vector>

namespace holonomic_subdomain {

/** The bonds of one process, and those at each atom. */
struct Graph {
    struct Bond {
        int from, to;
    };
    struct At {
        int bond;
        double sign; /**< of the atom in it: +1 at `to`, -1 at `from` */
    };

    Graph() = default;
    Graph(std::vector<double> inverse_masses, std::vector<Bond> bonds);

    int n_atoms() const { return static_cast<int>(w.size()); }
    int n_bonds() const { return static_cast<int>(bonds.size()); }
    const At *begin(int atom) const { return at_.data() + first_[atom]; }
    const At *end(int atom) const { return at_.data() + first_[atom + 1]; }

    std::vector<double> w; /**< inverse masses; 0: held fixed */
    std::vector<Bond> bonds;

private:
    std::vector<int> first_;
    std::vector<At> at_;
};

/** An atom of this process at which a bond is cut. */
struct End {
    int cut;  /**< number of the cut bond */
    int side; /**< 0: its first atom, 1: its second */
    int atom;
    double sign() const { return side ? 1.0 : -1.0; }
};

/**
 * Which ends are moved by a pull at which others, through what is inside. Each end has a colour: ends of one colour are
 * solved for together, since no place is moved by two of them. That is exact in a part with few ends, where each has a
 * colour of its own; in a part with many, ends of one colour are far apart along the bonds, and what passes between
 * them is left to refinement.
 */
struct Reach {
    /** A part with at most this many ends is treated exactly. */
    static constexpr int few_ends = 16;
    /** Bonds that lie between two ends of one colour at least: a pull loses three quarters at an average joint. */
    static constexpr int far = 20;

    Reach() = default;
    Reach(const Graph &graph, const std::vector<End> &ends);

    /** A pull at end `from` moves the atom of end `to`: numbers in the list of ends; they may be the same. */
    struct Coupling {
        int from, to;
    };

    int n_colours = 0;
    bool exact = true;
    std::vector<std::vector<int>> of_colour; /**< ends, by colour */
    std::vector<Coupling> couplings;         /**< ordered by the colour of `from`; first_coupling tells where */
    std::vector<int> first_coupling;         /**< [n_colours + 1] */
    std::vector<std::vector<int>> puller;    /**< [n_colours][n_bonds]: the end that pulls at a bond, -1: none */

private:
    void choose_colours(const Graph &graph, const std::vector<End> &ends);
    void find_pullers(const Graph &graph, const std::vector<End> &ends);

    std::vector<int> colour_;
    std::vector<std::vector<int>> near_;  // ends that each end is coupled to, itself too
};

}  // namespace holonomic_subdomain

#endif
