"""Says which tests passed in the first of two reports of pytest (junit's XML) and not in the second. Status 1 if there are any.

    compare.py AS_THEY_ARE EXCHANGED
"""

import sys
import xml.etree.ElementTree as tree


def outcomes(path):
    """What became of each test: "passed", "skipped", "failure" or "error"."""
    found = {}
    for case in tree.parse(path).iter("testcase"):
        kinds = [child.tag for child in case if child.tag in ("skipped", "failure", "error")]
        found[case.get("classname"), case.get("name")] = kinds[0] if kinds else "passed"
    return found


def main(as_they_are, exchanged):
    own, ours = outcomes(as_they_are), outcomes(exchanged)
    passed = [test for test, outcome in own.items() if outcome == "passed"]
    lost = [test for test in passed if ours.get(test) != "passed"]
    for test in lost:
        print(f"{'.'.join(test)}: passed with ASE's constraint, {ours.get(test, 'not run')} with holonomic's")
    both = list(own.values())
    print(f"{len(own)} tests: {len(passed)} pass with ASE's constraint, {len(passed) - len(lost)} of these with holonomic's; "
          f"{both.count('skipped')} skipped, {len(own) - len(passed) - both.count('skipped')} fail with both names or with ASE's")
    return 1 if lost or not passed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
