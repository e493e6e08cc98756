// Factors of all molecules at one configuration, kept for any number of right-hand sides: forces of several groups,
// terms that relax errors, whole rows of the inverse.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/molecules/chains.hpp"

namespace holonomic {

// What a solve reads and writes; arrays per atom of any layout. Right-hand sides rhs, or those of v and f.
struct FactorsSolve {
    AtomArray v{}, f{}, g{};
    const double *rhs = nullptr;
    double *lambda = nullptr, *tension = nullptr;
    bool add = false;
};

// So many right-hand sides go through the molecules together.
constexpr int rhs_at_once = 16;

// Molecules whose factors are not kept are left to the ordinary verbs: those of shapes that kernels keep none of, and
// those that plain products do not answer for.
class Factors {
public:
    // The set must outlive it.
    explicit Factors(const Chains &chains) : chains_(chains) {}
    ~Factors();
    Factors(const Factors &) = delete;
    Factors &operator=(const Factors &) = delete;

    // Takes positions, box and its rate as they are now. Throws Error of a bad molecule once all others are done.
    void update(const AtomArray &r);

    // Throw Error: of Status::state if there has been no update since the set was changed. virial [9] or null.
    void forces(const FactorsSolve &what, double *virial) const;
    // n right-hand sides, at most rhs_at_once; virial [n][9] or null.
    void solve(const FactorsSolve *what, int n, double *virial) const;

    const Chains &chains() const { return chains_; }

private:
    static double *room(void *owner, std::int64_t molecule, std::int64_t doubles);
    void begin();
    void need_update() const;
    void solve_one(const FactorsSolve &what, const double *rhs, double *virial) const;
    void solve_packed(const FactorsSolve *what, int n, const double *rhs, double *virial) const;
    void solve_rest(const FactorsSolve &what, unsigned char *left, double *virial) const;
    std::unique_ptr<Chains> those(const unsigned char *left, unsigned char marks) const;
    AtomArray positions() const;

    const Chains &chains_;
    std::int64_t revision_ = -1;  // of the set, at the last update
    Cell box_{};
    bool has_rate_ = false;
    double L_[9] = {};
    std::vector<double> r_;  // [n_atoms][3]

    struct KeptBlock {
        double *at = nullptr;
        std::int64_t doubles = 0;
    };
    std::mutex mutex_;
    std::vector<KeptBlock> blocks_;      // [n_molecules] by the first molecule of each
    std::vector<const double *> block_;  // the same for the kernels
    std::vector<double *> chunks_;       // memory of the blocks
    std::int64_t free_ = 0;              // doubles of the last one, in front of its end
    double *end_ = nullptr;
    bool out_of_memory_ = false;  // for a block of the last update
    KeptFactors kept_{};
    std::vector<unsigned char> left_;  // [n_molecules] not kept
    // These of given right-hand sides, and of forces where that is more; or null: there are none.
    std::unique_ptr<Chains> rest_, rest_of_forces_;
};

}  // namespace holonomic
