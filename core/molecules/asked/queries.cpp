// What a set of molecules tells about itself.
#include <algorithm>

#include "core/index.hpp"
#include "core/molecules/chains.hpp"
#include "core/rigid/bodies.hpp"

namespace holonomic {

std::int64_t Chains::n_molecules() const { return n_chains() + (bodies_ ? bodies_->n_molecules() : 0); }

bool Chains::is_active(std::int64_t molecule) const { return active_.empty() || active_[at(molecule)] != 0; }

void Chains::place_molecule(const Group &group, std::int64_t index, Molecule &m) const {
    m.number = group.first_molecule + index;
    m.atom_list = groups_.atoms(group, index, m.n_atoms);
    m.first_atom = m.atom_list ? m.atom_list[0] : group.first_atom + index * m.n_atoms;
    const std::int64_t bonds = group.first_bond + index * m.n_bonds;
    m.bond_list = group.reordered ? groups_.reordered().data() + bonds : nullptr;
    m.first_bond = m.bond_list ? m.bond_list[0] : bonds;
}

Molecule Chains::molecule_of(const Group &group, std::int64_t index) const {
    const Kind &kind = kind_of(group);
    Molecule m;
    m.n_atoms = kind.n_atoms();
    m.n_bonds = kind.n_bonds;
    m.shape = kind.shape == linear ? nullptr : &shapes_[kind.shape];
    m.w_table = kinds_.w(kind);
    m.length_table = kinds_.length(kind);
    m.w_uniform = kind.w_uniform;
    m.length_uniform = kind.length_uniform;
    place_molecule(group, index, m);
    return m;
}

Molecule Chains::molecule(std::int64_t molecule) const {
    const Group &group = groups_.of_molecule(molecule);
    return molecule_of(group, molecule - group.first_molecule);
}

int Chains::topology_of(std::int64_t number) const {
    return number < n_chains() ? static_cast<int>(molecule(number).topology()) : topology_with_bodies;
}

std::int64_t Chains::n_kinds() const { return kinds_.size() + (bodies_ ? bodies_->n_kinds() : 0); }

std::int64_t Chains::n_of_topology(int topology) const {
    if (topology == topology_with_bodies) return bodies_ ? bodies_->n_molecules() : 0;
    std::int64_t n = 0;
    for (const Group &group : groups_.all()) {
        const std::int32_t shape = kind_of(group).shape;
        const Topology its = shape == linear ? Topology::chain : shapes_[shape].topology;
        if (static_cast<int>(its) == topology) n += group.count;
    }
    return n;
}

void Chains::offsets(std::int64_t *out) const {
    if (bodies_)
        throw make_error(Status::value,
                         "molecules with rigid bodies have their bonds in any order: hol_chains_bonds tells where they "
                         "stand");
    std::int64_t next = 0;
    for (const Group &group : groups_.all()) {
        if (group.reordered || group.first_bond != next) {
            Error error =
                make_error(Status::value,
                           "the bonds of molecule %s do not follow those of the molecule before in the arrays "
                           "per bond: hol_chains_bonds tells where they stand",
                           name_of_molecule(group.first_molecule).text);
            error.chain = group.first_molecule;
            error.base = base;
            throw error;
        }
        next += group.count * kind_of(group).n_bonds;
    }
    if (next != n_bonds_)
        throw make_error(Status::value,
                         "the last bonds join fixed atoms and are in no molecule: hol_chains_bonds tells "
                         "where the others stand");
    std::int64_t molecule = 0;
    for (const Group &group : groups_.all())
        for (std::int64_t c = 0; c < group.count; ++c)
            out[molecule++] = base + group.first_bond + c * kind_of(group).n_bonds;
    out[molecule] = base + n_bonds_;
}

std::int64_t Chains::count_atoms(std::int64_t number) const {
    if (number >= n_chains()) return bodies_->kind(number - n_chains()).n_atoms;
    const Molecule m = molecule(number);
    if (!m.shape) return m.n_atoms;
    std::int64_t n = 1;
    for (std::int64_t i = 1; i < m.n_atoms; ++i) n += m.atom(i) != m.atom(i - 1);
    return n;
}

void Chains::atoms(std::int64_t number, std::int64_t *out) const {
    if (number >= n_chains()) {
        const std::int64_t *const list = bodies_->atoms(number - n_chains());
        std::transform(list, list + count_atoms(number), out, [this](std::int64_t atom) { return base + atom; });
        std::sort(out, out + count_atoms(number));
        return;
    }
    const Molecule m = molecule(number);
    for (std::int64_t i = 0; i < m.n_atoms; ++i)
        if (i == 0 || !m.shape || m.atom(i) != m.atom(i - 1)) *out++ = base + m.atom(i);
}

std::int64_t Chains::count_bonds(std::int64_t number) const {
    if (number < n_chains()) return molecule(number).n_bonds;
    return static_cast<std::int64_t>(bodies_->kind(number - n_chains()).bonds.size());
}

void Chains::bonds(std::int64_t number, std::int64_t *out) const {
    if (number >= n_chains()) {
        const std::int64_t *const list = bodies_->bonds(number - n_chains());
        std::transform(list, list + count_bonds(number), out, [this](std::int64_t bond) { return base + bond; });
        return;
    }
    const Molecule m = molecule(number);
    for (std::int64_t k = 0; k < m.n_bonds; ++k) out[k] = base + m.bond(k);
}

void Chains::molecules_of_bonds(std::int64_t *out) const {
    for (const Group &group : groups_.all()) {
        const std::int64_t n_bonds = kind_of(group).n_bonds;
        for (std::int64_t k = 0; k < group.count * n_bonds; ++k)
            out[groups_.bond(group, group.first_bond + k)] = base + group.first_molecule + k / n_bonds;
    }
    for (const std::int64_t bond : unconstrained_) out[bond] = -1;
    for (std::int64_t m = 0; bodies_ && m < bodies_->n_molecules(); ++m) {
        const std::int64_t number = n_chains() + m, *const list = bodies_->bonds(m);
        for (std::int64_t k = 0; k < count_bonds(number); ++k) out[list[k]] = base + number;
    }
}

// Calls each(bond, i, j, length, role) for all bonds; those of molecules as they were given, of molecules with bodies
// from the lower atom.
template <class Each>
void Chains::for_bonds(const Each &each) const {
    for (std::int64_t number = 0; number < n_chains(); ++number) {
        const Molecule m = molecule(number);
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            const bool back = is_backwards(m.bond(k));
            each(m.bond(k), m.atom(back ? m.j(k) : m.i(k)), m.atom(back ? m.i(k) : m.j(k)), m.length(k), Role::own);
        }
    }
    for (std::size_t k = 0; k < unconstrained_.size(); ++k) {
        const LeftOut &given = of_unconstrained_[k];
        const bool implied = std::binary_search(implied_.begin(), implied_.end(), unconstrained_[k]);
        each(unconstrained_[k], given.atoms[0], given.atoms[1], given.length, implied ? Role::implied : Role::fixed);
    }
    for (std::int64_t m = 0; bodies_ && m < bodies_->n_molecules(); ++m) {
        const std::int64_t *const atom = bodies_->atoms(m), *number = bodies_->bonds(m);
        for (const rigid::Bond &bond : bodies_->kind(m).bonds)
            each(*number++, atom[bond.i], atom[bond.j], bond.length, bond.row < 0 ? Role::body : Role::own);
    }
}

