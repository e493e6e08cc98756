#ifndef HOLONOMIC_SUBDOMAIN_SUBDOMAIN_HPP
#define HOLONOMIC_SUBDOMAIN_SUBDOMAIN_HPP

#include <initializer_list>
#include <string>

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
 * The equations A t = b of docs/theory.md, t = 2 lambda, of bonds that several processes hold. Each process eliminates
 * the bonds inside of its subdomain (I), but for some where many cut bonds meet; what is left is the interface's (C),
 * which all processes add up and solve alike.
 *
 *     S = A_CC - A_CI A_II^-1 A_IC,   S t_C = b_C - A_CI A_II^-1 b_I,   A_II t_I = b_I - A_IC t_C
 *
 * A residual of all bonds in twice the precision then corrects t once, and what the correction changes tells what error
 * is left: two solutions and three sums over processes, whatever the molecule is.
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
    /** Of the bonds inside, and of the interface: cut bonds, then what each process has left of those inside. */
    struct Factors {
        SparseFactors inside, interface;
    };

    void make_inside(const Given &given);
    void check_ends(const std::vector<std::int64_t> &ends);
    void make_interface();

    std::vector<double> of_ends(std::initializer_list<const double *> arrays) const;
    void find_vectors(const double *r);
    void matrix_inside(const std::vector<TwiceVector> &now, std::vector<double> &values,
                       std::vector<double> *lower) const;
    std::vector<double> factorize(Factors &factors, const std::vector<TwiceVector> &now, const std::vector<double> *x);

    TwiceVector rate_of(const TwiceVector &d, const double *i, const double *j) const;
    void right_hand_sides(const double *v, const double *f, bool with_forces, double *x);
    void cut_right_hand_sides(const double *shared, bool with_forces);
    void residuals(double *rho, double *parts);
    void gather(Factors &factors, const std::vector<double> &x, double *sums);
    void scatter(Factors &factors, const double *sums, std::vector<double> &x);
    double change_of(const std::vector<double> &dt);
    Found solve(const double *v, const double *f, bool with_forces);

    double excess(const double *r, double *sigma);
    double cut_excess(const double *ends, std::vector<double> &sigma);
    void move(std::vector<double> &r, const std::vector<double> &multipliers, double factor) const;
    void pull(Found &found) const;
    void react(Found &found) const;
    std::string name_of(int row) const;

    int n_cut() const { return static_cast<int>(cut_lengths_.size()); }
    int n_bonds() const { return graph_.n_bonds(); }
    bool is_fixed(int bond) const {
        return graph_.w[graph_.bonds[bond].from] == 0 && graph_.w[graph_.bonds[bond].to] == 0;
    }
    bool cut_is_fixed(int cut) const { return cut_w_[2 * cut] == 0 && cut_w_[2 * cut + 1] == 0; }

    Graph graph_;
    std::vector<double> lengths_, cut_lengths_;
    std::vector<std::int64_t> labels_;
    std::vector<End> ends_;
    std::vector<double> cut_w_;     // [n_cut][2], on every process
    Factors reference_, anew_;      // at the positions of factorize(); at those on the way to the next
    std::size_t n_interface_ = 0;   // its rows
    std::vector<int> row_of_rest_;  // of the interface's, for each that is left inside
    std::vector<std::size_t> pair_of_rest_;

    Box box_;
    double rate_[9] = {0};
    bool has_rate_ = false;

    bool factorized_ = false;
    std::vector<TwiceVector> cut_d_;
    std::vector<TwiceVector> d_,
        now_;  // of the process's equations: of the reference, on the way to the next positions

    std::vector<double> t_, dt_;    // multipliers of the process's equations, and their correction
    std::vector<double> t_cut_;     // of all cut bonds
    std::vector<Twice> b_, b_cut_;  // right-hand sides of bonds inside, of all cut ones
    std::vector<TwiceVector> accelerations_;
    std::vector<double> at_atoms_;

    std::int64_t n_solves_ = 0;
    double last_change_ = 0;
};

}  // namespace holonomic_subdomain

#endif
