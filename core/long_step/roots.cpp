#include "core/long_step/roots.hpp"

#include <algorithm>
#include <cmath>

#include "core/caller/box.hpp"
#include "core/kernels/atom.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Along the path: steps of this part of it, in which no bond is to be off by more than `near` of its length from where
// the last steps point.
constexpr double first_step = 0.25, shortest_step = 1.0 / 512, near = 0.25, very_near = 0.05;
constexpr double tolerance_on_the_way = 1e-9;
constexpr int iterations_on_the_way = 6;
// Of the symmetric part: what of a diagonal element counts as positive, and how many elements are looked at.
constexpr double least_pivot = 1e-10;
constexpr std::int64_t most_elements = 1 << 16;
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
}

std::vector<StepBonds::Vector> StepBonds::moved(const std::vector<double> &tau) const {
    std::vector<Vector> shift(at(m_.n_atoms), Vector{0, 0, 0}), D = D_;
    const auto add = [&](Vector &to, double factor, const Vector &v) {
        to.x += factor * v.x;
        to.y += factor * v.y;
        to.z += factor * v.z;
    };
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        add(shift[at(m_.i(k))], m_.w(m_.i(k)) * tau[at(k)], b_[at(k)]);
        add(shift[at(m_.j(k))], -m_.w(m_.j(k)) * tau[at(k)], b_[at(k)]);
    }
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        add(D[at(k)], 1, shift[at(m_.j(k))]);
        add(D[at(k)], -1, shift[at(m_.i(k))]);
    }
    return D;
}

double StepBonds::distance(const std::vector<double> &tau, const std::vector<double> &other) const {
    const std::vector<Vector> D = moved(tau), E = moved(other);
    double largest = 0;
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        const Vector d = {D[at(k)].x - E[at(k)].x, D[at(k)].y - E[at(k)].y, D[at(k)].z - E[at(k)].z};
        const double size = std::sqrt(dot(d, d)) / m_.length(k);
        if (!(size <= largest)) largest = size;  // keeps a NaN
    }
    return largest;
}

std::vector<std::int64_t> StepBonds::first_of_rows() const {
    std::vector<std::int64_t> of_atom(at(m_.n_atoms), -1), first(at(m_.n_bonds));
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        first[at(k)] = k;
        for (const std::int64_t atom : {m_.i(k), m_.j(k)}) {
            std::int64_t &one = of_atom[at(atom)];
            if (one < 0) one = k;
            first[at(k)] = std::min(first[at(k)], one);
        }
    }
    return first;
}

// By Cholesky's factors of the symmetric part, which exist or not. Rows are kept from their first element on.
bool StepBonds::is_certified(const std::vector<double> &tau) const {
    const std::vector<std::int64_t> first = first_of_rows();
    std::vector<std::int64_t> start(first.size() + 1, 0);
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        start[at(k) + 1] = start[at(k)] + k - first[at(k)] + 1;
        if (start[at(k) + 1] > most_elements) return false;
    }
    const std::vector<Vector> D = moved(tau);
    std::vector<double> s(at(start.back()));
    const auto element = [&](std::int64_t k, std::int64_t l) -> double & {
        return s[at(start[at(k)] + l - first[at(k)])];
    };
    for (std::int64_t k = 0; k < m_.n_bonds; ++k)
        for (std::int64_t l = first[at(k)]; l <= k; ++l) {
            double w = 0;
            for (const std::int64_t atom : {m_.i(k), m_.j(k)})
                for (const std::int64_t other : {m_.i(l), m_.j(l)})
                    if (atom == other) w += ((atom == m_.i(k)) == (other == m_.i(l)) ? 1 : -1) * m_.w(atom);
            double sum = w == 0 ? 0 : 0.5 * w * (dot(D[at(k)], b_[at(l)]) + dot(D[at(l)], b_[at(k)]));
            const double least = least_pivot * sum;
            for (std::int64_t i = std::max(first[at(k)], first[at(l)]); i < l; ++i)
                sum -= element(k, i) * element(l, i);
            if (l == k && !(sum > least)) return false;
            element(k, l) = l == k ? std::sqrt(sum) : sum / element(l, l);
        }
    return true;
}

