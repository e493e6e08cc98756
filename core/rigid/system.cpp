#include "core/rigid/system.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace holonomic::rigid {

namespace {

PairVector zero() { return {as_pair(0), as_pair(0), as_pair(0)}; }
PairVector difference(const double *a, const double *b) {
    return {plain::two_difference(a[0], b[0]), plain::two_difference(a[1], b[1]), plain::two_difference(a[2], b[2])};
}

// Nearest image, without a rounding.
PairVector image(const Box &box, PairVector d) {
    if (box.lattice == Box::none) return d;
    const double v[3] = {d.x.hi, d.y.hi, d.z.hi};
    for (int i = 0; i < 3; ++i) {
        const double n = std::nearbyint(v[0] * box.inverse[i] + v[1] * box.inverse[3 + i] + v[2] * box.inverse[6 + i]);
        if (n == 0) continue;
        d.x = d.x - n * as_pair(box.h[3 * i]);
        d.y = d.y - n * as_pair(box.h[3 * i + 1]);
        d.z = d.z - n * as_pair(box.h[3 * i + 2]);
    }
    return d;
}

double largest(const PairVector &v) {
    return std::max(std::max(std::fabs(v.x.hi), std::fabs(v.y.hi)), std::fabs(v.z.hi));
}

// Carves arrays out of a block of memory, one after the other.
class Carving {
public:
    explicit Carving(char *memory) : next_(memory) {}
    template <class T>
    T *take(std::int64_t n) {
        T *const here = reinterpret_cast<T *>(next_);
        next_ += n * static_cast<std::int64_t>(sizeof(T));
        return here;
    }
    std::int64_t used(const char *memory) const { return next_ - memory; }

private:
    char *next_;
};

}  // namespace

PairVector told_image(const Cell &box, const MoleculeView &view, std::size_t bond) {
    PairVector d = zero();
    for (int i = 0; i < 3; ++i) {
        const double n = view.images[3 * view.bonds[bond] + i];
        d.x = d.x + n * as_pair(box.given[3 * i]);
        d.y = d.y + n * as_pair(box.given[3 * i + 1]);
        d.z = d.z + n * as_pair(box.given[3 * i + 2]);
    }
    return d;
}

std::int64_t System::bytes(const MoleculeKind &kind) {
    alignas(64) static char nowhere[64];
    return System(kind, nullptr, nowhere).bytes_;
}

System::System(const MoleculeKind &kind, const Body *bodies, char *memory) : s_(kind), bodies_(bodies) {
    const std::int64_t entries = static_cast<std::int64_t>(kind.entries.size()),
                       fill = static_cast<std::int64_t>(kind.row.size()),
                       bonds = static_cast<std::int64_t>(kind.bonds.size()), rows = kind.n_rows, nodes = kind.n_nodes;
    Carving carving(memory);
    for (Conformation *which : {&now, &reference}) {
        which->x = carving.take<PairVector>(kind.n_atoms);
        which->q = carving.take<PairVector>(nodes);
        which->shift = carving.take<PairVector>(bonds);
        which->gradient = carving.take<PairVector>(entries);
    }
    a = carving.take<PairVector>(nodes);
    b = carving.take<PairVector>(nodes);
    start_ = carving.take<PairVector>(nodes);
    t = carving.take<DoublePair>(rows);
    c = carving.take<DoublePair>(rows);
    residual_ = carving.take<DoublePair>(rows);
    wide_x_ = carving.take<DoublePair>(rows);
    inverse_ = carving.take<DoublePair>(fill);
    wide_ = {carving.take<DoublePair>(rows), carving.take<DoublePair>(fill), carving.take<DoublePair>(fill), nullptr};
    plain_ = {carving.take<double>(rows), carving.take<double>(fill), carving.take<double>(fill),
              carving.take<double>(rows)};
    wide_.before = plain_.before;
    x_ = carving.take<double>(rows);
    raw = carving.take<double>(3 * std::int64_t{kind.n_atoms});
    gradient_[0] = carving.take<double>(3 * entries);
    gradient_[1] = carving.take<double>(3 * entries);
    path_ = carving.take<double>(3 * rows);
    within = carving.take<double>(kind.by_lengths ? 3 * (bonds + 2 * std::int64_t{kind.n_held}) : 0);
    bytes_ = (carving.used(memory) + 63) / 64 * 64;
}

