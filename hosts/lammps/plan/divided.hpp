// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_DIVIDED_HPP
#define HOLONOMIC_LAMMPS_PLAN_DIVIDED_HPP

#include <holonomic.h>
#include <holonomic_subdomain.h>

#include <memory>

#include "registry.hpp"

namespace holonomic_lammps {

/**
 * Molecules that no rank has as a whole. Each rank keeps its atoms, in the order of their tags, and the bonds between
 * them; bonds to atoms of other ranks are known to all. Arrays are [n_atoms][3], of these atoms. Calls but those that
 * only look are collective, and throw ErrorEverywhere.
 */
class Divided {
public:
    explicit Divided(MPI_Comm world) : world_(world), subdomain_(nullptr, hol_subdomain_destroy) {}

    /**
     * Which atoms are here now.
     * @param members, tags, masses  of all of this rank's atoms; mass 0: held fixed
     * @param fresh  bonds or masses may be others than before
     */
    void renew(const Registry &registry, const Membership *members, const Tag *tags, const std::vector<double> &masses,
               bool fresh);

    bool any() const { return subdomain_ != nullptr; } /**< on any rank */
    int n_atoms() const { return static_cast<int>(atoms_.size()); }
    const std::vector<int> &atoms() const { return atoms_; } /**< numbers that renew was given them with */

    /** rows [3][3] as hol_chains_set_box; L as hol_chains_set_box_rate. */
    void set_box(const double *rows);
    void set_rate(const double *L);

    void factorize(const double *r);
    /** From the positions of the last factorize. */
    void positions(double *now, double dt);
    void velocities(double *v);
    /** virial: this rank's part; gives multipliers for bonds(). */
    void forces(const double *v, const double *f, double *g, double *virial);
    hol_worst violation(const double *r, const double *v) const;

    /** A bond of which this rank has an atom. */
    struct Known {
        Tag from, to;
        int at[2];     /**< its atoms here; -1: another rank's */
        bool counts;   /**< here, in a list in which each bond stands once */
        double d[3];   /**< from the first to the second, at the positions of factorize */
        double lambda; /**< of the last forces */
    };
    /** r: positions of factorize; nearest(d) makes a vector the shortest of its images. */
    template <class Nearest>
    std::vector<Known> bonds(const double *r, Nearest nearest) const {
        std::vector<Known> known = list(r);
        for (Known &bond : known) nearest(bond.d);
        return known;
    }

private:
    /** A bond between atoms of two ranks; from < to. */
    struct Cut {
        Tag from, to;
        double length;
    };

    std::vector<Known> list(const double *r) const;
    void learn_partners(const Registry &registry);
    void make();
    void check(int status, const char *doing) const;
    static int add_up(void *self, std::int64_t n, double *numbers);

    MPI_Comm world_;
    std::vector<int> atoms_;
    std::vector<Tag> tags_;
    std::vector<double> masses_;
    std::unordered_map<Tag, std::vector<Partner>> partners_;
    std::vector<std::int64_t> pairs_, ends_;
    std::vector<double> lengths_, lambda_, cut_lambda_;
    std::vector<Cut> cuts_;  // of all ranks, in one order
    std::unique_ptr<hol_subdomain, void (*)(hol_subdomain *)> subdomain_;
};

}  // namespace holonomic_lammps

#endif
