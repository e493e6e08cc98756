/**
 * @file extended_shapes.hpp
 * Molecules for the tests of the extended-precision solver: trees, rings, and others.
 */
#ifndef EXTENDED_SHAPES_HPP
#define EXTENDED_SHAPES_HPP

#include "extended_case.hpp"

namespace extended_case
{

struct shape {
    const char *name;
    bonds list;
};

inline bonds ring(int n)
{
    bonds b;
    for (int i = 0; i < n; ++i) b.push_back({i, (i + 1) % n});
    return b;
}

inline bonds random_tree(int n, unsigned seed)
{
    std::mt19937 random(seed);
    bonds b;
    for (int i = 1; i < n; ++i) b.push_back({i, static_cast<int>(random() % static_cast<unsigned>(i))});
    return b;
}

inline bonds star(int arms)
{
    bonds b;
    for (int i = 1; i <= arms; ++i) b.push_back({0, i});
    return b;
}

inline bonds with(bonds b, const bonds &more)
{
    b.insert(b.end(), more.begin(), more.end());
    return b;
}

inline const shape shapes[] = {
    {"one bond", {{0, 1}}},
    {"chain of three", {{0, 1}, {1, 2}, {2, 3}}},
    {"star of four", star(4)},
    {"star of twenty", star(20)},
    {"random tree", random_tree(40, 5)},
    {"triangle", ring(3)},
    {"square", ring(4)},
    {"ring of 21", ring(21)},
    {"lariat", with(ring(5), {{4, 5}, {5, 6}, {5, 7}, {2, 8}})},
    {"bicycle", with(ring(6), {{0, 6}, {6, 7}, {7, 3}})},
    {"tetrahedron", {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}},
    {"triangles", {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {0, 2}, {1, 3}, {2, 4}, {3, 5}, {5, 6}, {5, 7}}},
    {"dense with tails", {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}, {3, 4}, {4, 0}, {4, 5}, {5, 6}, {1, 7}}},
};

}  // namespace extended_case

#endif
