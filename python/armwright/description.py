"""What is fixed about a problem: variables with units and bounds, objectives, constraints, metrics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ._values import FloatArray, to_points


@dataclass(frozen=True)
class Variable:
    """A decision variable: bounds and start in its unit; `scale` is "linear" or "logarithmic" (bounds and start of one sign)."""

    name: str
    unit: str
    lower: float
    upper: float
    start: float
    scale: str


@dataclass(frozen=True)
class Quantity:
    """Something that is measured, and its unit ("" for none)."""

    name: str
    unit: str


class Description:
    """A problem's description.

    Attributes
    ----------
    name : str
    variables : tuple of Variable
    lower, upper, start : array (d,)
        Of the variables, in their units.
    is_logarithmic : array of bool (d,)
    objectives : tuple of Quantity
        To be minimised.
    weights : array (m,)
        Where one number is needed, this weighted sum of the objectives counts.
    constraints : tuple of Quantity
        One is met where its value g is at most 0.
    violation_scale : float
        What a violation of 1 is worth in the unit of the weighted sum.
    metrics : tuple of Quantity
    has_residuals, has_jacobian : bool
        Whether evaluations can carry residuals, the sum of whose squares is the objective, and their exact derivatives.
    """

    def __init__(self, content: dict[str, Any]) -> None:
        self._content = content
        self.name: str = content["name"]
        self.variables = tuple(Variable(**{key: one[key] for key in Variable.__dataclass_fields__}) for one in content["variables"])
        self.lower: FloatArray = np.array([v.lower for v in self.variables])
        self.upper: FloatArray = np.array([v.upper for v in self.variables])
        self.start: FloatArray = np.array([v.start for v in self.variables])
        self.is_logarithmic: npt.NDArray[np.bool_] = np.array([v.scale == "logarithmic" for v in self.variables], dtype=bool)
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
        """How many decision variables there are."""
        return len(self.variables)

    def clip(self, points: npt.ArrayLike) -> FloatArray:
        """The nearest points within the bounds, (n, d)."""
        return np.clip(to_points(points), self.lower, self.upper)

    def to_unit(self, points: npt.ArrayLike) -> FloatArray:
        """Points as shares of the way from the lower to the upper bound on each variable's own scale, (n, d) from 0 to 1.

        A step of the same size means the same for all variables here, linear or logarithmic.
        """
        low, high = self._to_scale(self.lower[np.newaxis]), self._to_scale(self.upper[np.newaxis])
        return np.asarray((self._to_scale(to_points(points)) - low) / (high - low), dtype=np.float64)

    def from_unit(self, shares: npt.ArrayLike) -> FloatArray:
        """The points of to_unit()'s shares, (n, d), clipped to the bounds."""
        low, high = self._to_scale(self.lower[np.newaxis]), self._to_scale(self.upper[np.newaxis])
        scaled = low + to_points(shares, "shares") * (high - low)
        magnitude = np.exp(np.where(self.is_logarithmic, scaled, 0.0))
        return self.clip(np.where(self.is_logarithmic, self._sign * magnitude, scaled))

    def _to_scale(self, points: FloatArray) -> FloatArray:
        logarithm = np.log(np.where(self.is_logarithmic, np.abs(points), 1.0))
        return np.where(self.is_logarithmic, logarithm, points)

    def calc_values(self, objectives: FloatArray) -> FloatArray:
        """The weighted sums of objectives (n, m): one number a point, (n,)."""
        total = self.weights[0] * objectives[:, 0]
        for i in range(1, len(self.weights)):
            total = total + self.weights[i] * objectives[:, i]
        return np.asarray(total, dtype=np.float64)
