#ifndef HOLONOMIC_SUBDOMAIN_GRAPH_HPP
#define HOLONOMIC_SUBDOMAIN_GRAPH_HPP

#include <array>
#include <vector>

namespace holonomic_subdomain {

/** An atom of this process at which a bond is cut. */
struct End {
    int cut;  /**< number of the cut bond */
    int side; /**< 0: its first atom, 1: its second */
    int atom;
    int row; /**< of the process's equations */
    double sign() const { return side ? 1.0 : -1.0; }
};

/** The process's equations: one for each bond inside, then one for each cut bond that has an atom here. */
struct Graph {
    struct Bond {
        int from, to;
    };
    struct At {
        int row;
        double sign; /**< of the atom in it: +1 at `to`, -1 at `from` */
    };

    Graph() = default;
    Graph(std::vector<double> inverse_masses, std::vector<Bond> bonds, const std::vector<End> &ends);

    int n_atoms() const { return static_cast<int>(w.size()); }
    int n_bonds() const { return static_cast<int>(bonds.size()); }
    const At *begin(int atom) const { return at_.data() + first_[atom]; }
    const At *end(int atom) const { return at_.data() + first_[atom + 1]; }

    /** Calls with an atom that can move, and two of the bonds at it, for all such. */
    template <class Function>
    void for_pairs(Function function) const {
        for (int atom = 0; atom < n_atoms(); ++atom) {
            if (w[atom] == 0) continue;
            for (const At *a = begin(atom); a != end(atom); ++a)
                for (const At *b = begin(atom); b != a; ++b)
                    if (a->row != b->row) function(atom, *a, *b);
        }
    }

    std::vector<double> w; /**< inverse masses; 0: held fixed */
    std::vector<Bond> bonds;
    int n_rows = 0;

private:
    std::vector<int> first_;
    std::vector<At> at_;
};

}  // namespace holonomic_subdomain

#endif
