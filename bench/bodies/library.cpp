#include <holonomic.h>

#include <cstdio>
#include <cstdlib>

#include "bodies/movers.hpp"

namespace bench {
namespace {

void must(int status) {
    if (status == HOL_OK) return;
    std::fprintf(stderr, "bench_bodies: %s\n", hol_error_message());
    std::exit(1);
}

class Library final : public Mover {
public:
    explicit Library(const BodyScene &s) : r_(s.r), v_(s.v), before_(s.r) {
        std::vector<double> masses;
        std::vector<std::int64_t> atoms;
        const std::int64_t n = s.atoms_each();
        for (std::int64_t i = 0; i < n; ++i) atoms.push_back(i);
        for (std::int64_t b = 0; b < s.n_bodies; ++b)
            for (const double m : s.mass) masses.push_back(m), w_.insert(w_.end(), 3, 1 / m);
        mass_ = masses;
        must(hol_chains_create(s.n_atoms(), masses.data(), &chains_));
        must(hol_chains_add_rigid_molecules(chains_, s.n_bodies, n, 0, 1, &n, atoms.data(), s.place.data(), 0, nullptr,
                                            nullptr));
        must(hol_project_velocities(chains_, r_.data(), v_.data(), nullptr, nullptr));
    }
    ~Library() override { hol_chains_destroy(chains_); }

    void first_half(const double *f, double dt) override {
        before_.swap(r_);
        for (std::size_t i = 0; i < r_.size(); ++i) {
            v_[i] += 0.5 * dt * w_[i] * f[i];
            r_[i] = before_[i] + dt * v_[i];
        }
        must(hol_project_positions(chains_, before_.data(), r_.data(), v_.data(), dt, nullptr, 0, nullptr, nullptr));
    }
    void second_half(const double *f, double dt) override {
        for (std::size_t i = 0; i < r_.size(); ++i) v_[i] += 0.5 * dt * w_[i] * f[i];
        must(hol_project_velocities(chains_, r_.data(), v_.data(), nullptr, nullptr));
    }
    const double *positions() const override { return r_.data(); }
    double kinetic() const override {
        double sum = 0;
        for (std::size_t i = 0; i < v_.size(); ++i) sum += 0.5 * mass_[i / 3] * v_[i] * v_[i];
        return sum;
    }

private:
    hol_chains *chains_ = nullptr;
    std::vector<double> r_, v_, before_, w_, mass_;
};

}  // namespace

std::unique_ptr<Mover> by_the_library(const BodyScene &s) { return std::make_unique<Library>(s); }

}  // namespace bench
