/**
 * Sequences of calls of the whole C interface, made from a fuzzer's bytes: sizes, indices, pointers that may be NULL,
 * and numbers of every kind. Beside what the sanitizers see, it must hold that
 *   - a wrong argument writes nothing at all, and so does a failure of every chain;
 *   - sums over chains are not written if a chain fails;
 *   - a success leaves finite numbers only;
 *   - every failure has a message and a known name.
 */
#include <holonomic.h>

#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <utility>

#include "atom_array.hpp"

namespace fuzz
{
namespace
{

void check(bool right, const char *what)
{
    if (right) return;
    std::fprintf(stderr, "fuzz: %s (last message: %s)\n", what, hol_error_message());
    std::abort();
}

void check_status(int status)
{
    if (status == HOL_OK) return;
    check(hol_error_message()[0] != 0, "a failure without a message");
    check(std::strncmp(hol_status_name(status), "HOL_ERR_", 8) == 0, "a status without a name");
    check(status != HOL_ERR_INTERNAL && status != HOL_ERR_MEMORY, "an internal error");
}

bool is_wrong_argument(int status)
{
    return status == HOL_ERR_NULL || status == HOL_ERR_VALUE || status == HOL_ERR_INDEX ||
           status == HOL_ERR_SHARED_ATOM;
}

bool finite(const double *x, std::size_t n)
{
    for (std::size_t i = 0; i < n; ++i)
        if (!std::isfinite(x[i])) return false;
    return true;
}

/** Outputs of one call: what they were before, and what an error may have done to them. */
class outputs
{
public:
    void add(block &b)
    {
        all_.emplace_back(&b, b.copy());
    }
    void add_sum(block &b)
    {
        add(b);
        sums_.push_back(all_.size() - 1);
    }
    void check_after(int status, std::int64_t n_active) const
    {
        check_status(status);
        if (status == HOL_OK) return;
        std::int64_t n_bad = -1;
        hol_error_location(nullptr, nullptr, nullptr, &n_bad);
        const bool nothing = is_wrong_argument(status) || n_bad >= n_active;
        if (nothing)
            for (const auto &one : all_) check(one.first->holds(one.second), "an output was written on an error");
        for (const std::size_t s : sums_) check(all_[s].first->holds(all_[s].second), "a sum was written on an error");
    }

private:
    std::vector<std::pair<block *, std::vector<char>>> all_;
    std::vector<std::size_t> sums_;
};

struct session {
    byte_reader in;
    std::int64_t n_atoms = 0;
    int base = 0;
    bool any_inactive = false;
    hol_chains *chains = nullptr;

    explicit session(byte_reader r) : in(r)
    {
    }
    ~session()
    {
        hol_chains_destroy(chains);
    }
    session(const session &) = delete;
    session &operator=(const session &) = delete;

    std::size_t atoms3() const
    {
        return 3 * static_cast<std::size_t>(n_atoms);
    }
    std::size_t bonds() const
    {
        return static_cast<std::size_t>(hol_chains_n_bonds(chains));
    }
    std::int64_t active() const
    {
        return any_inactive ? INT64_MAX : hol_chains_n_chains(chains);
    }
    template <class T>
    T *maybe(T *p)
    {
        return in.often() ? p : nullptr;
    }

