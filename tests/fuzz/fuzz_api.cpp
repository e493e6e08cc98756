/**
 * Sequences of calls of the whole C interface, made from a fuzzer's bytes: sizes, indices, pointers that may be NULL,
 * and numbers of every kind. Beside what the sanitizers see, it must hold that
 *   - a wrong argument writes nothing at all, and so does a failure of every chain;
 *   - sums over chains are not written if a chain fails;
 *   - a success leaves finite numbers only;
 *   - every failure has a message and a known name.
 */
#include <cstddef>
#include <cstdint>

#include "session.hpp"

namespace fuzz
{

void session::run()
{
    create();
    for (int call = 0; call < 24 && !in.done(); ++call) {
        const int what = in.byte();
        switch (what < 160 ? what % 16 : what < 242 ? 16 + what % 7 : what < 250 ? 24 : 23) {
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
            case 15:
                forces();
                break;
            case 16:
            case 17:
                add_bonds();
                break;
            case 18:
                add_molecules();
                break;
            case 19:
                set_values();
                break;
            case 20:
                ask_about_molecules();
                break;
            case 21:
                react();
                break;
            case 23:
                compare();
                along();
                break;
            case 24:
                add_rigid();
                break;
            default:
                solve();
                break;
        }
    }
}

}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
    fuzz::session(fuzz::byte_reader(data, size)).run();
    return 0;
}
