#include "tally.hpp"

#include <algorithm>
#include <cstdio>

namespace stress
{

void tally::add(const hostile_chain &c, const verdict &v)
{
    ++chains;
    bonds += c.n_bonds;
    exceeded += v.exceeded();
    for (std::size_t bit = 0; bit < with_feature.size(); ++bit) {
        if (!(c.features >> bit & 1u)) continue;
        ++with_feature[bit];
        exceeded_with_feature[bit] += v.exceeded();
    }
    for (std::size_t q = 0; q < quantity.size(); ++q) {
        of_quantity &here = quantity[q];
        if (v.ratio[q] < 0) continue;
        ++here.checked;
        here.exceeded += v.ratio[q] > 1;
        if (v.ratio[q] > here.worst) {
            here.worst = v.ratio[q];
            here.seed = c.seed;
        }
    }
}

void tally::add(const tally &other)
{
    chains += other.chains;
    bonds += other.bonds;
    singular += other.singular;
    exceeded += other.exceeded;
    largest_condition = std::max(largest_condition, other.largest_condition);
    for (std::size_t bit = 0; bit < with_feature.size(); ++bit) {
        with_feature[bit] += other.with_feature[bit];
        exceeded_with_feature[bit] += other.exceeded_with_feature[bit];
    }
    for (std::size_t q = 0; q < quantity.size(); ++q) {
        quantity[q].checked += other.quantity[q].checked;
        quantity[q].exceeded += other.quantity[q].exceeded;
        if (other.quantity[q].worst > quantity[q].worst) {
            quantity[q].worst = other.quantity[q].worst;
            quantity[q].seed = other.quantity[q].seed;
        }
    }
}

long double tally::worst() const
{
    long double largest = 0;
    for (int q = 0; q < N_QUANTITIES; ++q)
        if (!for_information(q)) largest = std::max(largest, quantity[static_cast<std::size_t>(q)].worst);
    return largest;
}

void tally::print() const
{
    std::printf("\n%-14s %10s %16s %9s %8s\n", "quantity", "checked", "worst err/bound", "exceeded", "chain");
    for (int q = 0; q < N_QUANTITIES; ++q) {
        const of_quantity &here = quantity[static_cast<std::size_t>(q)];
        if (here.checked == 0) continue;
        std::printf("%-14s %10lld %16.3Lg %9lld %8llu%s\n", quantity_name(q), static_cast<long long>(here.checked),
                    here.worst, static_cast<long long>(here.exceeded), static_cast<unsigned long long>(here.seed),
                    for_information(q) ? "  (for information)" : "");
    }
    std::printf("\n%-20s %10s %10s\n", "chains with", "checked", "exceeded");
    for (int bit = 0; bit < n_features; ++bit)
        std::printf("%-20s %10lld %10lld\n", feature_name(bit),
                    static_cast<long long>(with_feature[static_cast<std::size_t>(bit)]),
                    static_cast<long long>(exceeded_with_feature[static_cast<std::size_t>(bit)]));
    std::printf(
        "\nstress: %lld chains, %lld bonds, condition numbers up to %.1Le, %lld singular, %lld exceed a bound\n",
        static_cast<long long>(chains), static_cast<long long>(bonds), largest_condition,
        static_cast<long long>(singular), static_cast<long long>(exceeded));
}

}  // namespace stress