    void create();
    void add();
    void add_block();
    void set();
    void ask();
    void forces();
    void velocities();
    void positions();
    void violation();
    void metric();
    void inverse();
    void tridiagonal();
    void partition();
    void run();
};

void session::create()
{
    hol_chains_destroy(chains);
    chains = nullptr;
    n_atoms = in.byte() % 70;
    block masses(static_cast<std::size_t>(n_atoms) * sizeof(double));
    fill(masses, static_cast<std::size_t>(n_atoms), in, true);
    hol_chains *const before = reinterpret_cast<hol_chains *>(&masses);
    hol_chains *made = before;
    const std::int64_t n = in.often() ? n_atoms : -1 - in.byte();
    const int status = hol_chains_create(n, maybe(masses.doubles()), in.often() ? &made : nullptr);
    check_status(status);
    if (made == before) made = nullptr;
    check(status == HOL_OK ? made != nullptr || n_atoms < 0 : made == nullptr,
          "a handle after an error, or none after success");
    chains = made;
    base = 0;
    any_inactive = false;
}

void session::add()
{
    std::int64_t n = in.whole();
    // Arrays as long as the numbers say, except where the numbers alone are an error.
    const std::size_t length = static_cast<std::size_t>(n > 0 && n <= n_atoms ? n : 0);
    block atoms((length + 1) * sizeof(std::int64_t)), lengths(length * sizeof(double));
    fill(lengths, length, in, true);
    std::int64_t *list = reinterpret_cast<std::int64_t *>(atoms.data());
    const std::int64_t first = in.byte() % 64, step = in.byte() % 3 == 0 ? -1 : 1;
    for (std::size_t k = 0; k <= length; ++k)
        list[k] = in.often() ? first + step * static_cast<std::int64_t>(k) : in.whole();
    const std::int64_t chains_before = hol_chains_n_chains(chains), bonds_before = hol_chains_n_bonds(chains);
    const int status = hol_chains_add(maybe(chains), n, maybe(list), maybe(lengths.doubles()));
    check_status(status);
    if (status != HOL_OK)
        check(hol_chains_n_chains(chains) == chains_before && hol_chains_n_bonds(chains) == bonds_before,
              "a failing add adds");
}

void session::add_block()
{
    const std::int64_t n_chains = in.whole(), n = in.whole(), first = in.whole();
    const std::size_t length = static_cast<std::size_t>(n > 0 && n <= n_atoms ? n : 0);
    block lengths(length * sizeof(double));
    fill(lengths, length, in, true);
    const std::int64_t chains_before = hol_chains_n_chains(chains), bonds_before = hol_chains_n_bonds(chains);
    const int status = hol_chains_add_block(maybe(chains), n_chains, n, first, maybe(lengths.doubles()));
    check_status(status);
    if (status != HOL_OK)
        check(hol_chains_n_chains(chains) == chains_before && hol_chains_n_bonds(chains) == bonds_before,
              "a failing add adds");
}

void session::set()
{
    switch (in.below(6)) {
        case 0: {
            const int wanted = in.below(4) - 1;
            const int status = hol_chains_set_index_base(maybe(chains), wanted);
            check_status(status);
            if (status == HOL_OK) base = wanted;
            break;
        }
        case 1: {
            block box(9 * sizeof(double));
            fill(box, 9, in);
            if (in.byte() & 1)
                for (int i = 0; i < 9; ++i) box.doubles()[i] = i % 4 == 0 ? in.size() * 8 : 0;
            check_status(hol_chains_set_box(maybe(chains), maybe(box.doubles())));
            break;
        }
        case 2:
            check_status(hol_chains_set_threads(maybe(chains), in.below(5) - 1));
            break;
        case 3: {
            const std::size_t n = static_cast<std::size_t>(hol_chains_n_chains(chains));
            block active(n);
            for (std::size_t c = 0; c < n; ++c) active.data()[c] = static_cast<char>(in.byte() % 3);
            check_status(
                hol_chains_set_active(maybe(chains), maybe(reinterpret_cast<const unsigned char *>(active.data()))));
            any_inactive = true;
            break;
        }
        case 4:
            check_status(hol_chains_set_tolerance(maybe(chains), in.number()));
            break;
        default:
            check_status(hol_chains_set_max_iterations(maybe(chains), static_cast<int>(in.byte()) * 5 - 10));
            break;
    }
}

void session::ask()
{
    const std::size_t n = static_cast<std::size_t>(hol_chains_n_chains(chains));
    block offsets((n + 1) * sizeof(std::int64_t));
    std::int64_t *const o = reinterpret_cast<std::int64_t *>(offsets.data());
    if (hol_chains_offsets(maybe(chains), maybe(o)) == HOL_OK) {
        const std::int64_t which = in.whole();
        const std::int64_t c = which - base;
        const std::size_t size =
            c >= 0 && c < static_cast<std::int64_t>(n) ? static_cast<std::size_t>(o[c + 1] - o[c] + 1) : 0;
        block atoms(size * sizeof(std::int64_t));
        check_status(hol_chains_atoms(maybe(chains), which, maybe(reinterpret_cast<std::int64_t *>(atoms.data()))));
    }
    check(hol_chains_memory(chains) >= 0 && hol_chains_n_atoms(chains) >= 0, "a negative count");
    hol_chains_degrees_of_freedom(maybe(chains), in.byte() % 5);
    hol_status_name(static_cast<int>(in.whole() % 1000));
    check(hol_version()[0] != 0 && hol_instruction_set()[0] != 0, "an empty name");
    std::int64_t place[4];
    hol_error_location(maybe(place), maybe(place + 1), maybe(place + 2), maybe(place + 3));
}

void session::forces()
{
    atom_array r(n_atoms, in), v(n_atoms, in), f(n_atoms, in), g(n_atoms, in);
    block lambda(bonds() * sizeof(double)), tension(bonds() * sizeof(double)), virial(9 * sizeof(double));
    outputs out;
    for (block *b : {&lambda, &tension, &g.plain, &g.laid_out}) out.add(*b);
    out.add_sum(virial);
    const int mode = in.often() ? in.byte() & 1 : in.byte();
    int status;
    if (in.byte() & 1) {
        double *const l = maybe(lambda.doubles());
        double *const into = in.often() ? maybe(g.plain.doubles()) : f.plain.doubles();  // "may be f itself"
        status = hol_forces(maybe(chains), maybe(r.plain.doubles()), maybe(v.plain.doubles()), maybe(f.plain.doubles()),
                            l, maybe(tension.doubles()), into, mode, maybe(virial.doubles()));
        if (status == HOL_OK && l && !any_inactive) check(finite(l, bonds()), "multipliers that are not finite");
    } else {
        status = hol_forces_view(maybe(chains), maybe(&r.view), maybe(&v.view), maybe(&f.view), maybe(lambda.doubles()),
                                 maybe(tension.doubles()), maybe(&g.view), mode, maybe(virial.doubles()));
    }
    out.check_after(status, active());
}

void session::velocities()
{
    atom_array r(n_atoms, in), v(n_atoms, in);
    block lambda(bonds() * sizeof(double)), virial(9 * sizeof(double));
    outputs out;
    for (block *b : {&lambda, &v.plain, &v.laid_out}) out.add(*b);
    out.add_sum(virial);
    const int status = in.byte() & 1
                           ? hol_project_velocities(maybe(chains), maybe(r.plain.doubles()), maybe(v.plain.doubles()),
                                                    maybe(lambda.doubles()), maybe(virial.doubles()))
                           : hol_project_velocities_view(maybe(chains), maybe(&r.view), maybe(&v.view),
                                                         maybe(lambda.doubles()), maybe(virial.doubles()));
    out.check_after(status, active());
}

void session::positions()
{
    atom_array before(n_atoms, in), r(n_atoms, in), v(n_atoms, in);
    if (in.byte() & 1)  // a step as it should be: not far from where it began
        for (std::size_t i = 0; i < atoms3(); ++i)
            r.plain.doubles()[i] = before.plain.doubles()[i] + in.byte() / 65536.0;
    block lambda(bonds() * sizeof(double)), virial(9 * sizeof(double)), report(sizeof(hol_report));
    fill(lambda, bonds(), in);
    outputs out;
    for (block *b : {&lambda, &r.plain, &r.laid_out, &v.plain, &v.laid_out}) out.add(*b);
    out.add_sum(virial);
    const double dt = in.often() ? 0.01 : in.number();
    const int guess = in.often() ? in.byte() & 1 : in.byte();
    hol_report *const said = maybe(reinterpret_cast<hol_report *>(report.data()));
    const int status =
        in.byte() & 1 ? hol_project_positions(maybe(chains), maybe(before.plain.doubles()), maybe(r.plain.doubles()),
                                              maybe(v.plain.doubles()), dt, maybe(lambda.doubles()), guess,
                                              maybe(virial.doubles()), said)
                      : hol_project_positions_view(maybe(chains), maybe(&before.view), maybe(&r.view), maybe(&v.view),
                                                   dt, maybe(lambda.doubles()), guess, maybe(virial.doubles()), said);
    out.check_after(status, active());
    if (said && status == HOL_OK)
        check(said->n_failed == 0 && said->max_error >= 0, "a report of failures without one");
}

void session::violation()
{
    atom_array r(n_atoms, in), v(n_atoms, in);
    block worst(sizeof(hol_worst));
    outputs out;
    out.add_sum(worst);
    hol_worst *const w = maybe(reinterpret_cast<hol_worst *>(worst.data()));
    const int status = in.byte() & 1
                           ? hol_violation(maybe(chains), maybe(r.plain.doubles()), maybe(v.plain.doubles()), w)
                           : hol_violation_view(maybe(chains), maybe(&r.view), maybe(&v.view), w);
    out.check_after(status, active());
}

void session::metric()
{
    atom_array r(n_atoms, in), force(n_atoms, in);
    const std::size_t n = static_cast<std::size_t>(hol_chains_n_chains(chains));
    block log_det(n * sizeof(double)), log_det_z(n * sizeof(double)), energy(sizeof(double));
    outputs out;
    for (block *b : {&log_det, &log_det_z, &force.plain, &force.laid_out}) out.add(*b);
    out.add_sum(energy);
    const double kT = in.often() ? 1 : in.number();
    const int mode = in.often() ? in.byte() & 1 : in.byte();
    const int status =
        in.byte() & 1
            ? hol_metric(maybe(chains), maybe(r.plain.doubles()), kT, maybe(log_det.doubles()),
                         maybe(log_det_z.doubles()), maybe(energy.doubles()), maybe(force.plain.doubles()), mode)
            : hol_metric_view(maybe(chains), maybe(&r.view), kT, maybe(log_det.doubles()), maybe(log_det_z.doubles()),
                              maybe(energy.doubles()), maybe(&force.view), mode);
    out.check_after(status, active());
}

void session::inverse()
{
    atom_array r(n_atoms, in), v(n_atoms, in), f(n_atoms, in);
    hol_inverse *made = reinterpret_cast<hol_inverse *>(this);
    const std::int64_t chain = in.whole();
    const int created = in.byte() & 1 ? hol_inverse_create(maybe(chains), chain, maybe(r.plain.doubles()), &made)
                                      : hol_inverse_create_view(maybe(chains), chain, maybe(&r.view), &made);
    check_status(created);
    check(created == HOL_OK || made == nullptr, "an inverse after an error");
    const std::int64_t n = hol_inverse_n_bonds(made);
    const std::size_t rows = static_cast<std::size_t>(n);
    const std::int64_t i = in.whole(), j = in.whole(), width = in.whole() % 300;
    block numbers((rows * rows + 1) * sizeof(double)), multipliers(rows * sizeof(double)),
        bounds(rows * sizeof(double));
    block band(rows * static_cast<std::size_t>(width < 0 ? 1 : width + 1) * sizeof(double));
    fill(multipliers, rows, in);
    const int scaling = in.often() ? in.byte() & 1 : in.byte();
    const auto after = [](block &b, const std::vector<char> &before, int status) {
        check_status(status);
        if (status != HOL_OK) check(b.holds(before), "an output was written on an error");
    };
    const hol_inverse *const given = maybe(made);
    std::vector<char> before = numbers.copy();
    after(numbers, before, hol_inverse_entry(given, scaling, i, j, maybe(numbers.doubles())));
    before = numbers.copy();
    after(numbers, before, hol_inverse_row(given, scaling, i, maybe(numbers.doubles())));
    before = numbers.copy();
    after(numbers, before, hol_inverse_matrix(given, scaling, maybe(numbers.doubles())));
    before = numbers.copy();
    after(numbers, before, hol_inverse_condition(given, maybe(numbers.doubles())));
    before = band.copy();
    after(band, before, hol_inverse_band(given, scaling, width, maybe(band.doubles())));
    before = bounds.copy();
    double relative = 0;
    after(bounds, before,
          in.byte() & 1
              ? hol_inverse_error_bound(given, maybe(v.plain.doubles()), maybe(f.plain.doubles()),
                                        maybe(multipliers.doubles()), maybe(bounds.doubles()), maybe(&relative))
              : hol_inverse_error_bound_view(given, maybe(&v.view), maybe(&f.view), maybe(multipliers.doubles()),
                                             maybe(bounds.doubles()), maybe(&relative)));
    hol_inverse_destroy(made);
}

void session::tridiagonal()
{
    const std::int64_t n = in.often() ? in.byte() % 30 : -1 - in.byte();
    const std::size_t rows = static_cast<std::size_t>(n > 0 ? n : 0);
    const std::int64_t width = in.whole() % 100;
    block gamma((rows > 0 ? rows - 1 : 0) * sizeof(double)), b(rows * sizeof(double));
    block out(rows * static_cast<std::size_t>(width < 0 ? 1 : width + 1) * sizeof(double) + sizeof(double));
    fill(gamma, rows > 0 ? rows - 1 : 0, in);
    if (in.often())
        for (std::size_t k = 0; k + 1 < rows; ++k) gamma.doubles()[k] = std::fmod(gamma.doubles()[k], 0.75);
    fill(b, rows, in);
    const std::vector<char> before = out.copy();
    const double *const g = maybe(gamma.doubles());
    double *const to = maybe(out.doubles());
    int status = 0;
    switch (in.below(5)) {
        case 0:
            status = hol_tridiagonal_pivots(n, g, to);
            break;
        case 1:
            status = hol_tridiagonal_log_det(n, g, to);
            break;
        case 2:
            status = hol_tridiagonal_solve(n, g, maybe(b.doubles()), to);
            break;
        case 3:
            status = hol_tridiagonal_inverse_entry(n, g, in.whole(), in.whole(), to);
            break;
        default:
            status = hol_tridiagonal_inverse_band(n, g, width, to);
            break;
    }
    check_status(status);
    if (status != HOL_OK) check(out.holds(before), "an output was written on an error");
}

void session::partition()
{
    const std::int64_t n = in.often() ? in.byte() % 6 : -1 - in.byte();
    const std::size_t atoms = static_cast<std::size_t>(n > 0 ? n + 1 : 0);
    block masses(atoms * sizeof(double)), out(3 * sizeof(double));
    fill(masses, atoms, in, true);
    const std::vector<char> before = out.copy();
    double *const o = out.doubles();
    const int status = hol_partition_function(n, maybe(masses.doubles()), maybe(o), maybe(o + 1), maybe(o + 2));
    check_status(status);
    if (status != HOL_OK) check(out.holds(before), "an output was written on an error");
}

void session::run()
{
    create();
    for (int call = 0; call < 24 && !in.done(); ++call) {
        switch (in.below(16)) {
            case 0:
                create();
                break;
            case 1:
            case 2:
                add();
                break;
            case 3:
            case 4:
                add_block();
                break;
            case 5:
                set();
                break;
            case 6:
                ask();
                break;
            case 7:
                partition();
                break;
            case 8:
                tridiagonal();
                break;
            case 9:
            case 10:
                positions();
                break;
            case 11:
                velocities();
                break;
            case 12:
                metric();
                break;
            case 13:
                inverse();
                break;
            case 14:
                violation();
                break;
            default:
                forces();
                break;
        }
    }
}

}  // namespace
}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
    fuzz::session(fuzz::byte_reader(data, size)).run();
    return 0;
}
