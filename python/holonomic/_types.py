"""What may be given for an array: one number, nested sequences of numbers, or an array. Text is none of these, though
numpy's own ArrayLike has it."""

from __future__ import annotations

from typing import Optional, Sequence, Union

import numpy as np

Number = Union[float, np.floating, np.integer]
Floats = Union[Number, np.ndarray, Sequence[Number], Sequence[np.ndarray], Sequence[Sequence[Number]]]
Integers = Union[np.ndarray, Sequence[Union[int, np.integer]]]
Pairs = Union[np.ndarray, Sequence[Integers]]
Bodies = Sequence[Integers]
Places = Union[np.ndarray, Sequence[Floats], Sequence[Sequence[Sequence[Number]]]]
Array = Optional[Floats]
