/**
 * @file session.hpp
 * One handle's life as a fuzzer's bytes tell it: each member function makes one call, or several that belong together.
 */
#ifndef FUZZ_SESSION_HPP
#define FUZZ_SESSION_HPP

#include <holonomic.h>

#include <cstdint>
#include <vector>

#include "byte_reader.hpp"
#include "outputs.hpp"

namespace fuzz
{

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
    // How many bad molecules leave nothing that is written: never so many if bonds between fixed atoms get their 0.
    std::int64_t active() const
    {
        std::vector<std::int64_t> molecules(bonds());
        if (!molecules.empty() && hol_chains_molecules_of_bonds(chains, molecules.data()) != HOL_OK) return INT64_MAX;
        for (const std::int64_t m : molecules)
            if (m < 0) return INT64_MAX;
        return any_inactive ? INT64_MAX : hol_chains_n_molecules(chains);
    }
    template <class T>
    T *maybe(T *p)
    {
        return in.often() ? p : nullptr;
    }

    void create();
    std::int64_t bonds_of_a_chain();
    void add();
    void add_block();
    void fill_pairs(block &pairs, std::size_t n_bonds, std::int64_t span);
    void add_bonds();
    void add_molecules();
    void add_rigid();
    void set_values();
    void ask_about_molecules();
    void solve();
    void react();
    void set();
    void ask();
    void forces();
    void velocities();
    void positions();
    void violation();
    void compare();
    void along();
    void metric();
    void inverse();
    void tridiagonal();
    void partition();
    void run();
};

}  // namespace fuzz

#endif
