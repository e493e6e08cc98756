#include "core/run/rescale.hpp"

#include <climits>
#include <cmath>
#include <cstring>
#include <new>

#include "core/caller/box.hpp"
#include "core/kernels/atom.hpp"
#include "core/run/thread_memory.hpp"

namespace holonomic {

namespace {

std::int64_t rounded_up(std::int64_t bytes) { return (bytes + 63) / 64 * 64; }

constexpr std::int64_t room_behind = most_lanes;  // what kernels may read there
constexpr std::int64_t most_atom_arrays = 8, most_value_arrays = 8;

// A NaN that no arithmetic makes: whether a kernel has written a result shows by it.
constexpr std::uint64_t unwritten = 0x7ff8600dcafe5a19u;

double unwritten_value() {
    double value;
    std::memcpy(&value, &unwritten, sizeof value);
    return value;
}

std::uint64_t bits_of(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}
bool same_bits(double a, double b) { return bits_of(a) == bits_of(b); }

bool overflows(double value, int e, bool is_float) {
    const double scaled = std::scalbn(value, e);
    return std::isfinite(value) ? !std::isfinite(is_float ? static_cast<float>(scaled) : scaled) : true;
}

}  // namespace

KernelMolecule::KernelMolecule(const Lane &lane)
    : n_atoms(lane.n_bonds + 1), n_bonds(lane.n_bonds), first_atom(lane.first_atom), atoms(lane.atoms), w(lane.w),
      length(lane.length), w_uniform(lane.w_uniform), length_uniform(lane.length_uniform), first_bond(lane.first_bond),
      bonds(nullptr), shared(nullptr), elimination(nullptr), number(lane.chain) {}

KernelMolecule::KernelMolecule(const EliminationPlan &s, const MoleculeLane &lane)
    : n_atoms(s.n_atoms), n_bonds(s.n_bonds), first_atom(lane.first_atom), atoms(lane.atoms), w(lane.w),
      length(lane.length), w_uniform(0), length_uniform(0), first_bond(lane.first_bond), bonds(lane.bonds),
      shared(lane.shared), elimination(&s), number(lane.molecule) {}

Rescaled::Rescaled(const KernelMolecule &molecule, const Powers &of) : units(of), one_(molecule) {
    const std::int64_t atoms = rounded_up(8 * (3 * one_.n_atoms + 3 * room_behind)),
                       values = rounded_up(8 * (std::max(one_.n_atoms, one_.n_bonds) + room_behind));
    memory_ = static_cast<char *>(thread_memory(Keep::rescaled, most_atom_arrays * atoms + most_value_arrays * values));
    if (!memory_) throw std::bad_alloc();
    if (one_.w) {
        w_ = take(one_.n_atoms);
        for (std::int64_t i = 0; i < one_.n_atoms; ++i) w_[i] = std::scalbn(one_.w[i], units.mass);
    }
    if (one_.length) {
        length_ = take(one_.n_bonds);
        for (std::int64_t k = 0; k < one_.n_bonds; ++k) length_[k] = std::scalbn(one_.length[k], -units.length);
    }
}

double *Rescaled::take(std::int64_t n) {
    double *const values = reinterpret_cast<double *>(memory_);
    memory_ += rounded_up(8 * (n + room_behind));
    for (std::int64_t i = n; i < n + room_behind; ++i) values[i] = 1;
    return values;
}

AtomArray Rescaled::copy_of(const AtomArray &callers, int e, bool read) {
    const std::int64_t size = callers.is_float ? sizeof(float) : sizeof(double);
    AtomArray copy{memory_,  memory_ + size,   callers.z ? memory_ + 2 * size : nullptr,
                   3 * size, callers.is_float, callers.packed};
    std::memset(memory_ + one_.n_atoms * 3 * size, 0, static_cast<std::size_t>(3 * room_behind * size));
    memory_ += rounded_up(8 * (3 * one_.n_atoms + 3 * room_behind));
    for (std::int64_t i = 0; i < one_.n_atoms; ++i) {
        double x[3] = {unwritten_value(), unwritten_value(), unwritten_value()};
        if (read) {
            read_atom(callers, atom_of(one_, i), x);
            for (double &component : x) component = std::scalbn(component, -e);
        }
        write_atom(copy, i, x);
    }
    return copy;
}

AtomArray Rescaled::inputs(const AtomArray &callers, int e) { return callers.x ? copy_of(callers, e, true) : callers; }

AtomArray Rescaled::add(const AtomArray &callers, int e, bool read) {
    if (!callers.x) return callers;
    const AtomArray copy = copy_of(callers, e, read), before = copy_of(callers, e, read);
    atoms_[n_atoms_++] = {callers, copy, before, e};
    return copy;
}

const double *Rescaled::inputs(const double *callers, int e) {
    double *const copy = take(one_.n_bonds);
    for (std::int64_t k = 0; k < one_.n_bonds; ++k) copy[k] = std::scalbn(callers[one_.bond(k)], -e);
    return copy;
}

const double *Rescaled::rates(const double *strain, int e) {
    if (!strain) return nullptr;
    for (int c = 0; c < 6; ++c) strain_[c] = std::scalbn(strain[c], -e);
    return strain_;
}

double *Rescaled::results(double *callers, int e, bool are_read) {
    if (!callers) return nullptr;
    double *const copy = take(one_.n_bonds), *const before = take(one_.n_bonds);
    for (std::int64_t k = 0; k < one_.n_bonds; ++k)
        copy[k] = before[k] = are_read ? std::scalbn(callers[one_.bond(k)], -e) : unwritten_value();
    values_[n_values_++] = {callers, copy, before, e};
    return copy;
}

Lane Rescaled::lane_of(const Lane &lane) const {
    Lane copy = lane;
    copy.first_atom = copy.first_bond = copy.chain = copy.kind = 0;
    copy.atoms = nullptr;
    copy.w = w_;
    copy.length = length_;
    copy.w_uniform = std::scalbn(lane.w_uniform, units.mass);
    copy.length_uniform = std::scalbn(lane.length_uniform, -units.length);
    for (std::int64_t k = 0; k < 4; ++k) copy.element[k] = k <= lane.n_bonds ? 3 * k : 0;
    return copy;
}

MoleculeLane Rescaled::lane_of(const MoleculeLane &lane) const { return {0, nullptr, lane.shared, w_, length_, 0, 0}; }

// Looks at all numbers first, and then writes those that a kernel has written.
bool Rescaled::put_back() const {
    for (int pass = 0; pass < 2; ++pass) {
        for (int a = 0; a < n_atoms_; ++a)
            for (std::int64_t i = 0; i < one_.n_atoms; ++i) {
                double x[3], before[3], now[3];
                read_atom(atoms_[a].copy, i, x);
                read_atom(atoms_[a].before, i, before);
                read_atom(atoms_[a].callers, atom_of(one_, i), now);
                bool any = false;
                for (int c = 0; c < 3; ++c) {
                    if (same_bits(x[c], before[c]) || x[c] == before[c])
                        continue;  // nor where a zero has lost its sign
                    any = true;
                    if (pass == 0 && overflows(x[c], atoms_[a].e, atoms_[a].callers.is_float)) return false;
                    now[c] = std::scalbn(x[c], atoms_[a].e);
                }
                if (pass == 1 && any) write_atom(atoms_[a].callers, atom_of(one_, i), now);
            }
        for (int a = 0; a < n_values_; ++a)
            for (std::int64_t k = 0; k < one_.n_bonds; ++k) {
                const double value = values_[a].copy[k];
                if (same_bits(value, values_[a].before[k])) continue;
                if (pass == 0 && overflows(value, values_[a].e, false)) return false;
                if (pass == 1) values_[a].callers[one_.bond(k)] = std::scalbn(value, values_[a].e);
            }
    }
    return true;
}

namespace {

// What lengths may be (holonomic.h); longer and shorter bonds than these are refused.
constexpr double longest_bond = 0x1p500;

double most_w(const KernelMolecule &m) { return m.w ? *std::max_element(m.w, m.w + m.n_atoms) : m.w_uniform; }

}  // namespace

bool find_units(const KernelMolecule &m, const AtomArray &r, const Box &box, Powers &units) {
    double longest = 0, sum = 0;  // max() may lose a NaN, the sum keeps it
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        double from[3], to[3], d[3];
        read_atom(r, atom_of(m, m.elimination ? m.elimination->atom_i[k] : k), from);
        read_atom(r, atom_of(m, m.elimination ? m.elimination->atom_j[k] : k + 1), to);
        bond_vector(box, from, to, d);
        for (const double component : d) {
            longest = std::max(longest, std::fabs(component));
            sum += std::fabs(component);
        }
    }
    if (!std::isfinite(sum) || !(longest > 1 / longest_bond && longest < longest_bond)) return false;
    units = powers_of(longest, most_w(m));
    return true;
}

