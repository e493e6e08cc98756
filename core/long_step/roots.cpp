#include "core/long_step/roots.hpp"

#include <algorithm>
#include <cmath>

#include "core/caller/box.hpp"
#include "core/index.hpp"
#include "core/kernels/atom.hpp"

namespace holonomic {

namespace {

// Along the path: steps of this part of it, in which no bond is to be off by more than `near` of its length from where
// the last steps point.
constexpr double first_step = 0.25, shortest_step = 1e-6, near = 0.25, very_near = 0.05;
// |D.D - a^2| / a^2 from which Newton's method begins at a point, and where it ends.
constexpr double near_enough = 0.3, close = 1e-9;
constexpr int iterations_at_a_point = 6;
// What of a diagonal element of the symmetric part counts as positive, and how many products factors may take.
constexpr double least_pivot = 1e-10, most_work = 1e7;
// Where Newton's method takes over from SHAKE.
constexpr double shaken = 1e-6;

}  // namespace

StepBonds::StepBonds(const Molecule &molecule, const AtomArray &r_ref, const Box &box_ref, const AtomArray &r,
                     const Box &box)
    : m_(molecule), b_(at(molecule.n_bonds)), D_(b_.size()) {
    for (std::int64_t k = 0; k < m_.n_bonds; ++k)
        for (const bool of_reference : {true, false}) {
            double from[3], to[3], d[3];
            const AtomArray &array = of_reference ? r_ref : r;
            read_atom(array, m_.atom(m_.i(k)), from);
            read_atom(array, m_.atom(m_.j(k)), to);
            bond_vector(of_reference ? box_ref : box, from, to, d);
            (of_reference ? b_ : D_)[at(k)] = {d[0], d[1], d[2]};
            if (of_reference) continue;
            const double a = m_.length(k), error = std::fabs(dot(D_[at(k)], D_[at(k)]) - a * a) / (a * a);
            if (!(error <= error_)) error_ = error;
        }
    make_rows();
}

std::vector<StepBonds::BondVector> StepBonds::moved(const std::vector<double> &tau, double part) const {
    std::vector<BondVector> shift(at(m_.n_atoms), BondVector{0, 0, 0}), D(b_.size());
    const auto add = [](BondVector &to, double factor, const BondVector &v) {
        to.x += factor * v.x;
        to.y += factor * v.y;
        to.z += factor * v.z;
    };
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        add(shift[at(m_.i(k))], m_.w(m_.i(k)) * tau[at(k)], b_[at(k)]);
        add(shift[at(m_.j(k))], -m_.w(m_.j(k)) * tau[at(k)], b_[at(k)]);
    }
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        add(D[at(k)] = shift[at(m_.j(k))], -1, shift[at(m_.i(k))]);
        add(D[at(k)], 1 - part, b_[at(k)]);
        add(D[at(k)], part, D_[at(k)]);
    }
    return D;
}

double StepBonds::distance(const std::vector<double> &tau, const std::vector<double> &other) const {
    const std::vector<BondVector> D = moved(tau, 1), E = moved(other, 1);
    double largest = 0;
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        const BondVector d = {D[at(k)].x - E[at(k)].x, D[at(k)].y - E[at(k)].y, D[at(k)].z - E[at(k)].z};
        const double size = std::sqrt(dot(d, d)) / m_.length(k);
        if (!(size <= largest)) largest = size;  // keeps a NaN
    }
    return largest;
}

// Rows begin with the first bond that shares an atom.
void StepBonds::make_rows() {
    std::vector<std::int64_t> of_atom(at(m_.n_atoms), -1);
    start_.assign(1, 0);
    double work = 0;
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        std::int64_t first = k;
        for (const std::int64_t atom : {m_.i(k), m_.j(k)}) {
            std::int64_t &one = of_atom[at(atom)];
            if (one < 0) one = k;
            first = std::min(first, one);
        }
        first_.push_back(first);
        start_.push_back(start_.back() + k - first + 1);
        work += static_cast<double>(k - first + 1) * static_cast<double>(k - first + 1);
        if (work > most_work) return;
    }
    coupling_.resize(at(start_.back()));
    for (std::int64_t k = 0; k < m_.n_bonds; ++k)
        for (std::int64_t l = first_[at(k)]; l <= k; ++l)
            for (const std::int64_t atom : {m_.i(k), m_.j(k)})
                for (const std::int64_t other : {m_.i(l), m_.j(l)})
                    if (atom == other)
                        coupling_[entry(k, l)] += ((atom == m_.i(k)) == (other == m_.i(l)) ? 1 : -1) * m_.w(atom);
}

// By Cholesky's factors of the symmetric part, which exist or not.
bool StepBonds::is_certified(const std::vector<double> &tau) const {
    if (!has_rows()) return false;
    const std::vector<BondVector> D = moved(tau, 1);
    std::vector<double> s(coupling_);
    for (std::int64_t k = 0; k < m_.n_bonds; ++k)
        for (std::int64_t l = first_[at(k)]; l <= k; ++l) {
            double &sum = s[entry(k, l)];
            sum *= 0.5 * (dot(D[at(k)], b_[at(l)]) + dot(D[at(l)], b_[at(k)]));
            const double least = least_pivot * sum;
            for (std::int64_t i = std::max(first_[at(k)], first_[at(l)]); i < l; ++i)
                sum -= s[entry(k, i)] * s[entry(l, i)];
            if (l == k && !(sum > least)) return false;
            sum = l == k ? std::sqrt(sum) : sum / s[entry(l, l)];
        }
    return true;
}

