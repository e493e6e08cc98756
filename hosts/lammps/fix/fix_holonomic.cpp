// SPDX-License-Identifier: GPL-2.0-only
// The fix as LAMMPS sees it: its command, its molecules, and what it keeps of each atom.
#include "fix_holonomic.h"

#include <cstring>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;
using namespace std::string_literals;
using namespace FixConst;
using namespace holonomic_lammps;

FixHolonomic::FixHolonomic(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), selection_(lmp) {
    if (!atom->tag_enable) error->all(FLERR, "Fix holonomic: atoms must have IDs"s);
    if (atom->molecular == Atom::TEMPLATE)
        error->all(FLERR, "Fix holonomic: the atom style must have bonds of its own, not from molecule templates"s);
    read_options(narg, arg, selection_.read(narg, arg, 3));
    if (selection_.empty())
        error->all(FLERR, "Illegal fix holonomic command: nothing is selected (b, t, m, rigid or bodies)"s);

    virial_global_flag = virial_peratom_flag = 1;
    thermo_virial = 1;
    create_attribute = 1;
    dof_flag = 1;
    stores_ids = 1;
    restart_global = 1;
    scalar_flag = vector_flag = 1;
    size_vector = 6;
    global_freq = 1;
    extscalar = extvector = 0;
    maxexchange = 7;
    if (forces_every_ > 0) {
        peratom_flag = 1;
        size_peratom_cols = 3;
        peratom_freq = forces_every_;
    }
    if (tensions_every_ > 0) {
        local_flag = 1;
        size_local_cols = 4;
        size_local_rows = 0;
        local_freq = tensions_every_;
    }
    grow_arrays(atom->nmax);
    atom->add_callback(on_grow);
    for (int i = 0; i < atom->nlocal; ++i) set_arrays(i);
    plan_ = std::make_unique<Plan>(world);
    divided_ = std::make_unique<Divided>(world);
    find_molecules();
    if (registry_.n_molecules() == 0)
        error->all(FLERR, "Fix holonomic: no bond is selected, and no molecule looks like a template"s);
    if (comm->me == 0)
        utils::logmesg(lmp, "Fix holonomic: " + std::to_string(registry_.n_molecules()) + " molecules, " +
                                std::to_string(registry_.n_atoms()) + " atoms, " + std::to_string(registry_.n_bonds()) +
                                " rigid distances, " + std::to_string(registry_.n_bodies()) + " bodies, " +
                                std::to_string(registry_.n_divided()) + " molecules divided (library holonomic " +
                                hol_version() + ", " + hol_instruction_set() + ")\n");
}

FixHolonomic::~FixHolonomic() {
    if (modify->find_fix(id) >= 0) atom->delete_callback(id, on_grow);
    selection_.release(atoms_);
    memory->destroy(array_atom);
    memory->destroy(array_local);
}

static bool is_keyword(const char *word) {
    for (const char *keyword : {"fixed", "forces", "tensions", "divide", "rigid", "bodies", "tolerance"})
        if (strcmp(word, keyword) == 0) return true;
    return false;
}

void FixHolonomic::read_options(int narg, char **arg, int first) {
    for (int k = first; k < narg; k += 2) {
        if (strcmp(arg[k], "rigid") == 0 && (k + 1 == narg || is_keyword(arg[k + 1]))) {
            selection_.bodies.take_as_they_stand();
            --k;
            continue;
        }
        if (k + 1 >= narg) error->all(FLERR, std::string("Fix holonomic: keyword ") + arg[k] + " needs a value");
        if (strcmp(arg[k], "fixed") == 0) {
            const int number = group->find(arg[k + 1]);
            if (number < 0) error->all(FLERR, std::string("Fix holonomic: there is no group ") + arg[k + 1]);
            fixed_bit_ = group->bitmask[number];
        } else if (strcmp(arg[k], "forces") == 0 || strcmp(arg[k], "tensions") == 0) {
            int &every = arg[k][0] == 'f' ? forces_every_ : tensions_every_;
            every = utils::inumeric(FLERR, arg[k + 1], false, lmp);
            if (every < 0)
                error->all(FLERR, std::string("Fix holonomic: ") + arg[k] + " needs a number of steps, or 0");
        } else if (strcmp(arg[k], "divide") == 0) {
            divide_ = utils::inumeric(FLERR, arg[k + 1], false, lmp);
            if (divide_ < 0) error->all(FLERR, "Fix holonomic: divide needs a number of atoms, or 0"s);
        } else if (strcmp(arg[k], "tolerance") == 0) {
            tolerance_ = utils::numeric(FLERR, arg[k + 1], false, lmp);
            if (!(tolerance_ >= 0 && tolerance_ <= 0.01))
                error->all(FLERR, "Fix holonomic: tolerance needs a part of a length, from 0 to 0.01"s);
        } else if (strcmp(arg[k], "bodies") == 0) {
            guarded([&] { selection_.bodies.add_list(arg[k + 1]); });
        } else if (strcmp(arg[k], "rigid") == 0) {
            guarded([&] { selection_.bodies.add_file(arg[k + 1]); });
        } else {
            error->all(FLERR, std::string("Illegal fix holonomic command: no keyword ") + arg[k]);
        }
    }
}

