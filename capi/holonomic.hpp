/**
 * @file holonomic.hpp
 * The library holonomic for C++17: header only, over holonomic.h, whose functions these are and whose comments say what
 * they do. A set owns what it has made, arrays come with their sizes, and a failure is an exception that says where.
 *
 *     holonomic::Chains molecules(masses);                  // any array of doubles: std::vector, std::array, a pair
 *     molecules.add_bonds(pairs, lengths);
 *     molecules.forces(r, v, f, {.g = g});                  // C++20; before that: holonomic::Outputs out; out.g = g;
 *
 * Sizes are compared with those that the library knows before anything is done; what does not fit is an Error of status
 * HOL_ERR_VALUE. What is empty is left out, as NULL is in C. The interface of the binary library is that of
 * holonomic.h alone: this header is compiled into the program, and may change with any release.
 */
#ifndef HOLONOMIC_HPP
#define HOLONOMIC_HPP

#include <holonomic.h>

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace holonomic {

/** What a function of the library refused, with hol_error_location(). */
class Error : public std::runtime_error {
public:
    Error(int code, const std::string &message) : std::runtime_error(message), status(code) {
        hol_error_location(&molecule, &bond, &atom, &n_bad);
    }
    /** Of an argument that this header refuses. */
    explicit Error(const std::string &message) : std::runtime_error(message) {}
    int status = HOL_ERR_VALUE;
    int64_t molecule = -1, bond = -1, atom = -1, n_bad = 0;
};

namespace detail {
inline void ask(int status) {
    if (status != HOL_OK) throw Error(status, hol_error_message());
}
}  // namespace detail

/** Consecutive elements that somebody else owns: of a std::vector, std::array, array, or a pointer and a size. */
template <class T>
class Span {
public:
    constexpr Span() = default;
    constexpr Span(std::nullptr_t) {}
    constexpr Span(T *data, std::size_t size) : data_(data), size_(size) {}
    template <std::size_t n>
    constexpr Span(T (&array)[n]) : data_(array), size_(n) {}
    template <class Container, class = decltype(static_cast<T *>(std::declval<Container &>().data()))>
    constexpr Span(Container &&container) : data_(container.data()), size_(container.size()) {}
    constexpr T *data() const { return data_; }
    constexpr std::size_t size() const { return size_; }
    constexpr bool empty() const { return size_ == 0; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

using In = Span<const double>;
using Out = Span<double>;
using Numbers = Span<const int64_t>;

/** Where results go; what is empty is not computed. `mode` is that of g. */
struct Outputs {
    Out lambda{}, tension{}, g{}, virial{};
    hol_mode mode = HOL_WRITE;
};

namespace detail {

/** The elements of an array that has at least `needed` of them, or nullptr if it is empty. */
template <class T>
T *checked(Span<T> array, int64_t needed, const char *name) {
    if (array.empty()) return nullptr;
    if (static_cast<int64_t>(array.size()) < needed)
        throw Error(std::string(name) + " has " + std::to_string(array.size()) + " elements; " +
                    std::to_string(needed) + " are needed");
    return array.data();
}

inline int64_t bonds_of(Numbers pairs, In lengths) {
    if (pairs.size() != 2 * lengths.size())
        throw Error(std::to_string(pairs.size()) + " numbers of atoms were given for " +
                    std::to_string(lengths.size()) + " bonds");
    return static_cast<int64_t>(lengths.size());
}

struct Destroy {
    void operator()(hol_chains *chains) const { hol_chains_destroy(chains); }
    void operator()(hol_factors *factors) const { hol_factors_destroy(factors); }
};

}  // namespace detail

/** A set of molecules (hol_chains). It may be moved and copied; a copy shares what is known of the molecules' shapes.
 */
class Chains {
public:
    explicit Chains(In masses) {
        hol_chains *made = nullptr;
        detail::ask(hol_chains_create(static_cast<int64_t>(masses.size()), masses.data(), &made));
        chains_.reset(made);
    }
    Chains(const Chains &other) {
        hol_chains *made = nullptr;
        detail::ask(hol_chains_copy(other.get(), &made));
        chains_.reset(made);
    }
    Chains(Chains &&) = default;
    Chains &operator=(Chains other) {
        chains_ = std::move(other.chains_);
        return *this;
    }

    /** For all functions of holonomic.h that have no member here. */
    hol_chains *get() { return chains_.get(); }
    const hol_chains *get() const { return chains_.get(); }

    void add(Numbers atoms, In lengths) {
        if (atoms.size() != lengths.size() + 1 && !(atoms.empty() && lengths.empty()))
            throw Error(std::to_string(atoms.size()) + " atoms were given for " + std::to_string(lengths.size()) +
                        " bonds of a chain");
        detail::ask(hol_chains_add(get(), static_cast<int64_t>(lengths.size()), atoms.data(), lengths.data()));
    }
    void add_block(int64_t n_chains, int64_t first_atom, In lengths) {
        detail::ask(
            hol_chains_add_block(get(), n_chains, static_cast<int64_t>(lengths.size()), first_atom, lengths.data()));
    }
    void add_bonds(Numbers pairs, In lengths) {
        detail::ask(hol_chains_add_bonds(get(), detail::bonds_of(pairs, lengths), pairs.data(), lengths.data()));
    }
    void add_molecules(int64_t n_molecules, int64_t n_atoms, int64_t first_atom, Numbers pairs, In lengths) {
        detail::ask(hol_chains_add_molecules(get(), n_molecules, n_atoms, first_atom, detail::bonds_of(pairs, lengths),
                                             pairs.data(), lengths.data()));
    }
    void set_box(In box) { detail::ask(hol_chains_set_box(get(), detail::checked(box, 9, "box"))); }
    void set_threads(int n_threads) { detail::ask(hol_chains_set_threads(get(), n_threads)); }
    void set_tolerance(double tolerance) { detail::ask(hol_chains_set_tolerance(get(), tolerance)); }
    void set_lengths(In lengths) {
        detail::ask(hol_chains_set_lengths(get(), detail::checked(lengths, n_bonds(), "lengths")));
    }

    int64_t n_atoms() const { return hol_chains_n_atoms(get()); }
    int64_t n_bonds() const { return hol_chains_n_bonds(get()); }
    int64_t n_molecules() const { return hol_chains_n_molecules(get()); }
    int64_t degrees_of_freedom(int dimensions = 3) const { return hol_chains_degrees_of_freedom(get(), dimensions); }

    void forces(In r, In v, In f, const Outputs &out) const {
        detail::ask(hol_forces(get(), atoms(r, "r"), atoms(v, "v"), atoms(f, "f"), bonds(out.lambda, "lambda"),
                               bonds(out.tension, "tension"), atoms(out.g, "g"), out.mode, tensor(out.virial)));
    }
    void solve(In r, In rhs, const Outputs &out) const {
        if (!out.tension.empty()) throw Error("solve gives no tensions: hol_reactions makes them of multipliers");
        detail::ask(hol_solve(get(), atoms(r, "r"), bonds(rhs, "rhs"), bonds(out.lambda, "lambda"), atoms(out.g, "g"),
                              out.mode, tensor(out.virial)));
    }
    void project_velocities(In r, Out v, Out lambda = {}, Out virial = {}) const {
        detail::ask(
            hol_project_velocities(get(), atoms(r, "r"), atoms(v, "v"), bonds(lambda, "lambda"), tensor(virial)));
    }
    hol_report project_positions(In r_ref, Out r, double dt, Out v = {}, Out lambda = {}, Out virial = {}) const {
        hol_report report{};
        detail::ask(hol_project_positions(get(), atoms(r_ref, "r_ref"), atoms(r, "r"), atoms(v, "v"), dt,
                                          bonds(lambda, "lambda"), 0, tensor(virial), &report));
        return report;
    }
    hol_report impose(Out r) const {
        hol_report report{};
        detail::ask(hol_impose(get(), atoms(r, "r"), &report));
        return report;
    }
    hol_worst violation(In r, In v = {}) const {
        hol_worst worst{};
        detail::ask(hol_violation(get(), atoms(r, "r"), atoms(v, "v"), &worst));
        return worst;
    }

private:
    friend class Factors;
    template <class T>
    T *atoms(Span<T> array, const char *name) const {
        return detail::checked(array, 3 * n_atoms(), name);
    }
    template <class T>
    T *bonds(Span<T> array, const char *name) const {
        return detail::checked(array, n_bonds(), name);
    }
    static double *tensor(Out virial) { return detail::checked(virial, 9, "virial"); }

    std::unique_ptr<hol_chains, detail::Destroy> chains_;
};

/** Factors that are kept (hol_factors). The set has to outlive them. */
class Factors {
public:
    explicit Factors(const Chains &chains) : chains_(&chains) {
        hol_factors *made = nullptr;
        detail::ask(hol_factors_create(chains.get(), &made));
        factors_.reset(made);
    }
    Factors(const Chains &&) = delete;
    void update(In r) { detail::ask(hol_factors_update(factors_.get(), chains_->atoms(r, "r"))); }
    void forces(In v, In f, const Outputs &out) const {
        const Chains &c = *chains_;
        detail::ask(hol_factors_forces(factors_.get(), c.atoms(v, "v"), c.atoms(f, "f"), c.bonds(out.lambda, "lambda"),
                                       c.bonds(out.tension, "tension"), c.atoms(out.g, "g"), out.mode,
                                       c.tensor(out.virial)));
    }
    /** n_rhs right-hand sides one behind the other, and as many multipliers. */
    void solve(int64_t n_rhs, In rhs, Out lambda) const {
        const int64_t n = n_rhs * chains_->n_bonds();
        detail::ask(hol_factors_solve(factors_.get(), n_rhs, detail::checked(rhs, n, "rhs"),
                                      detail::checked(lambda, n, "lambda"), nullptr, HOL_WRITE, nullptr));
    }
    hol_factors *get() { return factors_.get(); }

private:
    const Chains *chains_;
    std::unique_ptr<hol_factors, detail::Destroy> factors_;
};

}  // namespace holonomic
#endif
