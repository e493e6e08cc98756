#include "core/run/staging.hpp"

#include <cstring>
#include <new>

#include "core/caller/packed_array.hpp"
#include "core/run/thread_memory.hpp"

namespace holonomic {

namespace {

std::int64_t rounded_up(std::int64_t bytes) { return (bytes + 63) / 64 * 64; }

template <class Each>
void for_components(const AtomArray &a, std::int64_t i, const AtomArray &b, std::int64_t j, Each each) {
    if (a.x) each(a.x + i * a.stride, b.x + j * b.stride);
    if (a.y) each(a.y + i * a.stride, b.y + j * b.stride);
    if (a.z) each(a.z + i * a.stride, b.z + j * b.stride);
}

// Bit for bit.
void copy_atom(const AtomArray &from, std::int64_t i, const AtomArray &to, std::int64_t j) {
    const std::size_t size = from.is_float ? sizeof(float) : sizeof(double);
    for_components(from, i, to, j, [size](const char *source, char *target) { std::memcpy(target, source, size); });
}

// A NaN that no arithmetic makes: whether a kernel has written a result shows by it.
constexpr std::uint64_t unwritten = 0x7ff8600dcafe5a17u;
constexpr std::uint32_t unwritten_float = 0x7fc5a171u;

void mark_unwritten(const AtomArray &array, std::int64_t i) {
    if (array.is_float)
        std::memcpy(array.x + i * array.stride, &unwritten_float, sizeof unwritten_float);
    else
        std::memcpy(array.x + i * array.stride, &unwritten, sizeof unwritten);
}

bool is_unwritten(const AtomArray &array, std::int64_t i) {
    return array.is_float ? std::memcmp(array.x + i * array.stride, &unwritten_float, sizeof unwritten_float) == 0
                          : std::memcmp(array.x + i * array.stride, &unwritten, sizeof unwritten) == 0;
}

// Calls each(k, place) for all numbers in two arrays: of each bond in the order of the molecules, and where the caller
// has it. `width` of them for each.
template <class Each>
void for_values(const std::vector<std::int64_t> &places, std::int64_t width, Each each) {
    const std::int64_t *const p = places.data(), n = static_cast<std::int64_t>(places.size());
    if (width == 1)
        for (std::int64_t k = 0; k < n; ++k) each(k, p[k]);
    else
        for (std::int64_t k = 0; k < n * width; ++k) each(k, p[k / width] * width + k % width);
}

}  // namespace

void Staging::take_memory(int wide) {
    const std::int64_t n_stage = static_cast<std::int64_t>(plan_.stage.size());
    const std::int64_t n_values = reorders() ? static_cast<std::int64_t>(chains_.reordered_bonds().size()) : 0;
    const std::int64_t bytes =
        most * (rounded_up(n_stage * 24) + rounded_up(n_values * 8)) + rounded_up(n_values * 8 * wide);
    memory_ = static_cast<char *>(thread_memory(Keep::staging, bytes));
    if (!memory_) throw std::bad_alloc();
}

Staging::StagedValues &Staging::copy_of(const double *callers, int width) {
    for (int i = 0; i < n_values_; ++i)
        if (values_[i].callers == callers) return values_[i];
    const std::vector<std::int64_t> &places = chains_.reordered_bonds();
    double *const copy = reinterpret_cast<double *>(memory_);
    memory_ += rounded_up(static_cast<std::int64_t>(places.size() * sizeof(double)) * width);
    for_values(places, width, [=](std::int64_t k, std::int64_t place) { copy[k] = callers[place]; });
    values_[n_values_] = {callers, copy, nullptr, width};
    return values_[n_values_++];
}

double *Staging::results(double *callers, int width) {
    if (!callers) return nullptr;
    StagedValues &values = copy_of(callers, width);
    values.result = callers;
    return values.copy;
}

const double *Staging::inputs(const double *callers) { return callers ? copy_of(callers, 1).copy : nullptr; }

AtomArray Staging::stage(const AtomArray &callers, Use use) {
    if (!callers.x) return callers;
    for (int i = 0; i < n_atoms_; ++i)
        if (atoms_[i].callers.x == callers.x && atoms_[i].use == use) return atoms_[i].copy;
    const std::int64_t size = callers.is_float ? sizeof(float) : sizeof(double);
    AtomArray copy{memory_,  memory_ + size,   callers.z ? memory_ + 2 * size : nullptr,
                   3 * size, callers.is_float, callers.packed};
    memory_ += rounded_up(static_cast<std::int64_t>(plan_.stage.size()) * 24);
    for (std::size_t i = 0; i < plan_.stage.size(); ++i)
        copy_atom(callers, plan_.stage[i], copy, static_cast<std::int64_t>(i));
    const double zero[3] = {0, 0, 0};
    for (const Plan::Copy &shared : plan_.copies) {
        if (use == Use::written) mark_unwritten(copy, shared.place);
        if (use == Use::added) write_atom(copy, shared.place, zero);
    }
    atoms_[n_atoms_++] = {callers, copy, use};
    return copy;
}

AtomArray Staging::atoms(const AtomArray &callers) { return stage(callers, Use::read); }
AtomArray Staging::moved_atoms(const AtomArray &callers) { return stage(callers, Use::moved); }
AtomArray Staging::summed_atoms(const AtomArray &callers, bool add) {
    return stage(callers, add ? Use::added : Use::written);
}

// The copies of a shared atom stand next to each other in the plan, in the order of the molecules.
void Staging::sum_copies(const StagedAtoms &atoms) const {
    for (std::size_t first = 0, end; first < plan_.copies.size(); first = end) {
        const std::int64_t atom = plan_.copies[first].atom;
        double sum[3] = {0, 0, 0};
        bool any = false;
        for (end = first; end < plan_.copies.size() && plan_.copies[end].atom == atom; ++end) {
            if (atoms.use == Use::written && is_unwritten(atoms.copy, plan_.copies[end].place)) continue;
            double one[3];
            read_atom(atoms.copy, plan_.copies[end].place, one);
            any = any || atoms.use == Use::written || one[0] != 0 || one[1] != 0 || one[2] != 0;
            for (int c = 0; c < 3; ++c) sum[c] += one[c];
        }
        if (!any) continue;
        double before[3] = {0, 0, 0};
        if (atoms.use == Use::added) read_atom(atoms.callers, atom, before);
        for (int c = 0; c < 3; ++c) sum[c] += before[c];
        write_atom(atoms.callers, atom, sum);
    }
}

void Staging::put_back(const StagedAtoms &atoms) const {
    if (atoms.use == Use::read) return;
    for (std::size_t i = 0; i < plan_.stage.size(); ++i)
        if (!plan_.is_copy[i]) copy_atom(atoms.copy, static_cast<std::int64_t>(i), atoms.callers, plan_.stage[i]);
    if (atoms.use != Use::moved) sum_copies(atoms);
}

void Staging::put_all_back() const {
    const std::vector<std::int64_t> &places = chains_.reordered_bonds();
    for (int i = 0; i < n_values_; ++i) {
        double *const result = values_[i].result;
        const double *const copy = values_[i].copy;
        if (!result) continue;
        for_values(places, values_[i].width, [=](std::int64_t k, std::int64_t place) { result[place] = copy[k]; });
    }
    for (int i = 0; i < n_atoms_; ++i) put_back(atoms_[i]);
}

}  // namespace holonomic
