/**
 * The order in which the bonds of a kind of molecule are eliminated, and where its factors fill: found once per kind,
 * used by all direct and Newton methods of the comparison.
 */
#ifndef BENCH_MOLECULES_ELIMINATION_HPP
#define BENCH_MOLECULES_ELIMINATION_HPP

#include "kind.hpp"

namespace bench {

/// Steps of the elimination, in approximate minimum degree order, each tree of it in postorder.
struct Elimination {
    /// A coupling of two bonds that share an atom.
    struct Coupling {
        int entry, row, column;
        double factor;  ///< inverse mass of the shared atom, < 0 if one bond ends where the other begins
    };
    std::vector<int> bond;           ///< [n] the bond that each step eliminates
    std::vector<int> first, second;  ///< [n] its atoms
    std::vector<double> length, w;   ///< [n] its length, and the sum of the inverse masses of its atoms
    std::vector<int> column;         ///< [n+1] step k has the entries column[k] .. column[k+1]-1 below its diagonal
    std::vector<int> row;            ///< [entries] the later step that each couples to, ascending within a column
    std::vector<int>
        target;  ///< column by column, for each pair of its entries (a, b), a above b: the entry (row b, row a)
    std::vector<Coupling> couplings;  ///< entries that are there before any fill

    explicit Elimination(const Kind &kind);
    std::size_t n() const { return bond.size(); }
};

/// Pairs of bonds (k, l), k > l, that share an atom.
std::vector<std::pair<int, int>> coupled_bonds(const Kind &kind);
/// The coupling of two bonds without the product of their vectors: the inverse mass of the shared atom with its sign.
double coupling_factor(const Kind &kind, int k, int l);

/// The matrix of one molecule along its elimination; vectors [n][3] and right sides [n] are in the order of the steps.
class Factors {
public:
    explicit Factors(const Elimination &list);
    /// A_kl = s w d_k . d_l, to be factored as L D L^T.
    void assemble(const double *d);
    /// J_kl = s w D_k . b_l, to be factored as L U.
    void assemble(const double *d_new, const double *b);
    /// Factors, and with x != NULL carries the right side forward on the way.
    void factor_symmetric(double *x);
    void factor(double *x);
    void forward(double *x) const;
    void back_symmetric(double *x) const;
    void back(double *x) const;

private:
    const Elimination &list_;
    std::vector<double> diagonal_;       ///< after factoring the inverse pivots
    std::vector<double> lower_, upper_;  ///< J_(row)(column), J_(column)(row)
};

}  // namespace bench

#endif
