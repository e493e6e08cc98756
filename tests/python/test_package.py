"""The package beside the header, and beside the library's own version."""

import inspect
import os
import re
import unittest

import holonomic as hol
from holonomic import _library

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
LETTERS = {**dict.fromkeys(("hol_bodies", "hol_device_array", "hol_device_precision", "hol_mode", "hol_scaling", "hol_shape", "hol_when", "hol_which_box"), "i"), "int": "i", "void": "-", "int64_t": "l", "const char *": "s", "double": "d"}


def prototypes():
    with open(os.path.join(SOURCE, "capi", "holonomic.h")) as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
    for match in re.finditer(r"HOL_API\s+([^;(]*?)(\w+)\(([^)]*)\);", text):
        result, name, arguments = (" ".join(part.split()) for part in match.groups())
        letters = ""
        for argument in arguments.split(","):
            if argument != "void":
                letters += "p" if "*" in argument else LETTERS[argument.strip().rsplit(" ", 1)[0]]
        yield name, f"{LETTERS[result]} {letters}".strip()


class Package(unittest.TestCase):
    def test_declares_functions_as_the_header_does(self):
        header = dict(prototypes())
        self.assertGreater(len(header), 60)
        for name, signature in _library.SIGNATURES.items():
            self.assertEqual(signature, header[name], name)

    def test_reaches_every_function(self):
        by_view = {name for name, _ in prototypes() if name + "_view" in _library.SIGNATURES}
        # Python counts from 0, offsets say less than `Molecule.bonds`, and arrays that were set come back as they were given.
        left_out = {"hol_chains_set_index_base", "hol_chains_index_base", "hol_chains_offsets", "hol_chains_active",
                    "hol_chains_box_rate"}
        self.assertEqual({name for name, _ in prototypes()} - by_view - left_out - set(_library.SIGNATURES), set())

    def test_has_the_version_of_the_library(self):
        self.assertEqual(hol.__version__, hol.version())
        self.assertIn(hol.instruction_set(), ("baseline", "avx2", "avx512vl", "scalar"))

    def test_documents_everything(self):
        for name in hol.__all__:
            thing = getattr(hol, name)
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isclass(thing):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")
        for base in hol.Molecules.__mro__[1:-1]:
            for member, value in vars(base).items():
                if not member.startswith("_") and (inspect.isfunction(value) or inspect.isdatadescriptor(value)):
                    self.assertTrue(inspect.getdoc(value), member)


if __name__ == "__main__":
    unittest.main()
