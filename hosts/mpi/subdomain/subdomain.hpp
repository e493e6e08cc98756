#ifndef HOLONOMIC_SUBDOMAIN_SUBDOMAIN_HPP
#define HOLONOMIC_SUBDOMAIN_SUBDOMAIN_HPP

#include <memory>

#include "box.hpp"
#include "graph.hpp"
#include "processes.hpp"
#include "sparse_factors.hpp"

namespace holonomic_subdomain {

/** What was given to hol_subdomain_create. */
struct Given {
    std::vector<double> masses, lengths, cut_lengths;
    std::vector<std::int64_t> pairs, ends;
};

/** What a call of the acceleration or velocity level gives, of this process's atoms and bonds. */
struct Found {
    std::vector<double> lambda, cut_lambda;
    std::vector<double> g; /**< constraint forces, or impulses */
    std::vector<double> v; /**< velocities, of that level */
    double virial[9];
    int steps = 0; /**< of the interface, at the position level */
};

/**
 * The equations A t = b of docs/theory.md, t = 2 lambda, of bonds that several processes hold. I: bonds inside of the
 * processes' subdomains, C: cut ones. Each process has its rows of I; all have those of C.
 *
 *     S = A_CC - A_CI A_II^-1 A_IC,   S t_C = b_C - A_CI A_II^-1 b_I,   A_II t_I = b_I - A_IC t_C
 *
 * The first and the last are solved by the library, with pulls of cut bonds as forces on their atoms.
 */
class Subdomain {
public:
    Subdomain(const Processes &processes, Given given);

    void set_box(const double *box);
    void set_rate(const double *L);
    void set_labels(const std::int64_t *atoms);
    void factorize(const double *r);
    Found forces(const double *v, const double *f);
    Found velocities(const double *v);
    Found positions(std::vector<double> &r, double dt);
    /** worst: largest relative error of a length, and of a rate. v may be NULL. */
    void violation(const double *r, const double *v, double *worst);

    int n_atoms() const { return graph_.n_atoms(); }
    const std::vector<TwiceVector> &cut_vectors() const { return cut_d_; }
    bool factorized() const { return factorized_; }
    double inverse_mass(int atom) const { return graph_.w[atom]; }
    hol_subdomain_work work() const;

    Processes processes;

private:
    /** The right-hand side of a cut bond, and the sum of its terms in absolute values. */
    struct RightHandSide {
        Twice b;
        double size;
    };

    /** A_CI t of one end, and the sum of its terms in absolute values. */
    struct Pull {
        double sum, size;
    };

    void make_inside(const Given &given);
    void check_ends(const std::vector<std::int64_t> &ends);
    void make_interface();

    void share(const double *x, std::vector<double> &shared);
    void share(const double *x, const double *y, std::vector<double> &shared);
    TwiceVector bond_vector(int bond) const;
    void find_columns();
    void pull(std::vector<double> &x, const std::vector<double> &t_cut, bool with_masses) const;

    RightHandSide right_hand_side(const TwiceVector &d, const double *w, const double *i, const double *j,
                                  bool with_forces) const;
    void cut_right_hand_sides(const double *v, const double *f, bool with_forces);
    Pull pull_at(const End &end, const std::vector<double> &t) const;
    bool solve_interface();
    void solve_inside(const double *v, const double *f, Found &found, bool with_forces, bool multipliers_alone);
    Found solve(const double *v, const double *f, bool with_forces);

    void refine(const double *v, const double *f, bool with_forces);
    void inner_right_hand_sides(const double *v, const double *f, bool with_forces);
    void residuals(std::vector<double> &rho, std::vector<double> &parts);
    void correct(const std::vector<double> &rho, std::vector<double> &parts, std::vector<double> &dt,
                 std::vector<double> &dt_cut);
    double change_of(const std::vector<double> &dt, const std::vector<double> &dt_cut);

    void project_inside(std::vector<double> &r, double dt);
    double excess(const std::vector<double> &shared, std::vector<double> &sigma) const;
    void react(Found &found) const;
    void add_virial(int cut, double *virial) const;

    int n_cut() const { return static_cast<int>(cut_lengths_.size()); }
    int n_bonds() const { return graph_.n_bonds(); }

    Graph graph_;
    std::vector<double> lengths_, cut_lengths_;
    std::unique_ptr<hol_chains, void (*)(hol_chains *)> chains_;
    std::vector<End> ends_;
    std::vector<double> cut_w_;  // [n_cut][2], on every process
    Reach reach_;
    bool exact_ = true;       // no part on any process has more ends than are treated exactly
    std::vector<int> entry_;  // of the interface's matrix, by coupling; -1: it is the transpose of another
    int n_entries_ = 0;
    SparseFactors factors_;
    SparseFactors
        comparison_;        // of the matrix with its diagonal, and the rest negative: its inverse bounds the other's
    bool bounded_ = false;  // whether it does

    Box box_, reference_box_;
    double rate_[9] = {0};
    bool has_rate_ = false;

    bool factorized_ = false;
    std::vector<double> r_;
    std::vector<TwiceVector> cut_d_;
    std::vector<double> size_;                  // of the terms of the interface's elements
    std::vector<double> diagonal_;              // of the interface's matrix
    std::vector<std::vector<double>> columns_;  // A_II^-1 A_IC, by colour

    std::vector<double> t_, t_cut_;
    std::vector<RightHandSide> b_cut_;

    // Of refinement alone
    std::vector<TwiceVector> d_, accelerations_;
    std::vector<Twice> b_;
    std::vector<double> at_atoms_;

    std::int64_t n_solves_ = 0, n_refined_ = 0;
    double last_change_ = 0;
};

/** Throws what a call of the library returns unless it is HOL_OK. */
void check(int status);

}  // namespace holonomic_subdomain

#endif