void Chains::pairs(std::int64_t *out) const {
    for_bonds([&](std::int64_t bond, std::int64_t i, std::int64_t j, double, Role) {
        out[2 * bond] = i + base;
        out[2 * bond + 1] = j + base;
    });
}

void Chains::lengths(double *out) const {
    for_bonds([&](std::int64_t bond, std::int64_t, std::int64_t, double length, Role) { out[bond] = length; });
}

void Chains::active(unsigned char *out) const {
    for (std::int64_t m = 0; m < n_chains(); ++m) *out++ = is_active(m) ? 1 : 0;
    for (std::int64_t m = 0; bodies_ && m < bodies_->n_molecules(); ++m) *out++ = bodies_->is_active(m) ? 1 : 0;
}

void Chains::roles(std::int32_t *role, std::int64_t *n_removed) const {
    if (role)
        for_bonds([&](std::int64_t bond, std::int64_t, std::int64_t, double, Role its) {
            role[bond] = static_cast<std::int32_t>(its);
        });
    if (!n_removed) return;
    for (std::int64_t m = 0; m < n_chains(); ++m) n_removed[m] = count_bonds(m);
    for (std::int64_t m = n_chains(); m < n_molecules(); ++m) n_removed[m] = bodies_->constraints(m - n_chains(), 3);
}

std::int64_t Chains::degrees_of_freedom(int dimensions) const {
    std::int64_t constraints = 0;
    for (const Group &group : groups_.all()) {
        std::int64_t active = group.count;
        if (!active_.empty()) {
            active = 0;
            for (std::int64_t c = 0; c < group.count; ++c) active += is_active(group.first_molecule + c);
        }
        constraints += active * kind_of(group).n_bonds;
    }
    if (bodies_) constraints += bodies_->constraints(dimensions);
    return dimensions * masses_.n_movable() - constraints;
}

Name Chains::name_of_molecule(std::int64_t number) const {
    return labels_.of_molecule(number, molecule(number).atom(0), base);
}

std::int64_t Chains::memory() const {
    const Plan *const plan = plan_.there(), *const of_parts = plan_of_parts_.there();
    return static_cast<std::int64_t>(sizeof *this + masses_.bytes() + use_.bytes() + kinds_.bytes() + shapes_.bytes() +
                                     groups_.bytes() + unconstrained_.capacity() * sizeof(std::int64_t) +
                                     of_unconstrained_.capacity() * sizeof(LeftOut) + active_.capacity() +
                                     backwards_.capacity()) +
           labels_.bytes() + (bodies_ ? bodies_->bytes() : 0) + (plan ? plan->bytes() : 0) +
           (of_parts ? of_parts->bytes() : 0);
}

}  // namespace holonomic
