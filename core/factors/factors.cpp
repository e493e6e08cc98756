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
    KeptBlock &block = f.blocks_[at(molecule)];
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
            f.out_of_memory_ = true;  // kernels throw nothing
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
        blocks_.assign(n, KeptBlock{});
        rest_.reset();
        rest_of_forces_.reset();
    }
    block_.assign(n, nullptr);
    left_.assign(n, 0);
    r_.resize(at(3 * chains_.n_atoms()));
    kept_ = {this, room, block_.data(), positions(), &box_};
    out_of_memory_ = false;
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
    revision_ = -1;  // until all is done
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
    if (out_of_memory_) throw std::bad_alloc();
    rest_.reset();
    rest_of_forces_.reset();
    if (std::memchr(left_.data(), left_of_forces, left_.size())) rest_of_forces_ = those(left_.data(), any_mark);
    if (chains_.bodies() || std::memchr(left_.data(), 1, left_.size())) rest_ = those(left_.data(), 1);
    revision_ = chains_.revision();
    if (!rest_) return;
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

// Molecules that are left: those of which nothing is kept, and those marked in `left`. virial: of these is added.
void Factors::solve_rest(const FactorsSolve &what, unsigned char *left, double *virial) const {
    const std::int64_t n = chains_.n_molecules();
    std::unique_ptr<Chains> more;
    const Chains *rest = !what.rhs && rest_of_forces_ ? rest_of_forces_.get() : rest_.get();
    if (n > 0 && std::memchr(left, 1, at(n))) {
        for (std::int64_t m = 0; m < n; ++m) left[m] |= left_[at(m)];
        more = those(left, what.rhs ? 1 : any_mark);
        rest = more.get();
    }
    if (!rest) return;
    double sum[9] = {};
    if (what.rhs) {
        holonomic::solve(*rest, positions(), what.rhs, what.lambda, what.g, what.add, virial ? sum : nullptr);
    } else {
        ForcesCall call{};
        call.r = positions();
        call.v = what.v;
        call.f = what.f;
        call.g = what.g;
        call.lambda = what.lambda;
        call.tension = what.tension;
        call.add = what.add;
        holonomic::forces(*rest, call, virial ? sum : nullptr);
    }
    for (int i = 0; virial && i < 9; ++i) virial[i] += sum[i];
}

// Arrays per atom are packed. rhs: right-hand sides that v and f give, of a single one; else null.
void Factors::solve_packed(const FactorsSolve *what, int n, const double *rhs, double *virial) const {
    const std::int64_t n_molecules = chains_.n_molecules();
    unsigned char *const left = static_cast<unsigned char *>(thread_memory(Keep::factors, n * n_molecules + 1));
    if (!left) throw std::bad_alloc();
    std::memset(left, 0, at(n * n_molecules));
    KeptCall call[rhs_at_once];
    for (int k = 0; k < n; ++k)
        call[k] = {what[k].v,   what[k].f,         what[k].g, rhs ? rhs : what[k].rhs, what[k].lambda, what[k].tension,
                   what[k].add, virial != nullptr, &kept_,    left + k * n_molecules};
    const Tally tally = solve_kept(chains_, call, n);
    double sum[9] = {};
    add_virial(tally, sum);
    for (int k = 0; k < n; ++k) solve_rest(what[k], call[k].left, virial ? sum : nullptr);
    if (virial) write_virial(sum, virial);
}

void Factors::solve_one(const FactorsSolve &what, const double *rhs, double *virial) const {
    const auto is_other = [](const AtomArray &a) { return a.x && !a.packed; };
    const int n_others = is_other(what.v) + is_other(what.f) + is_other(what.g);
    if (n_others == 0) return solve_packed(&what, 1, rhs, virial);
    const std::int64_t n_atoms = chains_.n_atoms(), numbers = 3 * n_atoms;
    double *next = static_cast<double *>(
        thread_memory(Keep::arrays_of_factors, n_others * numbers * static_cast<std::int64_t>(sizeof(double))));
    if (!next && n_atoms > 0) throw std::bad_alloc();
    FactorsSolve packed = what;
    for (AtomArray *const a : {&packed.v, &packed.f, &packed.g}) {
        if (!is_other(*a)) continue;
        copy(*a, n_atoms, next);
        *a = packed_array(next);
        next += numbers;
    }
    solve_packed(&packed, 1, rhs, virial);
    if (is_other(what.g))
        for (std::int64_t i = 0; i < n_atoms; ++i)
            write_atom(what.g, i, reinterpret_cast<double *>(packed.g.x) + 3 * i);
}

void Factors::forces(const FactorsSolve &what, double *virial) const {
    need_update();
    if (!has_rate_) return solve_one(what, nullptr, virial);
    const std::int64_t bytes = chains_.n_bonds() * static_cast<std::int64_t>(sizeof(double));
    double *const rhs = static_cast<double *>(thread_memory(Keep::rhs_of_factors, bytes));
    if (!rhs && bytes > 0) throw std::bad_alloc();
    right_hand_sides(chains_, box_, L_, positions(), what.v, what.f, rhs);
    solve_one(what, rhs, virial);
}

void Factors::solve(const FactorsSolve *what, int n, double *virial) const {
    need_update();
    bool together = n > 1 && !virial && !chains_.plan().copied;
    for (int k = 0; k < n; ++k) together = together && (what[k].g.packed || !what[k].g.x);
    if (together) return solve_packed(what, n, nullptr, nullptr);
    for (int k = 0; k < n; ++k) solve_one(what[k], nullptr, virial ? virial + 9 * k : nullptr);
}

}  // namespace holonomic
