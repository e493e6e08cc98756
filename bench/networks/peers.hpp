/**
 * What others do with a network: the matrix of all bonds by CHOLMOD or by conjugate gradients, its pattern analysed
 * once.
 */
#ifndef BENCH_NETWORKS_PEERS_HPP
#define BENCH_NETWORKS_PEERS_HPP

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "networks/scenes.hpp"

namespace bench {

/** Z lambda = rhs of a network, Z_kl = 4 d_k . d_l (+- 1 / m for each atom that k and l share). */
class BondMatrix {
public:
    explicit BondMatrix(const Network &network);
    ~BondMatrix();
    BondMatrix(const BondMatrix &) = delete;
    BondMatrix &operator=(const BondMatrix &) = delete;

    const Network &network() const;
    /** Its elements at positions r, from the bonds. */
    void assemble(const std::vector<double> &r);
    /** The solution of CHOLMOD, refined by residuals in long double until they are at their rounding. */
    std::vector<double> refined(const std::vector<double> &rhs);

    struct Parts;
    std::unique_ptr<Parts> parts;
};

/** A way to solve it. analyse() is done once; solve() has the elements of today. Both may throw std::bad_alloc. */
struct Peer {
    std::string name;
    std::function<void(const BondMatrix &)> analyse;
    std::function<void(const BondMatrix &)> factorize;
    std::function<std::vector<double>(const std::vector<double> &rhs)> solve;
    std::function<long()> iterations;
    std::function<double()> entries;  ///< of the factor, a bond
};

/** CHOLMOD's own choice of supernodal or simplicial; conjugate gradients to a residual of 1e-14, with the diagonal and
 * with an incomplete factor. */
std::vector<Peer> peers();

/** Positions by Newton's method with the factor of the reference's matrix, until |D.D - a^2| <= tolerance a^2. Returns
 * the rounds that it took, or -1. */
int project(BondMatrix &matrix, const Peer &peer, std::vector<double> &r, double tolerance);

}  // namespace bench

#endif