bool find_units(const KernelMolecule &m, Powers &units) {
    units = powers_of(m.length ? *std::max_element(m.length, m.length + m.n_bonds) : m.length_uniform, most_w(m));
    return true;
}

namespace {

// Forces and the like are left as they are, denormal ones too, in all but extreme cases: over 2^(e + multiplier), where
// their units are 2^e and the largest is about 2^own.
constexpr int most_ordinary_input = 400;
int multiplier_of(int own, int e) { return std::abs(own) <= most_ordinary_input ? -e : own / 2 * 2 - e; }

// log2 of the largest component, or that of 1 if all are zero.
constexpr int of_zero = INT_MIN / 4;
int power_of(double largest) { return largest > 0 && std::isfinite(largest) ? std::ilogb(largest) : of_zero; }
int power_of(const KernelMolecule &m, const AtomArray &callers) {
    double largest = 0;
    for (std::int64_t i = 0; callers.x && i < m.n_atoms; ++i) {
        double x[3];
        read_atom(callers, atom_of(m, i), x);
        for (const double component : x) largest = std::max(largest, std::fabs(component));
    }
    return power_of(largest);
}
int or_one(int power) { return power <= of_zero / 2 ? 0 : power; }

}  // namespace

bool find_units(const KernelMolecule &m, const ForcesCall &call, Powers &units) {
    if (!find_units(m, call.r, call.box, units)) return false;
    const int of_forces = power_of(m, call.f), of_velocities = 2 * power_of(m, call.v) + units.mass - units.length;
    units.multiplier = multiplier_of(or_one(std::max(of_forces, of_velocities)), units.length + units.mass);
    return true;
}

