#include "core/reference.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/run/bond_words.hpp"
#include "core/run/lane.hpp"
#include "core/run/thread_memory.hpp"

namespace holonomic {

namespace {

// Of the length of a bond: by so much the vectors of a cycle may miss each other. The last one is what the others
// leave.
constexpr double most_open = 1e-3;

Error of_bond(const Chains &chains, const Molecule &m, std::int64_t k, Status status, const char *what) {
    Error error = make_error(status, "molecule %s: the reference vector of %s %s; nothing was changed",
                             chains.name_of_molecule(m.number).text, name_of_bond(chains, m, k).text, what);
    error.chain = m.number;
    error.bond = k;
    error.n_bad = 1;
    error.base = chains.base;
    return error;
}

}  // namespace

template <class Place>
void Reference::lay_out(const Molecule &m, const AtomArray &to, const Place &place) const {
    double at[3] = {0, 0, 0}, other[3], d[3];
    const auto vector_of = [&](std::int64_t k) {
        read_atom(bonds_, m.bond(k), d);
        if (chains_.is_backwards(m.bond(k)))
            for (double &component : d) component = -component;
        if (!std::isfinite(d[0] + d[1] + d[2])) throw of_bond(chains_, m, k, Status::not_finite, "is not finite");
    };
    write_atom(to, place(m.shape ? m.shape->start() : 0), at);
    if (!m.shape) {
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            vector_of(k);
            for (int c = 0; c < 3; ++c) at[c] += d[c];
            write_atom(to, place(k + 1), at);
        }
        return;
    }
    m.shape->walk([&](std::int64_t k, bool back) {
        const std::int64_t from = back ? m.j(k) : m.i(k), end = back ? m.i(k) : m.j(k);
        vector_of(k);
        read_atom(to, place(from), at);
        for (int c = 0; c < 3; ++c) at[c] = back ? at[c] - d[c] : at[c] + d[c];
        write_atom(to, place(end), at);
    });
    if (m.n_bonds < m.n_atoms) return;
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        vector_of(k);
        read_atom(to, place(m.i(k)), at);
        read_atom(to, place(m.j(k)), other);
        double open[3], gap = 0, size = 0;
        for (int c = 0; c < 3; ++c) {
            open[c] = other[c] - at[c] - d[c];
            size = std::max(size, std::fabs(d[c]));
        }
        const auto is_open = [&] {
            gap = std::max({std::fabs(open[0]), std::fabs(open[1]), std::fabs(open[2])});
            return gap > most_open * size;
        };
        if (!is_open()) continue;
        minimum_image(chains_.box_of_reference(), open);  // of a cycle round the box
        if (is_open()) throw of_bond(chains_, m, k, Status::degenerate, "does not close its cycle with the others");
        winds_ = true;
    }
}

Reference::Reference(const Chains &chains, const AtomArray &bonds) : chains_(chains), bonds_(bonds) {
    const Plan &plan = chains.plan();
    const std::int64_t n_atoms = chains.n_atoms(), n_staged = static_cast<std::int64_t>(plan.stage.size());
    double *const memory = static_cast<double *>(
        thread_memory(Keep::reference, 3 * static_cast<std::int64_t>(sizeof(double)) * (n_atoms + n_staged)));
    if (!memory && n_atoms + n_staged > 0) throw std::bad_alloc();
    atoms_ = packed_array(memory);
    staged_ = packed_array(memory + 3 * n_atoms);
    if (!bonds.z)
        for (AtomArray *array : {&atoms_, &staged_}) {
            array->z = nullptr;
            array->packed = false;
        }
    for (const Plan::Chunk &chunk : plan.chunks) {
        const AtomArray &to = chunk.where & holonomic::staged ? staged_ : atoms_;
        const auto take = [&](const auto &lane, std::int64_t number) {
            lay_out(chains.molecule(number), to, [&](std::int64_t i) { return atom_of(lane, i); });
        };
        if (chunk.shape == linear) {
            Lane first;
            const Unit unit = chains.unit(plan, chunk, &first);
            for (std::int64_t i = 0; i < unit.count; ++i) {
                const Lane lane = lane_of(unit, i);
                take(lane, lane.chain);
            }
        } else {
            MoleculeLane first;
            const MoleculeUnit unit = chains.unit(plan, chunk, &first);
            for (std::int64_t i = 0; i < unit.count; ++i) {
                const MoleculeLane lane = lane_of(unit, i);
                take(lane, lane.molecule);
            }
        }
    }
}

void Reference::show(std::int64_t number) const {
    const Molecule m = chains_.molecule(number);
    lay_out(m, atoms_, [&](std::int64_t i) { return m.atom(i); });
}

}  // namespace holonomic