// Places of the atoms that have these bonds, from any one of them. False if cycles go round a box.
bool StepBonds::lay_out(const std::vector<Vector> &bonds, std::vector<double> &atoms) const {
    atoms.assign(3 * at(m_.n_atoms), 0.0);
    const auto go = [&](std::int64_t k, bool back) {
        const double *const from = &atoms[3 * at(back ? m_.j(k) : m_.i(k))];
        double *const to = &atoms[3 * at(back ? m_.i(k) : m_.j(k))], sign = back ? -1 : 1;
        to[0] = from[0] + sign * bonds[at(k)].x;
        to[1] = from[1] + sign * bonds[at(k)].y;
        to[2] = from[2] + sign * bonds[at(k)].z;
    };
    if (m_.shape)
        m_.shape->walk(go);
    else
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) go(k, false);
    for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
        const double *const i = &atoms[3 * at(m_.i(k))], *const j = &atoms[3 * at(m_.j(k))];
        const Vector d = {j[0] - i[0] - bonds[at(k)].x, j[1] - i[1] - bonds[at(k)].y, j[2] - i[2] - bonds[at(k)].z};
        if (!(std::sqrt(dot(d, d)) <= 1e-3 * m_.length(k))) return false;
    }
    return true;
}

bool StepBonds::follow(OneMolecule &one, std::int64_t most, std::vector<double> &tau, std::int64_t &solves) const {
    std::vector<double> from, to, place(3 * at(m_.n_atoms)), length(b_.size());
    if (!lay_out(b_, from) || !lay_out(D_, to)) return false;
    PositionsCall call{};
    call.dt = 1;
    call.guess = true;
    call.tolerance = tolerance_on_the_way;
    call.max_iterations = iterations_on_the_way;
    std::vector<double> accepted(b_.size(), 0.0), slope(b_.size(), 0.0), guess(b_.size());
    double done = 0, step = first_step;
    for (std::int64_t n = 0; done < 1; ++n) {
        if (n >= most || step < shortest_step) return false;
        const double next = std::min(done + step, 1.0);
        for (std::size_t e = 0; e < place.size(); ++e) place[e] = from[e] + next * (to[e] - from[e]);
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
            const double q = dot(b_[at(k)], b_[at(k)]), a = m_.length(k);
            length[at(k)] = std::sqrt(q + next * (a * a - q));
            guess[at(k)] = accepted[at(k)] + (next - done) * slope[at(k)];
            one.lambda[at(k)] = 0.5 * guess[at(k)];
        }
        one.set(from, place);
        Tally tally = empty_tally();
        const bool solved = one.solve(call, length.data(), tally);
        solves += std::max<std::int64_t>(tally.iterations, 1);
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) tau[at(k)] = 2 * one.lambda[at(k)];
        const double off = solved ? distance(tau, guess) : 1;
        if (!(off <= near)) {
            step = 0.5 * (next - done);
            continue;
        }
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) slope[at(k)] = (tau[at(k)] - accepted[at(k)]) / (next - done);
        accepted = tau;
        done = next;
        if (off <= very_near) step *= 2;
    }
    return true;
}

bool StepBonds::shake(std::int64_t rounds, std::vector<double> &tau) const {
    std::fill(tau.begin(), tau.end(), 0.0);
    std::vector<Vector> shift(at(m_.n_atoms), Vector{0, 0, 0});
    for (std::int64_t round = 0; round < rounds; ++round) {
        double worst = 0;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
            const double w_i = m_.w(m_.i(k)), w_j = m_.w(m_.j(k)), a = m_.length(k);
            const Vector &b = b_[at(k)];
            Vector &i = shift[at(m_.i(k))], &j = shift[at(m_.j(k))];
            const Vector D = {D_[at(k)].x + j.x - i.x, D_[at(k)].y + j.y - i.y, D_[at(k)].z + j.z - i.z};
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
