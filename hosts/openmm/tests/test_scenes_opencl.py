"""The scenes of OpenMM's own tests on the platform OpenCL, in three precisions. Ends with 77, and the reason, where there is no device."""

import sys
import unittest

import test_scenes
from test_opencl import DEVICE, PRECISIONS, missing
from test_scenes import Scenes  # noqa: F401: what is run

test_scenes.PLATFORMS = [f"{DEVICE} {precision}" for precision in PRECISIONS]

if __name__ == "__main__":
    reason = missing()
    if reason:
        print(f"left out: {reason}")
        sys.exit(77)
    unittest.main()
