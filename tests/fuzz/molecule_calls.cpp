// Molecules of any shape: lists of bonds, new lengths and masses, questions, given right-hand sides.
#include <initializer_list>

#include "session.hpp"

namespace fuzz
{

// Pairs near each other, so that molecules come about, with wrong ones among them.
void session::fill_pairs(block &pairs, std::size_t n_bonds, std::int64_t span)
{
    std::int64_t *const list = reinterpret_cast<std::int64_t *>(pairs.data());
    const int near = 1 + in.below(6);
    for (std::size_t k = 0; k < n_bonds; ++k) {
        const std::int64_t i = span > 0 ? in.byte() % span : 0;
        list[2 * k] = base + i;
        list[2 * k + 1] = in.often() ? base + i + 1 + in.below(near) : in.whole();
    }
}

void session::add_bonds()
{
    const std::int64_t n = in.often() ? in.below(40) : in.whole();
    // Arrays as long as the number says, except where the number alone is an error.
    const std::size_t size = static_cast<std::size_t>(n > 0 && n < 2000 ? n : 0);
    block pairs(2 * size * sizeof(std::int64_t)), lengths(size * sizeof(double));
    fill_pairs(pairs, size, n_atoms);
    fill(lengths, size, in, true);
    const std::int64_t chains_before = hol_chains_n_molecules(chains), bonds_before = hol_chains_n_bonds(chains),
                       kinds_before = hol_chains_n_kinds(chains);
    const bool too_long = n > 2000 && n <= 1073741824;
    if (too_long) return;
    const int status = hol_chains_add_bonds(maybe(chains), n, maybe(reinterpret_cast<std::int64_t *>(pairs.data())),
                                            maybe(lengths.doubles()));
    check_status(status);
    if (status == HOL_OK)
        check(hol_chains_n_bonds(chains) == bonds_before + n, "bonds are missing");
    else
        check(hol_chains_n_molecules(chains) == chains_before && hol_chains_n_bonds(chains) == bonds_before &&
                  hol_chains_n_kinds(chains) == kinds_before,
              "a failing add adds");
}

void session::add_molecules()
{
    const std::int64_t n_molecules = in.whole(), n_of_each = in.whole(), first = in.whole(),
                       n = in.often() ? in.below(12) : in.whole();
    const std::size_t size = static_cast<std::size_t>(n > 0 && n < 2000 ? n : 0);
    if (n > 2000 && n <= 1073741824) return;
    block pairs(2 * size * sizeof(std::int64_t)), lengths(size * sizeof(double));
    fill_pairs(pairs, size, n_of_each);
    fill(lengths, size, in, true);
    const std::int64_t bonds_before = hol_chains_n_bonds(chains);
    const int status =
        hol_chains_add_molecules(maybe(chains), n_molecules, n_of_each, first, n,
                                 maybe(reinterpret_cast<std::int64_t *>(pairs.data())), maybe(lengths.doubles()));
    check_status(status);
    check(hol_chains_n_bonds(chains) == bonds_before + (status == HOL_OK ? n * n_molecules : 0), "a failing add adds");
}

void session::set_values()
{
    block lengths(bonds() * sizeof(double)), masses(static_cast<std::size_t>(n_atoms) * sizeof(double));
    fill(lengths, bonds(), in, true);
    fill(masses, static_cast<std::size_t>(n_atoms), in, true);
    check_status(hol_chains_set_lengths(maybe(chains), maybe(lengths.doubles())));
    check_status(hol_chains_set_masses(maybe(chains), maybe(masses.doubles())));
    block box(9 * sizeof(double));
    fill(box, 9, in);
    if (in.byte() & 1)
        for (int i = 0; i < 9; ++i) box.doubles()[i] = i % 4 == 0 ? in.size() * 8 : 0;
    check_status(hol_chains_set_reference_box(maybe(chains), maybe(box.doubles())));
    fill(box, 9, in, true);
    check_status(hol_chains_set_box_rate(maybe(chains), in.often() ? nullptr : box.doubles()));
    const std::size_t n_labels = static_cast<std::size_t>(n_atoms + hol_chains_n_molecules(chains));
    block labels(n_labels * sizeof(std::int64_t));
    fill(labels, n_labels, in);
    std::int64_t *const numbers = reinterpret_cast<std::int64_t *>(labels.data());
    check_status(hol_chains_set_labels(maybe(chains), maybe(numbers), maybe(numbers + n_atoms)));
}

void session::ask_about_molecules()
{
    const std::int64_t n_chains = hol_chains_n_molecules(chains), which = in.whole();
    std::int64_t n_of_atoms = -1, n_of_bonds = -1, of_shape = 0;
    int shape = -1;
    const int status = hol_chains_molecule(maybe(chains), which, maybe(&shape), &n_of_atoms, &n_of_bonds);
    check_status(status);
    if (status == HOL_OK) {
        hol_chains_molecule(chains, which, &shape, nullptr, nullptr);
        check(n_of_atoms >= 2 && (shape == HOL_SHAPE_RIGID || (n_of_bonds >= 1 && n_of_atoms <= n_of_bonds + 1)),
              "a molecule of another size");
        block atoms(static_cast<std::size_t>(n_of_atoms) * sizeof(std::int64_t)),
            list(static_cast<std::size_t>(n_of_bonds) * sizeof(std::int64_t)),
            molecules(bonds() * sizeof(std::int64_t));
        std::int64_t *const a = reinterpret_cast<std::int64_t *>(atoms.data()),
                            *const b = reinterpret_cast<std::int64_t *>(list.data()),
                            *const m = reinterpret_cast<std::int64_t *>(molecules.data());
        check_status(hol_chains_atoms(maybe(chains), which, a));
        check_status(hol_chains_molecules_of_bonds(chains, m));
        if (hol_chains_bonds(maybe(chains), which, b) == HOL_OK)
            for (std::int64_t k = 0; k < n_of_bonds; ++k)
                check(b[k] >= base && b[k] - base < hol_chains_n_bonds(chains) && m[b[k] - base] == which,
                      "a bond of another molecule");
    }
    for (int s = -1; s < 6; ++s) of_shape += hol_chains_n_of_shape(chains, static_cast<hol_shape>(s));
    check(of_shape == n_chains, "a molecule of no shape");
    check(hol_chains_n_kinds(maybe(chains)) <= n_chains, "more kinds than molecules");
}

void session::solve()
{
    atom_array r(n_atoms, in), g(n_atoms, in);
    block rhs(bonds() * sizeof(double)), lambda(bonds() * sizeof(double)), virial(9 * sizeof(double));
    fill(rhs, bonds(), in);
    outputs out;
    for (block *b : {&lambda, &g.plain, &g.laid_out}) out.add(*b);
    out.add_sum(virial);
    const hol_mode mode = static_cast<hol_mode>(in.often() ? in.byte() & 1 : in.byte());
    double *const into = in.often() ? maybe(lambda.doubles()) : rhs.doubles();  // "may be rhs itself"
    const int status = in.byte() & 1 ? hol_solve(maybe(chains), maybe(r.plain.doubles()), maybe(rhs.doubles()), into,
                                                 maybe(g.plain.doubles()), mode, maybe(virial.doubles()))
                                     : hol_solve_view(maybe(chains), maybe(r.input()), maybe(rhs.doubles()), into,
                                                      maybe(&g.view), mode, maybe(virial.doubles()));
    out.check_after(status, active());
}

void session::react()
{
    atom_array r(n_atoms, in), g(n_atoms, in);
    block lambda(bonds() * sizeof(double)), tension(bonds() * sizeof(double)), of_bonds(6 * bonds() * sizeof(double)),
        virial(9 * sizeof(double));
    fill(lambda, bonds(), in);
    outputs out;
    for (block *b : {&tension, &of_bonds, &g.plain, &g.laid_out}) out.add(*b);
    out.add_sum(virial);
    const hol_mode mode = static_cast<hol_mode>(in.often() ? in.byte() & 1 : in.byte());
    const hol_which_box box = static_cast<hol_which_box>(in.often() ? in.byte() & 1 : in.byte());
    const int status = in.byte() & 1
                           ? hol_reactions(maybe(chains), maybe(r.plain.doubles()), box, maybe(lambda.doubles()),
                                           maybe(tension.doubles()), maybe(g.plain.doubles()), mode,
                                           maybe(of_bonds.doubles()), maybe(virial.doubles()))
                           : hol_reactions_view(maybe(chains), maybe(r.input()), box, maybe(lambda.doubles()),
                                                maybe(tension.doubles()), maybe(&g.view), mode,
                                                maybe(of_bonds.doubles()), maybe(virial.doubles()));
    out.check_after(status, active());
}

}  // namespace fuzz
