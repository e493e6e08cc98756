#include "core/long_step/one_molecule.hpp"

#include <new>

#include "core/index.hpp"
#include "core/kernels/atom.hpp"
#include "core/run/execute.hpp"
#include "core/run/thread_memory.hpp"

namespace holonomic {

OneMolecule::OneMolecule(const Chains &chains, const Planned &planned, const Molecule &molecule)
    : lambda(at(molecule.n_bonds), 0.0), chains_(chains), planned_(planned), m_(molecule) {}

void OneMolecule::copy(const AtomArray &from, Array &to) {
    to.atoms = AtomArray{};
    if (!from.x) return;
    to.memory.resize(3 * at(m_.n_atoms));
    char *const x = reinterpret_cast<char *>(to.memory.data());
    const std::int64_t size = from.is_float ? sizeof(float) : sizeof(double);
    to.atoms = {x, x + size, from.z ? x + 2 * size : nullptr, 3 * size, from.is_float, from.packed};
    for (std::int64_t i = 0; i < m_.n_atoms; ++i) {
        double atom[3];
        read_atom(from, m_.atom(i), atom);
        write_atom(to.atoms, i, atom);
    }
}

void OneMolecule::read(const PositionsCall &call) {
    in_place_ = call.r_ref.x == call.r.x;
    copy(call.r_ref, r_ref_);
    copy(call.r, r_);
    copy(call.v, v_);
}

void OneMolecule::write(const PositionsCall &call) const {
    for (std::int64_t i = 0; i < m_.n_atoms; ++i) {
        if (m_.w(i) == 0) continue;
        double x[3];
        read_atom(r_.atoms, i, x);
        write_atom(call.r, m_.atom(i), x);
        if (!call.v.x) continue;
        read_atom(v_.atoms, i, x);
        write_atom(call.v, m_.atom(i), x);
    }
    for (std::int64_t k = 0; call.lambda && k < m_.n_bonds; ++k) call.lambda[m_.bond(k)] = lambda[at(k)];
}

bool OneMolecule::solve(PositionsCall call, Tally &tally) {
    call.r_ref = in_place_ ? r_.atoms : r_ref_.atoms;
    call.r = r_.atoms;
    call.v = v_.atoms;
    call.lambda = lambda.data();
    const std::int64_t bytes = chains_.plan().scratch_bytes;
    Tally own = empty_tally();
    if (!planned_.chain) {
        MoleculeLane lane = *planned_.molecule;
        lane.first_atom = lane.first_bond = 0;
        lane.atoms = lane.bonds = nullptr;
        lane.shared = nullptr;
        const MoleculeUnit unit{planned_.elimination,  &lane, 1, true, false, nullptr, planned_.batch,
                                planned_.batch ? 1 : 0};
        kernels().molecules.positions(call, unit, scratch_of_this_thread(bytes), own);
    } else {
        Lane lane = *planned_.chain;
        lane.first_atom = lane.first_bond = 0;
        lane.atoms = nullptr;
        for (std::int64_t i = 0; i < 4; ++i) lane.element[i] = 3 * i;
        const Unit unit{&lane, 1, true, false};
        if (lane.n_bonds <= longest_lane) {
            kernels(unit).positions(call, unit, scratch_of_this_thread(bytes), own);
        } else {
            const InWindows<PositionsCall> &windows = kernels().long_positions;
            double *const store = static_cast<double *>(thread_memory(Keep::store, store_bytes(windows, lane.n_bonds)));
            if (!store) throw std::bad_alloc();
            solve_long_chain(windows, kernels_for_one_chain().positions, call, lane, Team(1, bytes), store, own);
        }
    }
    add(tally, own);
    return own.n_bad == 0;
}

}  // namespace holonomic