// Solves A x = y, A_kl = w_kl D_k.b_l, by the factors L U of A without pivoting; up: columns of U.
void StepBonds::solve(const std::vector<BondVector> &D, std::vector<double> &x, EnvelopeFactors &f) const {
    std::vector<double> &low = f.low, &up = f.up;
    low = up = coupling_;
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        for (std::int64_t l = first_[at(k)]; l <= k; ++l) {
            double &of_row = low[entry(k, l)], &of_column = up[entry(k, l)];
            of_row *= dot(D[at(k)], b_[at(l)]);
            of_column *= dot(D[at(l)], b_[at(k)]);
            for (std::int64_t i = std::max(first_[at(k)], first_[at(l)]); i < l; ++i) {
                of_row -= low[entry(k, i)] * up[entry(l, i)];
                of_column -= low[entry(l, i)] * up[entry(k, i)];
            }
            if (l < k) of_row /= up[entry(l, l)];
        }
        for (std::int64_t l = first_[at(k)]; l < k; ++l) x[at(k)] -= low[entry(k, l)] * x[at(l)];
    }
    for (std::int64_t k = m_.n_bonds; k-- > 0;) {
        x[at(k)] /= up[entry(k, k)];
        for (std::int64_t l = first_[at(k)]; l < k; ++l) x[at(l)] -= up[entry(k, l)] * x[at(k)];
    }
}

// Newton's method at a point of the path, as long as it leaves a quarter of the error and less.
bool StepBonds::correct(double part, std::vector<double> &tau, std::int64_t &solves, EnvelopeFactors &f) const {
    std::vector<double> x(b_.size());
    double before = near_enough;
    for (int i = 0; i <= iterations_at_a_point; ++i) {
        const std::vector<BondVector> D = moved(tau, part);
        double error = 0;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
            const double q = dot(b_[at(k)], b_[at(k)]), a = m_.length(k),
                         left = dot(D[at(k)], D[at(k)]) - q - part * (a * a - q);
            x[at(k)] = left / 2;
            const double one = std::fabs(left) / (a * a);
            if (!(one <= error)) error = one;  // keeps a NaN
        }
        if (error <= close) return true;
        if (!(error < before)) return false;
        before = error / 4;
        solve(D, x, f);
        ++solves;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) tau[at(k)] += x[at(k)];
    }
    return false;
}

bool StepBonds::follow(std::int64_t most, std::vector<double> &tau, std::int64_t &solves) const {
    if (!has_rows()) return false;
    std::vector<double> accepted(b_.size(), 0.0), slope(b_.size(), 0.0), guess(b_.size());
    EnvelopeFactors factors;
    double done = 0, step = first_step;
    bool halved = false;
    for (std::int64_t n = 0; done < 1; ++n) {
        if (n >= most || step < shortest_step) return false;
        const double next = std::min(done + step, 1.0);
        for (std::size_t k = 0; k < guess.size(); ++k) guess[k] = accepted[k] + (next - done) * slope[k];
        tau = guess;
        const double off = correct(next, tau, solves, factors) ? distance(tau, guess) : 1;
        const bool there = off <= near;
        if (there && off <= very_near && !halved) step *= 2;
        halved = !there;
        if (!there) {
            step = 0.5 * (next - done);
            continue;
        }
        for (std::size_t k = 0; k < guess.size(); ++k) slope[k] = (tau[k] - accepted[k]) / (next - done);
        accepted = tau;
        done = next;
    }
    return true;
}

bool StepBonds::shake(std::int64_t rounds, std::vector<double> &tau) const {
    std::fill(tau.begin(), tau.end(), 0.0);
    std::vector<BondVector> shift(at(m_.n_atoms), BondVector{0, 0, 0});
    for (std::int64_t round = 0; round < rounds; ++round) {
        double worst = 0;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
            const double w_i = m_.w(m_.i(k)), w_j = m_.w(m_.j(k)), a = m_.length(k);
            const BondVector &b = b_[at(k)];
            BondVector &i = shift[at(m_.i(k))], &j = shift[at(m_.j(k))];
            const BondVector D = {D_[at(k)].x + j.x - i.x, D_[at(k)].y + j.y - i.y, D_[at(k)].z + j.z - i.z};
            const double left = dot(D, D) - a * a, error = std::fabs(left) / (a * a);
            if (!(error <= worst)) worst = error;
            const double t = left / (2 * (w_i + w_j) * dot(D, b));
            tau[at(k)] += t;
            i = {i.x + t * w_i * b.x, i.y + t * w_i * b.y, i.z + t * w_i * b.z};
            j = {j.x - t * w_j * b.x, j.y - t * w_j * b.y, j.z - t * w_j * b.z};
        }
        if (!std::isfinite(worst)) return false;
        if (worst <= shaken) return true;
    }
    return false;
}

}  // namespace holonomic
