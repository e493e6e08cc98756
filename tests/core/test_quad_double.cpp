// The arithmetic of the extended-precision solver's last resort, four doubles a number, against 640 bits of integer
// arithmetic.
#include <cstdio>
#include <random>

#define HOL_ISA quad_double
#define HOL_LANES 2
#define HOL_QUAD_DOUBLE
#include "core/kernels/extended/wide.hpp"
#include "wide_float.hpp"

namespace
{

using holonomic::quad_double::as_quad_double;
using holonomic::quad_double::QuadDouble;
using exact = reference::wide_float<640>;

exact value(const QuadDouble &a)
{
    return exact(a.hi) + exact(a.second) + exact(a.third) + exact(a.fourth);
}

int failures = 0;

// QuadDouble words of 53 bits, of which a few are lost.
void check(const char *what, const QuadDouble &found, const exact &wanted, const exact &size)
{
    const long double error = static_cast<long double>((value(found) - wanted) / size);
    const bool ordered = found.hi != 0 || (found.second == 0 && found.third == 0 && found.fourth == 0);
    if (error < 0x1p-200L && error > -0x1p-200L && ordered) return;
    if (failures++ < 10) std::printf("%s is off by %.3Lg of its terms\n", what, error);
}

struct Dice {
    std::mt19937_64 engine{1};
    double number()
    {
        return std::uniform_real_distribution<double>(-1, 1)(engine);
    }
    // Up to four words, with gaps between some of them.
    QuadDouble any()
    {
        QuadDouble sum = as_quad_double(number());
        double size = 1;
        for (int word = static_cast<int>(engine() % 4); word > 0; --word) {
            size *= engine() % 3 == 0 ? 0x1p-70 : 0x1p-53;
            sum = sum + as_quad_double(size * number());
        }
        return sum;
    }
};

void check_operations(Dice &dice)
{
    const QuadDouble a = dice.any(), b = dice.any(), tiny = 0x1p-90 * dice.any();
    const exact x = value(a), y = value(b);
    check("a + b", a + b, x + y, exact(2));
    check("a - b", a - b, x - y, exact(2));
    check("a b", a * b, x * y, x * y);
    check("s b", a.hi * b, exact(a.hi) * y, exact(a.hi) * y);
    check("a / b", a / b, x / y, x / y);
    // What is left of a sum in which the first words cancel.
    check("(a + tiny) - a", (a + tiny) - a, value(a + tiny) - x, exact(1));
    const QuadDouble square = a * a, root = holonomic::quad_double::square_root(square);
    check("square root", root, a.hi < 0 ? -x : x, x);
    check("zero", a - a, exact(0), exact(1));
    if (holonomic::quad_double::less(a, b) != (x < y)) check("less", as_quad_double(1), exact(0), exact(1));
}

}  // namespace

int main()
{
    Dice dice;
    for (int i = 0; i < 2000; ++i) check_operations(dice);
    std::printf("%d failures\n", failures);
    return failures > 0;
}
