#include "core/device/plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "core/device/group_table.hpp"
#include "core/device/kinds.hpp"
#include "core/device/source.hpp"
#include "core/error.hpp"
#include "core/index.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic::device {

namespace {

constexpr int most_bonds_of_small = 6;
// Work-items of a group whose molecule stands in local memory, and of others, which are larger.
constexpr int local_group = 64, global_group = 256;
constexpr std::size_t local_bytes = 32000;  // each device has 32 KiB

class KernelPlanner {
public:
    KernelPlanner(const Chains &chains, Precision precision, std::int64_t max_entries)
        : precision_(precision), sorted_(sorted_by_kind(chains, max_entries)), masses_(at(chains.n_atoms())) {
        chains.masses(masses_.data());
        plan_.source = prologue(precision);
        plan_.failures.assign(at(chains.n_molecules() + 1), 0);
        for (const std::int64_t molecule : sorted_.left) plan_.left.push_back(molecule + chains.base);
        split();
    }
    KernelPlan finished();

private:
    void split();
    void launch_items(int first, int last);
    void launch_groups(int first, int last, bool in_local_memory);
    std::int32_t header(std::int64_t count);
    void add_launch(std::int64_t n_groups, int group_size);
    std::int32_t numbers_of(const Member &member);
    std::int32_t next() const;
    std::size_t room(const KernelKind &kind) const;