void System::read(const AtomArray &r, const Cell &box, const MoleculeView &view, const Conformation &to) const {
    for (std::int32_t i = 0; i < s_.n_atoms; ++i) read_atom(r, view.atoms[i], raw + 3 * i);
    // A first atom that is not finite makes all of them so.
    to.x[0] = difference(raw, raw);
    for (const NearestStep &step : s_.steps) {
        const PairVector d = difference(raw + 3 * step.atom, raw + 3 * step.before);
        to.x[step.atom] = to.x[step.before] + (s_.has_images ? d : image(box, d));
    }
    for (const Part &part : s_.parts) {
        const Body &its = body(part);
        PairVector *const q = to.q + part.first_node;
        for (std::int32_t p = 0; p <= its.rank; ++p) q[p] = zero();
        const DoublePair *share = its.share.data();
        for (std::int32_t i = 0; i < its.n_atoms; ++i, share += 1 + its.rank)
            for (std::int32_t p = 0; its.masses[at(i)] > 0 && p <= its.rank; ++p)
                q[p] = q[p] + share[p] * to.x[part.first_atom + i];
    }
    for (std::int32_t i = s_.n_held; i < s_.n_atoms; ++i) to.q[s_.node_of[at(i)]] = to.x[i];
    for (std::size_t k = 0; k < s_.bonds.size(); ++k) {
        const Bond &bond = s_.bonds[k];
        to.shift[k] = zero();
        if (box.lattice == Box::none || bond.row < 0) continue;
        if (s_.has_images) {
            to.shift[k] = told_image(box, view, k);
            continue;
        }
        const PairVector nearest = image(box, difference(raw + 3 * bond.j, raw + 3 * bond.i));
        const PairVector other = nearest - (to.x[bond.j] - to.x[bond.i]);
        if (largest(other) > 1e-6 * bond.length) to.shift[k] = other;
    }
}

PairVector System::bond_vector(const Conformation &where, std::int32_t bond) const {
    return distance(where, s_.bonds[at(bond)].row);
}

PairVector System::distance(const Conformation &where, std::int32_t row) const {
    const std::int32_t bond = s_.bond_of_row[at(row)];
    PairVector d = bond < 0 ? zero() : where.shift[bond];
    for (std::int32_t e = s_.entry_start[at(row)]; e < s_.entry_start[at(row + 1)]; ++e)
        d = d + s_.entries[at(e)].factor * where.q[s_.entries[at(e)].node];
    return d;
}

void System::differentiate(const Conformation &where) const {
    for (std::int32_t k = 0; k < s_.n_rows; ++k) {
        const bool is_distance = s_.is_distance(k);
        const PairVector d = is_distance ? distance(where, k) : zero();
        for (std::int32_t e = s_.entry_start[at(k)]; e < s_.entry_start[at(k + 1)]; ++e) {
            const Entry &entry = s_.entries[at(e)];
            where.gradient[e] = is_distance ? entry.factor * d : where.q[entry.other];
        }
    }
}

void System::velocities(const AtomArray &v, const MoleculeView &view, PairVector *nodes) const {
    for (const Part &part : s_.parts) {
        const Body &its = body(part);
        PairVector *const q = nodes + part.first_node;
        for (std::int32_t p = 0; p <= its.rank; ++p) q[p] = zero();
        const DoublePair *share = its.share.data();
        for (std::int32_t i = 0; i < its.n_atoms; ++i, share += 1 + its.rank) {
            if (!(its.masses[at(i)] > 0)) continue;
            const PairVector of_atom = vector_of_atom(v, view.atoms[part.first_atom + i]);
            for (std::int32_t p = 0; p <= its.rank; ++p) q[p] = q[p] + share[p] * of_atom;
        }
    }
    for (std::int32_t i = s_.n_held; i < s_.n_atoms; ++i) nodes[s_.node_of[at(i)]] = vector_of_atom(v, view.atoms[i]);
}

void System::forces(const Conformation &where, const AtomArray &f, const MoleculeView &view, PairVector *nodes) const {
    for (const Part &part : s_.parts) {
        const Body &its = body(part);
        PairVector *const q = nodes + part.first_node;
        for (std::int32_t p = 0; p <= its.rank; ++p) q[p] = zero();
        for (std::int32_t i = 0; i < its.n_atoms; ++i) {
            const PairVector of_atom = vector_of_atom(f, view.atoms[part.first_atom + i]);
            q[0] = q[0] + (its.first.empty() ? of_atom : its.first[at(i)] * of_atom);
            for (std::int32_t p = 0; p < its.rank; ++p) q[1 + p] = q[1 + p] + its.y[at(i * its.rank + p)] * of_atom;
        }
        if (!its.z.empty()) carry_to_axes(where, part, lifted_force(part, f, view), nodes);
    }
    for (std::int32_t i = s_.n_held; i < s_.n_atoms; ++i)
        nodes[s_.node_of[at(i)]] = i < s_.n_movable ? vector_of_atom(f, view.atoms[i]) : zero();
}

