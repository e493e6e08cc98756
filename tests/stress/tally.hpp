/**
 * @file tally.hpp
 * Counts over all cases of a run by class with one set of kernels, and the tables at its end.
 */
#ifndef STRESS_TALLY_HPP
#define STRESS_TALLY_HPP

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "markdown_table.hpp"
#include "verdict.hpp"

namespace stress
{

/** What the reference says about a case, as far as it is counted. */
struct case_facts {
    std::int64_t n_bonds;
    std::uint64_t seed;
    bool regular, promised;
    long double condition;
};

template <class Quantity>
struct tally_of {
    using about = quantities<Quantity>;
    static const char *name(std::size_t q)
    {
        return about::name(static_cast<Quantity>(q));
    }
    static bool for_information(std::size_t q)
    {
        return about::for_information(static_cast<Quantity>(q));
    }
    struct of_quantity {
        std::int64_t checked = 0, exceeded = 0;
        long double worst = -1;
        std::uint64_t seed = 0;  ///< of the case with the largest error
        void add(const of_quantity &other)
        {
            checked += other.checked;
            exceeded += other.exceeded;
            if (other.worst > worst) worst = other.worst, seed = other.seed;
        }
    };
    struct of_class {
        std::array<of_quantity, about::count> quantity{};
        std::int64_t cases = 0, bonds = 0, singular = 0, not_promised = 0, exceeded = 0;
        long double largest_condition = 0;
        void add(const of_class &other)
        {
            cases += other.cases;
            bonds += other.bonds;
            singular += other.singular;
            not_promised += other.not_promised;
            exceeded += other.exceeded;
            largest_condition = std::max(largest_condition, other.largest_condition);
            for (std::size_t q = 0; q < quantity.size(); ++q) quantity[q].add(other.quantity[q]);
        }
    };
    static constexpr std::size_t most_classes = 6;
    std::array<of_class, most_classes> classes{};

    void add(std::size_t its_class, const case_facts &facts, const verdict_of<Quantity> &v)
    {
        of_class one;
        one.cases = 1;
        one.bonds = facts.n_bonds;
        one.singular = !facts.regular;
        one.not_promised = facts.regular && !facts.promised;
        one.exceeded = v.exceeded();
        if (facts.regular) one.largest_condition = facts.condition;
        for (std::size_t q = 0; q < one.quantity.size(); ++q)
            if (v.ratio[q] >= 0) one.quantity[q] = {1, v.ratio[q] > 1, v.ratio[q], facts.seed};
        classes[its_class].add(one);
    }
    void add(const tally_of &other)
    {
        for (std::size_t c = 0; c < classes.size(); ++c) classes[c].add(other.classes[c]);
    }
    of_class all() const
    {
        of_class sum;
        for (const of_class &c : classes) sum.add(c);
        return sum;
    }
    /** Whether no error is above `excess` times its bound and at most `share` of each class exceed one at all. */
    bool within(long double excess, double share) const
    {
        for (const of_class &here : classes) {
            if (static_cast<double>(here.exceeded) > share * static_cast<double>(here.cases)) return false;
            for (std::size_t q = 0; q < here.quantity.size(); ++q)
                if (!for_information(q) && here.quantity[q].worst > excess) return false;
        }
        return true;
    }
};

/** The classes of a run: how they are called, for people, and what a case is. */
struct class_names {
    const char *(*of)(int);
    std::size_t n;
    const char *one;
};

/** A table for each class, with a column for each set of kernels. */
template <class Tally>
void print_tables(const class_names &names, const std::vector<std::string> &sets, const std::vector<Tally> &of_set)
{
    for (std::size_t c = 0; c < names.n; ++c) {
        std::printf("\n%s\n%-15s %10s", names.of(static_cast<int>(c)), "worst err/bound", "checked");
        for (const std::string &set : sets) std::printf(" %9s", set.c_str());
        std::printf(" %9s %8s\n", "exceeded", names.one);
        for (std::size_t q = 0; q < Tally::about::count; ++q) {
            typename Tally::of_quantity all;
            for (const Tally &t : of_set) all.add(t.classes[c].quantity[q]);
            if (all.checked == 0) continue;
            std::printf("%-15s %10lld", Tally::name(q), static_cast<long long>(all.checked));
            for (const Tally &t : of_set) std::printf(" %9.3Lg", t.classes[c].quantity[q].worst);
            std::printf(" %9lld %8llu%s\n", static_cast<long long>(all.exceeded),
                        static_cast<unsigned long long>(all.seed),
                        Tally::for_information(q) ? "  (for information)" : "");
        }
    }
}

/** And a line for each class and set. */
template <class Tally>
void print_sums(const class_names &names, const std::vector<std::string> &sets, const std::vector<Tally> &of_set)
{
    std::printf("\n");
    for (std::size_t s = 0; s < sets.size(); ++s)
        for (std::size_t c = 0; c < names.n; ++c) {
            const typename Tally::of_class &here = of_set[s].classes[c];
            std::printf(
                "stress: %lld %s with %s, %lld bonds, condition numbers up to %.1Le, %lld singular, %lld "
                "promised nothing, %lld exceed a bound\n",
                static_cast<long long>(here.cases), names.of(static_cast<int>(c)), sets[s].c_str(),
                static_cast<long long>(here.bonds), here.largest_condition, static_cast<long long>(here.singular),
                static_cast<long long>(here.not_promised), static_cast<long long>(here.exceeded));
        }
}

/** The largest error of each class, to the end of the file that STRESS_MARKDOWN (environment) names. */
template <class Tally>
void write_markdown(const class_names &names, const std::vector<std::string> &sets, const std::vector<Tally> &of_set)
{
    const markdown_table table(sets);
    for (std::size_t c = 0; c < names.n && table.out; ++c) {
        table.row(names.of(static_cast<int>(c)),
                  [&](std::size_t s) { return std::to_string(of_set[s].classes[c].cases); });
        table.row("above a bound", [&](std::size_t s) { return std::to_string(of_set[s].classes[c].exceeded); });
        table.row("largest error", [&](std::size_t s) {
            std::size_t most = 0;
            const auto &quantity = of_set[s].classes[c].quantity;
            for (std::size_t q = 1; q < quantity.size(); ++q)
                if (!Tally::for_information(q) && quantity[q].worst > quantity[most].worst) most = q;
            return table.number(quantity[most].worst) + ", " + Tally::name(most);
        });
    }
}

}  // namespace stress

#endif