    const Precision precision_;
    Sorted sorted_;
    std::vector<double> masses_, numbers_;
    std::map<std::vector<double>, std::int32_t> known_;  // where molecules that are alike have their numbers
    std::size_t scratch_ = 0;                            // numbers
    KernelPlan plan_;
};

// Numbers of a molecule in the kernels of a group, as group_source.cpp has them; in numbers that it calls mixed.
std::size_t KernelPlanner::room(const KernelKind &kind) const {
    const auto n_bonds = at(kind.n_bonds()), mixed = bytes_of_mixed(precision_);
    const std::size_t reals = 5 * n_bonds + 2 * at(kind.n_entries());
    return 3 * (at(kind.n_atoms) + n_bonds) + (reals * bytes_of_real(precision_) + mixed - 1) / mixed;
}

// A kernel takes the registers of its largest molecule, so that the small ones, water above all, have one of their own.
void KernelPlanner::split() {
    const int n = static_cast<int>(sorted_.kinds.size());
    int n_large = 0, n_items = 0, n_global = 0;
    for (int k = 0; k < n; ++k) {
        const KernelKind &kind = sorted_.kinds[at(k)].kind;
        if (!kind.is_for_group()) {
            n_items = k + 1;
            if (kind.n_bonds() > most_bonds_of_small) n_large = k + 1;
        } else if ((room(kind) + local_group) * bytes_of_mixed(precision_) > local_bytes) {
            n_global = k + 1 - n_items;
        }
    }
    const int ends[] = {0, n_large, n_items, n_items + n_global, n};
    std::size_t n_launches = 0;
    for (int part = 0; part < 4; ++part) n_launches += ends[part] < ends[part + 1];
    plan_.integers.resize(2 * n_launches);
    launch_items(ends[0], ends[1]);
    launch_items(ends[1], ends[2]);
    launch_groups(ends[2], ends[3], false);
    launch_groups(ends[3], ends[4], true);
}

// Where the next integers stand; all of them are named by 32 bits.
std::int32_t KernelPlanner::next() const {
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (plan_.integers.size() > most || numbers_.size() > most || scratch_ > most || 3 * masses_.size() > most)
        throw make_error(Status::unsupported, "the molecules are too many for the 32 bits of a device's indices");
    return static_cast<std::int32_t>(plan_.integers.size());
}

// Of the launch that is made: where its data begin, and how many lanes or molecules there are.
std::int32_t KernelPlanner::header(std::int64_t count) {
    const std::int32_t begin = next();
    std::int32_t *const of_launch = &plan_.integers[2 * plan_.launches.size()];
    of_launch[0] = begin;
    of_launch[1] = static_cast<std::int32_t>(count);
    return begin;
}

void KernelPlanner::add_launch(std::int64_t n_groups, int group_size) {
    const std::string number = std::to_string(plan_.launches.size());
    plan_.launches.push_back({"hol_positions_" + number, "hol_velocities_" + number, n_groups, group_size});
}

// Inverse masses are relative to a power of two, so that floats hold them in any units.
std::int32_t KernelPlanner::numbers_of(const Member &member) {
    std::vector<double> values;
    double most = 0;
    for (const int atom : member.atoms) {
        const double mass = masses_[at(atom)];
        values.push_back(mass > 0 ? 1 / mass : 0);
        most = std::max(most, values.back());
    }
    const int exponent = std::ilogb(most);
    for (double &w : values) w = std::scalbn(w, -exponent);
    for (const double length : member.lengths) values.push_back(1 / (length * length));
    next();
    const auto place = known_.emplace(values, static_cast<std::int32_t>(numbers_.size()));
    if (place.second) numbers_.insert(numbers_.end(), values.begin(), values.end());
    return place.first->second;
}

void KernelPlanner::launch_items(int first, int last) {
    if (first == last) return;
    std::int64_t n_batches = 0;
    for (int k = first; k < last; ++k)
        n_batches += (static_cast<std::int64_t>(sorted_.kinds[at(k)].members.size()) + batch_width - 1) / batch_width;
    std::size_t batch = at(header(n_batches * batch_width));
    plan_.integers.resize(batch + at(2 * n_batches));
    for (int k = first; k < last; ++k) {
        const auto &[kind, members] = sorted_.kinds[at(k)];
        for (std::size_t begin = 0; begin < members.size(); begin += batch_width, batch += 2) {
            const std::int32_t columns = next();
            plan_.integers[batch] = k;
            plan_.integers[batch + 1] = columns;
            plan_.integers.resize(at(columns) + at(kind.n_atoms + 2) * batch_width, -1);
            for (std::size_t lane = 0; lane < batch_width && begin + lane < members.size(); ++lane) {
                const Member &member = members[begin + lane];
                std::size_t place = at(columns) + lane;
                const auto put = [&](std::int32_t value) {
                    plan_.integers[place] = value;
                    place += batch_width;
                };
                put(numbers_of(member));
                for (const int atom : member.atoms) put(atom);
                put(static_cast<std::int32_t>(member.number));
            }
        }
    }
    plan_.source += item_kernels(static_cast<int>(plan_.launches.size()), sorted_.kinds, first, last);
    add_launch(n_batches, batch_width);
}

void KernelPlanner::launch_groups(int first, int last, bool in_local_memory) {
    if (first == last) return;
    std::int64_t n_molecules = 0;
    std::size_t largest = 0;
    for (int k = first; k < last; ++k) {
        n_molecules += static_cast<std::int64_t>(sorted_.kinds[at(k)].members.size());
        largest = std::max(largest, room(sorted_.kinds[at(k)].kind));
    }
    std::size_t to = at(header(n_molecules));
    plan_.integers.resize(to + at(3 * n_molecules));
    for (int k = first; k < last; ++k) {
        const auto &[kind, members] = sorted_.kinds[at(k)];
        const std::int32_t table = next();
        const std::vector<int> of_kind = group_table(kind);
        plan_.integers.insert(plan_.integers.end(), of_kind.begin(), of_kind.end());
        for (const Member &member : members) {
            const std::int32_t row = next();
            plan_.integers[to++] = table;
            plan_.integers[to++] = row;
            plan_.integers[to++] = static_cast<std::int32_t>(scratch_);
            if (!in_local_memory) scratch_ += room(kind);
            plan_.integers.push_back(numbers_of(member));
            plan_.integers.insert(plan_.integers.end(), member.atoms.begin(), member.atoms.end());
            plan_.integers.push_back(static_cast<std::int32_t>(member.number));
        }
    }
    const int size = in_local_memory ? local_group : global_group;
    plan_.source +=
        group_kernels(static_cast<int>(plan_.launches.size()), size, in_local_memory ? static_cast<int>(largest) : 0);
    add_launch(n_molecules, size);
}

// No array is empty, since a device makes none of no bytes.
KernelPlan KernelPlanner::finished() {
    next();
    if (plan_.integers.empty()) plan_.integers.push_back(0);
    if (numbers_.empty()) numbers_.push_back(0);
    const std::size_t size = bytes_of_mixed(precision_);
    plan_.numbers.resize(numbers_.size() * size);
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
        const auto single = static_cast<float>(numbers_[k]);
        std::memcpy(&plan_.numbers[k * size], size == sizeof single ? static_cast<const void *>(&single) : &numbers_[k],
                    size);
    }
    plan_.scratch_bytes = static_cast<std::int64_t>(std::max<std::size_t>(scratch_, 1) * size);
    return std::move(plan_);
}

}  // namespace

KernelPlan make_plan(const Chains &chains, Precision precision, std::int64_t max_entries) {
    if (max_entries > most_entries)
        throw make_error(Status::value, "max_entries is %lld; it must be at most %lld",
                         static_cast<long long>(max_entries), static_cast<long long>(most_entries));
    return KernelPlanner(chains, precision, max_entries < 0 ? default_entries : max_entries).finished();
}

}  // namespace holonomic::device