bool find_units(const KernelMolecule &m, const VelocitiesCall &call, Powers &units) {
    if (!find_units(m, call.r, call.box, units)) return false;
    units.multiplier = multiplier_of(or_one(power_of(m, call.v)), units.length);
    return true;
}

bool find_units(const KernelMolecule &m, const SolveCall &call, Powers &units) {
    if (!find_units(m, call.r, call.box, units)) return false;
    double largest = 0;
    for (std::int64_t k = 0; k < m.n_bonds; ++k) largest = std::max(largest, std::fabs(call.rhs[m.bond(k)]));
    units.multiplier = multiplier_of(or_one(power_of(largest)), 2 * units.length);
    return true;
}

Box rescaled(const Box &box, int e) {
    Box copy{};
    copy.lattice = box.lattice;
    if (box.lattice == Box::none) return copy;
    for (int i = 0; i < 9; ++i) {
        copy.h[i] = std::scalbn(box.h[i], -e);
        copy.inverse[i] = std::scalbn(box.inverse[i], e);
    }
    for (int i = 0; i < most_lanes + 2; ++i) {
        copy.minus_side[i] = std::scalbn(box.minus_side[i], -e);
        copy.per_side[i] = std::scalbn(box.per_side[i], e);
    }
    return copy;
}

ForcesCall rescaled(const ForcesCall &call, Rescaled &copy) {
    const int length = copy.units.length, multiplier = copy.units.mass + copy.units.multiplier;
    ForcesCall c = call;
    c.r = copy.inputs(call.r, length);
    c.v = copy.inputs(call.v, length + copy.units.multiplier / 2);
    c.f = copy.inputs(call.f, length + multiplier);
    c.g = copy.results(call.g, length + multiplier, call.add);
    c.lambda = copy.results(call.lambda, multiplier);
    c.tension = copy.results(call.tension, length + multiplier);
    c.box = rescaled(call.box, length);
    return c;
}

VelocitiesCall rescaled(const VelocitiesCall &call, Rescaled &copy) {
    const int length = copy.units.length;
    VelocitiesCall c = call;
    c.r = copy.inputs(call.r, length);
    c.v = copy.moved(call.v, length + copy.units.multiplier);
    c.lambda = copy.results(call.lambda, copy.units.mass + copy.units.multiplier);
    c.strain = copy.rates(call.strain, copy.units.multiplier);
    c.box = rescaled(call.box, length);
    return c;
}

SolveCall rescaled(const SolveCall &call, Rescaled &copy) {
    const int length = copy.units.length, multiplier = copy.units.mass + copy.units.multiplier;
    SolveCall c = call;
    c.r = copy.inputs(call.r, length);
    c.rhs = copy.inputs(call.rhs, 2 * length + copy.units.multiplier);
    c.g = copy.results(call.g, length + multiplier, call.add);
    c.lambda = copy.results(call.lambda, multiplier);
    c.tension = copy.results(call.tension, length + multiplier);
    c.box = rescaled(call.box, length);
    return c;
}

PositionsCall rescaled(const PositionsCall &call, Rescaled &copy) {
    const int length = copy.units.length;
    PositionsCall c = call;
    c.r_ref = copy.inputs(call.r_ref, length);
    c.r = copy.moved(call.r, length);
    c.v = copy.moved(call.v, length);
    c.lambda = copy.results(call.lambda, copy.units.mass, call.guess);
    c.box = rescaled(call.box, length);
    c.box_ref = rescaled(call.box_ref, length);
    return c;
}

MetricCall rescaled(const MetricCall &call, Rescaled &copy) {
    const int length = copy.units.length;
    MetricCall c = call;
    c.r = copy.inputs(call.r, length);
    c.force = copy.results(call.force, -length, call.add);
    c.log_det = &copy.log_det;
    c.log_det_z = &copy.log_det_z;
    c.box = rescaled(call.box, length);
    return c;
}

// ln det Z is of the caller's units: Z is of lengths squared over masses.
void put_determinants(const MetricCall &call, const KernelMolecule &molecule, const Rescaled &copy) {
    const double per_bond = 0.693147180559945309417 * (2 * copy.units.length - copy.units.mass);
    if (call.log_det) call.log_det[molecule.number] = copy.log_det;
    if (call.log_det_z)
        call.log_det_z[molecule.number] = copy.log_det_z + static_cast<double>(molecule.n_bonds) * per_bond;
}

void add_rescaled(const KernelMolecule &molecule, const Powers &units, Tally own, Tally &tally) {
    for (double &sum : own.virial) sum = std::scalbn(sum, 2 * units.length + units.mass + units.multiplier);
    if (own.worst_chain >= 0) own.worst_chain = molecule.number;
    add(tally, own);
}

}  // namespace holonomic
