"""The description of a problem: variables with units and bounds, objectives, constraints, metrics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ._values import FloatArray, to_points


@dataclass(frozen=True)
class Variable:
    """A decision variable. Bounds and start are in its unit. `scale` is "linear" or "logarithmic" (bounds and start then have one sign).

    `type` is "real", "integer" or "category". `choices` are the words of a category; its values are the numbers of the words, from 0.
    """

    name: str
    unit: str
    lower: float
    upper: float
    start: float
    scale: str
    type: str = "real"
    choices: tuple[str, ...] = ()


def _read_variable(content: dict[str, Any]) -> Variable:
    values: dict[str, Any] = {key: content[key] for key in Variable.__dataclass_fields__ if key in content}
    values["choices"] = tuple(content.get("choices", ()))
    return Variable(**values)


@dataclass(frozen=True)
class Quantity:
    """A measured quantity and its unit ("" if it has none)."""

    name: str
    unit: str = ""


def _restore_shape(matrix: FloatArray, given: npt.ArrayLike) -> FloatArray:
    """Returns the only row of the matrix if one point was given as a vector, otherwise the matrix."""
    return np.asarray(matrix[0]) if np.ndim(given) == 1 else matrix


class Description:
    """The description of a problem.

    Attributes
    ----------
    name : str
    variables : tuple of Variable
    lower, upper, start : array (d,)
        One value per variable, in its unit.
    is_logarithmic, is_discrete : array of bool (d,)
        `is_discrete`: integers and categories, whose values are whole numbers.
    objectives : tuple of Quantity
        The quantities to minimise.
    weights : array (m,)
        Where one number is needed, it is the sum of the objectives with these weights.
    constraints : tuple of Quantity
        A constraint is met if its value g is at most 0.
    violation_scale : float
        The value that counts as much as a violation of 1, in the unit of the weighted sum.
    metrics : tuple of Quantity
    has_residuals, has_jacobian : bool
        Whether evaluations can contain residuals and their exact derivatives. The sum of the squared residuals is the objective.
    """

    def __init__(self, content: dict[str, Any]) -> None:
        self._content = content
        self.name: str = content["name"]
        self.variables = tuple(_read_variable(one) for one in content["variables"])
        self.lower: FloatArray = np.array([v.lower for v in self.variables])
        self.upper: FloatArray = np.array([v.upper for v in self.variables])
        self.start: FloatArray = np.array([v.start for v in self.variables])
        self.is_logarithmic: npt.NDArray[np.bool_] = np.array([v.scale == "logarithmic" for v in self.variables], dtype=bool)
        self.is_discrete: npt.NDArray[np.bool_] = np.array([v.type != "real" for v in self.variables], dtype=bool)
        self.objectives = tuple(Quantity(one["name"], one["unit"]) for one in content["objectives"])
        self.constraints = tuple(Quantity(one["name"], one["unit"]) for one in content["constraints"])
        self.metrics = tuple(Quantity(one["name"], one["unit"]) for one in content.get("metrics", []))
        weights = content["objective_weights"] or [1.0] + [0.0] * (len(self.objectives) - 1)
        self.weights: FloatArray = np.array(weights, dtype=np.float64)
        self.violation_scale: float = content.get("violation_scale", 1.0)
        self.has_residuals: bool = content["has_residuals"]
        self.has_jacobian: bool = content.get("has_jacobian", False)
        self._sign = np.where(self.is_logarithmic & (self.lower < 0), -1.0, 1.0)

    def __len__(self) -> int:
        """Returns the number of decision variables."""
        return len(self.variables)

    def clip(self, points: npt.ArrayLike) -> FloatArray:
        """Returns the nearest points within the bounds, in the shape of `points`: (n, d), or (d,) for one point.

        Integers and categories are rounded.
        """
        given = to_points(points)
        if self.is_discrete.any():
            given = np.where(self.is_discrete, np.floor(given + 0.5), given)
        return _restore_shape(np.clip(given, self.lower, self.upper), points)

    def to_unit(self, points: npt.ArrayLike) -> FloatArray:
        """Returns points as fractions, (n, d) or (d,) as given: 0 at the lower bound, 1 at the upper bound, on the scale of each variable.

        With fractions, a step of one size means the same for all variables, linear or logarithmic.
        """
        low, high = self._to_scale(self.lower[np.newaxis]), self._to_scale(self.upper[np.newaxis])
        return _restore_shape(np.asarray((self._to_scale(to_points(points)) - low) / (high - low), dtype=np.float64), points)

    def from_unit(self, shares: npt.ArrayLike) -> FloatArray:
        """Returns the points for fractions of to_unit(), (n, d) or (d,) as given, clipped to the bounds."""
        low, high = self._to_scale(self.lower[np.newaxis]), self._to_scale(self.upper[np.newaxis])
        scaled = low + to_points(shares, "shares") * (high - low)
        magnitude = np.exp(np.where(self.is_logarithmic, scaled, 0.0))
        return _restore_shape(self.clip(np.where(self.is_logarithmic, self._sign * magnitude, scaled)), shares)

    def _to_scale(self, points: FloatArray) -> FloatArray:
        logarithm = np.log(np.where(self.is_logarithmic, np.abs(points), 1.0))
        return np.where(self.is_logarithmic, logarithm, points)

    def calc_values(self, objectives: FloatArray) -> FloatArray:
        """Returns the weighted sums of objectives (n, m): one number per point, (n,)."""
        total = self.weights[0] * objectives[:, 0]
        for i in range(1, len(self.weights)):
            total = total + self.weights[i] * objectives[:, i]
        return np.asarray(total, dtype=np.float64)
