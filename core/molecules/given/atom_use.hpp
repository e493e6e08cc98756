// Which atoms belong to molecules already.
#pragma once

#include <cstdint>
#include <vector>

namespace holonomic {

// An atom that can move belongs to one molecule; a fixed one may end bonds of any number of them.
class AtomUse {
public:
    explicit AtomUse(std::int64_t n_atoms) : used_(words(n_atoms), 0), shared_(words(n_atoms), 0) {}

    bool used(std::int64_t atom) const { return test(used_, atom); }
    bool shared(std::int64_t atom) const { return test(shared_, atom); }
    bool any_shared() const { return any_shared_; }

    void take(std::int64_t atom) { word(used_, atom) |= bit(atom); }
    void give_back(std::int64_t atom) { word(used_, atom) &= ~bit(atom); }
    // A fixed atom: shared from the second time on.
    void take_fixed(std::int64_t atom) {
        if (used(atom)) {
            word(shared_, atom) |= bit(atom);
            any_shared_ = true;
        }
        take(atom);
    }
    std::size_t bytes() const { return (used_.capacity() + shared_.capacity()) * sizeof(std::uint64_t); }

private:
    using Bits = std::vector<std::uint64_t>;
    static std::size_t words(std::int64_t n) { return static_cast<std::size_t>((n + 63) / 64); }
    static std::uint64_t bit(std::int64_t atom) { return std::uint64_t{1} << (atom % 64); }
    static std::uint64_t &word(Bits &bits, std::int64_t atom) { return bits[static_cast<std::size_t>(atom / 64)]; }
    static bool test(const Bits &bits, std::int64_t atom) {
        return (bits[static_cast<std::size_t>(atom / 64)] & bit(atom)) != 0;
    }

    Bits used_, shared_;
    bool any_shared_ = false;
};

}  // namespace holonomic
