#include "core/factors/factors.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include "core/caller/packed_array.hpp"
#include "core/factors/keep.hpp"
#include "core/forces.hpp"
#include "core/index.hpp"
#include "core/rigid/bodies.hpp"
#include "core/run/execute.hpp"
#include "core/run/thread_memory.hpp"
#include "core/solve.hpp"

namespace holonomic {

namespace {

constexpr std::int64_t alignment = 64, chunk = std::int64_t{1} << 17;  // bytes; doubles of one

constexpr unsigned char any_mark = 1 | left_of_forces;

void copy(const AtomArray &from, std::int64_t n_atoms, double *to) {
    for (std::int64_t i = 0; i < n_atoms; ++i) read_atom(from, i, to + 3 * i);
}

}  // namespace

Factors::~Factors() {
    for (double *const memory : chunks_) ::operator delete[](memory, std::align_val_t{alignment});
}

AtomArray Factors::positions() const { return packed_array(r_.data()); }

// For kernels: memory of a block, the same as at the last update where that has been large enough. Several threads may
// ask at once.
double *Factors::room(void *owner, std::int64_t molecule, std::int64_t doubles) {
    Factors &f = *static_cast<Factors *>(owner);
    Block &block = f.blocks_[at(molecule)];
    if (block.doubles < doubles) {
        constexpr std::int64_t per_line = alignment / static_cast<std::int64_t>(sizeof(double));
        const std::int64_t whole = (doubles + per_line - 1) / per_line * per_line;
        const std::lock_guard<std::mutex> lock(f.mutex_);
        try {
            if (f.free_ < whole) {
                const std::int64_t more = std::max(chunk, whole);
                f.chunks_.reserve(f.chunks_.size() + 1);
                f.chunks_.push_back(
                    static_cast<double *>(::operator new[](at(more) * sizeof(double), std::align_val_t{alignment})));
                f.free_ = more;
                f.end_ = f.chunks_.back() + more;
            }
        } catch (const std::bad_alloc &) {
            return nullptr;
        }
        block = {f.end_ - f.free_, whole};
        f.free_ -= whole;
    }
    f.block_[at(molecule)] = block.at;
    return block.at;
}

// Forgets the blocks of a set that has been changed.
void Factors::begin() {
    const std::size_t n = at(chains_.n_molecules());
    if (revision_ != chains_.revision()) {
        revision_ = -1;
        for (double *const memory : chunks_) ::operator delete[](memory, std::align_val_t{alignment});
        chunks_.clear();
        free_ = 0;
        blocks_.assign(n, Block{});
        rest_.reset();
        rest_of_forces_.reset();
    }
    block_.assign(n, nullptr);
    left_.assign(n, 0);
    r_.resize(at(3 * chains_.n_atoms()));
    kept_ = {this, room, block_.data()};
}

// The set with those molecules alone that have one of these marks, and those with bodies.
std::unique_ptr<Chains> Factors::those(const unsigned char *left, unsigned char marks) const {
    std::unique_ptr<Chains> some = std::make_unique<Chains>(chains_);
    std::vector<unsigned char> active(at(chains_.n_molecules()));
    for (std::int64_t m = 0; m < chains_.n_molecules(); ++m)
        active[at(m)] =
            m < chains_.n_chains() ? (left[m] & marks) != 0 : chains_.bodies()->is_active(m - chains_.n_chains());
    some->set_active(active.data());
    some->keeps_outcomes = false;
    some->box = box_;
    return some;
}

void Factors::update(const AtomArray &r) {
    begin();
    copy(r, chains_.n_atoms(), r_.data());
    box_ = chains_.box;
    const BoxRate *const rate = chains_.box_rate();
    has_rate_ = rate != nullptr;
    if (rate) std::copy(rate->L, rate->L + 9, L_);
    KeepCall call{};
    call.r = positions();
    call.kept = &kept_;
    call.left = left_.data();
    call.box = box_;
    // Sums on shared fixed atoms are taken in one go: then all is left to the ordinary verbs.
    if (chains_.shares_fixed_atoms())
        for (std::int64_t m = 0; m < chains_.n_chains(); ++m) left_[at(m)] = chains_.is_active(m);
    else
        keep(chains_, call);
    revision_ = chains_.revision();
    rest_.reset();
    rest_of_forces_.reset();
    if (std::memchr(left_.data(), left_of_forces, left_.size())) rest_of_forces_ = those(left_.data(), any_mark);
    if (!chains_.bodies() && !std::memchr(left_.data(), 1, left_.size())) return;
    rest_ = those(left_.data(), 1);
    ForcesCall look{};  // finds what is bad
    look.r = positions();
    holonomic::forces(*rest_, look, nullptr);
}

void Factors::need_update() const {
    if (revision_ < 0) throw make_error(Status::state, "there are no factors yet: hol_factors_update makes them");
    if (revision_ != chains_.revision())
        throw make_error(Status::state,
                         "molecules, lengths, masses or which of them are active have been changed since "
                         "hol_factors_update made the factors");
}

void Factors::solve_all(const FactorsSolve &what, const double *rhs, double *virial) const {
    need_update();
    const std::int64_t n_atoms = chains_.n_atoms(), n = chains_.n_molecules();
    const auto other = [&](const AtomArray &a) { return a.x && !a.packed; };
    const std::int64_t n_others = other(what.v) + other(what.f) + other(what.g);
    const std::int64_t of_left = (n / alignment + 1) * alignment;
    const std::int64_t bytes = of_left + 3 * n_others * n_atoms * static_cast<std::int64_t>(sizeof(double));
    char *memory = static_cast<char *>(thread_memory(Keep::factors, bytes));
    if (!memory) throw std::bad_alloc();
    unsigned char *const left = reinterpret_cast<unsigned char *>(memory);
    std::fill(left, left + n, 0);
    double *next = reinterpret_cast<double *>(memory + of_left);
    const auto packed = [&](const AtomArray &a) {
        if (!other(a)) return a;
        double *const to = next;
        next += 3 * n_atoms;
        copy(a, n_atoms, to);
        return packed_array(to);
    };
    KeptCall call{};
    call.v = packed(what.v);
    call.f = packed(what.f);
    call.g = packed(what.g);
    call.rhs = rhs;
    call.lambda = what.lambda;
    call.tension = what.tension;
    call.add = what.add;
    call.virial = virial != nullptr;
    call.r = positions();
    call.box = box_;
    call.kept = &kept_;
    call.left = left;
    Tally tally = solve_kept(chains_, call);
    if (other(what.g))
        for (std::int64_t i = 0; i < n_atoms; ++i) write_atom(what.g, i, reinterpret_cast<double *>(call.g.x) + 3 * i);
    double sum[9] = {}, of_rest[9] = {};
    const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; ++i) sum[i] = tally.virial[place[i]];
    std::unique_ptr<Chains> more;
    if (n > 0 && std::memchr(left, 1, at(n))) {
        for (std::int64_t m = 0; m < n; ++m) left[m] |= left_[at(m)];
        more = those(left, rhs ? 1 : any_mark);
    }
    const Chains *const known = !rhs && rest_of_forces_ ? rest_of_forces_.get() : rest_.get();
    if (const Chains *const rest = more ? more.get() : known) {
        if (rhs && what.rhs) {
            holonomic::solve(*rest, positions(), rhs, what.lambda, what.g, what.add, virial ? of_rest : nullptr);
        } else {
            ForcesCall forces{};
            forces.r = positions();
            forces.v = what.v;
            forces.f = what.f;
            forces.g = what.g;
            forces.lambda = what.lambda;
            forces.tension = what.tension;
            forces.add = what.add;
            holonomic::forces(*rest, forces, virial ? of_rest : nullptr);
        }
    }
    for (int i = 0; i < 9; ++i) sum[i] += of_rest[i];
    if (virial) write_virial(sum, virial);
}

void Factors::forces(const FactorsSolve &what, double *virial) const {
    if (!has_rate_) return solve_all(what, nullptr, virial);
    need_update();
    const std::int64_t bytes = chains_.n_bonds() * static_cast<std::int64_t>(sizeof(double));
    double *const rhs = static_cast<double *>(thread_memory(Keep::sides_of_factors, bytes));
    if (!rhs && bytes > 0) throw std::bad_alloc();
    right_hand_sides(chains_, box_, L_, positions(), what.v, what.f, rhs);
    solve_all(what, rhs, virial);
}

void Factors::solve(const FactorsSolve &what, double *virial) const { solve_all(what, what.rhs, virial); }

}  // namespace holonomic
