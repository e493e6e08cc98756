// Coordinates of a group of atoms by their distances, as a topology file has them: with so many decimals, of which the
// last is rounded. Lengths are adjusted in the least way: coordinates are those of the least sum of squares of what
// distances miss.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace holonomic::rigid {

// Distances among n atoms, [n][n] and symmetric; 0 where none is held.
struct Distances {
    explicit Distances(std::int64_t size) : n(size), length(static_cast<std::size_t>(size * size), 0) {}
    double &at(std::int64_t i, std::int64_t j) { return length[static_cast<std::size_t>(i * n + j)]; }
    double at(std::int64_t i, std::int64_t j) const { return length[static_cast<std::size_t>(i * n + j)]; }
    std::int64_t n;
    std::vector<double> length;
};

// Of a distance that coordinates miss most, relative to it.
struct Misfit {
    double error;
    std::int64_t i, j;
    double distance;
};
Misfit misfit_of(const Distances &wanted, const std::vector<double> &coordinates);

// What distances of coordinates may be off without that lengths have been adjusted.
constexpr double rounding = 1.5e-14;

// The place of atom 0 by its distances to others, of which `coordinates` are known; only distances of atom 0 are looked
// at. False where these others do not tell it.
bool locate(const Distances &wanted, int dimension, std::vector<double> &coordinates);

// Moves coordinates [n][3], of which the first `dimension` coordinates are free, to the least sum of squares nearby.
Misfit fit_coordinates(const Distances &wanted, int dimension, std::vector<double> &coordinates);

// Lengths, each once, whatever its last digits, ascending.
std::vector<double> each_once(std::vector<double> lengths);

// All lengths of the molecule that a group is of, each once. They are asked for where a group's own are so few that
// full digits may look rounded by chance: then these have to be rounded likewise.
using MoleculeLengths = std::function<std::vector<double>()>;

// What the decimals of lengths leave open: by what part coordinates may miss one. Lengths that stand for coordinates of
// some decimals, as differences of these do, leave open the square of those; full digits leave nothing open but
// rounding.
class Decimals {
public:
    Decimals(const Distances &wanted, double tolerance, const MoleculeLengths &all);
    // Coordinates in fewer dimensions are what the lengths say. square: of the height that is left, of the largest
    // distance.
    bool allow(const Misfit &misfit) const { return misfit.error <= std::min(open_, most_); }
    bool allow(double square, const Misfit &misfit) const { return square <= highest_ && allow(misfit); }
    // Fewer than five atoms miss no place in space by more than positions do, which say how far they are from flat.
    bool allow_position(const Misfit &misfit) const { return std::isfinite(highest_) && misfit.error <= 1e-12; }
    // Of an atom by other atoms' coordinates, whose errors add up.
    bool allow_joining(const Misfit &misfit) const { return misfit.error <= 4 * std::min(open_, most_); }
    // Lengths that no other coordinates have may be adjusted so far.
    double most() const { return most_; }
    bool are_full() const { return are_full_; }

private:
    double open_, most_, highest_ = std::numeric_limits<double>::infinity();
    bool are_full_;
};

// What all distances of n atoms say: of three on a line, of four in a plane, of five and more anywhere. Three that make
// no triangle are refused elsewhere (closable.hpp).
struct FittedGroup {
    enum Dependence {
        independent,
        dependent,
        impossible
    } kind;  // impossible: of no place in space, by more than tolerance
    int dimension;
    Misfit misfit;
    std::vector<double> coordinates;
};
FittedGroup look_at(const Distances &wanted, double tolerance, const MoleculeLengths &all);

}  // namespace holonomic::rigid
