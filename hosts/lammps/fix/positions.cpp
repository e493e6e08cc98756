// SPDX-License-Identifier: GPL-2.0-only
// Who owns what, and the positions: from the atoms of all ranks to whole molecules and back.
#include <algorithm>
#include <cmath>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "fix_holonomic.h"
#include "input.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;
using namespace std::string_literals;
using namespace holonomic_lammps;

bool FixHolonomic::reruns() const { return CommandName::of(input) == "rerun"s; }

double FixHolonomic::mass_of(int i) const {
    if (fixed_bit_ && atom->mask[i] & fixed_bit_) return 0;
    return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
}

void FixHolonomic::pre_neighbor() {
    guarded([&] {
        replan(false);
        make_whole();
    });
}

/** Plans, and puts positions that come from a file onto the constraints before the first forces are computed. */
void FixHolonomic::setup_pre_neighbor() {
    guarded([&] {
        replan(true);
        make_whole();
        if (reruns()) return;
        before_ = now_;
        packed_->positions(before_.data(), now_.data(), 1.0);
        double moved = return_positions(0);
        MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_DOUBLE, MPI_MAX, world);
        if (moved > 0) comm->forward_comm();
    });
}

void FixHolonomic::replan(bool fresh) {
    const std::vector<Membership> members(atoms_.begin(), atoms_.begin() + atom->nlocal);
    const std::vector<Tag> tags(atom->tag, atom->tag + atom->nlocal);
    int changed = plan_->renew(registry_, members.data(), tags.data(), atom->nlocal) || fresh;
    MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, world);
    if (!changed) return;
    take_masses();
    packed_ = std::make_unique<Packed>(*plan_, masses_.data());
    for (std::vector<double> *array : {&now_, &before_, &velocities_, &projected_, &forces_, &reactions_})
        array->assign(3 * static_cast<std::size_t>(plan_->n_slots()), 0.0);
    tensions_.assign(packed_->n_bonds(), 0.0);
    walks_.clear();
    for (const Shape &shape : plan_->shapes()) walks_.push_back(walk(shape));
}

void FixHolonomic::take_masses() {
    masses_.resize(plan_->n_slots());
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (plan_->atoms()[slot] >= 0) masses_[slot] = mass_of(plan_->atoms()[slot]);
    plan_->exchange.to_homes<1>(
        world, [&](int i, double *mass) { *mass = mass_of(i); },
        [&](int slot, const double *mass) { masses_[slot] = *mass; });
}

/** Which image of each atom makes its molecule whole, seen from the atom at place 0; bonds are shorter than half a box.
 */
void FixHolonomic::make_whole() {
    shifted_.clear();
    collect_positions();
    for (const Resident &resident : plan_->residents())
        for (const auto &step : walks_[resident.shape]) {
            double *to = &now_[3 * (resident.first + step[0])];
            const double *from = &now_[3 * (resident.first + step[1])];
            const double d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
            const Shifts images = nearest_image(d);
            if (images == Shifts{0, 0, 0}) continue;
            shifted_.push_back({resident.first + step[0], images});
            const Vector shift = image_vector(images);
            for (int c = 0; c < 3; ++c) to[c] += shift[c];
        }
}

FixHolonomic::Vector FixHolonomic::image_vector(const Shifts &n) const {
    const double *h = domain->h;
    return {n[0] * h[0] + n[1] * h[5] + n[2] * h[4], n[1] * h[1] + n[2] * h[3], n[2] * h[2]};
}

/** How many box vectors to add to d to make it short. */
FixHolonomic::Shifts FixHolonomic::nearest_image(const double *d) const {
    const double *h = domain->h;
    Shifts n{0, 0, 0};
    if (domain->zperiodic) n[2] = -static_cast<int>(std::lround(d[2] / h[2]));
    const double y = d[1] + n[2] * h[3];
    if (domain->yperiodic) n[1] = -static_cast<int>(std::lround(y / h[1]));
    const double x = d[0] + n[2] * h[4] + n[1] * h[5];
    if (domain->xperiodic) n[0] = -static_cast<int>(std::lround(x / h[0]));
    return n;
}

void FixHolonomic::add_images(std::vector<double> &positions, int sign) {
    for (const Shifted &shifted : shifted_) {
        const Vector shift = image_vector(shifted.images);
        for (int c = 0; c < 3; ++c) positions[3 * shifted.slot + c] += sign * shift[c];
    }
}

void FixHolonomic::collect_positions() {
    double **x = atom->x;
    const int *atoms = plan_->atoms().data();
    const int n_slots = plan_->n_slots();
    for (int slot = 0; slot < n_slots; ++slot) {
        if (atoms[slot] < 0) continue;
        const double *from = x[atoms[slot]];
        double *to = &now_[3 * slot];
        to[0] = from[0], to[1] = from[1], to[2] = from[2];
    }
    plan_->exchange.to_homes<3>(
        world, [&](int i, double *r) { std::copy(x[i], x[i] + 3, r); },
        [&](int slot, const double *r) { std::copy(r, r + 3, &now_[3 * slot]); });
    add_images(now_, 1);
}

/** Positions as they are now go back to the atoms, whose velocities get what they have moved; gives the largest move.
 */
double FixHolonomic::return_positions(double inverse_time) {
    double **x = atom->x, **v = atom->v;
    double largest = 0;
    const auto place = [&](int i, const double *r) {
        for (int c = 0; c < 3; ++c) {
            const double moved = r[c] - x[i][c];
            v[i][c] += inverse_time * moved;
            x[i][c] = r[c];
            largest = std::max(largest, std::fabs(moved));
        }
    };
    std::vector<Vector> whole;
    for (const Shifted &shifted : shifted_) {
        const double *r = &now_[3 * shifted.slot];
        whole.push_back({r[0], r[1], r[2]});
    }
    add_images(now_, -1);
    const int *atoms = plan_->atoms().data();
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (atoms[slot] >= 0) place(atoms[slot], &now_[3 * slot]);
    plan_->exchange.to_owners<3>(
        world, [&](int slot, double *r) { std::copy(&now_[3 * slot], &now_[3 * slot] + 3, r); }, place);
    for (std::size_t k = 0; k < whole.size(); ++k)
        std::copy(whole[k].begin(), whole[k].end(), &now_[3 * shifted_[k].slot]);
    return largest;
}

void FixHolonomic::post_integrate() {
    guarded([&] {
        before_.swap(now_);
        collect_positions();
        packed_->positions(before_.data(), now_.data(), update->dt);
        return_positions(1 / update->dt);
    });
}