int FixHolonomic::setmask() {
    return PRE_NEIGHBOR | POST_INTEGRATE | POST_FORCE | MIN_PRE_NEIGHBOR | MIN_PRE_FORCE | MIN_POST_FORCE;
}

void FixHolonomic::init() {
    if (!minimises() && utils::strmatch(update->integrate_style, "^respa"))
        error->all(FLERR,
                   "Fix holonomic can't be used with run_style respa: the multipliers of a step belong to one set of "
                   "forces"s);
    check_other_fixes();
    find_molecules();
}

/** Forces of fixes behind this one would not be seen by it; two fixes must not move the same atoms. */
void FixHolonomic::check_other_fixes() {
    int me = 0;
    while (modify->fix[me] != this) ++me;
    for (int k = me + 1; k < modify->nfix; ++k)
        if (modify->fmask[k] & POST_FORCE && !utils::strmatch(modify->fix[k]->style, "^holonomic") && comm->me == 0)
            error->warning(FLERR, std::string("Fix ") + modify->fix[k]->id + " (" + modify->fix[k]->style +
                                      ") stands behind fix " + id + " (holonomic), which does not see its forces");
    for (int k = 0; k < me; ++k) {
        if (!utils::strmatch(modify->fix[k]->style, "^holonomic")) continue;
        const auto *other = static_cast<FixHolonomic *>(modify->fix[k]);
        for (int i = 0; i < atom->nlocal; ++i)
            if (other->atoms_[i].molecule && atoms_[i].molecule)
                error->one(FLERR, "Atom " + std::to_string(atom->tag[i]) + " belongs to fix " + other->id +
                                      " and to fix " + id +
                                      ": one fix holonomic has to have all rigid bonds of a molecule");
    }
    for (int k = 0; k < modify->nfix; ++k) {
        const char *style = modify->fix[k]->style;
        if (!utils::strmatch(style, "^shake") && !utils::strmatch(style, "^rattle") &&
            !utils::strmatch(style, "^ilves"))
            continue;
        const Tag shared = selection_.held_elsewhere(atoms_);
        if (shared && comm->me == 0)
            error->warning(FLERR, "Fix " + std::string(modify->fix[k]->id) + " (" + style +
                                      ") holds bonds of atoms of fix " + id + " (holonomic), atom " +
                                      std::to_string(shared) +
                                      " for one: each spoils what the other has done; let fix holonomic hold them all");
        break;
    }
    std::vector<int> rigid(atom->nlocal);
    for (int i = 0; i < atom->nlocal; ++i) rigid[i] = atoms_[i].molecule != 0;
    if (modify->check_rigid_list_overlap(rigid.data()))
        error->all(FLERR, "Fix holonomic: atoms of its molecules belong to a rigid body of another fix"s);
}

// ------------------------------------------------------------------------------------------------ what goes with atoms

void FixHolonomic::grow_arrays(int n) {
    atoms_.resize(n);
    if (forces_every_ > 0) memory->grow(array_atom, n, 3, "holonomic:array_atom");
}

void FixHolonomic::copy_arrays(int i, int j, int) { atoms_[j] = atoms_[i]; }

void FixHolonomic::set_arrays(int i) {
    atoms_[i] = Belonging();
    if (forces_every_ > 0) array_atom[i][0] = array_atom[i][1] = array_atom[i][2] = 0;
}

int FixHolonomic::pack_exchange(int i, double *buffer) {
    const Belonging &a = atoms_[i];
    const double numbers[7] = {
        static_cast<double>(a.molecule), static_cast<double>(a.place),  static_cast<double>(a.n_atoms), a.taken,
        static_cast<double>(a.bonds),    static_cast<double>(a.angles), static_cast<double>(a.topology)};
    memcpy(buffer, numbers, sizeof numbers);
    return 7;
}

int FixHolonomic::unpack_exchange(int i, double *buffer) {
    Belonging &a = atoms_[i];
    a.molecule = static_cast<Tag>(buffer[0]);
    a.place = static_cast<int>(buffer[1]);
    a.n_atoms = static_cast<int>(buffer[2]);
    a.taken = buffer[3];
    a.bonds = static_cast<std::uint32_t>(buffer[4]);
    a.angles = static_cast<std::uint32_t>(buffer[5]);
    a.topology = static_cast<std::uint32_t>(buffer[6]);
    return 7;
}

/** The box's rate of change, without which velocities under a barostat would not be those of an unbroken run. */
void FixHolonomic::write_restart(FILE *file) {
    if (comm->me != 0) return;
    double state[18];
    std::copy(rate_, rate_ + 6, state);
    std::copy(step_rate_, step_rate_ + 6, state + 6);
    std::copy(last_box_, last_box_ + 6, state + 12);
    const int size = sizeof state;
    fwrite(&size, sizeof size, 1, file);
    fwrite(state, sizeof state, 1, file);
}

void FixHolonomic::restart(char *buffer) {
    double state[18];
    memcpy(state, buffer, sizeof state);
    std::copy(state, state + 6, rate_);
    std::copy(state + 6, state + 12, step_rate_);
    std::copy(state + 12, state + 18, last_box_);
}