// The virtual work of forces where a fixed atom is shifted; that of the accelerations is 0.
void System::pass_to_fixed(const AtomArray &f, const MoleculeView &view, PairVector *nodes) const {
    for (const Part &part : s_.parts) {
        const Body &its = body(part);
        const std::size_t n_fixed = part.fixed.size();
        for (std::int32_t i = 0; n_fixed > 0 && i < its.n_atoms; ++i) {
            const PairVector of_atom = vector_of_atom(f, view.atoms[part.first_atom + i]);
            for (std::size_t j = 0; j < n_fixed; ++j) {
                PairVector &node = nodes[s_.node_of[at(part.fixed[j])]];
                node = node + its.of_fixed[at(i) * n_fixed + j] * of_atom;
            }
        }
    }
}

PairVector System::at_atom(const PairVector *nodes, std::int32_t atom) const {
    if (atom >= s_.n_held) return nodes[s_.node_of[at(atom)]];
    const Part &part = s_.parts[at(s_.part_of[at(atom)])];
    const Body &its = body(part);
    const DoublePair *const y = its.y.data() + (atom - part.first_atom) * its.rank;
    const std::size_t i = at(atom - part.first_atom), n_fixed = part.fixed.size();
    PairVector sum = nodes[part.first_node];
    if (!its.first.empty()) sum = its.first[i] * sum;
    for (std::int32_t p = 0; p < its.rank; ++p) sum = sum + y[p] * nodes[part.first_node + 1 + p];
    for (std::size_t j = 0; j < n_fixed; ++j)
        sum = sum + its.of_fixed[i * n_fixed + j] * nodes[s_.node_of[at(part.fixed[j])]];
    return sum;
}

double System::residuals(const Conformation &where, DoublePair *to, std::int32_t *worst_bond) const {
    double worst = 0;
    if (worst_bond) *worst_bond = -1;
    for (std::int32_t k = 0; k < s_.n_rows; ++k) {
        const std::int32_t bond = s_.bond_of_row[at(k)];
        DoublePair value;
        bool half = true;
        if (s_.is_distance(k)) {
            const PairVector d = distance(where, k);
            value = dot(d, d) - s_.target[at(k)];
        } else {
            const Entry &entry = s_.entries[at(s_.entry_start[at(k)])];
            value = dot(where.q[entry.node], where.q[entry.other]) - s_.target[at(k)];
            half = entry.node == entry.other;
        }
        const double error = std::fabs(value.hi) / s_.scale[at(k)];
        if (!(error <= worst)) {
            worst = error;  // also if it is no number
            if (worst_bond) *worst_bond = bond;
        }
        to[k] = half ? DoublePair{value.hi / 2, value.lo / 2} : value;
        if (std::isnan(error)) return error;
    }
    return worst;
}

void System::pulls(const Conformation &where, const DoublePair *multipliers, PairVector *nodes) const {
    for (std::int32_t n = 0; n < s_.n_nodes; ++n) nodes[n] = zero();
    for (std::int32_t k = 0; k < s_.n_rows; ++k)
        for (std::int32_t e = s_.entry_start[at(k)]; e < s_.entry_start[at(k + 1)]; ++e) {
            PairVector &node = nodes[s_.entries[at(e)].node];
            node = node - multipliers[k] * where.gradient[e];
        }
}

void System::add_virial(const Conformation &where, const DoublePair *multipliers, double factor, double *virial) const {
    double sum[6] = {0, 0, 0, 0, 0, 0};
    const auto add = [&](double s, const PairVector &p, const PairVector &q) {
        const double u[3] = {rounded(p.x), rounded(p.y), rounded(p.z)},
                     v[3] = {rounded(q.x), rounded(q.y), rounded(q.z)};
        double *to = sum;
        for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) *to++ -= 0.5 * s * (u[i] * v[j] + u[j] * v[i]);
    };
    for (std::int32_t k = 0; k < s_.n_rows; ++k) {
        const double m = factor * rounded(multipliers[k]);
        if (s_.is_distance(k)) {
            const PairVector d = distance(where, k);
            add(m, d, d);
        } else {
            const Entry &entry = s_.entries[at(s_.entry_start[at(k)])];
            add(entry.node == entry.other ? m : 2 * m, where.q[entry.node], where.q[entry.other]);
        }
    }
    for (int i = 0; i < 6; ++i) virial[i] += sum[i];
}

}  // namespace holonomic::rigid
