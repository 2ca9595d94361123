"""Spectra that are fitted to tracks whose spectrum is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import stats

from fmus.track.recorded_data import TrackData, as_text
from fmus.track.spectra import CHANNELS
from support.random_track import gaussian
from tracktrain.cli.main import main
from tracktrain.geometry.errors import GeometryError
from tracktrain.geometry.making import empty, with_spectrum
from tracktrain.geometry.spectra import published, read_spectrum
from tracktrain.inspection.fitting import fit
from tracktrain.inspection.whittle import fit_form, fit_scale, nearest, periodogram

SPACING, COUNT, BAND = 0.5, 4000, (3.0, 40.0)
TRUE = {
    "alignment": {"A_a": 0.3027, "Omega_c": 0.8245},
    "profile": {"A_v": 0.5376, "Omega_c": 0.8245},
    "cross_level": {"A_v": 0.5376, "Omega_s": 1.1312},
    "gauge": {"A_v": 0.5376, "Omega_s": 1.1312},
}
"""FRA class 4, [cm^2.rad/m] and [rad/m]."""


def record(channel, random, name="fra4"):
    values = gaussian(published(name)[channel].density, SPACING, COUNT, random)
    return periodogram(values, SPACING, BAND)


@pytest.mark.parametrize("channel", ["profile", "cross_level"])
def test_intervals_of_the_form_hold_the_true_parameters_at_their_nominal_rate(channel):
    """In 95 % of 100 records: fewer than 87 or all of them have a probability of 0.2 %."""
    random = np.random.default_rng(7)
    held = dict.fromkeys(TRUE[channel], 0)
    for _ in range(100):
        found = {e.symbol: e for e in fit_form(record(channel, random), channel).parameters}
        for symbol, true in TRUE[channel].items():
            held[symbol] += found[symbol].low <= true <= found[symbol].high
    low = stats.binom.ppf(1e-3, 100, 0.95)
    assert all(low <= count < 100 for count in held.values()), held


def test_a_scales_interval_holds_it_at_its_nominal_rate():
    random, held = np.random.default_rng(8), 0
    density = published("fra4")["alignment"].density
    for _ in range(100):
        (scale,) = fit_scale(record("alignment", random), "alignment", density, "").parameters
        held += scale.low <= 1.0 <= scale.high
    assert stats.binom.ppf(1e-3, 100, 0.95) <= held < 100


def test_agreement_by_chance_is_as_likely_as_it_says():
    """A record of the form agrees worse than 5 % in one of 20 cases."""
    random = np.random.default_rng(9)
    chances = [fit_form(record("profile", random), "profile").misfit for _ in range(100)]
    below = np.mean(np.array(chances) < 0.05)
    assert stats.binom.ppf(1e-3, 100, 0.05) <= 100 * below <= stats.binom.ppf(0.999, 100, 0.05)


def test_joints_are_no_spectrum_of_the_form():
    """Low joints of 39 ft have lines that no smooth density has."""
    station = SPACING * np.arange(COUNT)
    random = np.random.default_rng(3)
    values = gaussian(published("fra4")["profile"].density, SPACING, COUNT, random)
    joints = 0.02 * np.abs(np.sin(np.pi * station / 11.8872))
    found = fit_form(periodogram(values + joints, SPACING, BAND), "profile")
    assert found.misfit < 1e-3


@pytest.mark.parametrize("name", ["fra3", "fra6", "german-high"])
def test_the_likeliest_spectrum_is_the_one_that_a_record_is_of(name):
    measured = record("profile", np.random.default_rng(2), name)
    known = ("fra2", "fra3", "fra4", "fra5", "fra6", "german-low", "german-high")
    assert nearest(measured, {n: published(n)["profile"].density for n in known}) == name


@pytest.fixture(scope="module")
def made():
    """What `track make` makes of class 4."""
    return with_spectrum(empty("made", 1000.0, SPACING), "fra4", seed=2)


def test_what_is_made_of_a_spectrum_is_fitted_by_it(made):
    table = fit(made).tables["fit"]
    for channel, true in TRUE.items():
        rows = table[table["channel"] == channel.replace("_", "-")].set_index("parameter")
        for symbol, value in true.items():
            assert rows.loc[symbol, "from"] <= value <= rows.loc[symbol, "to"], (channel, symbol)


@pytest.mark.parametrize("form", ["fra", "table", "nearest"])
def test_a_fitted_spectrum_is_a_file_that_a_track_is_made_of(made, form, tmp_path):
    found = fit(made, form)
    (tmp_path / "own.csv").write_bytes(found.files["spectrum.csv"])
    own = read_spectrum(tmp_path / "own.csv")
    for channel in CHANNELS:
        whole = np.sqrt(float(own.channels[channel].variance(1 / 40, 1 / 3)))
        exact = np.sqrt(float(published("fra4")[channel].variance(1 / 40, 1 / 3)))
        assert whole == pytest.approx(exact, rel=0.12), channel
    again = with_spectrum(empty("again", 400.0, 1.0), str(tmp_path / "own.csv"), seed=5)
    assert again.values[1].std() == pytest.approx(made.values[1].std(), rel=0.4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--form", "fra7"), "did you mean fra"),
        (("--waves", "3 m", "200 m"), "cannot tell a spectrum of waves of 3 to 200 m"),
        (("--waves", "0.2 m", "40 m"), "give --waves within 1 to 100 m"),
    ],
)
def test_what_cannot_be_fitted_says_what_could(made, arguments, message, tmp_path):
    path = tmp_path / "made.csv"
    path.write_text(as_text(made))
    result = CliRunner().invoke(main, ["track", "fit", str(path), *arguments])
    assert result.exit_code != 0 and message in " ".join(result.output.split()), result.output


def test_a_track_that_holds_no_ten_waves_is_refused():
    short = np.random.default_rng(1).standard_normal((4, 60)) * 1e-3
    with pytest.raises(GeometryError, match=r"15 m of track .* cannot tell"):
        fit(TrackData("short", 0.0, 0.25, short))


def test_a_perfect_track_has_no_spectrum():
    with pytest.raises(GeometryError, match="no channel"):
        fit(TrackData("flat", 0.0, 0.5, np.zeros((4, 2000))))


@pytest.mark.filterwarnings("error")
def test_a_sinusoid_is_not_of_the_form_and_that_is_said():
    track = empty("waves", 99.75, 0.25)
    track = replace(track, values=np.tile(1e-3 * np.sin(track.stations), (len(CHANNELS), 1)))
    with pytest.raises(GeometryError, match=r"alignment is not of the form .*--form nearest"):
        fit(track)


def test_a_channel_that_is_not_of_the_form_leaves_the_others_their_fits(made):
    values = made.values.copy()
    cross_level = CHANNELS.index("cross_level")  # of f^-4, which is steeper than the form can be
    values[cross_level] = gaussian(
        lambda f: 1e-9 * f**-4.0, SPACING, len(made.stations), np.random.default_rng(1), (1.0, 60.0)
    )
    found = fit(replace(made, values=values))
    spectra = found.tables["fit"].groupby("channel")["spectrum"].first()
    assert spectra["cross-level"] != "FRA form"
    assert (spectra.drop("cross-level") == "FRA form").all()
    assert any("cross-level likeliest" in note for note in found.notes)
