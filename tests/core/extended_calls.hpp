/**
 * @file extended_calls.hpp
 * the extended-precision solver in twice the precision, called for one molecule.
 */
#ifndef EXTENDED_CALLS_HPP
#define EXTENDED_CALLS_HPP

#ifndef HOL_ISA
#define HOL_ISA double_double
#endif
#include "core/kernels/extended/verbs.hpp"
#include "extended_case.hpp"
#include "extended_plan.hpp"

namespace extended_case
{

namespace solver = holonomic::double_double::extended;

struct calls {
    molecule m;
    planned s;
    std::vector<double> lambda, g;
    holonomic::MoleculeLane lane;
    holonomic::Tally tally = empty_tally();

    explicit calls(const molecule &given)
        : m(given), s(m), lambda(m.n_bonds, 77.0),
          g(3 * m.n_atoms, 78.0), lane{0, nullptr, nullptr, m.w.data(), m.length.data(), 0, 0}
    {
    }

    void forces()
    {
        holonomic::ForcesCall call{};
        call.r = holonomic::packed_array(m.r.data());
        call.v = holonomic::packed_array(m.v.data());
        call.f = holonomic::packed_array(m.f.data());
        call.g = holonomic::packed_array(g.data());
        call.lambda = lambda.data();
        call.virial = true;
        run(call, solver::forces);
    }
    template <class Call>
    void run(const Call &call, void (*verb)(const Call &, const holonomic::ExtendedPlan &,
                                            const holonomic::MoleculeLane &, double *, holonomic::Tally &))
    {
        verb(call, s.plan, lane, s.scratch, tally);
        require(!s.overrun(), m.name, "scratch memory is overrun");
    }
};

}  // namespace extended_case

#endif
