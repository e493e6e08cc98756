/**
 * @file seam_features.hpp
 * What decouples, couples or is far larger than the rest, put where the kernels cut a chain and beside it.
 */
#ifndef STRESS_SEAM_FEATURES_HPP
#define STRESS_SEAM_FEATURES_HPP

#include "cuts.hpp"
#include "hostile_chain.hpp"

namespace stress
{

enum seam_feature {
    FIXED_THERE,
    SQUARE_THERE,  ///< exactly, if the atoms are near the origin
    STRAIGHT_THERE,
    FOLDED_THERE,
    HEAVY_THERE,
    LIGHT_THERE,
    HEAVY_BESIDE_LIGHT,
    PULLED_THERE,   ///< a force 1e18 times the others
    FAST_THERE,     ///< a velocity 1e6 times the others
    IN_LINE_THERE,  ///< a light atom nearly in line, which nothing pulls; another one exactly at the seam behind
    N_SEAM_FEATURES
};
constexpr int n_drawn_features = IN_LINE_THERE;  // by chains with numbers; what follows has come later
const char *seam_feature_name(int feature);

/** Which feature stands where. */
struct seam_features {
    seam_feature feature;
    std::vector<std::int64_t> atoms;

    /** In the order in which a chain is drawn; each does what concerns it. */
    void put_masses(hostile_chain &c) const;
    void put_forces(hostile_chain &c) const;
    void put_bends(hostile_chain &c) const;
};

/** How far from a seam: one before, at it, one and two behind. */
constexpr int n_seam_offsets = 4, first_seam_offset = -1;

/** The same at all seams, or at number `one` of them; `one` counts on beyond the last. */
seam_features at_all_seams(seam_feature feature, const std::vector<std::int64_t> &seams, int offset);
seam_features at_one_seam(seam_feature feature, const std::vector<std::int64_t> &seams, int offset, std::size_t one);

/** Coils and rods that are cut, by every feature, place and number of lanes: numbers 0 .. n_seam_chains() - 1. */
std::uint64_t n_seam_chains();
hostile_chain make_seam_chain(std::uint64_t number);
std::string words_of_seam_chain(std::uint64_t number);

}  // namespace stress

#endif
