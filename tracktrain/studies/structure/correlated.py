"""Analysis beside the survey: the report's Tables 4-2 to 4-4, and the data that come out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from fmus.carbody.default_data import shapes_at
from fmus.carbody.modal_data import ModalData, Mode
from structures.correlation import Correlation, correlate
from structures.errors import StructureError
from structures.scaling import ScaleFactors, scale_factors, scaled, with_measured
from structures.survey import Survey

from ...car.hopper import parameters_of
from .printed import names, printed

ALIKE = 0.4
"""Assurance below which a pair of shapes is not the same mode. A good pair has 0.9; a beam in the
survey's place knows nothing of an open car's walls, which sway more than the sills in lateral
bending, and reaches half."""


@dataclass(frozen=True)
class Pair:
    """A mode of the survey and the one of the analysis that is most like it, by assurance."""

    test: Mode
    analysis: Mode
    assurance: float


@dataclass(frozen=True, eq=False)
class Correlated:
    """An analysis as the model gives it, beside its survey."""

    car: str
    data: ModalData
    correlation: Correlation

    @property
    def pairs(self) -> list[Pair]:
        test, analysis = self.correlation.survey.modes, self.data.modes
        return [
            Pair(test[i], analysis[j], float(self.correlation.assurance[i, j]))
            for i, j in self.correlation.pairs
        ]

    @property
    def alike(self) -> list[Pair]:
        """The pairs that are the same mode; raises StructureError for none."""
        found = [pair for pair in self.pairs if pair.assurance >= ALIKE]
        if not found:
            raise StructureError(
                f"no mode of {self.correlation.survey.name} is like one of {self.data.name}: the "
                f"assurance is {self.correlation.assurance.max():.2f} at most, {ALIKE:g} is "
                "needed; look whether axes, signs and places of the sensors are those of the model"
            )
        return found

    @property
    def factors(self) -> ScaleFactors:
        """What the stiffness is to be multiplied by to meet the test."""
        return scale_factors(
            [pair.test.frequency for pair in self.alike],
            [pair.analysis.frequency for pair in self.alike],
        )

    def with_test_frequencies(self) -> ModalData:
        """The analysis' shapes with the test's frequencies."""
        return with_measured(self.data, {pair.analysis.name: pair.test for pair in self.alike})


def correlated(car: str, data: ModalData, survey: Survey | None = None) -> Correlated:
    """An analysis beside a survey, or beside the report's."""
    return Correlated(car, data, correlate(survey or reports_survey(car, data), data))


def reports_survey(car: str, data: ModalData) -> Survey:
    """The report's survey of a car, at the points of an analysis.

    Its frequencies are printed, its shapes are not (Figure 4-10 is lost). A twisted and two bent
    beams stand for them: that is what the report calls its modes.
    """
    values, found = parameters_of(car)["carbody"], printed("test", car)
    modes = tuple(
        Mode(name, frequency, values["modal_damping"], "measured", found.source)
        for name, frequency in zip(names(), found.values, strict=True)
    )
    shapes = np.stack([shapes_at(values, point) for point in data.points], axis=1)
    shapes[:, :, 3:] = np.nan  # accelerometers of a survey do not turn
    return Survey(f"report's survey, {car} car", modes, data.points, shapes)


def compared(found: Correlated) -> pd.DataFrame:
    """Test, report's analysis and ours of each pair: Tables 4-2 and 4-4."""
    theirs = dict(zip(names(), printed("analysis", found.car).values, strict=True))
    rows = [
        {
            "mode": pair.test.name,
            "test [Hz]": pair.test.frequency,
            "report [Hz]": theirs.get(pair.test.name, np.nan),
            "ours [Hz]": pair.analysis.frequency,
            "ours over test": pair.analysis.frequency / pair.test.frequency,
            "ours over report": pair.analysis.frequency / theirs.get(pair.test.name, np.nan),
            "assurance": pair.assurance,
            "our mode": pair.analysis.name,
        }
        for pair in found.pairs
    ]
    return pd.DataFrame(rows).set_index("mode")


def scaled_table(found: Correlated) -> pd.DataFrame:
    """Frequencies with the stiffness scaled by both readings of the factor: Table 4-3."""
    factors = found.factors
    theirs = dict(zip(names(), printed("scaled", "empty").values, strict=True))
    by_name = {
        reading: {m.name: m.frequency for m in scaled(found.data, factor).modes}
        for reading, factor in (
            ("by mean ratio, squared", factors.squared_mean),
            ("by mean of squares", factors.mean_square),
        )
    }
    rows = [
        {
            "mode": pair.test.name,
            "not scaled [Hz]": pair.analysis.frequency,
            **{f"{reading} [Hz]": f[pair.analysis.name] for reading, f in by_name.items()},
            "test [Hz]": pair.test.frequency,
            "report, scaled [Hz]": theirs.get(pair.test.name, np.nan),
        }
        for pair in found.pairs
    ]
    return pd.DataFrame(rows).set_index("mode")


def factor_table(found: Correlated) -> pd.DataFrame:
    """The scale factor of the stiffness in both readings (erratum 10), the report's beside ours."""
    reports = scale_factors(printed("test", "empty").values, printed("analysis", "empty").values)
    rows = [
        {
            "reading": reading,
            "report": getattr(reports, field),
            "ours": getattr(found.factors, field),
        }
        for reading, field in (
            ("mean ratio, squared (Table 4-3)", "squared_mean"),
            ("mean of squared ratios (printed)", "mean_square"),
        )
    ]
    return pd.DataFrame(rows).set_index("reading")
