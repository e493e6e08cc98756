// The inverse of the matrix Z of one molecule in one conformation: elements on demand, condition number, error bounds.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/molecules/chains.hpp"

namespace holonomic {

class Inverse {
public:
    // Throws Error if the molecule's data are bad.
    static std::unique_ptr<const Inverse> make(const Chains &chains, std::int64_t molecule, const AtomArray &r);
    virtual ~Inverse() = default;

    virtual std::int64_t n_bonds() const = 0;
    int base() const { return base_; }

    // Bonds are counted from 0 as in Molecule; physical: of Z, otherwise of Z~. Throw Error if arguments are bad.
    virtual double entry(bool physical, std::int64_t i, std::int64_t j) const = 0;
    virtual void row(bool physical, std::int64_t i, double *out) const = 0;
    virtual void band(bool physical, std::int64_t width, double *out) const = 0;
    virtual void matrix(bool physical, double *out) const = 0;
    virtual double condition() const = 0;

    // |lambda_k - exact| <= bound[k]. Throws Error if something is not finite.
    virtual std::vector<double> error_bound(const AtomArray &v, const AtomArray &f, const double *lambda) const = 0;

protected:
    explicit Inverse(int base) : base_(base) {}
    void check(std::int64_t bond) const;
    // Throws Error unless all numbers that a bound is made of are finite.
    void check_finite(const std::vector<std::int64_t> &atoms, const AtomArray &v, const AtomArray &f,
                      const double *lambda) const;
    [[noreturn]] static void refuse(const Chains &chains, std::int64_t molecule, const AtomArray &r);

private:
    int base_;
};

}  // namespace holonomic
